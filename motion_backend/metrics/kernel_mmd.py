"""How far one set of feature vectors is from another: the unbiased kernel MMD².

Eq. 3 of Gretton and others, JMLR 2012, with several kernels.

With few clips it says more than a Fréchet distance, which is large between two halves of one set. 0 on average for
equal distributions (so it is often negative), at most 2. Windows of one person are alike: spreads are bootstrapped over
people, and the distance between people is the floor that a distance is read against.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.rotations import Array

WIDTHS: Final = (0.5, 1.0, 2.0)
"""Of the Gaussian kernels, against the median distance within the reference."""
REPEATS: Final = 400
"""Bootstrap samples, and divisions of the reference in two."""


@dataclass(frozen=True)
class Distance:
    """MMD² of two sets, with 95 % of it."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Scale:
    """What makes features comparable, taken from the reference alone, so that distances to it are comparable too."""

    mean: Array
    """(F,)."""
    deviation: Array
    """(F,) standard deviation; 1 where the reference does not vary."""
    median: float
    """Distance of two standardised vectors of the reference, in the middle."""

    @staticmethod
    def of(reference: Array) -> Scale:
        """From (N, F) with at least two vectors."""
        deviation = reference.std(axis=0)
        deviation = np.where(deviation > 1e-12, deviation, 1.0)
        gaps = distances(reference / deviation, reference / deviation)[np.triu_indices(len(reference), 1)]
        return Scale(reference.mean(axis=0), deviation, float(np.median(gaps)) or 1.0)

    def standard(self, features: Array) -> Array:
        """Features in standard deviations of the reference. (N, F)."""
        return np.asarray((features - self.mean) / self.deviation)


def distances(first: Array, second: Array) -> Array:
    """Euclidean distances. (N, F), (M, F) to (N, M)."""
    squares = np.sum(first**2, axis=1)[:, None] + np.sum(second**2, axis=1) - 2 * first @ second.T
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def kernel(gaps: Array, median: float) -> Array:
    """The mean of three Gaussian kernels of distances."""
    return np.asarray(np.mean([np.exp(-((gaps / (width * median)) ** 2) / 2) for width in WIDTHS], axis=0))


def mmd_squared(within: Array, without: Array, between: Array, weights: tuple[Array, Array] | None = None) -> float:
    """From kernels of the first set (N, N), of the second (M, M) and from one to the other (N, M).

    `weights` say how often each vector was drawn: one that is drawn twice is not a pair with itself.
    """
    first, second = weights or (np.ones(len(within)), np.ones(len(without)))
    cross = float(first @ between @ second / (first.sum() * second.sum()))
    return _among(within, first) + _among(without, second) - 2 * cross


def _among(kernels: Array, weights: Array) -> float:
    """The mean over ordered pairs of two different vectors."""
    own = np.diagonal(kernels) @ weights**2
    return float((weights @ kernels @ weights - own) / (weights.sum() ** 2 - (weights**2).sum()))


def discrepancy(
    reference: Array, people: Sequence[str], other: Array, groups: Sequence[str], seed: int = 0
) -> Distance:
    """How far (M, F) is from the reference (N, F), bootstrapped over the people of one and the groups of the other."""
    scale = Scale.of(reference)
    first, second = scale.standard(reference), scale.standard(other)
    within, without, between = (
        kernel(distances(a, b), scale.median) for a, b in ((first, first), (second, second), (first, second))
    )
    rng = np.random.default_rng(seed)
    drawn = [mmd_squared(within, without, between, (_drawn(people, rng), _drawn(groups, rng))) for _ in range(REPEATS)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Distance(mmd_squared(within, without, between), float(low), float(high))


def floor(reference: Array, people: Sequence[str], seed: int = 0) -> Distance:
    """How far one half of the reference's people is from the other, over random halves, and where 95 % of them lie."""
    scale = Scale.of(reference)
    standard = scale.standard(reference)
    kernels = kernel(distances(standard, standard), scale.median)
    rng, names, of = np.random.default_rng(seed), sorted(set(people)), np.array(people)
    found = []
    for _ in range(REPEATS):
        half = np.isin(of, rng.choice(names, len(names) // 2, replace=False))
        if min(half.sum(), (~half).sum()) > 1:
            found.append(
                mmd_squared(kernels[np.ix_(half, half)], kernels[np.ix_(~half, ~half)], kernels[np.ix_(half, ~half)])
            )
    low, high = np.quantile(found, [0.025, 0.975])
    return Distance(float(np.mean(found)), float(low), float(high))


def _drawn(groups: Sequence[str], rng: np.random.Generator) -> Array:
    """How often each vector is in a sample of whole groups, drawn with replacement, of at least two vectors."""
    names, index = np.unique(np.array(groups), return_inverse=True)
    while True:
        times = np.bincount(rng.integers(len(names), size=len(names)), minlength=len(names))
        weights = times[index].astype(np.float64)
        if (weights > 0).sum() > 1:
            return weights
