"""An empty room with straight corners: walls, doors and windows.

Rectangles on the floor: what a piece of furniture covers, what must stay clear, and whether two of them meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import atan2, cos, hypot, inf, sin
from typing import NamedTuple

import numpy as np
import shapely

from scene_graphs.layout import Opening, Point2


class Rectangle(NamedTuple):
    """A rectangle on the floor plane, turned about its middle (metres)."""

    x: float
    z: float
    half_width: float
    half_depth: float
    cos: float = 1.0
    sin: float = 0.0

    @property
    def corners(self) -> tuple[Point2, ...]:
        """[x, z] of the four corners, in order around."""
        return tuple(self.at(i * self.half_width, j * self.half_depth) for i, j in ((-1, -1), (-1, 1), (1, 1), (1, -1)))

    def at(self, right: float, ahead: float) -> Point2:
        """The point so far along the rectangle's own x and z axes from its middle."""
        return (self.x + self.cos * right + self.sin * ahead, self.z - self.sin * right + self.cos * ahead)

    def meets(self, other: Rectangle, gap: float = 0.0) -> bool:
        """Whether the two share floor, or (gap > 0) come about that near: no axis of either separates them."""
        x, z = other.x - self.x, other.z - self.z
        along = abs(self.cos * other.cos + self.sin * other.sin)
        across = abs(self.sin * other.cos - self.cos * other.sin)
        return (
            abs(self.cos * x - self.sin * z)
            < self.half_width + other.half_width * along + other.half_depth * across + gap
            and abs(self.sin * x + self.cos * z)
            < self.half_depth + other.half_width * across + other.half_depth * along + gap
            and abs(other.cos * x - other.sin * z)
            < other.half_width + self.half_width * along + self.half_depth * across + gap
            and abs(other.sin * x + other.cos * z)
            < other.half_depth + self.half_width * across + self.half_depth * along + gap
        )


def rectangle(middle: Point2, width: float, depth: float, yaw: float = 0.0) -> Rectangle:
    """The rectangle of that width (its own x) and depth (its own z) at yaw 0, turned about +Y."""
    return Rectangle(middle[0], middle[1], width / 2, depth / 2, cos(yaw), sin(yaw))


DOOR_WIDTH = 0.9
DOOR_TOP = 2.05
WINDOW = (0.9, 2.1)
"""Heights between which a window opens the wall."""
MIN_WING_WIDTH = 2.3
"""Neither wing of an L-shaped room is narrower, in metres."""
_FROM_CORNER = 0.25
_DOOR_WALL, _WINDOW_WALL = 1.6, 1.9
"""Walls shorter than this have no door, no window."""


@dataclass(frozen=True)
class Side:
    """One wall seen from inside: it faces `yaw`, and its own +x runs to the right of who stands with the back to it."""

    yaw: float
    center: Point2
    """Middle of the wall on the floor, [x, z]."""
    length: float
    reach: float
    """Distance from the middle to the wall opposite."""
    corners: tuple[bool, bool]
    """Whether the wall ends (at its -x, at its +x) in a corner of the room, and not where the room turns outward."""

    def at(self, along: float, away: float) -> Point2:
        """The point `along` the wall from its middle and `away` from it into the room."""
        x = self.center[0] + along * cos(self.yaw) + away * sin(self.yaw)
        z = self.center[1] - along * sin(self.yaw) + away * cos(self.yaw)
        return (x, z)

    def along(self, point: Point2) -> float:
        """Where a point lies along the wall, from its middle."""
        return (point[0] - self.center[0]) * cos(self.yaw) - (point[1] - self.center[1]) * sin(self.yaw)

    def away(self, point: Point2) -> float:
        """How far a point lies from the wall's line, into the room."""
        return (point[0] - self.center[0]) * sin(self.yaw) + (point[1] - self.center[1]) * cos(self.yaw)


