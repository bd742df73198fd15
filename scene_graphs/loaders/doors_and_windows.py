"""Doors and windows of a house: found as things between rooms, then given to every room in whose wall they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import shapely

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Array, Point2, Segment
from scene_graphs.loaders.floor_polygon import ON_WALL, on_outline
from scene_graphs.loaders.plan_boxes import rectangle_around

MAX_GAPS: Final = 1000
"""Doors and windows of one house."""
MIN_GAP, MAX_GAP = 0.4, 6.0
"""No door or window is narrower or wider, in metres."""
SAME: Final = 0.35
"""Two things whose middles are this near to each other's line are one gap: a leaf, its frame and its hole."""
MAX_TRIES: Final = 200_000
"""Sides of rooms compared with gaps near them; 500 in a house of eight rooms."""
_COVERED: Final = 0.6
"""The share of a gap's width that lies in a room's wall if it is that room's."""
_DOOR_SILL, _DOOR_TOP = 0.3, 1.6
"""A gap that begins lower and ends higher, in metres, can be walked through."""


class Gap(NamedTuple):
    """A door or a window of a house, its heights above the house's floor."""

    is_door: bool
    segment: Segment
    bottom: float
    top: float


def gap_around(points: Array, is_door: bool | None = None) -> Gap | None:
    """The gap that a door's or window's points [x, y, z] fill; None if they are too narrow, too wide or too flat.

    Where `is_door` is None, what reaches from the floor to a head's height is a door.
    """
    start, end = rectangle_around(points[:, [0, 2]]).long_axis
    width = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    bottom, top = float(points[:, 1].min()), float(points[:, 1].max())
    if not MIN_GAP <= width <= MAX_GAP or top - bottom < MIN_GAP:
        return None
    if is_door is None:
        is_door = bottom <= _DOOR_SILL and top >= _DOOR_TOP
    return Gap(is_door, (start, end), bottom, top)


def distinct(gaps: Sequence[Gap]) -> list[Gap]:
    """The gaps, the first of those that fill one hole."""
    if not gaps:
        return []
    lines = shapely.linestrings([gap.segment for gap in gaps[:MAX_GAPS]])
    middles = shapely.centroid(lines)
    kept: list[int] = []
    for number, (line, middle) in enumerate(zip(lines, middles, strict=True)):
        before = min(
            shapely.distance(lines[kept], middle).min(initial=np.inf),
            shapely.distance(middles[kept], line).min(initial=np.inf),
        )
        if before > SAME:
            kept.append(number)
    return [gaps[number] for number in kept]


def gaps_of_rooms(gaps: Sequence[Gap], floors: Sequence[Sequence[Point2] | None]) -> list[list[Gap]]:
    """For every room the gaps in its walls; a door between two rooms is in both."""
    found: list[list[Gap]] = [[] for _ in floors]
    lines = shapely.linestrings([gap.segment for gap in gaps]) if gaps else np.empty(0, dtype=object)
    tries = 0
    for room, floor in zip(found, floors, strict=True):
        if floor is None or len(floor) < 3 or not gaps:
            continue
        walls = shapely.Polygon(floor).exterior
        shapely.prepare(walls)
        for number in np.flatnonzero(shapely.dwithin(lines, walls, ON_WALL)).tolist():
            gap, tries = gaps[number], tries + len(floor)
            if tries > MAX_TRIES:
                raise LayoutError(f"doors and windows stand at more than {MAX_TRIES} walls", "split the house")
            on_wall = on_outline(gap.segment, floor)
            if on_wall is not None and _length(on_wall) >= _COVERED * _length(gap.segment):
                room.append(gap)
    return found


def _length(segment: Segment) -> float:
    (ax, az), (bx, bz) = segment
    return float(np.hypot(bx - ax, bz - az))
