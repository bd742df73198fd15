"""What of a room's furniture a body can really use, piece by piece, and what keeps it from the rest.

Where a table, or anything, blocks a seat, a chair is pulled out by the least move after which it can be sat on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import cos, hypot, pi, sin
from typing import Final, Literal

import numpy as np

from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.affordances.room_validation import OUT_OF_REACH, RoomCheck, solids_overlap
from scene_graphs.furniture import affordances, class_of, group_of
from scene_graphs.layout import Array, Layout, Placed, Point3

BACK: Final = np.arange(0.05, 0.81, 0.05)
"""A chair is pulled back by one of these distances, in metres."""
SLIGHTLY: Final = pi / 12 * np.arange(-3, 4)
"""Straight, or turned so far with its back first (radians)."""
OUT: Final = np.arange(0.1, 1.51, 0.1)
"""Where that does not help, since a wall is behind it, it is taken out by one of these distances,"""
ALL_ROUND: Final = pi / 8 * np.arange(-7, 9)
"""in any direction, turned in any way."""
TURNING: Final = 0.3
"""A radian of turning counts as much as this many metres of moving."""
HEAVY: Final = frozenset({"armchair", "bench", "lounge_chair"})
"""Seats nobody pulls out with one hand."""


@dataclass(frozen=True)
class Pull:
    """A seat moved away from what it faces, so that a body can sit down on it (metres, radians)."""

    object_id: str
    start: Point3
    """Its position before."""
    start_yaw: float
    end: Point3
    end_yaw: float

    @property
    def distance(self) -> float:
        """How far it was moved."""
        return hypot(self.end[0] - self.start[0], self.end[2] - self.start[2])


def can_be_pulled(placed: Placed) -> bool:
    """Whether it is a seat that one moves to sit down: a chair or stool that stands on the floor."""
    return class_of(placed.category) == "seat" and placed.category not in HEAVY and placed.parent is None


def pulled_out(layout: Layout, object_id: str) -> Pull | None:
    """The least pull after which a body can sit on a seat; None if none helps, or none is needed.

    The seat comes straight back, away from what it faces, or slightly turned. Where that does not help, because it is
    hemmed in by walls and other chairs, it is taken out and set down near by, as little turned as can be. It ends
    inside the walls, in nothing, before no door, and takes nobody's way to what could be used before. KeyError if the
    layout has no such object.
    """
    seat, check = layout.object(object_id), RoomCheck(layout)
    if not can_be_pulled(seat) or not (places := spots(seat, "sit")) or any(map(check.is_usable, places)):
        return None
    return next((pull for pull in _promising(check, seat, places) if is_as_good(check, pull)), None)


def pulled(layout: Layout, pull: Pull) -> Layout:
    """The room with the seat, and what lies on it, where the pull leaves it."""
    seat, carried = layout.object(pull.object_id), RoomCheck(layout).carried[pull.object_id]
    there = replace(seat, position=pull.end, yaw=pull.end_yaw)

    def moved(placed: Placed) -> Placed:
        x, y, z = there.to_world(seat.to_local(placed.position)).tolist()
        return replace(placed, position=(x, y, z), yaw=placed.yaw + pull.end_yaw - pull.start_yaw)

    objects = [moved(placed) if placed.id in carried else placed for placed in layout.objects]
    return replace(layout, objects=tuple(there if placed.id == seat.id else placed for placed in objects))


def _promising(check: RoomCheck, seat: Placed, places: Sequence[Spot]) -> Iterator[Pull]:
    """Pulls that leave the seat inside the walls with room to stand before it, the least first."""
    for moves in (_PULLED_BACK, _TAKEN_OUT):
        turn = moves[:, 2] + seat.yaw
        ends = seat.to_world(np.insert(moves[:, :2], 1, 0.0, axis=1))[:, [0, 2]]
        inside = check.within_walls(_turned(ends, turn, seat.footprint, seat))
        stands = _turned(ends, turn, np.array([spot.standing for spot in places]), seat)
        for number in np.flatnonzero(inside & check.has_room(stands, seat.id).any(axis=1)):
            end = (float(ends[number, 0]), seat.position[1], float(ends[number, 1]))
            yield Pull(seat.id, seat.position, seat.yaw, end, float(turn[number]))


def _turned(ends: Array, yaws: Array, points: Array, seat: Placed) -> Array:
    """Where M points [x, z] that move with a seat come to be for N of its places. (N, M, 2)."""
    away, turn = points - [seat.position[0], seat.position[2]], yaws - seat.yaw
    straight, across = np.cos(turn)[:, None], np.sin(turn)[:, None]
    x, z = away.T
    return np.asarray(ends[:, None] + np.stack([straight * x + across * z, straight * z - across * x], axis=-1))


def is_as_good(check: RoomCheck, pull: Pull) -> bool:
    """Whether a body can sit on a seat where a pull leaves it, and nothing in the room is the worse for it."""
    layout = pulled(check.layout, pull)
    seat, there = check.layout.object(pull.object_id), layout.object(pull.object_id)
    reach = hypot(seat.size[0], seat.size[2])
    others = (
        other
        for other in layout.objects
        if other.id not in check.carried[seat.id]
        and other.category != "rug"
        and hypot(other.position[0] - pull.end[0], other.position[2] - pull.end[2])
        < (reach + hypot(other.size[0], other.size[2])) / 2
    )
    if any(solids_overlap(there, other) and not solids_overlap(seat, other) for other in others):
        return False
    after = RoomCheck(layout, check.cell)
    if next(after.usable(there, "sit"), None) is None or after.blocked_doors().keys() - check.blocked_doors().keys():
        return False
    return set(after.unreachable()) <= set(check.unreachable())


def _moves(distances: Array, ways: Iterable[tuple[float, float]]) -> Array:
    """Moves [x, z, turn] in a seat's own frame, the least first; a way is a direction off straight back and a turn."""
    moves = [
        (round(distance + TURNING * abs(turn), 6), abs(way), -distance * sin(way), -distance * cos(way), turn)
        for way, turn in ways
        for distance in distances
    ]
    return np.array(sorted(moves))[:, 2:]


