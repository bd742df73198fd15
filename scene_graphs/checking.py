"""Whether a room can be lived in: what stands in the way, what overlaps, and which spots a body can get to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, islice
from math import cos, pi, sin

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.clearance import Clearance, measure_clearance, obstacles, part_outline
from scene_graphs.forms import parts
from scene_graphs.furniture import AFFORDANCES, affordances, group_of
from scene_graphs.layouts import Layout, Opening, Placed, Point2
from scene_graphs.surfaces import Spot, spots

STANDING_RADIUS = 0.20
"""What a body standing at a spot keeps free of other things: a little less than when walking."""
DOOR_CLEAR = 0.6
"""Depth of the floor inside a door that nothing may stand on, in metres."""
OUT_OF_REACH = 1.4
"""Things whose bottom hangs higher than this offer no spot a room must make reachable."""
MOST_OVERLAPS = 100
"""Overlaps that are told of one room; a heap of things has thousands."""
_LEAST_OVERLAP = 2e-3
_STEPS = (0.0, 0.1, 0.2, 0.3)
_TURNS = (0.0, pi / 4, -pi / 4, pi / 2, -pi / 2)


@dataclass(frozen=True)
class RoomCheck:
    """A layout with its clearance measured once; asks what works in it."""

    layout: Layout
    cell: float = 0.05

    @cached_property
    def floor(self) -> shapely.Polygon:
        """The outline of the room."""
        return shapely.Polygon(self.layout.floor_polygon)

    @cached_property
    def clearance(self) -> Clearance:
        """Clearance to furniture and walls; doors count as wall."""
        blocked = [outline for _, outline in self._obstacles]
        return measure_clearance(self.floor, blocked, [self.floor.exterior], self.cell)

    @cached_property
    def main_region(self) -> int:
        """The connected region inside the first door, or the largest of a room without doors; 0 if there is none."""
        regions = self.clearance.regions
        if self.layout.doors:
            return self._region_behind(self.layout.doors[0])
        counts = np.bincount(regions.ravel())[1:]
        return int(counts.argmax()) + 1 if len(counts) else 0

    def usable(self, placed: Placed, affordance: str) -> Iterator[Spot]:
        """Spots of an object that a body can walk to, stand at and use, best first."""
        return (spot for spot in spots(placed, affordance) if self.is_usable(spot))

    def is_usable(self, spot: Spot) -> bool:
        """Whether a body fits at the spot's standing point and gets there from the door."""
        here = shapely.Point(spot.standing)
        if not self.floor.contains(here) or self.floor.exterior.distance(here) < STANDING_RADIUS:
            return False
        if self._distance_to_others(spot) < STANDING_RADIUS:
            return False
        return self.main_region != 0 and any(self._is_walkable(point) for point in _ways_out(spot))

    def problems(self) -> list[str]:
        """What is wrong with the room, one sentence each; empty if nothing is."""
        return [*self._outside(), *self._overlaps(), *self._blocked_doors(), *self._unreachable()]

    def unreachable(self) -> list[tuple[str, str]]:
        """(object id, affordance) of everything a body should be able to use and cannot."""
        return [
            (placed.id, affordance)
            for placed in self.layout.objects
            if placed.position[1] < OUT_OF_REACH
            and (placed.parent is None or group_of(placed.category) in ("light", "media"))
            for affordance in AFFORDANCES
            if affordance in affordances(placed.category)
            and spots(placed, affordance)
            and next(self.usable(placed, affordance), None) is None
        ]

    @cached_property
    def _obstacles(self) -> list[tuple[Placed, shapely.Polygon]]:
        return obstacles(self.layout.objects)

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree([outline for _, outline in self._obstacles])

    @cached_property
    def _owners(self) -> NDArray[np.str_]:
        """The ids of the objects that the outlines of the tree belong to."""
        return np.array([placed.id for placed, _ in self._obstacles], dtype=np.str_)

    def _distance_to_others(self, spot: Spot) -> float:
        here = shapely.Point(spot.standing)
        near = self._tree.query(here.buffer(STANDING_RADIUS))
        others = near[self._owners[near] != spot.object_id]
        return float(shapely.distance(here, self._tree.geometries[others]).min(initial=1.0))

    def _is_walkable(self, point: Point2) -> bool:
        return self.clearance.region_at(point) == self.main_region

    def _region_behind(self, door: Opening) -> int:
        """The region of the floor just inside a door, a little farther in where a body does not fit yet."""
        (x, z), inward = _middle(door), self._inward(door)
        for depth in (0.3, 0.4, 0.5, 0.6):
            region = self.clearance.region_at((x + inward[0] * depth, z + inward[1] * depth))
            if region:
                return region
        return 0

    def _inward(self, door: Opening) -> Point2:
        (ax, az), (bx, bz) = door.segment
        length = float(np.hypot(bx - ax, bz - az)) or 1.0
        nx, nz = (az - bz) / length, (bx - ax) / length
        x, z = _middle(door)
        return (nx, nz) if self.floor.contains(shapely.Point(x + 0.1 * nx, z + 0.1 * nz)) else (-nx, -nz)

    def _outside(self) -> list[str]:
        room = self.floor.buffer(0.03)
        return [
            f"{placed.id} stands outside the walls"
            for placed in self.layout.objects
            if not room.contains(shapely.Polygon(placed.footprint))
        ]

    def _overlaps(self) -> list[str]:
        solid = [placed for placed in self.layout.objects if placed.category != "rug"]
        found = (
            f"{a.id} and {b.id} overlap"
            for a, b in combinations(solid, 2)
            if a.parent != b.id and b.parent != a.id and solids_overlap(a, b)
        )
        return list(islice(found, MOST_OVERLAPS))

    def _blocked_doors(self) -> list[str]:
        found = []
        for index, door in enumerate(self.layout.doors):
            area = door_area(door, self._inward(door))
            for placed, outline in self._obstacles:
                if outline.intersection(area).area > _LEAST_OVERLAP:
                    found.append(f"door {index} is blocked by {placed.id}")
                    break
            if index and self._region_behind(door) != self.main_region:
                found.append(f"door {index} cannot be reached from door 0")
        return found

    def _unreachable(self) -> list[str]:
        verbs = {"sit": "sit on", "lie": "lie on", "touch": "touch"}
        return [f"nobody can get to {name} to {verbs[affordance]} it" for name, affordance in self.unreachable()]


