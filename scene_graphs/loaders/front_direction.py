"""Which way furniture faces where its source does not say: a box has four sides, and one of them is the front."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.furniture import class_of, group_of
from scene_graphs.layout import Array, Placed, Point2, wrap

LONGER: Final = 1.12
"""How many times longer one side must be before it says which way a piece is turned."""
REACH: Final = 1.0
"""A chair belongs to a table this near, in metres between the chair's middle and the table's edge."""
IN_VIEW: Final = 7.0
"""A sofa is turned to a screen this near, in metres."""
_QUARTERS: Final = np.arange(4) * (np.pi / 2)
_EVEN: Final = 0.05
"""Gaps to the wall that differ by less are the same, in metres."""
_EASY: Final = ("armchair", "lounge_chair", "lazy_sofa", "ottoman")
"""Seats that belong to no table and stand with their back to the wall more often than they face a screen."""


def faced(objects: Sequence[Placed], floor_polygon: Sequence[Point2], unknown: Container[str]) -> list[Placed]:
    """The objects in their order, those with an id in `unknown` turned so that their front is the likeliest side.

    The box of a piece stays where it is: only which of its four sides is the front is chosen, and width and depth trade
    places with a quarter turn. A bed's foot points away from its pillows, a chair and its table or desk face each
    other, a sofa faces the screen, and everything else has its back to the nearest wall, long side along it.
    """
    if not any(placed.id in unknown for placed in objects):
        return list(objects)
    company = _Company(objects, floor_polygon)
    return [
        _turned(placed, company.best_quarter(number)) if placed.id in unknown else placed
        for number, placed in enumerate(objects)
    ]


class _Company:
    """The objects of a room, asked where each would look."""

    def __init__(self, objects: Sequence[Placed], floor_polygon: Sequence[Point2]) -> None:
        self.objects = objects
        self.prints = np.array([shapely.Polygon(placed.footprint) for placed in objects], dtype=object)
        self.edges = shapely.boundary(self.prints)
        self.middles = shapely.points([(placed.position[0], placed.position[2]) for placed in objects])
        self.chairs = [number for number, placed in enumerate(objects) if _is_chair(placed)]
        self.tables = [number for number, placed in enumerate(objects) if class_of(placed.category) == "table"]
        floor = shapely.Polygon(floor_polygon)
        self.walls, self.middle = floor.boundary, np.array([floor.centroid.x, floor.centroid.y])

    def best_quarter(self, number: int) -> int:
        """How many quarter turns counter-clockwise bring the box's +Z side to where the front most likely is."""
        placed = self.objects[number]
        allowed = _quarters_by_shape(placed)
        wish = self._wish(number)
        if wish is not None:
            return int(allowed[np.argmax(np.round(_fronts(placed)[allowed] @ wish, 9))])
        gaps = np.round(self._gaps_behind(placed)[allowed] / _EVEN)
        inwards = _fronts(placed)[allowed] @ (self.middle - _plan(placed))
        return int(allowed[np.lexsort((-np.round(inwards, 9), gaps))[0]])

    def _wish(self, number: int) -> Array | None:
        """The direction [x, z] the piece would look in, or None if nothing but the wall decides."""
        placed = self.objects[number]
        if group_of(placed.category) == "bed":
            return self._from_pillows(number)
        if placed.category == "desk":
            return self._to_nearest(number, self.chairs)
        if _is_chair(placed):
            return self._to_nearest(number, self.tables)
        if class_of(placed.category) == "sofa" and placed.category not in _EASY:
            return self._to_screen(number)
        return None

    def _from_pillows(self, number: int) -> Array | None:
        bed = self.objects[number]
        on_it = shapely.contains_properly(self.prints[number], self.middles)
        pillows = [
            _plan(other)
            for other, lies_on_it in zip(self.objects, on_it, strict=True)
            if other.category in ("pillow", "cushion") and (lies_on_it or other.parent == bed.id)
        ]
        return _plan(bed) - np.mean(pillows, axis=0) if pillows else None

    def _to_nearest(self, number: int, others: list[int]) -> Array | None:
        """Towards the nearest edge of the nearest of those pieces; inwards from it for one that is pushed under."""
        if not others:
            return None
        edges = self.edges[others]
        away = shapely.distance(edges, self.middles[number])
        nearest = int(np.argmin(away))
        is_under = shapely.covers(self.prints[others[nearest]], self.middles[number])
        if away[nearest] > REACH and not is_under:
            return None
        to_edge = np.diff(shapely.get_coordinates(shapely.shortest_line(self.middles[number], edges[nearest])), axis=0)
        return np.asarray(-to_edge[0] if is_under else to_edge[0], dtype=float)

    def _to_screen(self, number: int) -> Array | None:
        here = _plan(self.objects[number])
        ways = [_plan(o) - here for o in self.objects if o.category in ("tv", "tv_stand")]
        way = min(ways, key=lambda way: float(np.hypot(*way)), default=None)
        return None if way is None or np.hypot(*way) > IN_VIEW else way

    def _gaps_behind(self, placed: Placed) -> Array:
        """Mean distance from the box's side behind each of the four fronts to the wall. (4,)."""
        corners = placed.footprint[[3, 0, 1, 2, 3]]  # the back side at no turn, then round counter-clockwise
        backs = np.stack([corners[:-1], (corners[:-1] + corners[1:]) / 2, corners[1:]], axis=1)  # (4, 3, 2)
        gaps: Array = shapely.distance(shapely.points(backs), self.walls).mean(axis=1)
        return gaps


def _is_chair(placed: Placed) -> bool:
    return class_of(placed.category) == "seat" and placed.category not in _EASY


def _plan(placed: Placed) -> Array:
    return np.array([placed.position[0], placed.position[2]])


def _fronts(placed: Placed) -> Array:
    """The four directions [x, z] in which the front may be. (4, 2)."""
    yaws = placed.yaw + _QUARTERS
    return np.stack([np.sin(yaws), np.cos(yaws)], axis=1)


def _quarters_by_shape(placed: Placed) -> NDArray[np.intp]:
    """The quarter turns that make a long bed deep and every other long piece wide; all four of a squarish one."""
    w, _, d = placed.size
    if max(w, d) <= LONGER * min(w, d) or _is_chair(placed):
        return np.arange(4)
    wants_depth = group_of(placed.category) == "bed" and placed.category != "sofa_bed"
    return np.array([0, 2] if (d > w) == wants_depth else [1, 3])


def _turned(placed: Placed, quarters: int) -> Placed:
    w, h, d = placed.size
    yaw = wrap(placed.yaw + float(_QUARTERS[quarters]))
    return replace(placed, yaw=yaw, size=(d, h, w) if quarters % 2 else (w, h, d))
