"""The search for the best rectangle of a plan, compiled: imported late, see `planar_faces.best_block`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scene_graphs.jit import compiled


@compiled
def greatest_run(sums: NDArray[np.float64]) -> tuple[float, int, int, int, int]:
    """The greatest sum of a rectangle, its first row and the one after its last, its first column and the one after.

    `sums` (R + 1, C) are the sums of each column down to a row. Of equal ones the first is taken.
    """
    greatest, found = -np.inf, (0, 0, 0, 0)
    for first in range(len(sums) - 1):
        for last in range(first + 1, len(sums)):
            run, best = -np.inf, -np.inf
            start, begins, ends = 0, 0, 0
            for column in range(sums.shape[1]):
                here = sums[last, column] - sums[first, column]
                if run <= 0:
                    start, run = column, here
                else:
                    run = run + here
                if run > best + 1e-9:
                    best, begins, ends = run, start, column + 1
            if best > greatest:
                greatest, found = best, (first, last, begins, ends)
    return greatest, found[0], found[1], found[2], found[3]
