"""A body is in balance where its soles are under it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_motions import standing_still

from motion_backend import rotations
from motion_backend.metrics.balance_figures import outside_soles, rising_frames, upright_frames
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Phase, PhaseKind


def leaning(degrees: float) -> Motion:
    """A T-pose that leans to its left about its ankles, so that its soles stay where they are."""
    motion = standing_still()
    tilt = rotations.axis_to_quat("z", np.array(-np.radians(degrees)))
    local = motion.local_rotations.astype(np.float64)
    local[:, 0] = tilt
    for ankle in (7, 8):
        local[:, ankle] = rotations.inverse(tilt)
    return replace(motion, local_rotations=local.astype(np.float32))


def test_who_stands_on_both_feet_is_in_balance_and_who_leans_far_is_not() -> None:
    assert outside_soles(Kinematics.of(leaning(0))).max() == 0
    small, far = (outside_soles(Kinematics.of(leaning(degrees)))[30] for degrees in (15, 25))
    assert 0 < small < far < 0.5


def test_a_foot_that_is_in_the_air_carries_nothing() -> None:
    motion = standing_still()
    right = np.tile(np.array([0, 0, 1, 1], np.float32), (len(motion), 1))
    alone = outside_soles(Kinematics.of(replace(motion, contacts=right)))
    # The middle of the body is as far from the right foot as the hip is, less at most half the width of a sole.
    assert 0.088 - 0.04 < alone.min() <= alone.max() < 0.088
    assert np.isnan(outside_soles(Kinematics.of(replace(motion, contacts=0 * right)))).all()


def test_a_seat_that_is_not_left_carries_and_what_comes_after_is_rising() -> None:
    height = np.concatenate([np.full(20, -0.4), np.linspace(-0.4, 0, 20), np.zeros(20)])
    motion = standing_still(root=np.outer(height, [0.0, 1.0, 0.0]))
    phases = (Phase(PhaseKind.SITDOWN, 0, 10), Phase(PhaseKind.STANDUP, 10, 45), Phase(PhaseKind.WALK, 45, 60))
    body = Kinematics.of(replace(motion, phases=phases))
    rising, upright = np.flatnonzero(rising_frames(body)), np.flatnonzero(upright_frames(body))
    assert rising[0] in range(20, 23)
    assert rising[-1] in range(30, 34)
    assert upright.tolist() == list(range(45, 60))
