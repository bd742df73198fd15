"""An empty rectangular room: walls, doors and windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from scene_graphs.layouts import Opening, Point2

DOOR_WIDTH = 0.9
DOOR_TOP = 2.05
_FROM_CORNER = 0.25


@dataclass(frozen=True)
class Side:
    """One wall seen from inside: it faces `yaw`, and its own +x runs to the right of who stands with the back to it."""

    yaw: float
    center: Point2
    """Middle of the wall on the floor, [x, z]."""
    length: float
    reach: float
    """Distance to the opposite wall."""

    def at(self, along: float, away: float) -> Point2:
        """The point `along` the wall from its middle and `away` from it into the room."""
        x = self.center[0] + along * cos(self.yaw) + away * sin(self.yaw)
        z = self.center[1] - along * sin(self.yaw) + away * cos(self.yaw)
        return (x, z)

    def along(self, point: Point2) -> float:
        """Where a point lies along the wall, from its middle."""
        return (point[0] - self.center[0]) * cos(self.yaw) - (point[1] - self.center[1]) * sin(self.yaw)


@dataclass(frozen=True)
class Shell:
    """A rectangular room centred on the origin, width along x and depth along z."""

    width: float
    depth: float
    height: float
    doors: tuple[tuple[int, float], ...] = ()
    """(index of the side, position of the middle along it)."""
    windows: tuple[tuple[int, float, float], ...] = ()
    """(index of the side, position of the middle along it, width)."""

    @property
    def sides(self) -> tuple[Side, Side, Side, Side]:
        """The walls at -z, -x, +z and +x, so that neighbours and opposites are one and two indices apart."""
        w, d = self.width, self.depth
        return (
            Side(0.0, (0.0, -d / 2), w, d),
            Side(pi / 2, (-w / 2, 0.0), d, w),
            Side(pi, (0.0, d / 2), w, d),
            Side(-pi / 2, (w / 2, 0.0), d, w),
        )

    @property
    def outline(self) -> tuple[Point2, ...]:
        """The corners, counter-clockwise seen from above."""
        x, z = self.width / 2, self.depth / 2
        return ((-x, -z), (-x, z), (x, z), (x, -z))

    def door_openings(self) -> tuple[Opening, ...]:
        """The doors as openings on the outline."""
        return tuple(self._opening(side, along, DOOR_WIDTH, 0.0, DOOR_TOP) for side, along in self.doors)

    def window_openings(self) -> tuple[Opening, ...]:
        """The windows as openings on the outline."""
        return tuple(self._opening(side, along, width, 0.9, 2.1) for side, along, width in self.windows)

    def spans(self, side: int) -> list[tuple[float, float]]:
        """Stretches of a wall that doors and windows take up, from its middle."""
        doors = [(along - DOOR_WIDTH / 2, along + DOOR_WIDTH / 2) for index, along in self.doors if index == side]
        return doors + [(along - w / 2, along + w / 2) for index, along, w in self.windows if index == side]

    def _opening(self, side: int, along: float, width: float, bottom: float, top: float) -> Opening:
        wall = self.sides[side]
        start, end = (_tidy(wall.at(along + half, 0.0)) for half in (-width / 2, width / 2))
        return Opening((start, end), bottom, top)


def build_shell(rng: np.random.Generator, least: Sequence[float], most: Sequence[float]) -> Shell:
    """A room of random size (metres, to 5 cm) with one or two doors on different walls and one or two windows."""
    width, depth = (round(float(rng.uniform(low, high)) * 20) / 20 for low, high in zip(least, most, strict=True))
    empty = Shell(width, depth, round(float(rng.uniform(2.55, 2.85)), 2))
    order = [int(side) for side in rng.permutation(4)]
    doors = [(side, _door_place(rng, empty.sides[side].length)) for side in order[: 1 + int(rng.random() < 0.45)]]
    windows = []
    for side in order[2 : 3 + int(rng.random() < 0.5)]:
        length = empty.sides[side].length
        wide = round(min(float(rng.uniform(1.1, 1.9)), 0.5 * length), 2)
        slack = length / 2 - wide / 2 - 0.5
        windows.append((side, round(float(rng.uniform(-slack, slack)) * 0.6, 2), wide))
    return Shell(width, depth, empty.height, tuple(doors), tuple(windows))


def _door_place(rng: np.random.Generator, length: float) -> float:
    """Doors sit near a corner more often than in the middle, where they would cost a whole wall."""
    slack = length / 2 - DOOR_WIDTH / 2 - _FROM_CORNER
    side = 1.0 if rng.random() < 0.5 else -1.0
    return round(side * slack * float(rng.uniform(0.55, 1.0)), 2)


def _tidy(point: Point2) -> Point2:
    return (round(point[0], 3) + 0.0, round(point[1], 3) + 0.0)
