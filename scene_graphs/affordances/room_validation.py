"""Whether a room can be lived in: what stands in the way, what overlaps, and which spots a body can get to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from math import cos, pi, sin

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.furniture import AFFORDANCES, affordances, class_of, group_of
from scene_graphs.furniture_shapes import parts_of
from scene_graphs.layout import Array, Layout, Opening, Placed, Point2
from scene_graphs.navigation.clearance import BODY_RADIUS, Footing, Rectangles, find_footing, obstacles, part_outline

STANDING_RADIUS = 0.20
"""What a body standing at a spot keeps free of other things: a little less than when walking."""
DOOR_CLEAR = 0.6
"""Depth of the floor inside a door that nothing may stand on, in metres."""
OUT_OF_REACH = 1.4
"""Things whose bottom hangs higher than this offer no spot a room must make reachable."""
MAX_OVERLAPS = 100
"""Overlaps that are told of one room; a heap of things has thousands."""
_STANDING = STANDING_RADIUS - 1e-9
_MIN_OVERLAP = 2e-3
_STEPS = (0.0, 0.1, 0.2, 0.3, 0.35)
_TURNS = (0.0, *(sign * eighth * pi / 8 for eighth in (2, 4, 1, 3) for sign in (1, -1)))


@dataclass(frozen=True)
class RoomCheck:
    """A layout with its free floor measured once; asks what works in it."""

    layout: Layout
    cell: float = 0.05

    @cached_property
    def floor(self) -> shapely.Polygon:
        """The outline of the room."""
        return shapely.Polygon(self.layout.floor_polygon)

    @cached_property
    def footing(self) -> Footing:
        """Where a walking body can be; doors count as wall."""
        return find_footing(self.floor, self._blocked, BODY_RADIUS, self.cell)

    @cached_property
    def main_region(self) -> int:
        """The region inside the first door that leads anywhere, or the largest of a room without doors; 0 if none."""
        if self.layout.doors:
            return next(filter(None, map(self._region_behind, self.layout.doors)), 0)
        counts = np.bincount(self.footing.regions.ravel())[1:]
        return int(counts.argmax()) + 1 if len(counts) else 0

    @cached_property
    def carried(self) -> dict[str, list[str]]:
        """Every object with what stands on it, and on that: what lies on a seat is in nobody's way to it."""
        parents = {placed.id: placed.parent for placed in self.layout.objects}
        carried: dict[str, list[str]] = {name: [name] for name in parents}
        for name, parent in parents.items():
            seen = {name}
            while parent in carried and parent not in seen:
                carried[parent].append(name)
                seen.add(parent)
                parent = parents[parent]
        return carried

    def usable(self, placed: Placed, affordance: str) -> Iterator[Spot]:
        """Spots of an object that a body can walk to, stand at and use, best first."""
        return (spot for spot in spots(placed, affordance) if self.is_usable(spot))

    def is_usable(self, spot: Spot) -> bool:
        """Whether a body fits at the spot's standing point and gets there from the door."""
        fits = self.has_room(np.array(spot.standing), spot.object_id)
        return bool(fits) and self.main_region != 0 and any(map(self._is_walkable, _ways_out(spot)))

    def has_room(self, standing: Array, object_id: str) -> NDArray[np.bool_]:
        """Whether a body fits at standing points before an object, wherever that is taken to stand. (..., 2): (...)."""
        inside = shapely.contains_xy(self.floor, standing[..., 0], standing[..., 1])
        others = ~np.isin(self._owners, self.carried[object_id])
        to_walls = self._walls.distances(standing).min(axis=-1)
        to_others = self._blocked.distances(standing)[..., others].min(axis=-1, initial=1.0)
        return np.asarray(inside & (np.minimum(to_walls, to_others) >= _STANDING))

    def in_the_way(self, spot: Spot) -> str:
        """What keeps a body from standing at a spot: "wall", or the id of the nearest object; empty if nothing does."""
        standing = np.array(spot.standing)
        if self.has_room(standing, spot.object_id):
            return ""
        others = np.flatnonzero(~np.isin(self._owners, self.carried[spot.object_id]))
        distances = self._blocked.distances(standing)[others]
        if not distances.size or distances.min() >= _STANDING:
            return "wall"
        return str(self._owners[others[distances.argmin()]])

    def within_walls(self, footprints: Array) -> NDArray[np.bool_]:
        """Whether footprints lie inside the walls, give or take 3 cm. (N, 4, 2): (N,)."""
        return np.asarray(shapely.contains(self._walled, shapely.polygons(footprints)))

    def blocked_doors(self) -> dict[int, str]:
        """Every door that something stands before, with the first such object."""
        found = {}
        for index, door in enumerate(self.layout.doors):
            covered = shapely.area(shapely.intersection(self._outlines, door_area(door, self._inward(door))))
            for number in np.flatnonzero(covered > _MIN_OVERLAP)[:1]:
                found[index] = str(self._owners[number])
        return found

    def problems(self) -> list[str]:
        """What is wrong with the room, one sentence each; empty if nothing is."""
        return [*self._outside(), *self._overlaps(), *self._blocked_doors(), *self._unreachable()]

    def unreachable(self) -> list[tuple[str, str]]:
        """(object id, affordance) of all that a body should be able to use and cannot; pictures may hang over beds."""
        return [
            (placed.id, affordance)
            for placed in self.layout.objects
            if placed.position[1] < OUT_OF_REACH
            and (placed.parent is None or group_of(placed.category) in ("light", "media"))
            and not (class_of(placed.category) == "decor" and placed.position[1] > 0)
            for affordance in AFFORDANCES
            if affordance in affordances(placed.category)
            and (candidates := spots(placed, affordance))
            and not any(map(self.is_usable, candidates))
        ]

    @cached_property
    def _walled(self) -> shapely.Geometry:
        return self.floor.buffer(0.03)

    @cached_property
    def _obstacles(self) -> list[tuple[Placed, shapely.Polygon]]:
        return obstacles(self.layout.objects)

    @cached_property
    def _outlines(self) -> NDArray[np.object_]:
        return np.array([outline for _, outline in self._obstacles], dtype=object)

    @cached_property
    def _blocked(self) -> Rectangles:
        return Rectangles.of(shapely.get_coordinates(self._outlines).reshape(-1, 5, 2)[:, :4])

    @cached_property
    def _walls(self) -> Rectangles:
        return Rectangles.of_walls(np.array(self.layout.floor_polygon))

    @cached_property
    def _owners(self) -> NDArray[np.str_]:
        """The ids of the objects that the rectangles belong to."""
        return np.array([placed.id for placed, _ in self._obstacles], dtype=np.str_)

    def _is_walkable(self, point: Point2) -> bool:
        return self.footing.region_at(point) == self.main_region

    def _region_behind(self, door: Opening) -> int:
        """The region of the floor just inside a door, a little farther in where a body does not fit yet."""
        (x, z), inward = _middle(door), self._inward(door)
        for depth in (0.3, 0.4, 0.5, 0.6):
            region = self.footing.region_at((x + inward[0] * depth, z + inward[1] * depth))
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
        if not self.layout.objects:
            return []
        within = self.within_walls(np.array([placed.footprint for placed in self.layout.objects]))
        return [f"{self.layout.objects[i].id} stands outside the walls" for i in np.flatnonzero(~within)]

    def _overlaps(self) -> list[str]:
        solid = [placed for placed in self.layout.objects if placed.category != "rug"]
        found = (
            f"{a.id} and {b.id} overlap"
            for a, b in _neighbours(solid)
            if a.parent != b.id and b.parent != a.id and solids_overlap(a, b)
        )
        return list(islice(found, MAX_OVERLAPS))

    def _blocked_doors(self) -> list[str]:
        blocked, found = self.blocked_doors(), []
        for index, door in enumerate(self.layout.doors):
            if index in blocked:
                found.append(f"door {index} is blocked by {blocked[index]}")
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
    if not any(_neighbours((a, b))) or not shapely.Polygon(a.footprint).intersects(shapely.Polygon(b.footprint)):
        return False
    (low_a, high_a, plans_a), (low_b, high_b, plans_b) = _columns(a), _columns(b)
    shared = np.minimum(high_a[:, None], high_b) - np.maximum(low_a[:, None], low_b)
    i, k = np.nonzero(shared > 0.01)
    return bool((shapely.area(shapely.intersection(plans_a[i], plans_b[k])) > _MIN_OVERLAP).any())


