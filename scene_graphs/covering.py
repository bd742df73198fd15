"""Covering the cells of a plan with few rectangles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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

    Every pair of first and last rows is tried at once, with Kadane's greatest run along the columns: O(X² Z), once rows
    and columns that are like the one before are taken together. Of equal rectangles the first found is taken.
    """
    rows, columns = _changes(gains), _changes(gains.T)
    sums = np.pad(np.add.reduceat(np.cumsum(gains, axis=0)[rows[1:] - 1], columns[:-1], axis=1), ((1, 0), (0, 0)))
    first, last = np.triu_indices(len(rows), 1)
    run = np.full(len(first), -np.inf)
    start = np.zeros(len(first), dtype=np.intp)
    best, ends, starts = run.copy(), start.copy(), start.copy()
    for column in range(len(columns) - 1):
        here = sums[last, column] - sums[first, column]
        fresh = run <= 0
        start[fresh] = column
        run = np.where(fresh, here, run + here)
        better = run > best + 1e-9
        best[better], starts[better], ends[better] = run[better], start[better], column + 1
    chosen = int(best.argmax())
    block = Block(rows[first[chosen]], rows[last[chosen]], columns[starts[chosen]], columns[ends[chosen]])
    return Block(*(int(edge) for edge in block)), float(best[chosen])


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
