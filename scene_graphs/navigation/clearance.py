"""How far every place on the floor is from furniture and walls, and what of furniture is in a walker's way.

Where a body of one radius can stand, and which of those places hang together, is asked more often: that only compares
distances with a radius, so it looks at the cells around each obstacle alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from scene_graphs.furniture_shapes import parts_of
from scene_graphs.layout import Array, Placed, Point2

_EIGHT = np.ones((3, 3), dtype=int)
_EXACTLY = 1e-9
"""Touching is allowed; rounding is not to decide it."""


@dataclass(frozen=True)
class Rectangles:
    """N rectangles on the floor; one without width is a wall."""

    corners: Array
    """(N, 2) [x, z]."""
    along: Array
    """(N, 2) unit vector u of the first side; the second side is [u_z, -u_x]."""
    extents: Array
    """(N, 2) lengths of the first and the second side, in metres."""

    @staticmethod
    def of(outlines: Array) -> Rectangles:
        """From four corners each, in order around. (N, 4, 2)."""
        first, second = outlines[:, 1] - outlines[:, 0], outlines[:, 3] - outlines[:, 0]
        extents = np.stack([np.hypot(*first.T), np.hypot(*second.T)], axis=1)
        along = first / np.maximum(extents[:, :1], 1e-12)
        turned = along[:, 1] * second[:, 0] < along[:, 0] * second[:, 1]
        return Rectangles(outlines[np.arange(len(outlines)), 3 * turned], along, extents)

    @staticmethod
    def of_walls(outline: Array) -> Rectangles:
        """The sides of a room's outline, not closed. (N, 2)."""
        starts, ends = outline, np.roll(outline, -1, axis=0)
        return Rectangles.of(np.stack([starts, ends, ends, starts], axis=1))

    @property
    def outlines(self) -> Array:
        """The corners of every rectangle, in order around. (N, 4, 2)."""
        first = self.along * self.extents[:, :1]
        second = np.stack([self.along[:, 1], -self.along[:, 0]], axis=1) * self.extents[:, 1:]
        corners: Array = self.corners[:, None] + np.stack([0 * first, first, first + second, second], axis=1)
        return corners

    def distances(self, points: Array) -> Array:
        """From points to every rectangle, 0 inside it. (..., 2): (..., N)."""
        away = points[..., None, :] - self.corners
        return _outside(away[..., 0], away[..., 1], *self.along.T, *self.extents.T)

    def around(self, x: Array, z: Array, reach: float) -> Iterator[tuple[tuple[slice, slice], Array]]:
        """For each rectangle the window of a grid that lies within `reach` of it, and the distances there.

        x (nx,) and z (nz,) ascend; a window's distances are (its nx, its nz).
        """
        low, high = self.outlines.min(axis=1) - reach, self.outlines.max(axis=1) + reach
        windows = [
            (np.searchsorted(axis, low[:, i]), np.searchsorted(axis, high[:, i])) for i, axis in ((0, x), (1, z))
        ]
        for number, (i, k, j, m) in enumerate(zip(*windows[0], *windows[1], strict=True)):
            (cx, cz), (ux, uz), (length, width) = self.corners[number], self.along[number], self.extents[number]
            yield (slice(i, k), slice(j, m)), _outside(x[i:k, None] - cx, z[None, j:m] - cz, ux, uz, length, width)


@dataclass(frozen=True)
class Footing:
    """The cells of a floor where the centre of a body can be, exact at the cells' centres."""

    origin: Point2
    """[x, z] of the centre of cell (0, 0)."""
    cell: float
    free: NDArray[np.bool_]
    """(nx, nz)."""

    @cached_property
    def regions(self) -> NDArray[np.int32]:
        """The number, from 1, of the connected region every free cell belongs to; 0 elsewhere. (nx, nz)."""
        return np.asarray(ndimage.label(self.free, structure=_EIGHT)[0], dtype=np.int32)

    def region_at(self, point: Point2) -> int:
        """The region the cell of a point belongs to; 0 outside every region."""
        column, row = ((point[axis] - self.origin[axis]) / self.cell for axis in (0, 1))
        if not (0 <= column <= self.free.shape[0] - 1 and 0 <= row <= self.free.shape[1] - 1):
            return 0
        return int(self.regions[round(column), round(row)])


def edges_of(floor: shapely.Geometry) -> Rectangles:
    """The edges of a floor, holes and all, as walls without thickness."""
    rings = [ring for part in shapely.get_parts(floor) for ring in (part.exterior, *part.interiors)]
    lines = [np.stack([corners[:-1], corners[1:]], axis=1) for corners in map(shapely.get_coordinates, rings)]
    starts, ends = np.concatenate(lines).swapaxes(0, 1)
    return Rectangles.of(np.stack([starts, ends, ends, starts], axis=1))


def find_footing(floor: shapely.Geometry, blocked: Rectangles, radius: float, cell: float = 0.05) -> Footing:
    """The cells inside the floor that are at least `radius` from its walls and from everything that blocks."""
    low_x, low_z, high_x, high_z = shapely.bounds(floor)
    x, z = np.arange(low_x + cell / 2, high_x, cell), np.arange(low_z + cell / 2, high_z, cell)
    shapely.prepare(floor)
    free = np.asarray(shapely.contains_xy(floor, *np.meshgrid(x, z, indexing="ij")))
    for rectangles in (edges_of(floor), blocked):
        for window, distances in rectangles.around(x, z, radius):
            free[window] &= distances >= radius - _EXACTLY
    return Footing((float(x[0]), float(z[0])), cell, free)


def _outside(x: Array, z: Array, ux: Array, uz: Array, length: Array, width: Array) -> Array:
    """Distance of points, seen from a corner, to the rectangle along u and [u_z, -u_x]."""
    s, t = x * ux + z * uz, x * uz - z * ux
    gaps = (np.maximum(np.maximum(-side, side - most), 0.0) for side, most in ((s, length), (t, width)))
    return np.asarray(np.hypot(*gaps))


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
