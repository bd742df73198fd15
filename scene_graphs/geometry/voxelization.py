"""Meshes as solid cells: a grid over a piece's box that knows what is filled and, to the millimetre, how far.

A mesh need not be closed. A cell is solid if the surface passes through it, or if it is seen neither from above nor
from any of the four sides, so that tables and shelves stay hollow while a sofa without an underside is filled.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scene_graphs.json_fields import MAX_COORDINATE, LayoutError
from scene_graphs.layout import Array

Mask = NDArray[np.bool_]
Slices = tuple[slice, slice, slice]

CELL = 0.03
"""Width of a cell in plan, in metres."""
LAYER = 0.02
"""Height of a cell."""
MAX_CELLS = 128
"""Cells along the longest side: what is larger than 3.84 m gets wider cells."""
MAX_TRIANGLES = 5_000_000
MAX_SAMPLES = 20_000_000
"""Points a surface is sampled with; a real piece of furniture takes well under a million."""
_AT_ONCE = 500_000
_THINNEST = 0.02
_MARGIN = 1e-3
"""How much wider the grid is than the mesh, so that boards of round measures seldom end just between two cells."""


@dataclass(frozen=True)
class Voxels:
    """A grid of cells over a mesh, in the mesh's own frame; indices are [x, y, z]."""

    origin: Array
    """Corner of least x, y, z. (3,)."""
    cell: Array
    """Size of a cell. (3,)."""
    solid: Mask
    """(X, Y, Z)."""
    lowest: NDArray[np.float32]
    """Least x, y, z of the surface within each cell; inf where it does not pass. (X, Y, Z, 3)."""
    highest: NDArray[np.float32]
    """Greatest x, y, z of the surface within each cell; -inf where it does not pass. (X, Y, Z, 3)."""

    @cached_property
    def tops(self) -> Array:
        """Exact height of the uppermost surface in each cell, of the cell itself where there is none. (X, Y, Z)."""
        faces = self.origin[1] + self.cell[1] * np.arange(1, self.solid.shape[1] + 1)
        found = self.highest[..., 1].astype(np.float64)
        return np.where(np.isfinite(found), found, faces[None, :, None])

    def bounds(self, cells: Slices) -> tuple[Array, Array]:
        """Corners of what the surface fills of a block of cells; the block's own where no surface passes. (3,) each."""
        start = np.array([part.start for part in cells])
        stop = np.array([part.stop for part in cells])
        low, high = self.origin + start * self.cell, self.origin + stop * self.cell
        least = self.lowest[cells].reshape(-1, 3).min(axis=0).astype(np.float64)
        most = self.highest[cells].reshape(-1, 3).max(axis=0).astype(np.float64)
        # A side no surface lies along is inside something solid: only a cell's own surface can pull it in.
        low = np.where(least - low < self.cell, np.maximum(low, least), low)
        high = np.where(high - most < self.cell, np.minimum(high, most), high)
        return low, high