_PULLED_BACK: Final = _moves(BACK, zip(SLIGHTLY, SLIGHTLY, strict=True))
_TAKEN_OUT: Final = _moves(OUT, product(ALL_ROUND, ALL_ROUND[1::2]))


Verdict = Literal["as placed", "pulled out", "no surface", "no room", "no way"]
"""Used where it stands, or after a pull; else it has no surface, nobody can stand before it, or nobody gets there."""


@dataclass(frozen=True)
class Use:
    """One piece and one thing that is done with such pieces."""

    object_id: str
    category: str
    affordance: str
    verdict: Verdict
    hindrance: str = ""
    """no room: what stands where the body would, most often: "wall" or a group of furniture."""


def uses(layout: Layout) -> Iterator[Use]:
    """Every piece that stands on the floor and is to be sat or lain on, in the layout's order."""
    check = RoomCheck(layout)
    for placed in layout.objects:
        if placed.parent is None and placed.position[1] < OUT_OF_REACH:
            for affordance in ("sit", "lie"):
                if affordance in affordances(placed.category):
                    yield _use(check, placed, affordance)


def count_uses(layouts: Iterable[Layout]) -> dict[tuple[str, str], Counter[str]]:
    """For every category and affordance, how many pieces got each verdict; "no room" with what is in the way."""
    counts: dict[tuple[str, str], Counter[str]] = {}
    for layout in layouts:
        for use in uses(layout):
            said = f"{use.verdict}: {use.hindrance}" if use.hindrance else use.verdict
            counts.setdefault((use.category, use.affordance), Counter())[said] += 1
    return counts


def _use(check: RoomCheck, placed: Placed, affordance: str) -> Use:
    found = spots(placed, affordance)
    verdict: Verdict
    hindrance = ""
    if not found:
        verdict = "no surface"
    elif any(map(check.is_usable, found)):
        verdict = "as placed"
    elif affordance == "sit" and pulled_out(check.layout, placed.id) is not None:
        verdict = "pulled out"
    else:
        hindrances = Counter(_hindrance(check, spot) for spot in found)
        hindrance = "" if "" in hindrances else hindrances.most_common(1)[0][0]
        verdict = "no room" if hindrance else "no way"
    return Use(placed.id, placed.category, affordance, verdict, hindrance)


def _hindrance(check: RoomCheck, spot: Spot) -> str:
    """What stands where a body would stand: "wall", the group of a piece, or nothing."""
    owner = check.in_the_way(spot)
    return owner if owner in ("", "wall") else group_of(check.layout.object(owner).category)
