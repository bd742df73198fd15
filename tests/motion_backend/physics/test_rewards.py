"""Eq. 7 to 13 of SIMS against values worked out by hand, and what must hold of them anywhere."""

from __future__ import annotations

from dataclasses import replace
from math import exp

import numpy as np
import pytest

from motion_backend.physics.rewards import (
    SWITCH,
    Approach,
    contact_far,
    contact_near,
    contact_reward,
    getup_reward,
    nearest_points,
    total_reward,
    walk_far,
    walk_near,
    walk_reward,
    walk_still,
)
from motion_backend.rotations import Array

AHEAD = np.array([[0.0, 0.0, 1.0]])


def approach(away: float, pace: float = 1.0, speed: float = 1.0, facing: Array = AHEAD) -> Approach:
    """A body `away` metres before its target that moves towards it at `pace`."""
    return Approach(np.zeros((1, 3)), away * AHEAD, pace * AHEAD, np.array([speed]), AHEAD, facing)


def random(count: int, seed: int = 0) -> Approach:
    rng = np.random.default_rng(seed)
    unit = rng.normal(size=(2, count, 3))
    unit /= np.linalg.norm(unit, axis=-1, keepdims=True)
    places = rng.normal(size=(3, count, 3))
    return Approach(places[0], places[1], places[2], rng.uniform(0, 2, count), unit[0], unit[1])


def test_walk_rewards_are_those_worked_out_by_hand() -> None:
    far = approach(2.0, pace=0.5, facing=np.array([[np.sin(0.5), 0.0, np.cos(0.5)]]))
    expected = 0.6 * exp(-0.5 * 4) + 0.2 * exp(-2 * 0.25) + 0.2 * np.cos(0.5) ** 2
    assert walk_far(far)[0] == pytest.approx(expected)
    assert walk_near(far)[0] == pytest.approx(exp(-40))
    assert walk_reward(far, far.velocity)[0] == pytest.approx(0.4 * exp(-40) + 0.5 * expected)
    near = approach(0.5)
    still = walk_still(near.velocity, np.array([[0.3, 0.0, 1.0]]))
    assert still[0] == pytest.approx(exp(-2 * 0.09))
    assert walk_reward(near, np.array([[0.3, 0.0, 1.0]]))[0] == pytest.approx(0.4 * exp(-2.5) + 0.5 + 0.1 * still[0])


def test_contact_rewards_are_those_worked_out_by_hand() -> None:
    joints, goals, mask = np.zeros((1, 15, 3)), np.zeros((1, 15, 3)), np.zeros(15, dtype=bool)
    goals[0, 0], goals[0, 5], goals[0, 9] = [0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [7.0, 7.0, 7.0]
    mask[[0, 5]] = True
    near = exp(-10 * (0.01 + 0.04))
    assert contact_near(joints, goals, mask)[0] == pytest.approx(near)
    far = approach(2.0, pace=0.0)
    there = 0.5 * exp(-2) + 0.4 * exp(-2) + 0.1
    assert contact_far(far)[0] == pytest.approx(there)
    assert contact_reward(far, joints, goals, mask)[0] == pytest.approx(0.6 * near + 0.4 * there)
    assert contact_reward(approach(0.2), joints, goals, mask)[0] == pytest.approx(0.6 * near + 0.4)


def test_the_switch_is_at_a_squared_distance_of_a_half() -> None:
    inside, outside = approach(np.sqrt(SWITCH) - 1e-6, pace=0.0), approach(np.sqrt(SWITCH) + 1e-6, pace=0.0)
    assert walk_reward(inside, inside.velocity)[0] - walk_reward(outside, outside.velocity)[0] > 0.1
    assert walk_reward(approach(0.6), AHEAD)[0] > 0.6, "0.6 m is nearer than the switch although 0.6 > 0.5"


def test_who_faces_backwards_is_paid_as_who_looks_ahead() -> None:
    assert walk_far(approach(2.0, facing=-AHEAD)) == pytest.approx(walk_far(approach(2.0)))
    sideways = approach(2.0, facing=np.array([[1.0, 0.0, 0.0]]))
    assert walk_far(sideways)[0] == pytest.approx(walk_far(approach(2.0))[0] - 0.2)


def test_who_drifts_evenly_counts_as_still() -> None:
    assert walk_still(AHEAD, AHEAD)[0] == 1.0
    assert walk_still(0 * AHEAD, AHEAD)[0] < 0.2


def test_rewards_lie_between_nought_and_one() -> None:
    some = random(200)
    rng = np.random.default_rng(1)
    joints, goals = rng.normal(size=(2, 200, 15, 3))
    mask = rng.random((200, 15)) < 0.3
    for told in (walk_reward(some, rng.normal(size=(200, 3))), contact_reward(some, joints, goals, mask)):
        assert told.shape == (200,)
        assert ((told >= 0) & (told <= 1)).all()
    best = replace(approach(0.0), velocity=AHEAD)
    assert walk_reward(best, AHEAD)[0] == pytest.approx(1.0)
    assert contact_reward(best, joints[:1], joints[:1], np.ones(15, dtype=bool))[0] == pytest.approx(1.0)


def test_nearer_is_never_worse() -> None:
    ways = [walk_reward(approach(away), AHEAD)[0] for away in np.linspace(0, 4, 80)]
    assert (np.diff(ways) <= 1e-12).all()
    joints, mask = np.zeros((40, 15, 3)), np.ones(15, dtype=bool)
    goals = np.zeros((40, 15, 3))
    goals[:, 3, 1] = np.linspace(0, 1, 40)
    assert (np.diff(contact_near(joints, goals, mask)) < 0).all()


def test_a_goal_that_does_not_count_changes_nothing() -> None:
    joints, goals, mask = np.zeros((1, 15, 3)), np.zeros((1, 15, 3)), np.zeros(15, dtype=bool)
    goals[0, 4] = 5.0
    assert contact_near(joints, goals, mask)[0] == 1.0


def test_the_nearest_point_of_a_part_is_no_farther_than_any_other() -> None:
    rng = np.random.default_rng(2)
    part, joints = rng.normal(size=(30, 3)), rng.normal(size=(2, 15, 3))
    found = nearest_points(part, joints)
    gaps = np.linalg.norm(joints[:, :, None] - part, axis=-1)
    np.testing.assert_allclose(np.linalg.norm(found - joints, axis=-1), gaps.min(axis=-1))


def test_getting_up_is_paid_once_the_contact_was_reached() -> None:
    told = getup_reward(np.array([False, True]), np.array([0.3, 0.3]), np.array([0.8, 0.8]))
    assert told.tolist() == [0.3, 0.8]
    assert total_reward(np.array([0.5]), np.array([0.25]), 2.0).tolist() == [1.0]
