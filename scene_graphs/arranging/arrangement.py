"""A room being furnished: tries groups of furniture at places and keeps those that fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, pi, sin

import numpy as np
import shapely

from scene_graphs.arranging.shell import DOOR_WIDTH, Shell
from scene_graphs.layouts import Placed, Point2, Point3

Rect = tuple[float, float, float, float]
"""x0, x1, z0, z1 in a group's frame."""

GAP = 0.02
"""Least space between two pieces of furniture."""
DOOR_DEPTH = 0.75
TALL = 1.0
"""Things taller than this do not stand before a window."""
_FLAT = frozenset({"rug", "pendant_lamp", "ceiling_lamp", "picture"})


@dataclass(frozen=True)
class Item:
    """One piece of a group, in the group's frame: x, z of its bottom centre, front +z at yaw 0."""

    category: str
    x: float
    z: float
    size: Point3
    yaw: float = 0.0
    y: float = 0.0
    on: int | None = None
    """Index in the group of the piece it stands on."""


@dataclass(frozen=True)
class Group:
    """Pieces that belong together; the frame's origin is on the wall line (or a free group's middle), +z inward."""

    items: tuple[Item, ...]
    clear: tuple[Rect, ...] = ()
    """Floor that other groups' furniture must leave free."""

    @property
    def span(self) -> tuple[float, float]:
        """Least and greatest x of the furniture on the floor."""
        edges = [_corners(item)[:, 0] for item in self.items if item.category not in _FLAT]
        return (float(min(edge.min() for edge in edges)), float(max(edge.max() for edge in edges)))


