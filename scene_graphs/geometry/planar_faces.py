"""Flat faces of a mesh: the rectangles one can sit, lie or put things on.

Covering the cells of a plan with few rectangles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scene_graphs.boxes import Part, Point3
from scene_graphs.geometry.voxelization import Voxels
from scene_graphs.layout import Array

Gains = NDArray[np.float64]
Mask = NDArray[np.bool_]


class Block(NamedTuple):
    """A rectangle of cells, ends excluded."""

    x0: int
    x1: int
    z0: int
    z1: int

    @property
    def cells(self) -> tuple[slice, slice]:
        """What it holds of a plan [x, z]."""
        return slice(self.x0, self.x1), slice(self.z0, self.z1)

    def grown(self, by: int) -> Block:
        """With that many cells more on every side, as far as indices go down to 0."""
        return Block(max(self.x0 - by, 0), self.x1 + by, max(self.z0 - by, 0), self.z1 + by)


def best_block(gains: Gains) -> tuple[Block, float]:
    """The rectangle whose cells' gains (X, Z) have the greatest sum, and the sum.

    Every pair of first and last rows is tried, with Kadane's greatest run along the columns: O(X² Z), once rows
    and columns that are like the one before are taken together. Of equal rectangles the first found is taken.
    """
    # Here, since numba takes half a second, and most that ask for furniture have no mesh.
    from scene_graphs.geometry.rectangle_kernel import greatest_run

    rows, columns = _changes(gains), _changes(gains.T)
    sums = np.pad(np.add.reduceat(np.cumsum(gains, axis=0)[rows[1:] - 1], columns[:-1], axis=1), ((1, 0), (0, 0)))
    best, first, last, start, end = greatest_run(np.ascontiguousarray(sums))
    block = Block(rows[first], rows[last], columns[start], columns[end])
    return Block(*(int(edge) for edge in block)), float(best)


def compile_faces() -> None:
    """Search once, so that the search is compiled and kept on disk."""
    best_block(np.ones((1, 1)))


def _changes(gains: Gains) -> NDArray[np.intp]:
    """The rows that differ from the one before, with 0 and the number of rows."""
    differs = np.flatnonzero((gains[1:] != gains[:-1]).any(axis=1)) + 1
    return np.concatenate([[0], differs, [len(gains)]])


def blocks(mask: Mask, hole: float, margin: int) -> Iterator[Block]:
    """Rectangles, largest first, that together cover a mask (X, Z); one may hold a gap where that costs it `hole`.

    What lies within `margin` cells of a rectangle counts as covered by it.
    """
    left, gains = mask.copy(), np.where(mask, 1.0, -hole)
    while left.any():
        x, z = (np.flatnonzero(left.any(axis=axis)) for axis in (1, 0))
        window = (slice(x[0], x[-1] + 1), slice(z[0], z[-1] + 1))
        found, _ = best_block(gains[window])
        block = Block(found.x0 + int(x[0]), found.x1 + int(x[0]), found.z0 + int(z[0]), found.z1 + int(z[0]))
        yield block
        near = block.grown(margin).cells
        left[near] = False
        gains[near] = np.minimum(gains[near], 0.0)


@dataclass(frozen=True)
class Kind:
    """What a face must be to serve as a seat, a mattress or a top; lengths in metres."""

    heights: tuple[float, float]
    """Least and greatest above the floor it stands on."""
    headroom: float
    """What must be free above it."""
    sides: tuple[float, float]
    """Shorter and longer side of the least rectangle."""
    thick: float
    """It is made of this much at most; what is below is what it stands on."""
    strewn: float = 0.0
    """Up to this height above it things are pillows and blankets, which take nothing away."""


KINDS: Final = {
    "seat": Kind((0.15, 0.80), 0.70, (0.24, 0.24), 0.15),
    "mattress": Kind((0.15, 0.90), 0.70, (0.50, 1.20), 0.25, 0.30),
    "top": Kind((0.15, 1.25), 0.25, (0.20, 0.20), 0.06),
}
"""By the role of the part they become."""
EVEN: Final = 0.05
"""Cells this near a level, in metres, belong to it: cushions are crowned, seats lean back."""
RISEN: Final = 0.12
"""What stands higher above a face is no part of it."""
ROUNDED: Final = 0.13
"""How far the edges of a cushion may be rounded off beyond its flat part."""
_HOLE: Final = 3.0
"""What a cell off the level costs a rectangle that holds it: the best one in a disc is 0.8 of it wide."""
_FEW: Final = 0.2
_LEVELS: Final = 4
_TOUCHING: Final = 1e-3


@dataclass(frozen=True)
class FlatFace:
    """A rectangle of cells at one level."""

    part: Part
    """The board, cushion or mattress below it."""
    block: Block
    layers: slice
    """From the first layer of its part to the last that belongs to what lies on it."""


def flat_faces(voxels: Voxels, role: str) -> list[FlatFace]:
    """The faces of a mesh that serve as "seat", "mattress" or "top", largest first: rectangles on the one level that
    has the largest. Cushions of one sofa make one face, wings at an angle one each."""
    layers, heights = _uppermost(voxels, KINDS[role])
    best: list[tuple[Block, float]] = []
    for level, cells in _levels(heights, KINDS[role].heights[1]):
        strewn = (heights > level) & (heights <= level + KINDS[role].strewn)
        found = _rectangles(np.where(cells, 1.0, np.where(strewn, 0.0, -_HOLE)), voxels.cell[[0, 2]], KINDS[role])
        best = max(best, found, key=lambda blocks: blocks[0][1] if blocks else 0.0)
    return [_face(voxels, block, role, layers, heights) for block, _ in best]


def _rectangles(gains: Array, plan: Array, kind: Kind) -> list[tuple[Block, float]]:
    """Large enough rectangles of cells (X, Z) that are `plan` metres wide and deep, and their gains, greatest first."""
    found = []
    while (gains > 0).any():
        block, gain = best_block(gains)
        if gain * plan.prod() < 0.5 * kind.sides[0] * kind.sides[1]:
            break
        shorter, longer = sorted((plan * [block.x1 - block.x0, block.z1 - block.z0] + 1e-6).tolist())
        if shorter >= kind.sides[0] and longer >= kind.sides[1]:
            found.append((block, gain))
        gains[block.cells] = -_HOLE
    return found


def _uppermost(voxels: Voxels, kind: Kind) -> tuple[NDArray[np.intp], Array]:
    """For each column the highest layer that is open above and whose top face is at the heights asked for, and its
    exact height; -1 and nan where there is none. (X, Z) each."""
    solid, tall = voxels.solid, voxels.solid.shape[1]
    room = round(kind.headroom / float(voxels.cell[1]))
    tops = voxels.tops
    count = np.cumsum(np.pad(solid, ((0, 0), (1, room), (0, 0))), axis=1)
    above: NDArray[np.intp] = count[:, 1 + room :] - count[:, 1 : 1 + tall]
    covered = np.pad(solid[:, 1:], ((0, 0), (0, 1), (0, 0)))
    fits = solid & ~covered & (above * voxels.cell[1] <= kind.strewn)
    fits &= (tops >= kind.heights[0]) & (tops <= kind.heights[1] + kind.strewn)
    layer = np.where(fits.any(axis=1), tall - 1 - fits[:, ::-1].argmax(axis=1), -1)
    height = np.take_along_axis(tops, np.maximum(layer, 0)[:, None, :], axis=1)[:, 0]
    return layer, np.where(layer >= 0, height, np.nan)


def _levels(heights: Array, most: float) -> Iterator[tuple[float, Mask]]:
    """The height around which most cells lie and those cells (X, Z), then of the others, a few times."""
    left = heights <= most
    for _ in range(_LEVELS):
        found = np.sort(heights[left])
        if not len(found):
            return
        many = np.searchsorted(found, found + 1.5 * EVEN, side="right") - np.arange(len(found))
        start = int(many.argmax())
        level = float(np.median(found[start : start + int(many[start])]))
        cells = left & (np.abs(heights - level) <= EVEN)
        yield level, cells
        left &= ~cells


def _face(voxels: Voxels, block: Block, role: str, layers: NDArray[np.intp], heights: Array) -> FlatFace:
    kind, tall = KINDS[role], float(voxels.cell[1])
    inside = np.nan_to_num(heights[block.cells])
    level = float(np.median(inside[inside > 0]))
    middle = int(np.median(layers[block.cells][inside > 0]))
    bottom = max(_underside(voxels, block, middle), level - kind.thick)
    first = min(int((bottom - voxels.origin[1] - _TOUCHING) / tall), middle)
    block = _rounded(voxels, block, first, middle)
    # Down to the floor: one sits at the edge of the rails or the base below where these stand out.
    low, high = voxels.bounds((slice(block.x0, block.x1), slice(0, middle + 1), slice(block.z0, block.z1)))
    ends: list[Point3] = [(float(end[0]), y, float(end[2])) for end, y in ((low, bottom), (high, level))]
    above = 0.0 if kind.strewn else RISEN
    return FlatFace(Part(role, *ends), block, slice(first, middle + 1 + round(above / tall)))


def _underside(voxels: Voxels, block: Block, layer: int) -> float:
    """The height at which most columns of a block, followed down from a layer, stop being solid."""
    columns = voxels.solid[block.x0 : block.x1, layer::-1, block.z0 : block.z1]
    run = np.where(columns.all(axis=1), columns.shape[1], columns.argmin(axis=1))
    last = layer + 1 - int(np.median(run[run > 0])) if (run > 0).any() else layer
    found = voxels.lowest[block.x0 : block.x1, last, block.z0 : block.z1, 1]
    found = found[np.isfinite(found)]
    return float(np.median(found) if len(found) else voxels.origin[1] + last * voxels.cell[1])


def _rounded(voxels: Voxels, block: Block, first: int, layer: int) -> Block:
    """The block grown over edges that round off: on every side where the piece ends close by and nothing rises."""
    filled = np.asarray(voxels.solid[:, first : layer + 1].any(axis=1))
    risen = np.asarray(voxels.solid[:, layer + 1 + round(RISEN / voxels.cell[1]) :].any(axis=1))
    (x0, x1, z0, z1), (wide, _, deep) = block, voxels.cell.tolist()
    return Block(
        x0 - _overhang(filled[:x0, z0:z1][::-1], risen[:x0, z0:z1][::-1], wide),
        x1 + _overhang(filled[x1:, z0:z1], risen[x1:, z0:z1], wide),
        z0 - _overhang(filled[x0:x1, :z0].T[::-1], risen[x0:x1, :z0].T[::-1], deep),
        z1 + _overhang(filled[x0:x1, z1:].T, risen[x0:x1, z1:].T, deep),
    )


def _overhang(filled: NDArray[np.bool_], risen: NDArray[np.bool_], cell: float) -> int:
    """How many rows of cells, going outwards from a side, still belong to it; 0 where the piece goes on or rises."""
    for row in range(round(ROUNDED / cell) + 1):
        if row == len(filled) or filled[row].mean() < _FEW:
            return row
        if risen[row].mean() > _FEW:
            return 0
    return 0