@dataclass(frozen=True)
class Shell:
    """A room whose walls run along x and z, with its doors and windows."""

    outline: tuple[Point2, ...]
    """The corners, counter-clockwise seen from above."""
    height: float
    doors: tuple[tuple[int, float], ...] = ()
    """(index of the side, position of the middle along it)."""
    windows: tuple[tuple[int, float, float], ...] = ()
    """(index of the side, position of the middle along it, width)."""

    @cached_property
    def sides(self) -> tuple[Side, ...]:
        """The walls in the order of the outline; side i runs from corner i to corner i + 1."""
        count = len(self.outline)
        turns = [
            _turns_inward(self.outline[i - 1], self.outline[i], self.outline[(i + 1) % count]) for i in range(count)
        ]
        return tuple(self._side(i, (turns[(i + 1) % count], turns[i])) for i in range(count))

    @cached_property
    def floor(self) -> Rectangle:
        """The upright rectangle around the outline."""
        xs, zs = zip(*self.outline, strict=True)
        (x0, x1), (z0, z1) = (min(xs), max(xs)), (min(zs), max(zs))
        return Rectangle((x0 + x1) / 2, (z0 + z1) / 2, (x1 - x0) / 2, (z1 - z0) / 2)

    @cached_property
    def outside(self) -> tuple[Rectangle, ...]:
        """Rectangles that fill what of `floor` lies outside the outline."""
        xs, zs = (sorted(set(values)) for values in zip(*self.outline, strict=True))
        room = shapely.Polygon(self.outline)
        cells = [
            Rectangle((x0 + x1) / 2, (z0 + z1) / 2, (x1 - x0) / 2, (z1 - z0) / 2)
            for x0, x1 in pairwise(xs)
            for z0, z1 in pairwise(zs)
        ]
        return tuple(cell for cell in cells if not room.contains(shapely.Point(cell.x, cell.z)))

    def holds(self, piece: Rectangle, margin: float = 0.005) -> bool:
        """Whether a rectangle lies inside the walls, or reaches into them by no more than the margin."""
        room = self.floor
        return all(
            abs(x - room.x) <= room.half_width + margin and abs(z - room.z) <= room.half_depth + margin
            for x, z in piece.corners
        ) and not any(piece.meets(cell, -margin) for cell in self.outside)

    def door_openings(self) -> tuple[Opening, ...]:
        """The doors as openings on the outline."""
        return tuple(self._opening(side, along, DOOR_WIDTH, (0.0, DOOR_TOP)) for side, along in self.doors)

    def window_openings(self) -> tuple[Opening, ...]:
        """The windows as openings on the outline."""
        return tuple(self._opening(side, along, width, WINDOW) for side, along, width in self.windows)

    def spans(self, side: int) -> list[tuple[float, float]]:
        """Stretches of a wall that doors and windows take up, from its middle."""
        doors = [(along - DOOR_WIDTH / 2, along + DOOR_WIDTH / 2) for index, along in self.doors if index == side]
        return doors + [(along - w / 2, along + w / 2) for index, along, w in self.windows if index == side]

    def _side(self, index: int, corners: tuple[bool, bool]) -> Side:
        (ax, az), (bx, bz) = self.outline[index], self.outline[(index + 1) % len(self.outline)]
        length, middle = hypot(bx - ax, bz - az), ((ax + bx) / 2, (az + bz) / 2)
        inward = ((bz - az) / length, (ax - bx) / length)
        return Side(atan2(*inward), middle, length, self._reach(middle, inward), corners)

    def _reach(self, start: Point2, direction: Point2) -> float:
        """Distance from a point straight on to the next wall that crosses the way."""
        nearest = inf
        for a, b in pairwise((*self.outline, self.outline[0])):
            ahead, beside = (
                [(x - start[0]) * u + (z - start[1]) * v for x, z in (a, b)]
                for u, v in (direction, (direction[1], -direction[0]))
            )
            if min(ahead) > 1e-6 and min(beside) <= 0.0 < max(beside):
                nearest = min(nearest, *ahead)
        return nearest

    def _opening(self, side: int, along: float, width: float, heights: tuple[float, float]) -> Opening:
        wall = self.sides[side]
        start, end = (_tidy(wall.at(along + half, 0.0)) for half in (-width / 2, width / 2))
        return Opening((start, end), *heights)


