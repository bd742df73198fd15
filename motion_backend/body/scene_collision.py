"""What a body must not go through: every solid box of a home, and how deep points are inside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array
from motion_backend.walls import Side
from scene_graphs.home import Home, Wall
from scene_graphs.meshes.furniture_mesh import parts_of

WALL = "wall"
"""The owner of a wall's boxes."""
THICKNESS = 0.10
HEAD_HEIGHT = 1.9
"""Openings that begin higher leave the wall a wall for bodies (metres)."""


@dataclass(frozen=True)
class Obstacles:
    """N upright boxes turned about Y, in the home's frame."""

    centers: Array
    """(N, 3)."""
    halves: Array
    """(N, 3) half sizes in the box's own frame."""
    yaws: Array
    """(N,)."""
    owners: tuple[str, ...]
    """Object id of each box, or `WALL`."""
    soft: NDArray[np.bool_]
    """(N,) pillows and the like, which give way."""

    @staticmethod
    def of_home(home: Home) -> Obstacles:
        """The furniture parts and the walls of a home; doorways, doors and windows are cut out of the walls."""
        rows = [
            (placed.to_world(part.center), np.asarray(part.size) / 2, placed.yaw, placed.id, part.is_soft)
            for placed in home.objects
            for part in parts_of(placed)
        ]
        for wall in home.walls:
            rows.extend((*box, WALL, False) for box in _wall_boxes(wall, home))
        centers, halves, yaws, owners, soft = zip(*rows, strict=True) if rows else ((), (), (), (), ())
        return Obstacles(
            np.array(centers, dtype=np.float64).reshape(-1, 3),
            np.array(halves, dtype=np.float64).reshape(-1, 3),
            np.array(yaws, dtype=np.float64),
            tuple(owners),
            np.array(soft, dtype=bool),
        )

    def near(self, low: Array, high: Array) -> Obstacles:
        """Only the boxes whose surroundings meet the axis-aligned box from low to high (3,) each."""
        return self.only(np.all((self.centers + self.spans >= low) & (self.centers - self.spans <= high), axis=1))

    @cached_property
    def spans(self) -> Array:
        """Half sizes of the boxes along the axes of the home. (N, 3)."""
        cos, sin = np.abs(np.cos(self.yaws)), np.abs(np.sin(self.yaws))
        x, y, z = self.halves.T
        return np.stack([cos * x + sin * z, y, sin * x + cos * z], axis=1)

    def only(self, chosen: NDArray[np.bool_]) -> Obstacles:
        """The boxes a mask (N,) chooses."""
        owners = tuple(owner for owner, keep in zip(self.owners, chosen, strict=True) if keep)
        return Obstacles(self.centers[chosen], self.halves[chosen], self.yaws[chosen], owners, self.soft[chosen])

    def solid(self) -> Obstacles:
        """Without what gives way."""
        return self.only(~self.soft)

    def sunk_into(self, owner: str | None, by: float) -> Obstacles:
        """The same with the boxes of one piece smaller all round, by as much as is sunk into it (metres)."""
        own = np.array([one == owner for one in self.owners], dtype=bool)
        return replace(self, halves=np.maximum(self.halves - by * own[:, None], 0.0))

    def inside(self, points: Array, index: int) -> Array:
        """Depth of points (P, 3) in one box: positive inside, to the nearest face; negative outside. (P,)."""
        moved = points - self.centers[index]
        cos, sin = np.cos(self.yaws[index]), np.sin(self.yaws[index])
        local = np.abs(
            np.stack([cos * moved[:, 0] - sin * moved[:, 2], moved[:, 1], sin * moved[:, 0] + cos * moved[:, 2]])
        )
        gap = local - self.halves[index][:, None]
        outside = np.sqrt((np.maximum(gap, 0.0) ** 2).sum(axis=0))
        return np.asarray(np.where(outside > 0, -outside, -gap.max(axis=0)))

    def depth(self, points: Array) -> Array:
        """Greatest depth of points (P, 3) in any box; -inf where there is none. (P,)."""
        deepest = np.full(len(points), -np.inf)
        if not len(points):
            return deepest
        close = self.near(points.min(axis=0) - 0.1, points.max(axis=0) + 0.1)
        for index in range(len(close.owners)):
            deepest = np.maximum(deepest, close.inside(points, index))
        return deepest


def _wall_boxes(wall: Wall, home: Home) -> Iterator[tuple[Array, Array, float]]:
    """Centre, half size and yaw of the solid stretches of a wall; it is as thick as it can be away from its room."""
    side = Side.of(wall, home)
    if side is None:
        return
    start, outward = side.start, side.outward
    length = float(np.linalg.norm(side.end - start))
    along = (side.end - start) / length
    yaw = float(np.arctan2(outward[0], outward[1]))
    gaps = sorted(
        tuple(sorted(float((np.asarray(point) - start) @ along) for point in opening.segment))
        for opening in wall.openings
        if opening.bottom < HEAD_HEIGHT
    )
    edges = [0.0, *[edge for gap in gaps for edge in gap], length]
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        if high - low > 0.01:
            center = start + along * (low + high) / 2 + outward * THICKNESS / 2
            half = np.array([(high - low) / 2, wall.height / 2, THICKNESS / 2])
            yield np.array([center[0], wall.height / 2, center[1]]), half, yaw
