"""Which room each keyframe plays in, where a script does not say: the one that usually has its furniture."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from motion_backend.motion import Emotion, Skill
from motion_backend.procedural.walk.walk_styles import walk_style
from planner_service.grounding.seat_tables import tables_of
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.script import LongScript, PlannedKeyframe
from scene_graphs.furniture import canonical, categories_of
from scene_graphs.layout import Layout

FOUND = 0.1
"""Furniture that so many rooms of a type have is found where it is asked for."""
USUAL = 0.3
"""A room type of which this share has a piece is a place for it; a body need not go elsewhere,"""
ENOUGH = 5
"""nor where so many rooms of the type have it with all that is used there besides: one of them is found."""
Wanted = tuple[frozenset[str], ...]
"""Categories of furniture of which a room has one each."""


def housed(script: LongScript, layouts: Sequence[Layout], types: Sequence[str]) -> LongScript:
    """The script with a room at every keyframe, one of `types`; what has a room keeps it.

    The body stays where it is as long as that kind of room usually has what is used next, or some of them have all that
    is used there. A keyframe on the floor plays where the next piece of furniture is; where the body is, if it stays on
    the spot.
    """
    if all(keyframe.room for keyframe in script.keyframes):
        return script
    room: str | None = next((keyframe.room for keyframe in script.keyframes if keyframe.room), None)
    rooms: list[str | None] = []
    used: dict[str | None, Wanted] = {}
    for keyframe, table in zip(script.keyframes, tables_of(script.keyframes), strict=True):
        wanted = () if keyframe.on_floor else _wanted(keyframe.piece[0], table)
        if keyframe.room or keyframe.on_floor:
            here = room if _stays(keyframe) else None
            rooms.append(keyframe.room or here)
        else:
            shares = shares_of(keyframe.piece[0], layouts, types, table)
            stays = room is not None and (shares.get(room, 0.0) >= USUAL or not any(shares.values()))
            stays = stays or (room in types and _having(layouts, room, (*used.get(room, ()), *wanted)) >= ENOUGH)
            rooms.append(room if stays else max(types, key=lambda name: shares[name]))
        room = rooms[-1] or room
        used[rooms[-1]] = (*used.get(rooms[-1], ()), *wanted)
    known = [name for name in rooms if name] or [types[0]]
    for index in reversed(range(len(rooms))):
        following = rooms[index + 1] if index + 1 < len(rooms) else known[-1]
        rooms[index] = rooms[index] or following
    keyframes = [k.model_copy(update={"room": name}) for k, name in zip(script.keyframes, rooms, strict=True)]
    return script.model_copy(update={"keyframes": tuple(keyframes)})


def _stays(keyframe: PlannedKeyframe) -> bool:
    """Whether it is done on the spot, wherever the body is: who stands still, waves or weeps."""
    on_spot = keyframe.on_floor and keyframe.skill is Skill.LOCO
    return on_spot and walk_style(Emotion.NEUTRAL, look_of(keyframe.caption)).stays > 0


def usual_furniture(layouts: Sequence[Layout], room_type: str) -> frozenset[str]:
    """Categories that at least `FOUND` of the rooms of a type have."""
    own = [layout for layout in layouts if layout.room_type == room_type]
    having = Counter(category for layout in own for category in {placed.category for placed in layout.objects})
    return frozenset(category for category, count in having.items() if count >= FOUND * len(own))


def shares_of(
    word: str, layouts: Sequence[Layout], types: Sequence[str], beside: str | None = None
) -> dict[str, float]:
    """For each room type, the share of its rooms that have such a piece, and one of those that it stands `beside`."""
    wanted = _wanted(word, beside)
    counts = Counter(layout.room_type for layout in layouts)
    return {name: _having(layouts, name, wanted) / max(counts[name], 1) for name in types}


def _wanted(word: str, beside: str | None) -> Wanted:
    return tuple(categories_of(canonical(one)) for one in (word, beside) if one is not None)


def _having(layouts: Sequence[Layout], room: str | None, wanted: Wanted) -> int:
    """How many rooms of a type have all that is wanted."""
    own = ({one.category for one in layout.objects} for layout in layouts if layout.room_type == room)
    return sum(all(kinds & there for kinds in wanted) for there in own)
