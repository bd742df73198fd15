"""A home seen from above, in small square cells: what stands over each of them, from what height to what height."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.furniture_shapes import parts_of
from scene_graphs.home import Home
from scene_graphs.layout import Array, Placed, Point2
from scene_graphs.navigation.clearance import MAX_OBSTACLE_HEIGHT

CELL: Final = 0.02
"""Side of a cell, in metres: LINGO's and TRUMANS'."""
MAX_CELLS: Final = 40_000_000
"""Of one raster; a home of four halls has 36 million of 2 cm."""

Heights = NDArray[np.float32]
Indices = NDArray[np.int64]
Stamp = tuple[slice, slice, NDArray[np.bool_], float, float]
"""Rows and columns of the cells around a part, which of them it covers, and its bottom and top above the floor."""


@dataclass(frozen=True)
class Raster:
    """Square cells over a stretch of floor plane; the outermost ring stands for everything beyond."""

    origin: Point2
    """[x, z] of the centre of cell (0, 0)."""
    cell: float
    shape: tuple[int, int]
    """Cells along x and along z, the ring included."""

    @classmethod
    def around(cls, low: Point2, high: Point2, cell: float) -> Raster:
        """Cells over a rectangle, with a ring around it. ValueError if they are too many or no size."""
        if not cell > 0:
            raise ValueError(f"cell must be a positive length in metres, got {cell!r}")
        nx, nz = (int(np.ceil((b - a) / cell)) + 2 for a, b in zip(low, high, strict=True))
        if nx * nz > MAX_CELLS:
            raise ValueError(f"{nx} by {nz} cells of {cell} m are more than {MAX_CELLS}; take a greater cell")
        return cls((low[0] - cell / 2, low[1] - cell / 2), cell, (nx, nz))

    def cells_at(self, x: Array, z: Array) -> tuple[Indices, Indices]:
        """The cells nearest to points, those beyond the raster in the ring. (...), (...) -> (...), (...)."""
        (nx, nz), scale = self.shape, 1.0 / self.cell
        i = np.clip((x - self.origin[0]) * scale + 0.5, 0.0, nx - 1).astype(np.int64)
        j = np.clip((z - self.origin[1]) * scale + 0.5, 0.0, nz - 1).astype(np.int64)
        return i, j

    def centers(self) -> tuple[Array, Array]:
        """x of every row and z of every column of cells. (nx,), (nz,)."""
        x = np.asarray(self.origin[0] + self.cell * np.arange(self.shape[0]), dtype=float)
        z = np.asarray(self.origin[1] + self.cell * np.arange(self.shape[1]), dtype=float)
        return x, z

    def inside(self, area: shapely.Geometry) -> NDArray[np.bool_]:
        """Which cells have their centre in an area. (nx, nz)."""
        x, z = self.centers()
        found = np.zeros(self.shape, dtype=bool)
        for part in shapely.get_parts(area):
            low_x, low_z, high_x, high_z = part.bounds
            rows = slice(*np.searchsorted(x, (low_x, high_x)))
            columns = slice(*np.searchsorted(z, (low_z, high_z)))
            shapely.prepare(part)
            found[rows, columns] |= shapely.contains_xy(part, x[rows, None], z[None, columns])
        return found

    def stamps(self, placed: Placed) -> Iterator[Stamp]:
        """The cells each solid part of an object covers; what begins above a walker's head is left out.

        What is thinner than a cell counts as wide as one across, so that no board has holes between two centres.
        """
        x, z = self.centers()
        (low_x, low_z), (high_x, high_z) = placed.footprint.min(axis=0), placed.footprint.max(axis=0)
        rows = slice(*np.searchsorted(x, (low_x - self.cell, high_x + self.cell)))
        columns = slice(*np.searchsorted(z, (low_z - self.cell, high_z + self.cell)))
        cos, sin = np.cos(placed.yaw), np.sin(placed.yaw)
        dx, dz = x[rows, None] - placed.position[0], z[None, columns] - placed.position[2]
        across, ahead = cos * dx - sin * dz, sin * dx + cos * dz
        thinnest = self.cell * (abs(cos) + abs(sin))
        for part in parts_of(placed):
            bottom, top = part.low[1] + placed.position[1], part.high[1] + placed.position[1]
            if part.is_soft or top <= 0.0 or bottom >= MAX_OBSTACLE_HEIGHT:
                continue
            half_x, half_z = (max(part.size[axis], thinnest) / 2 + 1e-9 for axis in (0, 2))
            covers = (np.abs(across - part.center[0]) <= half_x) & (np.abs(ahead - part.center[2]) <= half_z)
            yield rows, columns, covers, bottom, top


@dataclass(frozen=True)
class Columns:
    """What is solid over each cell of a raster, as intervals of height: a table is a top and legs with air between."""

    raster: Raster
    inside: NDArray[np.bool_]
    """Which cells belong to a room or a doorway; the rest are wall or the world outside. (nx, nz)."""
    first: Indices
    """Where the intervals of a cell begin; they end where those of the next begin. (nx * nz + 1,)."""
    bottoms: Array
    tops: Array
    """Heights above the floor, cell after cell. (intervals,)."""

    @classmethod
    def over(cls, raster: Raster, home: Home) -> Columns:
        """The columns of a home's furniture."""
        numbers = np.arange(raster.shape[0] * raster.shape[1]).reshape(raster.shape)
        cells, bottoms, tops = [np.empty(0, np.int64)], [np.empty(0)], [np.empty(0)]
        for placed in home.objects:
            for rows, columns, covers, bottom, top in raster.stamps(placed):
                cells.append(numbers[rows, columns][covers])
                bottoms.append(np.full(len(cells[-1]), bottom))
                tops.append(np.full(len(cells[-1]), top))
        covered = np.concatenate(cells)
        order = np.argsort(covered, kind="stable")
        first = np.concatenate([[0], np.cumsum(np.bincount(covered, minlength=numbers.size))])
        inside = raster.inside(home.floor)
        return cls(raster, inside, first, np.concatenate(bottoms)[order], np.concatenate(tops)[order])

    def solid(self, x: Array, z: Array, heights: Array) -> NDArray[np.bool_]:
        """Whether something solid is at heights over points; outside the rooms everything is.

        (n,), (n,), (m,) -> (m, n).
        """
        i, j = self.raster.cells_at(x, z)
        cells = i * self.raster.shape[1] + j
        begin, end = self.first[cells], self.first[cells + 1]
        found = np.zeros((len(heights), len(cells)), dtype=bool)
        found[:, ~self.inside[i, j]] = True
        level = np.asarray(heights)[:, None]
        while len(here := np.flatnonzero(begin < end)):
            at = begin[here]
            found[:, here] |= (self.bottoms[at] <= level) & (level <= self.tops[at])
            begin[here] += 1
        return found