def validate(layout: Layout) -> list[str]:
    """Problems of a room, one sentence each: outside the walls, overlaps, blocked doors, what nobody can get to."""
    return RoomCheck(layout).problems()


def solids_overlap(a: Placed, b: Placed) -> bool:
    """Whether solid parts of two objects share space (a chair may be pushed under a table, not into it)."""
    reach = sum(float(np.hypot(placed.size[0], placed.size[2])) / 2 for placed in (a, b))
    if np.hypot(a.position[0] - b.position[0], a.position[2] - b.position[2]) > reach:
        return False
    if not shapely.Polygon(a.footprint).intersects(shapely.Polygon(b.footprint)):
        return False
    return any(
        min(high_a, high_b) - max(low_a, low_b) > 0.01 and plan_a.intersection(plan_b).area > _LEAST_OVERLAP
        for low_a, high_a, plan_a in _columns(a)
        for low_b, high_b, plan_b in _columns(b)
    )


def door_area(door: Opening, inward: Point2, depth: float = DOOR_CLEAR) -> shapely.Polygon:
    """The floor inside a door that must stay free."""
    a, b = door.segment
    reach = (inward[0] * depth, inward[1] * depth)
    return shapely.Polygon([a, b, (b[0] + reach[0], b[1] + reach[1]), (a[0] + reach[0], a[1] + reach[1])])


def _columns(placed: Placed) -> list[tuple[float, float, shapely.Polygon]]:
    return [
        (
            part.low[1] + placed.position[1],
            part.high[1] + placed.position[1],
            shapely.Polygon(part_outline(placed, part.low, part.high)),
        )
        for part in parts(placed.category, placed.size)
        if not part.is_soft
    ]


def _ways_out(spot: Spot) -> Iterator[Point2]:
    """Points a few steps from a standing point, straight away from the object first, then to the sides."""
    away = spot.facing + pi if spot.affordance == "touch" else spot.approach
    for turn in _TURNS:
        for step in _STEPS:
            yield (spot.standing[0] + step * sin(away + turn), spot.standing[1] + step * cos(away + turn))


def _middle(door: Opening) -> Point2:
    (ax, az), (bx, bz) = door.segment
    return ((ax + bx) / 2, (az + bz) / 2)
