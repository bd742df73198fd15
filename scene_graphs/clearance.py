"""How far every place on the floor is from furniture and walls: the raster that walking and checking rooms share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from scene_graphs.forms import parts
from scene_graphs.layouts import Array, Placed, Point2

BODY_RADIUS = 0.22
"""Radius of the disc a walking body keeps free."""
LOWEST, HIGHEST = 0.02, 1.8
"""Heights above the floor between which a part is in a walker's way."""
_AT_ONCE = 1000
"""Points that are asked for in one call: other threads of the process wait until it is done."""
_EIGHT = np.ones((3, 3), dtype=int)


@dataclass(frozen=True)
class Clearance:
    """Distance from every cell's centre to the nearest obstacle or edge of the floor; 0 where one cannot be."""

    origin: Point2
    """[x, z] of the centre of cell (0, 0)."""
    cell: float
    distances: Array
    """(nx, nz) metres, exact at the cell centres."""

    def indices(self, points: Array) -> NDArray[np.int64]:
        """The cells that points lie in, clipped to the raster. (..., 2) -> (..., 2)."""
        cells = np.rint((np.asarray(points, dtype=float) - self.origin) / self.cell).astype(np.int64)
        return np.clip(cells, 0, np.array(self.distances.shape) - 1)

    def at(self, points: Array) -> Array:
        """Clearance at points, interpolated between cell centres; 0 outside the raster. (..., 2) -> (...)."""
        cells = (np.asarray(points, dtype=float) - self.origin) / self.cell
        flat = cells.reshape(-1, 2).T
        values: Array = ndimage.map_coordinates(self.distances, flat, order=1, mode="constant", cval=0.0)
        return values.reshape(cells.shape[:-1])

    @cached_property
    def regions(self) -> NDArray[np.int32]:
        """Label of the connected region each cell belongs to for a body of `BODY_RADIUS`; 0 where it does not fit."""
        return np.asarray(ndimage.label(self.distances >= BODY_RADIUS, structure=_EIGHT)[0], dtype=np.int32)

    def region_at(self, point: Point2) -> int:
        """The region the cell of a point belongs to; 0 outside every region."""
        column, row = self.indices(np.array(point))
        outside = self.at(np.array(point)) <= 0.0
        return 0 if outside else int(self.regions[column, row])


def obstacles(objects: Iterable[Placed]) -> list[tuple[Placed, shapely.Polygon]]:
    """Plan outlines of every solid part that is in a walker's way, with the object it belongs to."""
    found = []
    for placed in objects:
        for part in parts(placed.category, placed.size):
            bottom, top = part.low[1] + placed.position[1], part.high[1] + placed.position[1]
            if part.is_soft or top <= LOWEST or bottom >= HIGHEST:
                continue
            found.append((placed, shapely.Polygon(part_outline(placed, part.low, part.high))))
    return found


def part_outline(placed: Placed, low: Sequence[float], high: Sequence[float]) -> Array:
    """The four [x, z] corners of a box of the object's own frame, in the frame the object is placed in. (4, 2)."""
    corners = np.array([[low[0], 0, low[2]], [low[0], 0, high[2]], [high[0], 0, high[2]], [high[0], 0, low[2]]])
    return placed.to_world(corners)[:, [0, 2]]


def measure_clearance(
    floor: shapely.Geometry, blocked: Sequence[shapely.Geometry], walls: Sequence[shapely.Geometry], cell: float = 0.05
) -> Clearance:
    """Clearance over a floor (one polygon or several): distance to `blocked` areas and to `walls`, 0 off the floor.

    What is neither blocked nor a wall may be stepped to the very edge of, so doorways belong to the floor.
    """
    low_x, low_z, high_x, high_z = shapely.bounds(floor)
    x = np.arange(low_x + cell / 2, high_x, cell)
    z = np.arange(low_z + cell / 2, high_z, cell)
    centers = np.asarray(shapely.points(*np.meshgrid(x, z, indexing="ij")))
    shapely.prepare(floor)
    inside = shapely.contains(floor, centers)
    distances = np.zeros(centers.shape)
    tree = shapely.STRtree([*blocked, *walls])
    wanted = np.flatnonzero(inside)
    if len(wanted) and len(tree):
        for some in np.array_split(wanted, len(wanted) // _AT_ONCE + 1):
            pairs, nearest = tree.query_nearest(centers.ravel()[some], return_distance=True, all_matches=False)
            distances.ravel()[some[pairs[0]]] = nearest
    else:
        distances[inside] = np.inf
    return Clearance((float(x[0]), float(z[0])), cell, distances)