def door_area(door: Opening, inward: Point2, depth: float = DOOR_CLEAR) -> shapely.Polygon:
    """The floor inside a door that must stay free."""
    a, b = door.segment
    reach = (inward[0] * depth, inward[1] * depth)
    return shapely.Polygon([a, b, (b[0] + reach[0], b[1] + reach[1]), (a[0] + reach[0], a[1] + reach[1])])


def _neighbours(objects: Sequence[Placed]) -> Iterator[tuple[Placed, Placed]]:
    """Pairs whose footprints are near enough to touch, in the objects' order."""
    centers = np.array([(placed.position[0], placed.position[2]) for placed in objects]).reshape(-1, 2)
    reach = np.array([np.hypot(placed.size[0], placed.size[2]) / 2 for placed in objects])
    away = np.hypot(*(centers[:, None] - centers).transpose(2, 0, 1))
    near = np.triu(away <= reach[:, None] + reach, 1)
    return ((objects[i], objects[k]) for i, k in np.argwhere(near))


def _columns(placed: Placed) -> tuple[Array, Array, NDArray[np.object_]]:
    """Lower and upper height and plan of every solid part."""
    solid = [part for part in parts_of(placed) if not part.is_soft]
    low = placed.position[1] + np.array([part.low[1] for part in solid])
    high = placed.position[1] + np.array([part.high[1] for part in solid])
    plans = np.array([shapely.Polygon(part_outline(placed, part.low, part.high)) for part in solid], dtype=object)
    return low, high, plans


def _ways_out(spot: Spot) -> Iterator[Point2]:
    """Points a few steps from a standing point, straight away from the object first, then to the sides."""
    away = spot.facing + pi if spot.affordance == "touch" else spot.approach
    for turn in _TURNS:
        for step in _STEPS:
            yield (spot.standing[0] + step * sin(away + turn), spot.standing[1] + step * cos(away + turn))


def _middle(door: Opening) -> Point2:
    (ax, az), (bx, bz) = door.segment
    return ((ax + bx) / 2, (az + bz) / 2)
