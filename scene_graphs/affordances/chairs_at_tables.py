"""Chairs drawn up to the table they belong to, for what is done at it: rooms show chairs a step away, ready to sit on.

A chair is set down square before a side of the table, so near that bent elbows reach it from the front of the seat,
and so far that a body still gets between.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from math import atan2, cos, hypot, sin
from typing import Final

import numpy as np

from scene_graphs.affordances.affordances import spots
from scene_graphs.affordances.room_validation import RoomCheck
from scene_graphs.affordances.usable_furniture import Pull, can_be_pulled, is_as_good
from scene_graphs.furniture import class_of
from scene_graphs.layout import Layout, Placed, wrap

FROM_TABLE: Final = (0.48, 0.46, 0.44)
"""Gaps between the front of a seat and the edge of the table, the best first (metres)."""
NEAR: Final = 0.5
"""A chair that stands square before the table with no wider gap stays where it is (metres)."""
SQUARE: Final = 0.3
"""What counts as square (radians)."""
BELONGS: Final = 1.6
"""A table whose edge is this near to the middle of a chair is the chair's (metres)."""
HEIGHTS: Final = (0.6, 0.82)
"""Between these a top is one to eat and write at from a chair (metres)."""
FROM_CORNER: Final = 0.32
"""The middle of a seat stands so far from the corner of the table at least, where the side is long enough (metres)."""
_ASIDE: Final = (0.0, 0.25, -0.25, 0.5, -0.5)
"""Along the side, from the place nearest to where the chair stands (metres)."""
_TRIES: Final = 12


def drawn_up(layout: Layout, object_id: str) -> Pull | None:
    """Where a chair is set for what is done at its table; None where it stands so, has no table near by, or where
    nobody could sit on it then. KeyError if the layout has no such object."""
    seat = layout.object(object_id)
    if not can_be_pulled(seat):
        return None
    check = RoomCheck(layout)
    near = [(_edge_away(one, seat), one) for one in layout.objects if _is_table(one)]
    for away, table in sorted(near, key=lambda pair: pair[0]):
        if away > BELONGS:
            return None
        if _stands_at(seat, table):
            return None
        fitting = islice(_fitting(check, seat, table), _TRIES)
        found = next((pull for pull in fitting if is_as_good(check, pull)), None)
        if found is not None:
            return found
    return None


def _is_table(placed: Placed) -> bool:
    top = placed.position[1] + placed.size[1]
    return class_of(placed.category) == "table" and placed.parent is None and HEIGHTS[0] <= top <= HEIGHTS[1]


def _edge_away(table: Placed, seat: Placed) -> float:
    """From the middle of a seat to the nearest edge of a table (metres)."""
    x, _, z = np.abs(table.to_local(seat.position))
    return hypot(max(x - table.size[0] / 2, 0.0), max(z - table.size[2] / 2, 0.0))


def _stands_at(seat: Placed, table: Placed) -> bool:
    """Whether a seat stands square and near before one side of a table."""
    return any(
        abs(wrap(yaw - seat.yaw)) < SQUARE and abs(along) <= half and ahead - seat.size[2] / 2 <= NEAR
        for yaw, along, half, ahead in _sides(table, seat)
    )


def _sides(table: Placed, seat: Placed) -> list[tuple[float, float, float, float]]:
    """Each side of a table that a seat is before: the yaw that faces it, where along it the seat is, half its length
    and how far before it the seat is (metres); the nearest first."""
    x, _, z = table.to_local(seat.position)
    half_x, half_z = table.size[0] / 2, table.size[2] / 2
    sides = []
    for out_x, out_z in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        along, half = (x, half_x) if out_z else (z, half_z)
        ahead = x * out_x + z * out_z - (half_z if out_z else half_x)
        if ahead > 0.0:
            sides.append((table.yaw + atan2(-out_x, -out_z), float(along), half, float(ahead)))
    return sorted(sides, key=lambda side: side[3] + max(abs(side[1]) - side[2], 0.0))


def _fitting(check: RoomCheck, seat: Placed, table: Placed) -> Iterator[Pull]:
    """Where the seat would stand inside the walls with room for a body before it, the best first."""
    for pull in _places_at(seat, table):
        there = replace(seat, position=pull.end, yaw=pull.end_yaw)
        stands = np.array([spot.standing for spot in spots(there, "sit")])
        inside = check.within_walls(there.footprint[None])[0]
        if inside and check.has_room(stands, seat.id).any():
            yield pull


def _places_at(seat: Placed, table: Placed) -> Iterator[Pull]:
    for yaw, along, half, _ in _sides(table, seat):
        most = max(half - FROM_CORNER, 0.0)
        middle = float(np.clip(along, -most, most))
        along_side = dict.fromkeys(round(float(np.clip(middle + aside, -most, most)), 6) for aside in _ASIDE)
        for at in along_side:
            for gap in FROM_TABLE:
                yield Pull(seat.id, seat.position, seat.yaw, _before(table, seat, yaw, at, gap), yaw)


def _before(table: Placed, seat: Placed, yaw: float, along: float, gap: float) -> tuple[float, float, float]:
    """The middle of a seat that faces a side of a table with a gap between them."""
    out_x, out_z = -round(sin(yaw - table.yaw)), -round(cos(yaw - table.yaw))
    half = table.size[2] / 2 if out_z else table.size[0] / 2
    ahead = half + gap + seat.size[2] / 2
    local = (along, 0.0, out_z * ahead) if out_z else (out_x * ahead, 0.0, along)
    x, _, z = table.to_world(local)
    return float(x), seat.position[1], float(z)
