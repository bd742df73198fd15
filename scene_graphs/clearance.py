"""How far every place on the floor is from furniture and walls, and what of furniture is in a walker's way."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from scene_graphs.footing import Rectangles
from scene_graphs.forms import parts_of
from scene_graphs.layouts import Array, Placed, Point2

BODY_RADIUS = 0.22
"""Radius of the disc a walking body keeps free."""
MIN_OBSTACLE_HEIGHT, MAX_OBSTACLE_HEIGHT = 0.02, 1.8
"""Heights above the floor between which a part is in a walker's way."""
_MANY: Final = 150
"""Obstacles of which the nearest is looked up in a tree."""
_NEAR: Final = 0.6
"""Up to here distances are found around each obstacle; the few cells farther from everything ask for the nearest."""


@dataclass(frozen=True)
class Clearance:
    """Distance from every cell's centre to the nearest obstacle or edge of the floor; 0 where one cannot be."""

    origin: Point2
    """[x, z] of the centre of cell (0, 0)."""
    cell: float
    distances: Array
    """(nx, nz) metres, exact at the cell centres."""

    def at(self, points: Array) -> Array:
        """Clearance at points, interpolated between cell centres; 0 outside the raster. (..., 2) -> (...)."""
        cells = (np.asarray(points, dtype=float) - self.origin) / self.cell
        flat = cells.reshape(-1, 2).T
        values: Array = ndimage.map_coordinates(self.distances, flat, order=1, mode="constant", cval=0.0)
        return values.reshape(cells.shape[:-1])


def obstacles(objects: Iterable[Placed]) -> list[tuple[Placed, shapely.Polygon]]:
    """Plan outlines of every solid part that is in a walker's way, with the object it belongs to."""
    found = []
    for placed in objects:
        for part in parts_of(placed):
            bottom, top = part.low[1] + placed.position[1], part.high[1] + placed.position[1]
            if part.is_soft or top <= MIN_OBSTACLE_HEIGHT or bottom >= MAX_OBSTACLE_HEIGHT:
                continue
            found.append((placed, shapely.Polygon(part_outline(placed, part.low, part.high))))
    return found


def part_outline(placed: Placed, low: Sequence[float], high: Sequence[float]) -> Array:
    """The four [x, z] corners of a box of the object's own frame, in the frame the object is placed in. (4, 2)."""
    corners = np.array([[low[0], 0, low[2]], [low[0], 0, high[2]], [high[0], 0, high[2]], [high[0], 0, low[2]]])
    return placed.to_world(corners)[:, [0, 2]]


def rectangles_of(outlines: Sequence[shapely.Polygon] | NDArray[np.object_]) -> Rectangles:
    """Plan outlines of `obstacles` as one value."""
    return Rectangles.of(shapely.get_coordinates(np.asarray(outlines, dtype=object)).reshape(-1, 5, 2)[:, :4])


def measure_clearance(floor: shapely.Geometry, blocked: Rectangles, walls: Rectangles, cell: float = 0.05) -> Clearance:
    """Clearance over a floor (one polygon or several): distance to `blocked` areas and to `walls`, 0 off the floor.

    What is neither blocked nor a wall may be stepped to the very edge of, so doorways belong to the floor.
    """
    low_x, low_z, high_x, high_z = shapely.bounds(floor)
    x, z = np.arange(low_x + cell / 2, high_x, cell), np.arange(low_z + cell / 2, high_z, cell)
    shapely.prepare(floor)
    distances = np.where(shapely.contains_xy(floor, x[:, None], z[None, :]), np.inf, 0.0)
    for rectangles in (walls, blocked):
        for window, found in rectangles.around(x, z, _NEAR):
            np.minimum(distances[window], found, out=distances[window])
    i, j = np.nonzero(distances > _NEAR)
    distances[i, j] = _far(np.stack([x[i], z[j]], axis=-1), blocked, walls)
    return Clearance((float(x[0]), float(z[0])), cell, distances)


def _far(points: Array, *obstacles: Rectangles) -> Array:
    """Distances of points outside all rectangles to the nearest of them. (N, 2) -> (N,)."""
    outlines = np.concatenate([rectangles.outlines for rectangles in obstacles])
    rings = np.asarray(shapely.linearrings(outlines), dtype=object)
    if len(rings) > _MANY and len(points):
        found = shapely.STRtree(rings).query_nearest(shapely.points(points), return_distance=True, all_matches=False)
        return np.asarray(found[1])
    nearest = shapely.multilinestrings(rings)
    shapely.prepare(nearest)
    return np.asarray(shapely.distance(nearest, shapely.points(points)))
