"""Which pieces of a home hands open, shut and switch in the actions of a script, as far as these have what moves."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final, Literal

from motion_backend.body.cast import Worked
from motion_backend.motion import Action, Does, Skill
from motion_backend.props import works
from planner_service.grounding.opening_places import opening_piece
from planner_service.scripts.script import LongScript, PlannedKeyframe
from planner_service.themes.opening_words import opening_of
from scene_graphs.affordances.affordances import Spot
from scene_graphs.furniture import categories_of, class_of
from scene_graphs.home import Home
from scene_graphs.layout import Placed

HANGING: Final = 0.8
"""How high hands hang of who walks (metres)."""
GOES_OUT: Final = re.compile(
    r"\b(?:out of|out at|out through|through|leav\w+|left|go(?:es)? out|storms? out)\b", re.IGNORECASE
)
SCREENS: Final = frozenset(("tv", "monitor"))
_BY_CAPTION: Final[tuple[tuple[re.Pattern[str], Does], ...]] = (
    (re.compile(r"^slamming\b"), "close"),
    (re.compile(r"^turn on\b"), "on"),
)
"""What captions of a script without a theme do to the piece that they name."""


def worked_pieces(actions: Sequence[Action], script: LongScript, home: Home) -> dict[int, Worked]:
    """What hands open, shut and switch, by keyframe; nothing at a piece of which nothing moves. Who comes in has the
    door open behind, who goes out before them."""
    found: dict[int, Worked] = {}
    for action in actions:
        keyframe = script.keyframes[action.keyframe]
        if action.skill is Skill.LOCO:
            passed = _passed(action, f"{keyframe.caption}; {script.said_of(keyframe)}", home)
            found |= {action.keyframe: passed} if passed is not None else {}
            continue
        does = _does(keyframe)
        if action.skill is not Skill.TOUCH or action.spot is None or not does or action.lacks:
            continue
        before = next((one.piece for one in reversed(found.values()) if one.piece.category in SCREENS), None)
        piece = _piece(home, action.spot, keyframe.piece[0], does, before)
        if piece is not None:
            hand: Literal["left", "right"] = "left" if action.hand == "left" else "right"
            found[action.keyframe] = Worked(does, piece, action.spot.point, hand, action.handle)
    return found


def _passed(action: Action, said: str, home: Home) -> Worked | None:
    """The door that is shut behind who has just come in by it, or opens before who goes out."""
    place = action.begins[:2] if action.begins else action.goal
    leaves = opening_of(action.skill, said) == "door" and GOES_OUT.search(said) is not None
    leaves = leaves or (action.skill is Skill.LOCO and action.handle is not None)
    if place is None or action.lacks or not (action.begins or leaves):
        return None
    door = opening_piece(home, True, place)
    does: Does = "close" if action.begins else "open"
    if door is None:
        return None
    at = (place[0], HANGING, place[1]) if action.begins or action.spot is None else action.spot.point
    return Worked(does, door, at, "left" if action.hand == "left" else "right", action.handle)


def _does(keyframe: PlannedKeyframe) -> Does | None:
    """What is done to the piece under the hand: as the keyframe says, or, of one that no theme stands behind, its
    caption."""
    if keyframe.does or keyframe.beat is not None:
        return keyframe.does or None
    return next((does for words, does in _BY_CAPTION if words.search(keyframe.caption)), None)


def _piece(home: Home, spot: Spot, named: str, does: Does, before: Placed | None) -> Placed | None:
    """The piece that is meant by a hand at a spot: that which it is on, or what stands on that; a lamp that hangs in
    the room where nobody gets to it; a screen that is switched off from afar."""
    if spot.object_id in ("door", "window"):
        return opening_piece(home, spot.object_id == "door", (spot.point[0], spot.point[2]))
    own = next((one for one in home.objects if one.id == spot.object_id), None)
    if own is None:
        return None
    if does in ("open", "close", "into") and class_of(own.category) != class_of(named):
        return None
    standing = [one for one in home.objects if one.parent == own.id]
    hanging = [
        one for one in home.objects
        if does in ("on", "off") and one.category in categories_of("lamp") and one.category in categories_of(named)
        and home.room_at((one.position[0], one.position[2])) == home.room_at(spot.standing)
    ]  # fmt: skip
    afar = [before] if before is not None and does == "off" else []
    return next((one for one in (own, *standing, *hanging, *afar) if works(one, does)), None)
