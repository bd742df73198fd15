"""The last pass over arms: out of what is solid and of the own body, none too fast, and what is clear is left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.joint_limits import limits_share
from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.self_collision import self_penetration
from motion_backend.motion import FPS, Action, Emotion, Posture, Skill
from motion_backend.procedural.arm_clearance import FASTEST, STRETCHED, Around, _within_reach, arms_clear
from motion_backend.procedural.arm_collision import _Box, _out_of_box
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose, concatenate, interpolate
from motion_backend.procedural.pose_solver import chest_frame, solve
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.evaluation.trials import Trial, act_trial

SKELETON = build_skeleton()
ARMS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist")]
NOTHING = Obstacles(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=bool))
STAND = Part(PartKind.HOLD, Action(Skill.LOCO, "stand still", Emotion.NEUTRAL))


def stood(arms: str, frames: int) -> Pose:
    return standing((0.0, 0.0), 0.0, Bearing(arms=(arms, arms)), SKELETON).repeat(frames)


def cleared(pose: Pose, start: Pose, things: Obstacles = NOTHING, part: Part = STAND) -> Pose:
    return arms_clear(pose, start, Around(part, Posture.STANDING, None, things), SKELETON)


def wall(near: float) -> Obstacles:
    """A thin wall on the left whose face is at x = near."""
    return Obstacles(
        np.array([[near + 0.05, 1.3, 0.0]]), np.array([[0.05, 1.3, 2.0]]), np.zeros(1), ("wall",), np.zeros(1, bool)
    )


def joint(pose: Pose, name: str) -> np.ndarray:
    """Where it is. (T, 3)."""
    return SKELETON.forward_kinematics(*solve(pose, SKELETON))[0].astype(np.float64)[:, INDEX[name]]


def deepest(pose: Pose) -> float:
    """How deep parts of the body are in each other (metres)."""
    positions, world = SKELETON.forward_kinematics(*solve(pose, SKELETON))
    return float(self_penetration(SKELETON, positions.astype(np.float64), world).max())


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
        np.testing.assert_allclose(slowed.arms[-1], pose.arms[-1], atol=0.05)


def test_arms_that_are_slow_and_clear_are_left_alone() -> None:
    pose = stood("hips", 40)
    kept = cleared(pose, pose.at(0), wall(joint(pose, "left_elbow")[0, 0] + 0.06))
    np.testing.assert_array_equal(kept.arms, pose.arms)
    np.testing.assert_array_equal(kept.elbows, pose.elbows)


@for_each("into", [0.02, 0.05, 0.08])
def test_an_elbow_in_a_wall_swings_out_and_the_hand_nearly_stays(into: float) -> None:
    pose = stood("hips", 60)
    beside = wall(joint(pose, "left_elbow")[0, 0] + 0.042 - into)
    swung = cleared(pose, pose.at(0), beside)
    assert beside.depth(joint(pose, "left_elbow")[-1:])[0] > -0.04
    assert beside.depth(joint(swung, "left_elbow")[30:]).max() < -0.036
    assert np.linalg.norm(joint(swung, "left_wrist") - joint(pose, "left_wrist"), axis=1).max() < 0.7 * into + 0.005
    np.testing.assert_allclose(joint(swung, "left_elbow")[0], joint(pose, "left_elbow")[0], atol=0.04)
    np.testing.assert_allclose(joint(swung, "right_elbow"), joint(pose, "right_elbow"), atol=1e-6)


def test_who_drifts_towards_a_wall_goes_round_it_where_the_arm_would_be_in_it() -> None:
    pose = stood("hips", 60)
    way = np.linspace(0.0, 0.12, len(pose))[:, None] * [1.0, 0.0, 0.0]
    drifting = replace(pose, pelvis=pose.pelvis + way, ankles=pose.ankles + way[:, None])
    beside = wall(joint(drifting, "left_elbow")[-1, 0] - 0.02)
    before, after = (
        beside.depth(joint(one, "left_elbow")) for one in (drifting, cleared(drifting, pose.at(0), beside))
    )
    assert before.max() == pytest.approx(0.02, abs=0.005)
    assert after.max() < -0.036


def test_a_hand_stretched_through_a_wall_comes_back_to_its_own_side() -> None:
    pose = stood("open", 60)
    reach = joint(pose, "left_wrist")[0, 0]
    out = cleared(pose, pose.at(0), wall(reach - 0.10))
    assert joint(out, "left_wrist")[20:, 0].max() < reach - 0.10
    np.testing.assert_allclose(joint(out, "right_wrist"), joint(pose, "right_wrist"), atol=1e-6)


@for_each("arms", ["hang", "hips", "open"])
def test_no_detour_stretches_an_arm_until_its_elbow_snaps_straight(arms: str) -> None:
    pose = stood(arms, 60)
    arm = Arm.of(pose, SKELETON, 0, chest_frame(pose, SKELETON))
    aside = np.linspace(0.0, 0.3, 60)[:, None] * rotations.normalize(arm.way)
    way, most = arm.way + _within_reach(arm, aside), STRETCHED * sum(arm.lengths)
    assert np.linalg.norm(way, axis=1).max() == pytest.approx(max(most, float(np.linalg.norm(arm.way[0]))))
    short = np.linalg.norm(arm.way + aside, axis=1) <= most
    assert short.any() or arms == "open"
    np.testing.assert_allclose(way[short], (arm.way + aside)[short])


def test_the_touching_hand_is_left_where_it_is_laid() -> None:
    pose = stood("open", 60)
    wrists = np.stack([joint(pose, "left_wrist"), joint(pose, "right_wrist")], axis=1)
    laid = replace(pose, reach=wrists, reaching=np.ones((60, 2)), pressing=np.ones((60, 2)))
    touch = Part(PartKind.REACH, Action(Skill.TOUCH, "touch", Emotion.NEUTRAL, hand="left"))
    out = cleared(laid, laid.at(0), wall(wrists[0, 0, 0] - 0.03), touch)
    np.testing.assert_allclose(joint(out, "left_wrist"), joint(laid, "left_wrist"), atol=2e-3)


@for_each(
    ("hand", "out"),
    [((0.45, 1.0, 0.0), (1.0, 0.0, 0.0)), ((0.0, 1.0, 0.27), (0.0, 0.0, 1.0)), ((0.45, 1.97, 0.0), (0.0, 1.0, 0.0))],
)
def test_a_hand_in_a_box_goes_out_by_the_nearest_of_the_sides_it_came_from_or_over_its_top(
    hand: tuple[float, float, float], out: tuple[float, float, float]
) -> None:
    box = _Box(np.array([0.0, 1.0, 0.0]), np.array([0.5, 1.0, 0.3]), 0.0)
    thick, upwards = np.array([[0.03]]), np.array([[0.1]])
    (way,) = _out_of_box(np.array([hand]), np.array([[1.0, 1.4, 1.0]]), thick, upwards, box)
    inside = np.dot(box.half + box.center * [0, 1, 0] - hand, out)
    np.testing.assert_allclose(way, (inside + 0.03) * np.array(out), atol=1e-9)
    away = np.array([[hand[0] + 3.0, hand[1], hand[2]]])
    assert not _out_of_box(away, np.array([[4.0, 1.4, 1.0]]), thick, upwards, box).any()


def test_a_hand_on_its_way_through_a_thigh_goes_round_it() -> None:
    still = stood("hang", 1).at(0)
    inside = replace(still, reach=still.pelvis - [[0.088, 0.25, 0.0], [-0.088, 0.25, 0.0]], reaching=np.ones(2))
    through = interpolate([0.0, 0.8, 1.6], [still, inside, still], FPS)
    round_it = cleared(through, still)
    assert deepest(round_it) < 0.06 < 0.10 < deepest(through)
    np.testing.assert_allclose(round_it.arms[-1], through.arms[-1], atol=0.08)


def test_an_elbow_deep_in_the_trunk_and_forearms_in_each_other_come_out() -> None:
    start = stood("hang", 1).at(0)
    deep = replace(start, arms=np.array([[-0.35, -0.45, 0.12], [0.35, -0.45, 0.12]]), elbows=-start.elbows)
    pose = interpolate([0.0, 1.0, 2.0], [start, deep, deep], FPS)
    assert deepest(cleared(pose, start)) < 0.07 < 0.10 < deepest(pose)


def test_a_hand_that_lies_on_something_stays_there_while_its_elbow_is_slowed() -> None:
    pose = stood("bent", 60)
    place = solve(pose, SKELETON)
    wrists = SKELETON.forward_kinematics(*place)[0].astype(np.float64)[:, [INDEX["left_wrist"], INDEX["right_wrist"]]]
    elbows = pose.elbows.copy()
    elbows[30:] *= -1.0
    laid = replace(pose, reach=wrists, reaching=np.ones((60, 2)), pressing=np.ones((60, 2)), elbows=elbows)
    touch = Part(PartKind.REACH, Action(Skill.TOUCH, "wash with both hands", Emotion.NEUTRAL))
    slowed = cleared(laid, laid.at(0), part=touch)
    assert fastest(laid.at(0), laid) > FASTEST
    assert fastest(laid.at(0), slowed) < 20.0
    after = SKELETON.forward_kinematics(*solve(slowed, SKELETON))[0].astype(np.float64)
    np.testing.assert_allclose(after[:, [INDEX["left_wrist"], INDEX["right_wrist"]]], wrists, atol=2e-3)


def test_a_detour_that_leads_deeper_is_taken_back() -> None:
    """Round a bookshelf that is reached up into, full steps turned this shoulder 70 degrees out of its range."""
    _, _, motions = act_trial(Trial(Skill.TOUCH, "An act of reaching high", "study-0088", 1))
    assert limits_share(motions[-1].local_rotations) == 0.0
