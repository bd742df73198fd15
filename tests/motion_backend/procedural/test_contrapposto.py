"""Who stands for a while has the weight on one leg and then on the other, and sets the free foot anew."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.contrapposto import contrapposto, contrapposto_table
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton(1.70)
LEFT, RIGHT = 0, 1


def stood(
    seconds: float = 20.0, seed: int = 0, restless: float = 1.0, goes_on: bool = False, steps: bool = True
) -> Pose:
    """Standing at the origin, facing +Z: left is +X."""
    held = standing((0.0, 0.0), 0.0, Bearing(), SKELETON).repeat(round(seconds * FPS))
    return contrapposto(held, SKELETON, restless, np.random.default_rng(seed), goes_on=goes_on, steps=steps)


def test_the_weight_goes_over_either_leg_and_the_pelvis_tips_up_on_that_side() -> None:
    pose, row = stood(steps=False), contrapposto_table()
    aside = pose.pelvis[:, 0]
    assert aside.max() > 0.7 * row.aside_m
    assert aside.min() < -0.7 * row.aside_m
    assert np.corrcoef(aside, pose.hips[:, 2])[0, 1] > 0.99
    assert np.corrcoef(aside, pose.spine[:, 2])[0, 1] < -0.99, "shoulders tip against it"
    assert pose.pelvis[:, 1].max() <= stood(0.1).pelvis[0, 1] + 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_a_foot_that_stands_does_not_move_and_one_that_steps_is_not_the_one_that_carries(seed: int) -> None:
    pose = stood(seed=seed)
    between = (pose.planted[1:] > 0) & (pose.planted[:-1] > 0)
    # The heel of a standing foot may come up; its ball stays.
    ball = pose.ankles + rotations.rotate(pose.feet, SKELETON.offsets[INDEX["left_foot"]])
    assert np.abs(np.diff(ball, axis=0))[between].max() < 2e-3
    for foot, carries in ((LEFT, -1.0), (RIGHT, 1.0)):
        lifted = pose.planted[:, foot] == 0
        assert (carries * pose.pelvis[lifted, 0] > 0).all()
    assert pose.planted.max(axis=1).all(), "nobody hops"


def test_feet_are_set_down_near_where_they_stood_and_stay_where_they_were_without_room_to_step() -> None:
    row, walked = contrapposto_table().step, False
    for seed in range(6):
        pose = stood(seed=seed)
        off = np.linalg.norm((pose.ankles[-1] - pose.ankles[0])[:, [0, 2]], axis=1)
        assert off.max() <= np.hypot(row.ahead_m, row.outwards_m) + 1e-6
        walked |= bool(off.max() > 0.01)
        assert (stood(seed=seed, steps=False).ankles == pose.ankles[0]).all()
    assert walked


def test_it_begins_as_it_was_and_ends_on_both_legs_unless_it_goes_on_standing() -> None:
    pose, goes_on = stood(steps=False), stood(steps=False, goes_on=True)
    for name in ("pelvis", "hips", "spine"):
        first = getattr(stood(0.1), name)[0]
        assert getattr(pose, name)[0] == pytest.approx(first, abs=2e-3)
        assert getattr(pose, name)[-1] == pytest.approx(first, abs=1e-9)
    assert abs(goes_on.pelvis[-1, 0]) > 0.5 * contrapposto_table().aside_m


def test_the_restless_shift_their_weight_more_often_and_the_same_seed_does_the_same() -> None:
    turns = [(np.diff(np.sign(stood(60.0, restless=size, steps=False).pelvis[:, 0])) != 0).sum() for size in (0.5, 1.5)]
    assert turns[0] < turns[1]
    assert (stood().ankles == stood().ankles).all()
    assert (stood(seed=1).pelvis != stood().pelvis).any()
