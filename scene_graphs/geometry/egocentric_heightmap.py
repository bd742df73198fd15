"""Egocentric heightmaps: how high things are around a body, on a square grid that turns with it (SIMS 3.3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
import shapely

from scene_graphs.geometry.height_raster import CELL, Columns, Heights, Raster
from scene_graphs.home import Home
from scene_graphs.layout import Array, Placed


@dataclass(frozen=True)
class HeightmapSpec:
    """A square grid of samples around a body, in its heading frame (+Z ahead, +X to its left)."""

    size: int
    """Samples along each side."""
    spacing: float
    """Between neighbouring samples, in metres."""
    behind: float
    """From the body to the rearmost row, in metres; sideways the grid is centred."""
    shows: Literal["scene", "furniture", "target"] = "scene"
    """The scene has walls outside its rooms; furniture and the target object alone stand on an endless floor."""
    relative: bool = True
    """Whether heights count from the root or from the floor."""

    def __post_init__(self) -> None:
        if not 1 <= self.size <= 512 or not 0 < self.spacing < 100 or not abs(self.behind) < 100:
            raise ValueError(f"a heightmap has 1 to 512 samples a side, metres between them and behind, got {self}")

    @cached_property
    def offsets(self) -> tuple[Array, Array]:
        """Where the samples are, x and z in the heading frame, x-major. (size²,), (size²,)."""
        steps = self.spacing * np.arange(self.size)
        x, z = np.meshgrid(steps - steps[-1] / 2, steps - self.behind, indexing="ij")
        return x.ravel(), z.ravel()


SIMS: Final = HeightmapSpec(12, 0.15, 0.825, "target")
"""The paper gives no size; 12 × 12 at 0.15 m is reported of a later version. Heights of the target object alone."""
TOKENHSI: Final = HeightmapSpec(25, 2 / 24, 1.0, "furniture")
"""25 × 25 samples, linspace(-1, 1) both ways, the highest of all objects, less the root's height."""
UNIHSI: Final = HeightmapSpec(9, 0.2, 0.4, "scene", relative=False)
"""9 × 9 samples from 0.4 m behind to 1.2 m ahead; heights above the floor."""


class SceneHeights:
    """How high everything in a home is, on cells of 2 cm, computed once and then looked up.

    Solid parts that begin below a walker's head count (`MAX_OBSTACLE_HEIGHT`), what a body sinks into does not. Cells
    outside the rooms and their doorways are as high as the highest room. ValueError if the home has too many cells of
    that size.
    """

    def __init__(self, home: Home, cell: float = CELL) -> None:
        self.home = home
        low_x, low_z, high_x, high_z = shapely.bounds(home.floor).tolist()
        self.raster = Raster.around((low_x, low_z), (high_x, high_z), cell)
        self.columns = Columns.over(self.raster, home)
        self._scene, self._furniture = self._heights()
        self._targets: dict[str, tuple[Raster, Heights]] = {}

    def egocentric(
        self,
        position: Array | tuple[float, float, float],
        yaw: Array | float,
        spec: HeightmapSpec = TOKENHSI,
        target: str | None = None,
    ) -> Heights:
        """Heights around roots at positions (..., 3) heading to yaws (...). (..., size, size), x first.

        Every sample takes the height of its nearest cell. `target` is the id of the object a spec that shows only its
        target looks at; on a grid that shows more it is ignored. ValueError if such a spec gets none, or a root is not
        finite; KeyError for an unknown object.
        """
        root, heading = np.asarray(position, dtype=float), np.asarray(yaw, dtype=float)[..., None]
        if not (np.isfinite(root).all() and np.isfinite(heading).all()):
            raise ValueError(f"position and yaw must be finite numbers, got {position!r:.80} and {yaw!r:.80}")
        raster, heights = self._shown(spec, target)
        (x, z), cos, sin = spec.offsets, np.cos(heading), np.sin(heading)
        i, j = raster.cells_at(root[..., 0, None] + cos * x + sin * z, root[..., 2, None] + cos * z - sin * x)
        found = heights[i, j]
        if spec.relative:
            found -= root[..., 1, None].astype(np.float32)
        return found.reshape(*found.shape[:-1], spec.size, spec.size)

    def _shown(self, spec: HeightmapSpec, target: str | None) -> tuple[Raster, Heights]:
        if spec.shows != "target":
            return self.raster, self._scene if spec.shows == "scene" else self._furniture
        if target is None:
            raise ValueError("this heightmap shows its target alone: name the target, an object's id")
        if target not in self._targets:
            self._targets[target] = self._alone(self.home.object(target))
        return self._targets[target]

    def _heights(self) -> tuple[Heights, Heights]:
        """The highest of the scene and of its furniture alone over every cell. (nx, nz) each."""
        furniture = np.zeros(self.raster.shape, dtype=np.float32)
        for placed in self.home.objects:
            _raise(furniture, self.raster, placed)
        walls = np.float32(max(room.layout.height for room in self.home.rooms))
        return np.where(self.columns.inside, furniture, walls), furniture

    def _alone(self, placed: Placed) -> tuple[Raster, Heights]:
        """One object's own heights, in a raster of its own on the same cells."""
        whole = self.raster
        low, high = (
            np.floor((corner - np.asarray(whole.origin)) / whole.cell).astype(int)
            for corner in (placed.footprint.min(axis=0) - 2 * whole.cell, placed.footprint.max(axis=0) + 2 * whole.cell)
        )
        x, z = (origin + whole.cell * first for origin, first in zip(whole.origin, low, strict=True))
        raster = Raster((float(x), float(z)), whole.cell, (int(high[0] - low[0]) + 2, int(high[1] - low[1]) + 2))
        heights = np.zeros(raster.shape, dtype=np.float32)
        _raise(heights, raster, placed)
        return raster, heights


def _raise(heights: Heights, raster: Raster, placed: Placed) -> None:
    """Raise the cells an object covers to its height there."""
    for rows, columns, covers, _, top in raster.stamps(placed):
        window = heights[rows, columns]
        np.maximum(window, np.where(covers, np.float32(top), np.float32(0.0)), out=window)
