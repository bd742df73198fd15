"""Features on one scale: mean and spread of what was learned from, stored beside the weights that rest on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Normalization:
    """Mean and spread of F features; both (F,)."""

    mean: Floats
    spread: Floats

    @staticmethod
    def of(rows: NDArray[np.floating], floor: NDArray[np.floating] | float) -> Normalization:
        """That of rows (N, F). What spreads less than its `floor`, in its own unit, is not blown up."""
        if not len(rows) or not np.isfinite(rows).all():
            raise ValueError("rows: a scale needs finite rows, and at least one")
        spread = np.maximum(rows.std(axis=0, dtype=np.float64), floor)
        return Normalization(rows.mean(axis=0, dtype=np.float64).astype(np.float32), spread.astype(np.float32))

    def apply(self, rows: NDArray[np.floating]) -> Floats:
        """Rows (..., F) with mean 0 and spread 1."""
        return np.asarray((rows - self.mean) / self.spread, dtype=np.float32)

    def undo(self, rows: NDArray[np.floating]) -> Floats:
        """The inverse of `apply`. (..., F)."""
        return np.asarray(rows * self.spread + self.mean, dtype=np.float32)
