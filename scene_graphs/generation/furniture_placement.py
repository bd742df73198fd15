"""A room being furnished: tries groups of furniture at places and keeps those that fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import cos, pi, sin

import numpy as np

from scene_graphs.generation.room_shell import DOOR_WIDTH, Rectangle, Shell, rectangle
from scene_graphs.layout import Placed, Point2, Point3, wrap

Rect = tuple[float, float, float, float]
"""x0, x1, z0, z1 in a group's frame."""

GAP = 0.02
"""Least space between two pieces of furniture."""
DOOR_DEPTH = 0.75
TALL = 1.0
"""Things taller than this do not stand before a window."""
BEFORE_WINDOW = 0.45
FLAT = frozenset({"rug", "pendant_lamp", "ceiling_lamp", "picture"})
"""What takes no floor."""


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

    @property
    def stands(self) -> bool:
        """Whether it takes floor."""
        return self.category not in FLAT and self.on is None


@dataclass(frozen=True)
class Group:
    """Pieces that belong together; the frame's origin is on the wall line (or a free group's middle), +z inward."""

    items: tuple[Item, ...]
    clear: tuple[Rect, ...] = ()
    """Floor that other groups' furniture must leave free."""

    @cached_property
    def span(self) -> tuple[float, float]:
        """Least and greatest x of the furniture on the floor."""
        edges = [x for item in self.items if item.stands for x, _ in _covered(item, (item.x, item.z), item.yaw).corners]
        return (min(edges), max(edges))


@dataclass
class Arrangement:
    """A shell with what stands in it so far; grows by `try_at`, `against_wall` and `in_the_room`."""

    shell: Shell
    rng: np.random.Generator
    placed: list[Placed] = field(default_factory=list)
    _solid: list[Rectangle] = field(default_factory=list)
    _reserved: list[Rectangle] = field(default_factory=list)
    _light: list[Rectangle] = field(default_factory=list)
    """The floor before the windows."""

    def __post_init__(self) -> None:
        for side, along in self.shell.doors:
            self._reserved.append(self._strip(side, along, DOOR_WIDTH, DOOR_DEPTH))
        for side, along, width in self.shell.windows:
            self._light.append(self._strip(side, along, width, BEFORE_WINDOW))

    def against_wall(
        self, group: Group, sides: Sequence[int] | None = None, corner: int = 0, tries: int = 12
    ) -> int | None:
        """Put a group with its back to a wall, somewhere or (corner -1, 1) into its end's corner; the side, or None."""
        order = [int(side) for side in self.rng.permutation(len(self.shell.sides))] if sides is None else list(sides)
        low, high = group.span
        for side in order:
            wall = self.shell.sides[side]
            first, last = -wall.length / 2 - low + 0.03, wall.length / 2 - high - 0.03
            if first > last or (corner and not wall.corners[corner > 0]):
                continue
            for _ in range(tries if corner == 0 else 1):
                along = {0: float(self.rng.uniform(first, last)), -1: first, 1: last}[corner]
                if self.try_at(group, wall.at(along, 0.0), wall.yaw):
                    return side
        return None

    def in_the_room(self, group: Group, spread: float = 0.5, tries: int = 20) -> bool:
        """Put a free-standing group, turned by any quarter, within a share of the room about its middle."""
        room = self.shell.floor
        for _ in range(tries):
            x, z = (float(self.rng.uniform(-spread, spread)) for _ in range(2))
            origin = (room.x + x * room.half_width, room.z + z * room.half_depth)
            if self.try_at(group, origin, float(self.rng.integers(4)) * pi / 2):
                return True
        return False

    def try_at(self, group: Group, origin: Point2, yaw: float) -> bool:
        """Put a group's origin at a point if everything fits: inside the walls, nothing on something, doors clear."""
        solid = []
        for item in group.items:
            if item.stands:
                piece = _covered(item, _turn((item.x, item.z), origin, yaw), yaw + item.yaw)
                if not self.shell.holds(piece) or not self._has_space(piece, item):
                    return False
                solid.append(piece)
        clear = [_strip(rect, origin, yaw) for rect in group.clear]
        for free in clear:
            if not self.shell.holds(free) or any(free.meets(other, -1e-3) for other in self._solid):
                return False
        self._solid += solid
        self._reserved += clear
        new = [self._place(item, origin, yaw) for item in group.items]
        self.placed += self._with_ids(new, group)
        return True

    def add(self, item: Item, origin: Point2, yaw: float) -> None:
        """Put something that takes no floor (a picture, a hanging lamp, a rug) where it is asked to be."""
        self.placed += self._with_ids([self._place(item, origin, yaw)], Group((item,)))

    def _has_space(self, piece: Rectangle, item: Item) -> bool:
        if any(piece.meets(other, GAP) for other in self._solid):
            return False
        if any(piece.meets(other, -1e-3) for other in self._reserved):
            return False
        hides = item.y + item.size[1] > TALL and item.category != "plant"
        return not (hides and any(piece.meets(other) for other in self._light))

    def _strip(self, side: int, along: float, width: float, depth: float) -> Rectangle:
        """The floor along a stretch of a wall."""
        wall = self.shell.sides[side]
        return rectangle(wall.at(along, depth / 2), width, depth, wall.yaw)

    def _place(self, item: Item, origin: Point2, yaw: float) -> Placed:
        x, z = _turn((item.x, item.z), origin, yaw)
        position = (round(x, 3) + 0.0, round(item.y, 3), round(z, 3) + 0.0)
        return Placed("", item.category, position, item.size, round(wrap(yaw + item.yaw), 4) + 0.0)

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


def _covered(item: Item, middle: Point2, yaw: float) -> Rectangle:
    return rectangle(middle, item.size[0], item.size[2], yaw)


def _strip(rect: Rect, origin: Point2, yaw: float) -> Rectangle:
    x0, x1, z0, z1 = rect
    return rectangle(_turn(((x0 + x1) / 2, (z0 + z1) / 2), origin, yaw), x1 - x0, z1 - z0, yaw)


def _turn(point: Point2, origin: Point2, yaw: float) -> Point2:
    x = origin[0] + point[0] * cos(yaw) + point[1] * sin(yaw)
    z = origin[1] - point[0] * sin(yaw) + point[1] * cos(yaw)
    return (x, z)
