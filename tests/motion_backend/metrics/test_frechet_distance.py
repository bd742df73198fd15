"""The Fréchet distance of Gaussians against its closed form, and APD against its definition."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend.metrics.frechet_distance import MIN_SAMPLES, average_pairwise_distance, frechet_distance


def drawn(mean: float, spread: float, count: int = 4000, seed: int = 0) -> np.ndarray:
    rows = np.random.default_rng(seed).normal(size=(count, 3))
    rows -= rows.mean(axis=0)
    rows @= np.linalg.inv(np.linalg.cholesky(np.cov(rows, rowvar=False)).T)  # its covariance is exactly the identity
    return rows * spread + mean


def test_gaussians_on_one_axis_system_have_the_distance_of_the_closed_form() -> None:
    told = frechet_distance(drawn(0.0, 1.0), drawn(2.0, 3.0, seed=1))
    assert told == pytest.approx(3 * 2.0**2 + 3 * (1.0 - 3.0) ** 2, rel=1e-6)


def test_a_set_is_at_no_distance_from_itself_and_both_ways_are_alike() -> None:
    some, others = drawn(0.0, 1.0) @ np.diag([1.0, 2.0, 0.0]), drawn(1.0, 0.5, seed=2)
    assert frechet_distance(some, some) == pytest.approx(0.0, abs=1e-6)
    assert frechet_distance(some, others) == pytest.approx(frechet_distance(others, some))


def test_few_samples_are_refused() -> None:
    with pytest.raises(ValueError, match=f"made: a Fréchet distance needs {MIN_SAMPLES}"):
        frechet_distance(drawn(0, 1, 100), drawn(0, 1))
    with pytest.raises(ValueError, match="reference"):
        frechet_distance(drawn(0, 1), np.full((1000, 3), np.nan))


def test_apd_is_the_mean_over_pairs() -> None:
    assert average_pairwise_distance(np.array([[0.0, 0.0], [3.0, 4.0], [0.0, 0.0]])) == pytest.approx(10 / 3)
    with pytest.raises(ValueError, match="two samples"):
        average_pairwise_distance(np.zeros((1, 2)))
