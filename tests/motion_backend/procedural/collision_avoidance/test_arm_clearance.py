"""The last pass over arms: what is too fast is slowed, the seam included, and what is not is left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from for_each import for_each

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS, Action, Emotion, Posture, Skill
from motion_backend.procedural.collision_avoidance.arm_clearance import FASTEST, Around, arms_clear
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.procedural.pose_solver import solve
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()
ARMS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist")]
NOTHING = Obstacles(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=bool))
STAND = Part(PartKind.HOLD, Action(Skill.LOCO, "stand still", Emotion.NEUTRAL))


def stood(arms: str, frames: int) -> Pose:
    return standing((0.0, 0.0), 0.0, Bearing(arms=(arms, arms)), SKELETON).repeat(frames)


def cleared(pose: Pose, start: Pose) -> Pose:
    return arms_clear(pose, start, Around(STAND, Posture.STANDING, None, NOTHING), SKELETON)


def fastest(start: Pose, pose: Pose) -> float:
    """Of the joints of arms, from the pose before on (radians a second)."""
    _, local = solve(concatenate([start.repeat(1), pose]), SKELETON)
    turns = rotations.compose(rotations.inverse(local[:-1, ARMS]), local[1:, ARMS])
    return float(np.linalg.norm(rotations.quat_to_rotvec(turns), axis=-1).max() * FPS)


JUMPS = [("hang", "open"), ("hips", "behind_head"), ("crossed", "open"), ("behind_back", "hang")]


@for_each(("before", "after"), JUMPS)
def test_arms_that_jump_in_the_middle_or_at_the_seam_are_no_longer_too_fast(before: str, after: str) -> None:
    start = stood(before, 1).at(0)
    for pose in (concatenate([stood(before, 30), stood(after, 30)]), stood(after, 60)):
        assert fastest(start, pose) > FASTEST
        slowed = cleared(pose, start)
        assert fastest(start, slowed) < 20.0
        np.testing.assert_allclose(slowed.arms[-1], pose.arms[-1], atol=1e-6)


def test_arms_that_are_slow_are_left_alone() -> None:
    pose = stood("crossed", 40)
    np.testing.assert_array_equal(cleared(pose, pose.at(0)).arms, pose.arms)


def test_a_hand_that_lies_on_something_stays_there_while_its_elbow_is_slowed() -> None:
    pose = stood("bent", 60)
    place = solve(pose, SKELETON)
    wrists = SKELETON.forward_kinematics(*place)[0].astype(np.float64)[:, [INDEX["left_wrist"], INDEX["right_wrist"]]]
    elbows = pose.elbows.copy()
    elbows[30:] *= -1.0
    laid = replace(pose, reach=wrists, reaching=np.ones((60, 2)), pressing=np.ones((60, 2)), elbows=elbows)
    slowed = cleared(laid, laid.at(0))
    assert fastest(laid.at(0), laid) > FASTEST
    assert fastest(laid.at(0), slowed) < 20.0
    after = SKELETON.forward_kinematics(*solve(slowed, SKELETON))[0].astype(np.float64)
    np.testing.assert_allclose(after[:, [INDEX["left_wrist"], INDEX["right_wrist"]]], wrists, atol=2e-3)