def build_shell(rng: np.random.Generator, area: float, is_l_shaped: bool = False) -> Shell:
    """A room of about that floor (square metres; its walls to 5 cm), with one or two doors and one or two windows.

    An L-shaped room is a rectangle without one corner; where that would leave a narrow wing it stays a rectangle.
    """
    # What is cut off is made up for: the rectangle around an L is larger.
    stretch = float(rng.uniform(0.8, 1.25))
    cut = (float(rng.uniform(0.3, 0.5)), float(rng.uniform(0.3, 0.5))) if is_l_shaped else (0.0, 0.0)
    whole = area / (1 - cut[0] * cut[1])
    width, depth = (max(_to_step(side), 2.6) for side in (stretch * whole**0.5, whole**0.5 / stretch))
    notch = tuple(
        min(_to_step(part * side), _to_step(side - MIN_WING_WIDTH))
        for part, side in zip(cut, (width, depth), strict=True)
    )
    outline = _outline(width, depth, (notch[0], notch[1]), int(rng.integers(4)))
    empty = Shell(outline, round(float(rng.uniform(2.55, 2.85)), 2))
    order = [int(side) for side in rng.permutation(len(empty.sides))]
    doors = [
        (side, _door_place(rng, empty.sides[side].length)) for side in order if empty.sides[side].length >= _DOOR_WALL
    ][: 1 + int(rng.random() < 0.45)]
    free = [side for side in order if side not in dict(doors) and empty.sides[side].length >= _WINDOW_WALL]
    windows = []
    for side in free[: 1 + int(rng.random() < 0.5)]:
        length = empty.sides[side].length
        wide = round(min(float(rng.uniform(1.1, 1.9)), 0.5 * length), 2)
        slack = length / 2 - wide / 2 - 0.3
        windows.append((side, round(float(rng.uniform(-slack, slack)) * 0.6, 2), wide))
    return replace(empty, doors=tuple(doors), windows=tuple(windows))


def _outline(width: float, depth: float, notch: Sequence[float], corner: int) -> tuple[Point2, ...]:
    """A rectangle centred on the origin without a notch at one of its corners; too small a notch is left in place."""
    x, z = width / 2, depth / 2
    corners = [(-x, -z), (-x, z), (x, z), (x, -z)]
    if min(notch) < 0.8:
        return tuple(corners)
    cx, cz = corners[corner]
    nx, nz = cx - notch[0] * (1 if cx > 0 else -1), cz - notch[1] * (1 if cz > 0 else -1)
    inner = [(cx, nz), (nx, nz), (nx, cz)]
    # Going round, the wall before corners 0 and 2 runs along x, so there the notch is entered along x first.
    corners[corner : corner + 1] = inner if corner in (1, 3) else inner[::-1]
    return tuple((round(a, 3), round(b, 3)) for a, b in corners)


def _turns_inward(before: Point2, here: Point2, after: Point2) -> bool:
    """Whether a corner is one of the room's own (90 degrees inside), and not one around which the room lies."""
    cross = (here[0] - before[0]) * (after[1] - here[1]) - (here[1] - before[1]) * (after[0] - here[0])
    return cross < 0


def _door_place(rng: np.random.Generator, length: float) -> float:
    """Doors sit near a corner more often than in the middle, where they would cost a whole wall."""
    slack = length / 2 - DOOR_WIDTH / 2 - _FROM_CORNER
    side = 1.0 if rng.random() < 0.5 else -1.0
    return round(side * slack * float(rng.uniform(0.55, 1.0)), 2)


def _to_step(length: float) -> float:
    return round(length * 20) / 20


def _tidy(point: Point2) -> Point2:
    return (round(point[0], 3) + 0.0, round(point[1], 3) + 0.0)
