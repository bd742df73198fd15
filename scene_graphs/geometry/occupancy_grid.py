"""What a body has around it and around its goal: LINGO's two occupancy grids (LINGO A.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.layout import Array, Point2

LOOK_AHEAD: Final = 0.8
"""How far towards its goal the second grid of a walking body lies, in metres."""

Occupancy = NDArray[np.bool_]


@dataclass(frozen=True)
class VoxelSpec:
    """A box of points in the heading frame of a body (+Z ahead, +X to its left), from floor heights low to high."""

    size: int = 32
    """Points along each side."""
    reach: float = 0.6
    """To both sides, ahead and behind, in metres."""
    low: float = 0.1
    high: float = 1.2

    def __post_init__(self) -> None:
        if not 2 <= self.size <= 128 or not 0 < self.reach < 100 or not 0 <= self.low < self.high < 100:
            raise ValueError(f"a voxel grid has 2 to 128 points a side, some reach, and low below high, got {self}")

    @cached_property
    def offsets(self) -> tuple[Array, Array, Array]:
        """Heights (size,), then x and z of the points of one level, x-major. (size²,), (size²,)."""
        line = np.linspace(-self.reach, self.reach, self.size)
        x, z = np.meshgrid(line, line, indexing="ij")
        return np.linspace(self.low, self.high, self.size), x.ravel(), z.ravel()


LINGO: Final = VoxelSpec()
TRUMANS: Final = VoxelSpec(low=0.0)


def occupancy(scene: SceneHeights, position: Point2, yaw: float, spec: VoxelSpec = LINGO) -> Occupancy:
    """Whether each point of a box around a place [x, z] on the floor is in something solid. (size, size, size) y, x, z.

    Points outside the rooms are occupied. ValueError if the place or the yaw is not finite.
    """
    if not np.isfinite([*position, yaw]).all():
        raise ValueError(f"position and yaw must be finite numbers, got {position!r:.80} and {yaw!r:.80}")
    heights, x, z = spec.offsets
    cos, sin = np.cos(yaw), np.sin(yaw)
    solid = scene.columns.solid(position[0] + cos * x + sin * z, position[1] + cos * z - sin * x, heights)
    return solid.reshape(spec.size, spec.size, spec.size)


def occupancy_pair(
    scene: SceneHeights,
    position: Point2,
    yaw: float,
    goal: Point2 | None = None,
    *,
    walking: bool = False,
    spec: VoxelSpec = LINGO,
) -> Occupancy:
    """The grid around the pelvis and the one around its goal, both turned with the body. (2, size, size, size).

    A walking body looks `LOOK_AHEAD` towards its goal instead of at it; without a goal both grids are the same.
    """
    here = occupancy(scene, position, yaw, spec)
    if goal is None:
        return np.stack([here, here])
    if walking:
        way = np.subtract(goal, position)
        distance = float(np.hypot(*way))
        ahead = np.asarray(position) + (way * (LOOK_AHEAD / distance) if distance > 0 else way)
        goal = float(ahead[0]), float(ahead[1])
    return np.stack([here, occupancy(scene, goal, yaw, spec)])
