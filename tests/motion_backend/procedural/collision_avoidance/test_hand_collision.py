"""Arms and hands keep out of what is solid, and spread arms out of narrow places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from for_each import for_each

from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.collision_avoidance.hand_collision import THICKNESS, _way_out, arms_in, hands_clear
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.walk_skill import NARROW_ARMS
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()


def stood(arms: str, frames: int = 60) -> Pose:
    return standing((0.0, 0.0), 0.0, Bearing(arms=(arms, arms)), SKELETON).repeat(frames)


def wrists(pose: Pose) -> np.ndarray:
    root, local = solve(pose, SKELETON)
    positions = SKELETON.forward_kinematics(root, local)[0].astype(np.float64)
    return positions[:, [INDEX["left_wrist"], INDEX["right_wrist"]]]


@for_each(
    ("hand", "out"),
    [((0.45, 1.0, 0.0), (1.0, 0.0, 0.0)), ((0.0, 1.0, 0.27), (0.0, 0.0, 1.0)), ((0.45, 1.97, 0.0), (0.0, 1.0, 0.0))],
)
def test_a_hand_in_a_box_goes_out_by_the_nearest_of_the_sides_it_came_from_or_over_its_top(
    hand: tuple[float, float, float], out: tuple[float, float, float]
) -> None:
    box = Obstacles(
        np.array([[0.0, 1.0, 0.0]]), np.array([[0.5, 1.0, 0.3]]), np.zeros(1), ("0/box",), np.zeros(1, bool)
    )
    (way,) = _way_out(np.array([[hand]]), np.array([[1.0, 1.4, 1.0]]), box)
    inside = np.dot(box.halves[0] + box.centers[0] * [0, 1, 0] - hand, out)
    np.testing.assert_allclose(way, (inside + THICKNESS) * np.array(out), atol=1e-9)
    away = np.array([[[hand[0] + 3.0, hand[1], hand[2]]]])
    assert not _way_out(away, np.array([[4.0, 1.4, 1.0]]), box).any()


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


def test_a_hand_stretched_through_a_wall_comes_back_to_its_own_side() -> None:
    pose = stood("open")
    reach = wrists(pose)[0, 0, 0]
    wall = Obstacles(
        np.array([[reach - 0.05, 1.3, 0.0]]),
        np.array([[0.05, 1.3, 2.0]]),
        np.zeros(1),
        ("wall",),
        np.zeros(1, dtype=bool),
    )
    cleared = wrists(hands_clear(pose, SKELETON, wall))[20:-5]
    assert cleared[:, 0, 0].max() < reach - 0.10
    np.testing.assert_allclose(cleared[:, 1], wrists(pose)[20:-5, 1], atol=1e-6)


def test_the_touching_hand_is_left_where_it_is_laid() -> None:
    pose = stood("open")
    laid = replace(pose, pressing=np.ones((60, 2)))
    wall = Obstacles(
        np.array([[0.6, 1.3, 0.0]]), np.array([[0.1, 1.3, 2.0]]), np.zeros(1), ("wall",), np.zeros(1, dtype=bool)
    )
    touching = hands_clear(laid, SKELETON, wall, touching="left")
    np.testing.assert_allclose(wrists(touching)[:, 0], wrists(laid)[:, 0], atol=1e-6)
