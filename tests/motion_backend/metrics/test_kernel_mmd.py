"""The kernel distance between sets of features: 0 between equals on average, larger the farther they are apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.metrics.kernel_mmd import WIDTHS, Scale, discrepancy, distances, floor, kernel, mmd_squared

SEEDS = st.integers(0, 2**32 - 1)


def of(first: np.ndarray, second: np.ndarray, median: float = 1.0) -> float:
    pairs = ((first, first), (second, second), (first, second))
    within, without, between = (kernel(distances(a, b), median) for a, b in pairs)
    return mmd_squared(within, without, between)


def test_two_points_against_two_others_is_as_worked_out_by_hand() -> None:
    near = np.mean([np.exp(-1 / (2 * width**2)) for width in WIDTHS])
    ones, zeros = np.ones((2, 1)), np.zeros((2, 1))
    assert of(zeros, ones) == pytest.approx(2 - 2 * near)
    # Within either set one pair, at 1; across four pairs, two at 0 and two at 1: 2e - (1 + e).
    both = np.array([[0.0], [1.0]])
    assert of(both, both) == pytest.approx(near - 1)


def test_equal_distributions_are_apart_by_nothing_on_average() -> None:
    rng = np.random.default_rng(0)
    found = [of(rng.standard_normal((12, 3)), rng.standard_normal((9, 3)), 2.0) for _ in range(600)]
    assert abs(np.mean(found)) < 4 * np.std(found) / np.sqrt(len(found))


@given(SEEDS)
def test_it_grows_with_the_shift(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = rng.standard_normal((30, 4)), rng.standard_normal((30, 4))
    found = [of(first, second + shift, 2.8) for shift in (0.0, 1.5, 3.0, 6.0)]
    assert found == sorted(found)
    assert found[-1] <= 2.0


@given(SEEDS)
def test_the_order_of_either_set_and_which_comes_first_do_not_matter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = rng.standard_normal((7, 3)), rng.standard_normal((5, 3))
    assert of(rng.permutation(first), rng.permutation(second)) == pytest.approx(of(first, second))
    assert of(second, first) == pytest.approx(of(first, second))


@given(SEEDS, st.lists(st.integers(0, 3), min_size=6, max_size=6).filter(lambda times: sum(map(bool, times)) > 1))
def test_weights_are_how_often_a_vector_was_drawn(seed: int, times: list[int]) -> None:
    """A vector drawn twice is no pair with itself: only pairs of different ones are counted, each as often as drawn."""
    rng = np.random.default_rng(seed)
    first, second = rng.standard_normal((6, 2)), rng.standard_normal((4, 2))
    kernels = [kernel(distances(a, b), 1.0) for a, b in ((first, first), (second, second), (first, second))]
    found = mmd_squared(kernels[0], kernels[1], kernels[2], (np.array(times, dtype=np.float64), np.ones(4)))
    drawn = np.repeat(np.arange(6), times)
    pairs = [kernels[0][a, b] for a in drawn for b in drawn if a != b]
    wanted = np.mean(pairs) + (kernels[1].sum() - 4) / 12 - 2 * kernels[2][drawn].mean()
    assert found == pytest.approx(wanted)


def test_features_in_other_units_are_as_far_apart() -> None:
    rng = np.random.default_rng(1)
    first, second = rng.standard_normal((20, 3)), rng.standard_normal((20, 3)) + 1
    people, groups = [f"p{k // 5}" for k in range(20)], [f"s{k // 4}" for k in range(20)]
    found = discrepancy(first, people, second, groups)
    units, shift = np.array([100.0, 0.01, 57.3]), np.array([5.0, -3.0, 0.0])
    again = discrepancy(first * units + shift, people, second * units + shift, groups)
    assert again.value == pytest.approx(found.value)
    assert found.low <= found.value <= found.high
    assert discrepancy(first, people, second, groups) == found


def test_people_who_differ_raise_the_floor() -> None:
    rng = np.random.default_rng(2)
    alike = rng.standard_normal((40, 3))
    people = [f"p{k // 4}" for k in range(40)]
    differing = alike + 3 * np.repeat(rng.standard_normal((10, 3)), 4, axis=0)
    assert abs(floor(alike, people).value) < 0.1
    assert floor(differing, people).value > floor(alike, people).value


def test_a_feature_that_never_changes_is_no_fault() -> None:
    same = np.stack([np.arange(6.0), np.full(6, 3.0)], axis=1)
    scale = Scale.of(same)
    assert scale.deviation[1] == 1.0
    assert np.isfinite(scale.standard(same)).all()
