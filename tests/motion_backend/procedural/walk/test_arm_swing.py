"""Arms of a walking body: those that are spread keep out of narrow places."""

from __future__ import annotations

import numpy as np
from for_each import for_each

from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.arm_swing import arms_in
from motion_backend.procedural.walk.walk_skill import NARROW_ARMS
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()


def stood(arms: str, frames: int = 60) -> Pose:
    return standing((0.0, 0.0), 0.0, Bearing(arms=(arms, arms)), SKELETON).repeat(frames)


def test_open_arms_stay_open_where_there_is_room() -> None:
    pose = stood("open")
    np.testing.assert_allclose(arms_in(pose, np.full(60, 2.0), "embracing", 0.8).arms, pose.arms, atol=1e-9)


def test_open_arms_open_to_the_front_where_it_is_narrow_and_hanging_arms_hang_on() -> None:
    narrow = np.full(60, 0.3)
    embracing, _ = arm_arrays("embracing", "embracing")
    np.testing.assert_allclose(arms_in(stood("open"), narrow, "embracing", 0.8).arms[-1], embracing, atol=1e-6)
    hanging = stood("hang")
    np.testing.assert_allclose(arms_in(hanging, narrow, "embracing", 0.8).arms, hanging.arms, atol=1e-9)


@for_each(("arms", "needed"), [(arms, needed) for arms, (_, needed) in NARROW_ARMS.items()])
def test_arms_that_stick_out_come_in_only_where_they_would_meet_something(arms: str, needed: float) -> None:
    pose = stood(arms)
    root, local = solve(pose, SKELETON)
    chest = SKELETON.forward_kinematics(root, local)[0][0, [INDEX["left_elbow"], INDEX["left_wrist"]]][:, [0, 2]]
    assert np.linalg.norm(chest, axis=1).max() < needed
    assert (arms_in(pose, np.full(60, needed), "hang", needed).arms == pose.arms).all()
    came_in = arms_in(pose, np.full(60, 0.55 * needed), "hang", needed)
    np.testing.assert_allclose(came_in.arms[-1], stood("hang").arms[-1], atol=1e-6)
    np.testing.assert_allclose(came_in.elbows[-1], stood("hang").elbows[-1], atol=1e-6)


def test_a_segment_begins_in_the_pose_it_was_given() -> None:
    pose = stood("open")
    np.testing.assert_allclose(arms_in(pose, np.full(60, 0.3), "embracing", 0.8).arms[0], pose.arms[0], atol=1e-9)
