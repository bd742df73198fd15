"""Nobody rests twice alike, nor does a thing again in the same time; what is rested on is the same place."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from acted import Body, lain, sat

from motion_backend.motion import FPS
from motion_backend.procedural.own_time import own_time

SEEDS = (1, 2, 3, 4)
SITTING = ("crossing arms", "hands behind head, legs straight", "leaning forward, elbows on knees")
LYING = ("lying still", "hands on belly", "curled up on the left side, knees drawn up")


@pytest.mark.parametrize(("rest", "place", "caption"), [
    *((sat, "sofa", caption) for caption in SITTING), *((lain, "bed", caption) for caption in LYING),
])  # fmt: skip
def test_two_who_rest_on_one_place_are_three_centimetres_apart_and_their_pelvises_are_not(
    rest: Callable[..., Body], place: str, caption: str
) -> None:
    bodies = [rest(place, caption, seed=seed).kinematics.positions[-FPS:].mean(axis=0) for seed in SEEDS]
    apart = np.array([np.linalg.norm(one - other, axis=1) for one, other in combinations(bodies, 2)])
    assert np.median(apart.mean(axis=1)) > 0.03
    assert apart[:, 0].max() < 0.02


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_done_again_and_again_is_now_slower_and_now_quicker_and_takes_as_long_on_the_whole(seed: int) -> None:
    clock = np.arange(1, 8 * FPS + 1) / FPS
    time = own_time(clock, np.random.default_rng(seed))
    assert (np.diff(time) > 0).all()
    assert time[-1] == clock[-1]
    pace = np.diff(time) * FPS
    assert 0.6 < pace.min() < pace.max() < 1.4
    assert np.ptp(pace) > 0.05


def test_the_time_of_one_is_not_that_of_another() -> None:
    clock = np.arange(1, 8 * FPS + 1) / FPS
    one, other = (own_time(clock, np.random.default_rng(seed)) for seed in SEEDS[:2])
    assert np.abs(one - other).max() > 0.03


def test_on_the_whole_it_is_quicker_in_the_end() -> None:
    clock = np.arange(1, 8 * FPS + 1) / FPS
    half = len(clock) // 2
    assert np.mean([own_time(clock, np.random.default_rng(seed))[half] for seed in range(40)]) < clock[half] - 0.05
