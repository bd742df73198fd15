"""How far a figure of a few trials can be trusted: 95 % intervals."""

from __future__ import annotations

import numpy as np

from motion_backend.rotations import Array

RESAMPLES = 1000


def wilson(values: Array) -> tuple[float, float]:
    """Of a share, from what each of N trials gave, 0 to 1 (Wilson 1927): also where all of them did the same. (N,)."""
    count, share, z = len(values), float(values.mean()), 1.96
    middle = (share + z**2 / (2 * count)) / (1 + z**2 / count)
    wide = z / (1 + z**2 / count) * float(np.sqrt(share * (1 - share) / count + z**2 / (4 * count**2)))
    return max(middle - wide, 0.0), min(middle + wide, 1.0)


def drawn_anew(values: Array) -> tuple[float, float]:
    """Of a mean, by drawing N trials anew. (N,)."""
    drawn = np.random.default_rng(0).integers(len(values), size=(RESAMPLES, len(values)))
    low, high = np.quantile(values[drawn].mean(axis=1), [0.025, 0.975])
    return float(low), float(high)