def voxelise(vertices: ArrayLike, faces: ArrayLike) -> Voxels:
    """The solid cells of a triangle mesh, vertices (N, 3) in metres with Y up and faces (M, 3) of vertex numbers.

    Double and degenerate faces change nothing. LayoutError, with the remedy, if the arrays are no mesh, a coordinate is
    not finite or too far, the mesh is empty, or its surface is too large for its box to be sampled.
    """
    points, corners = _checked(vertices, faces)
    is_used = np.zeros(len(points), dtype=bool)
    is_used[corners] = True
    used = points[is_used]
    low, high = used.min(axis=0), used.max(axis=0)
    extent = np.maximum(high - low, _THINNEST) + _MARGIN
    low = (low + high - extent) / 2
    finest = np.maximum([CELL, LAYER, CELL], extent.max() / MAX_CELLS)
    counts = np.maximum(np.ceil(extent / finest - 1e-6), 1).astype(np.intp)
    cell = extent / counts
    lowest = np.full((int(counts.prod()), 3), np.inf, dtype=np.float32)
    highest = np.full_like(lowest, -np.inf)
    step = float(cell.min()) / 2
    for samples in chain(
        np.array_split(used, len(used) // _AT_ONCE + 1), _samples(_large(points, corners, step), step)
    ):
        places = np.clip((samples - low) / cell, 0, counts - 1).astype(np.intp)
        flat = np.ravel_multi_index((places[:, 0], places[:, 1], places[:, 2]), tuple(counts))
        for axis in range(3):
            values = samples[:, axis].astype(np.float32)
            np.minimum.at(lowest[:, axis], flat, values)
            np.maximum.at(highest[:, axis], flat, values)
    shape = (*counts.tolist(), 3)
    surface = np.isfinite(lowest[:, 0]).reshape(shape[:3])
    return Voxels(low, cell, surface | ~_seen(surface), lowest.reshape(shape), highest.reshape(shape))


def _checked(vertices: ArrayLike, faces: ArrayLike) -> tuple[Array, NDArray[np.intp]]:
    points, corners = np.asarray(vertices, dtype=np.float64), np.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
        raise LayoutError(f"a mesh is vertices (N, 3) and faces (M, 3), got {points.shape} and {corners.shape}")
    if not len(corners) or not np.issubdtype(corners.dtype, np.integer):
        raise LayoutError(f"a mesh needs faces of whole numbers, got {len(corners)} of {corners.dtype}")
    if len(corners) > MAX_TRIANGLES:
        raise LayoutError(f"a mesh of {len(corners)} triangles is too fine", f"simplify it to {MAX_TRIANGLES} or fewer")
    if corners.min() < 0 or corners.max() >= len(points):
        raise LayoutError(f"faces must name vertices 0 to {len(points) - 1}, got {corners.min()} to {corners.max()}")
    if not (np.abs(points) <= MAX_COORDINATE).all():
        raise LayoutError(
            f"vertices must be finite and within {MAX_COORDINATE:g} m of the origin", "is the mesh in metres?"
        )
    return points, corners.astype(np.intp)


def _large(points: Array, corners: NDArray[np.intp], step: float) -> Array:
    """The triangles with a side longer than a step, that side from the first to the second corner. (K, 3, 3)."""
    found = []
    for some in np.array_split(corners, len(corners) // _AT_ONCE + 1):
        triangles = points[some]
        sides = np.stack([((triangles[:, i] - triangles[:, i - 2]) ** 2).sum(axis=1) for i in range(3)], axis=1)
        large = np.flatnonzero(sides.max(axis=1) > step * step)
        turned = (sides[large].argmax(axis=1)[:, None] + [0, 1, 2]) % 3
        found.append(triangles[large[:, None], turned])
    return np.concatenate(found)


def _samples(triangles: Array, step: float) -> Iterator[Array]:
    """Points on triangles (K, 3, 3), nowhere farther apart than a step along and across the first side. (N, 3) each."""
    if not len(triangles):
        return
    along, across = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    length = np.linalg.norm(along, axis=1)
    height = np.linalg.norm(np.cross(along, across), axis=1) / np.maximum(length, 1e-12)
    rows = np.stack([np.ceil(height / step), np.ceil(length / step)], axis=1).astype(np.int64) + 1
    total = int(rows.prod(axis=1).sum())
    if total > MAX_SAMPLES:
        raise LayoutError(f"a mesh whose surface takes {total} samples is no piece of furniture", "simplify it")
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    order = np.argsort(kind.ravel(), kind="stable")
    for (down, right), members in zip(kinds, np.split(order, np.cumsum(np.bincount(kind.ravel()))[:-1]), strict=True):
        t, s = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, down), np.linspace(0, 1, right), indexing="ij"))
        weights = np.stack([(1 - t) * (1 - s), (1 - t) * s, t])  # towards the corner c the rows grow shorter
        for chosen in np.array_split(members, len(members) * len(t) // _AT_ONCE + 1):
            yield np.einsum("nck,cs->nsk", triangles[chosen], weights).reshape(-1, 3)


def _seen(surface: Mask) -> Mask:
    """The cells that nothing hides from above or from one of the four sides. (X, Y, Z)."""
    seen = ~np.logical_or.accumulate(surface[:, ::-1], axis=1)[:, ::-1]
    for axis in (0, 2):
        seen |= ~np.logical_or.accumulate(surface, axis=axis)
        seen |= ~np.flip(np.logical_or.accumulate(np.flip(surface, axis), axis=axis), axis)
    return np.asarray(seen)