@dataclass
class Arrangement:
    """A shell with what stands in it so far; grows by `try_at`, `against_wall` and `in_the_room`."""

    shell: Shell
    rng: np.random.Generator
    placed: list[Placed] = field(default_factory=list)
    groups: list[tuple[str, ...]] = field(default_factory=list)
    """Ids of the pieces of each group, the one it is about first."""
    _solid: list[shapely.Polygon] = field(default_factory=list)
    _reserved: list[shapely.Polygon] = field(default_factory=list)

    def __post_init__(self) -> None:
        for index, along in self.shell.doors:
            side, half = self.shell.sides[index], DOOR_WIDTH / 2
            corners = [(along - half, 0.0), (along - half, DOOR_DEPTH), (along + half, DOOR_DEPTH), (along + half, 0.0)]
            self._reserved.append(shapely.Polygon([side.at(*corner) for corner in corners]))

    def against_wall(
        self, group: Group, sides: Sequence[int] | None = None, corner: int = 0, tries: int = 12
    ) -> int | None:
        """Put a group with its back to a wall, somewhere or (corner -1, 1) up to the wall's end; the side, or None."""
        order = [int(side) for side in self.rng.permutation(4)] if sides is None else list(sides)
        low, high = group.span
        for side in order:
            wall = self.shell.sides[side]
            first, last = -wall.length / 2 - low + 0.03, wall.length / 2 - high - 0.03
            if first > last:
                continue
            for attempt in range(tries if corner == 0 else 1):
                middle = (first + last) / 2
                spread = 0.0 if attempt == 0 and low == -high else 1.0
                along = middle + spread * float(self.rng.uniform(-0.5, 0.5)) * (last - first)
                along = {0: along, -1: first, 1: last}[corner]
                if self.try_at(group, wall.at(along, 0.0), wall.yaw):
                    return side
        return None

    def in_the_room(self, group: Group, near: Point2 = (0.0, 0.0), spread: float = 0.5, tries: int = 20) -> bool:
        """Put a free-standing group near a point, turned by any quarter."""
        for _ in range(tries):
            x, z = (near[axis] + float(self.rng.uniform(-spread, spread)) for axis in (0, 1))
            if self.try_at(group, (x, z), float(self.rng.integers(4)) * pi / 2):
                return True
        return False

    def try_at(self, group: Group, origin: Point2, yaw: float) -> bool:
        """Put a group's origin at a point if everything fits: inside the walls, nothing on something, doors clear."""
        new = [self._place(item, origin, yaw, index) for index, item in enumerate(group.items)]
        standing = [placed for placed, item in zip(new, group.items, strict=True) if _stands(item)]
        solid = [shapely.Polygon(placed.footprint) for placed in standing]
        clear = [
            shapely.Polygon([_turn(corner, origin, yaw) for corner in _rect_corners(rect)]) for rect in group.clear
        ]
        room = shapely.Polygon(self.shell.outline)
        if not all(room.buffer(0.005).contains(shape) for shape in [*solid, *clear]):
            return False
        if any(_meet(shape, other, GAP) for shape in solid for other in self._solid):
            return False
        if any(_meet(shape, other) for shape in solid for other in self._reserved):
            return False
        if any(_meet(shape, other) for shape in clear for other in self._solid) or self._hides_window(standing):
            return False
        self._solid += solid
        self._reserved += clear
        named = self._with_ids(new, group)
        self.placed += named
        self.groups.append(tuple(placed.id for placed in named))
        return True

    def add(self, item: Item, origin: Point2, yaw: float) -> None:
        """Put something that takes no floor (a picture, a hanging lamp, a rug) where it is asked to be."""
        self.placed += self._with_ids([self._place(item, origin, yaw, 0)], Group((item,)))

    def _place(self, item: Item, origin: Point2, yaw: float, index: int) -> Placed:
        x, z = _turn((item.x, item.z), origin, yaw)
        turned = (yaw + item.yaw + pi) % (2 * pi) - pi
        position = (round(x, 3) + 0.0, round(item.y, 3), round(z, 3) + 0.0)
        return Placed(str(index), item.category, position, item.size, round(turned, 4) + 0.0)

    def _with_ids(self, new: list[Placed], group: Group) -> list[Placed]:
        """Number the pieces of each category through the room, and let what stands on something name it."""
        counts: dict[str, int] = {}
        for placed in self.placed:
            counts[placed.category] = counts.get(placed.category, 0) + 1
        names = []
        for placed in new:
            counts[placed.category] = counts.get(placed.category, 0) + 1
            names.append(f"{placed.category}_{counts[placed.category]}")
        return [
            Placed(name, p.category, p.position, p.size, p.yaw, None if item.on is None else names[item.on])
            for name, p, item in zip(names, new, group.items, strict=True)
        ]

    def _hides_window(self, standing: list[Placed]) -> bool:
        tall = [placed for placed in standing if placed.top > TALL and placed.category != "plant"]
        for index, along, width in self.shell.windows:
            side = self.shell.sides[index]
            ends = [side.at(along - width / 2, 0.0), side.at(along + width / 2, 0.0)]
            strip = shapely.LineString(ends).buffer(0.45, cap_style="flat")
            if any(strip.intersects(shapely.Polygon(placed.footprint)) for placed in tall):
                return True
        return False


def _stands(item: Item) -> bool:
    return item.category not in _FLAT and item.on is None


def _meet(a: shapely.Polygon, b: shapely.Polygon, gap: float = 0.0) -> bool:
    return bool(a.distance(b) < gap) if gap else bool(a.intersection(b).area > 1e-3)


def _corners(item: Item) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return Placed("", item.category, (item.x, 0.0, item.z), item.size, item.yaw).footprint


def _rect_corners(rect: Rect) -> list[Point2]:
    x0, x1, z0, z1 = rect
    return [(x0, z0), (x0, z1), (x1, z1), (x1, z0)]


def _turn(point: Point2, origin: Point2, yaw: float) -> Point2:
    x = origin[0] + point[0] * cos(yaw) + point[1] * sin(yaw)
    z = origin[1] - point[0] * sin(yaw) + point[1] * cos(yaw)
    return (x, z)
