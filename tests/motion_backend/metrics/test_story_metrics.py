"""Every figure is checked on motions whose answer is known beforehand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from for_each import for_each
from sample_motions import standing_still

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics import contact_error, foot_skate, smoothness, story_metrics
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.motion import Action, ContactGoal, Emotion, Skill
from motion_backend.skeleton import INDEX, build_skeleton
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Opening

SKELETON = build_skeleton()
NOTHING = Obstacles(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=bool))


def box(center: tuple[float, float, float], size: tuple[float, float, float], owner: str = "0/box") -> Obstacles:
    return Obstacles(np.array([center]), np.array([size]) / 2, np.zeros(1), (owner,), np.zeros(1, dtype=bool))


def touch(**changes: Any) -> Action:
    return replace(Action(Skill.TOUCH, "touch", Emotion.NEUTRAL), **changes)


def test_a_body_that_stands_still_neither_skates_nor_jerks_nor_sinks() -> None:
    motion = standing_still()
    body = Kinematics.of(motion)
    assert foot_skate.skate_ratio(body) == 0
    assert foot_skate.skate_speed(body) == pytest.approx(0, abs=1e-4)
    assert smoothness.jerk(body.positions, 30) == pytest.approx(0, abs=1e-3)
    assert body.soles[..., 1].min() == pytest.approx(0, abs=1e-6)


def test_a_body_that_glides_skates_all_the_time_at_its_own_speed() -> None:
    root = np.outer(np.arange(60) / 30, [1.2, 0.0, 0.0])
    motion = standing_still(root=root)
    body = Kinematics.of(motion)
    assert foot_skate.skate_ratio(body) == 1.0
    assert foot_skate.skate_speed(body) == pytest.approx(120, rel=1e-3)


def test_slow_creeping_is_skate_speed_but_not_gmd_skating() -> None:
    motion = standing_still(root=np.outer(np.arange(60) / 30, [0.3, 0.0, 0.0]))
    body = Kinematics.of(motion)
    assert foot_skate.skate_ratio(body) == 0.0
    assert foot_skate.skate_speed(body) == pytest.approx(30, rel=1e-3)


def test_the_best_supported_point_slips_as_fast_as_the_body_glides_and_not_when_one_foot_stands() -> None:
    gliding = Kinematics.of(standing_still(root=np.outer(np.arange(60) / 30, [0.3, 0.0, 0.0])))
    assert foot_skate.support_slip(gliding) == pytest.approx(30, rel=1e-3)
    carrying, lying = (
        replace(gliding, motion=replace(gliding.motion, contacts=np.full_like(gliding.motion.contacts, felt)))
        for felt in (1.0, 0.0)
    )
    assert foot_skate.carried_slip(carrying) == foot_skate.support_slip(gliding)
    assert foot_skate.carried_slip(lying) == 0.0
    stepping = standing_still()
    turns = stepping.local_rotations.astype(np.float64)
    turns[:, INDEX["left_hip"]] = rotations.axis_to_quat("x", 0.3 * np.sin(np.arange(60) / 3))
    stepping = replace(stepping, local_rotations=turns.astype(np.float32))
    assert foot_skate.support_slip(Kinematics.of(stepping)) == pytest.approx(0, abs=1e-3)
    flying = np.outer(np.arange(60) / 30, [0.3, 0.0, 0.0])
    flying[:, 1] = 0.2
    assert foot_skate.support_slip(Kinematics.of(standing_still(root=flying))) == 0.0


def test_a_body_in_the_air_does_not_skate() -> None:
    root = np.outer(np.arange(60) / 30, [1.2, 0.0, 0.0])
    root[:, 1] = 0.2
    motion = standing_still(root=root)
    assert foot_skate.skate_ratio(Kinematics.of(motion)) == 0.0


def test_jerk_of_a_cubic_is_its_third_derivative() -> None:
    time = np.arange(90) / 30
    positions = np.zeros((90, 2, 3))
    positions[:, 0, 0] = positions[:, 1, 2] = 5 * time**3
    assert smoothness.jerk(positions, 30) == pytest.approx(30.0, rel=1e-6)


@pytest.mark.parametrize(("depth", "seen"), [(0.03, 0.03), (-0.01, 0.0)])
def test_penetration_is_the_depth_of_the_deepest_skin_point(depth: float, seen: float) -> None:
    motion = standing_still(10)
    body = Kinematics.of(motion)
    head = body.positions[0, INDEX["head"]]
    # A ceiling comes down on the head: its crown is at the capsule's end plus its radius at 45 degrees.
    crown = head[1] + 0.09 + 0.09 * np.sqrt(0.5)
    ceiling = box((0.0, crown - depth + 0.5, 0.0), (4.0, 1.0, 4.0))
    found = penetration(body, ceiling, None)
    np.testing.assert_allclose(found, seen, atol=2e-3)


def test_only_contact_bodies_may_sink_and_only_into_their_own_target() -> None:
    motion = standing_still(5)
    body = Kinematics.of(motion)
    hips = body.positions[0, 0]
    seat = box((0.0, hips[1] - 0.09 + 0.03 - 0.5, -0.3), (0.5, 1.0, 0.6), owner="0/chair")
    sit = Action(Skill.SITDOWN, "sit", Emotion.NEUTRAL, object_id="0/chair")
    free = penetration(body, seat, None)
    own = penetration(body, seat, sit)
    other = penetration(body, seat, replace(sit, object_id="0/table"))
    assert free.max() > 0.05
    np.testing.assert_allclose(other, free)
    np.testing.assert_allclose(own, np.maximum(free - 0.05, 0), atol=0.03)
    assert own.max() < free.max()


def test_success_must_be_sustained_for_a_second_unless_any_frame_counts() -> None:
    motion = standing_still(90)
    x, y, z = motion.joint_positions()[0, INDEX["right_wrist"]].tolist()
    goal = ContactGoal("right_wrist", (x, y, z))
    sliding = standing_still(root=np.outer(np.concatenate([np.zeros(20), np.arange(1, 71) / 30]), [1.0, 0.0, 0.0]))
    for moved, sustained in ((motion, True), (sliding, False)):
        trial = replace(moved, goals=(goal,))
        found = contact_error.outcome(touch(), Kinematics.of(trial))
        assert (found.reached, found.reached_any) == (sustained, True)
        assert found.error == pytest.approx(0, abs=1e-5)
        assert found.seconds == 0


@pytest.mark.parametrize(("away", "reached", "strict"), [(0.05, True, True), (0.15, True, False), (0.25, False, False)])
def test_strict_success_asks_for_ten_centimetres(away: float, reached: bool, strict: bool) -> None:
    motion = standing_still(60)
    wrist = motion.joint_positions()[0, INDEX["right_wrist"]].astype(float)
    trial = replace(motion, goals=(ContactGoal("right_wrist", (wrist[0], wrist[1] + away, wrist[2])),))
    found = contact_error.outcome(touch(), Kinematics.of(trial))
    assert (found.reached, found.reached_strict) == (reached, strict)
    assert found.error == pytest.approx(away, abs=1e-5)
    assert (found.seconds is None) == (not reached)


def test_execution_time_is_when_the_threshold_is_first_met() -> None:
    motion = standing_still(root=np.outer(np.arange(90) / 30, [1.0, 0.0, 0.0]))
    found = contact_error.outcome(Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(2.3, 0.0)), Kinematics.of(motion))
    assert found.seconds == pytest.approx(2.0, abs=1 / 30)


def test_a_trial_without_a_goal_is_not_a_success() -> None:
    motion = standing_still()
    found = contact_error.outcome(touch(), Kinematics.of(motion))
    assert (found.reached, found.reached_any, found.error) == (False, False, None)


def test_a_walk_succeeds_where_it_ends_not_where_it_passes() -> None:
    root = np.outer(np.arange(90) / 30, [1.0, 0.0, 0.0])
    motion = standing_still(root=root)
    there = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(2.9, 0.0))
    passed = replace(there, goal=(1.0, 0.0))
    body = Kinematics.of(motion)
    for action, reached in ((there, True), (passed, False)):
        found = contact_error.outcome(action, body)
        assert (found.reached, found.reached_any) == (reached, True)


def test_a_motion_that_was_not_completed_is_never_reached() -> None:
    motion = replace(standing_still(), completed=False, reason="no way")
    figures = story_metrics.judge(motion, Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(0.0, 0.0)), NOTHING)
    assert not figures.reached
    assert figures.reason == "no way"


def test_rising_means_high_and_upright() -> None:
    motion = standing_still(40)
    assert contact_error.risen(Kinematics.of(motion)).all()
    low = replace(motion, root_positions=motion.root_positions - np.array([0, 0.3, 0], np.float32))
    assert not contact_error.risen(Kinematics.of(low)).any()
    bent = motion.local_rotations.copy()
    bent[:, 0] = rotations.rotvec_to_quat(np.array([0.8, 0.0, 0.0]))
    tilted = replace(motion, local_rotations=bent)
    assert not contact_error.risen(Kinematics.of(tilted)).any()


def test_a_jump_at_a_seam_is_found_and_a_smooth_seam_is_not() -> None:
    root = np.outer(np.arange(60) / 30, [0.5, 0.0, 0.0])
    smooth = replace(standing_still(root=root), actions=np.repeat([0, 1], 30).astype(np.int32))
    assert smoothness.seam_jump(smooth) == pytest.approx(0, abs=1e-4)
    root[30:, 2] += 0.25
    broken = replace(standing_still(root=root), actions=np.repeat([0, 1], 30).astype(np.int32))
    assert smoothness.seam_jump(broken) == pytest.approx(0.235, abs=0.02)


def test_a_body_that_changes_its_speed_at_a_seam_is_found() -> None:
    there = np.concatenate([np.arange(30), 29 + 3 * np.arange(1, 31)]) / 30
    motion = replace(
        standing_still(root=np.outer(there, [0.5, 0.0, 0.0])), actions=np.repeat([0, 1], 30).astype(np.int32)
    )
    assert smoothness.seam_speed_jump(motion) == pytest.approx(1.0, abs=1e-2)
    assert smoothness.seam_speed_jump(standing_still()) == 0


def test_bones_keep_their_length_whatever_the_joints_do() -> None:
    random = np.random.default_rng(3).normal(size=(20, 22, 4))
    motion = replace(standing_still(20), local_rotations=rotations.normalize(random).astype(np.float32))
    assert smoothness.bone_deviation(Kinematics.of(motion)) < 1e-5
    stretched = Kinematics.of(motion)
    assert smoothness.bone_deviation(replace(stretched, positions=stretched.positions * 1.1)) > 0.03


def test_a_contact_that_is_touched_once_and_not_held_is_near_in_one_frame_and_far_on_average() -> None:
    still = standing_still(90)
    wrist = Kinematics.of(still).positions[0, INDEX["right_wrist"]]
    goal = (ContactGoal("right_wrist", (float(wrist[0]), float(wrist[1]), float(wrist[2]))),)
    wandering = np.outer(0.1 * np.abs(np.sin(np.arange(90) / 5)), [1.0, 0.0, 0.0])
    held = contact_error.outcome(touch(), Kinematics.of(replace(still, goals=goal)))
    waved = contact_error.outcome(touch(), Kinematics.of(replace(standing_still(root=wandering), goals=goal)))
    assert held.error == pytest.approx(0, abs=1e-5)
    assert held.mean_error == pytest.approx(0, abs=1e-5)
    assert waved.error == pytest.approx(0, abs=0.005)
    assert waved.mean_error == pytest.approx(0.2 / np.pi, abs=0.01)


def test_the_peak_of_jerk_is_above_its_mean() -> None:
    positions = np.zeros((200, 1, 3))
    positions[100, 0, 0] = 0.01
    assert smoothness.jerk_peak(positions, 30) > 10 * smoothness.jerk(positions, 30) > 0


def test_jerk_is_held_against_recorded_walks_of_the_same_speed() -> None:
    assert smoothness.jerk_against_real(Kinematics.of(standing_still())) is None
    gliding = standing_still(root=np.outer(np.arange(60) / 30, [1.2, 0.0, 0.0]))
    found = smoothness.jerk_against_real(Kinematics.of(gliding))
    assert found is not None
    assert found < 0.05
    shaken = np.outer(np.arange(60) / 30, [1.0, 0.0, 0.0])
    shaken[:, 1] = 0.002 * np.sin(2 * np.pi * 5 * np.arange(60) / 30)
    found = smoothness.jerk_against_real(Kinematics.of(standing_still(root=shaken)))
    # Of a sine to the third difference, whose size is 2/π of its swing on average.
    usual = 0.002 * (2 * np.sin(np.pi / 6) * 30) ** 3 * 2 / np.pi
    assert found == pytest.approx(usual / smoothness.REAL_WALK[0], rel=0.1)


def test_what_only_a_camera_shakes_is_no_jerk_on_the_ruler() -> None:
    shaken = np.outer(np.arange(60) / 30, [1.0, 0.0, 0.0])
    shaken[:, 1] = 0.002 * (-1.0) ** np.arange(60)
    positions = Kinematics.of(standing_still(root=shaken)).positions
    assert smoothness.ruled_jerk(positions, 30) < 0.1 * smoothness.jerk(positions, 30)


def test_a_body_floats_above_the_floor_and_not_above_what_holds_it() -> None:
    root = np.zeros((5, 3))
    root[:, 1] = 0.5
    body = Kinematics.of(standing_still(root=root))
    np.testing.assert_allclose(foot_skate.height_above_support(body, NOTHING), 0.5, atol=1e-6)
    podium = box((0.0, 0.25, 0.0), (2.0, 0.5, 2.0))
    np.testing.assert_allclose(foot_skate.height_above_support(body, podium), 0.0, atol=1e-6)
    ceiling = box((0.0, 3.0, 0.0), (2.0, 0.5, 2.0))
    np.testing.assert_allclose(foot_skate.height_above_support(body, ceiling), 0.5, atol=1e-6)


def test_a_summary_counts_every_trial_and_has_no_error_where_nothing_is_touched() -> None:
    walk = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(0.0, 0.0))
    figures = story_metrics.judge(standing_still(), walk, NOTHING)
    told = story_metrics.summarise([figures, replace(figures, reached=False, seconds=6.0, pen_max=0.1)])
    assert (told["success"], told["contact_error"], told["contact_error_success"]) == (0.5, None, None)
    assert (told["pen_max"], told["seconds"]) == (0.1, 8.0)


@for_each(
    ("flags", "run"),
    [([0, 1, 1, 0, 1], (1, 3)), ([1, 1, 0, 1, 1], (3, 5)), ([0, 0], (0, 0)), ([1], (0, 1))],
)
def test_the_longest_run_is_the_later_of_equals(flags: list[int], run: tuple[int, int]) -> None:
    assert contact_error.longest_run(np.array(flags, dtype=bool)) == run


def test_depth_inside_a_turned_box_is_the_distance_to_its_nearest_face() -> None:
    turned = Obstacles(
        np.array([[1.0, 0.5, 2.0]]), np.array([[1.0, 0.5, 0.25]]), np.array([0.7]), ("0/a",), np.zeros(1, dtype=bool)
    )
    across = np.array([np.sin(0.7), 0.0, np.cos(0.7)])
    center = np.array([1.0, 0.5, 2.0])
    inside = turned.inside(center + np.outer([0.0, 0.2, 0.35], across), 0)
    np.testing.assert_allclose(inside, [0.25, 0.05, -0.10], atol=1e-9)
    assert np.isneginf(NOTHING.depth(np.zeros((2, 3)))).all()


def test_walls_are_solid_and_doorways_are_not() -> None:
    layout = Layout(
        "r",
        "bedroom",
        ((0.0, 0.0), (0.0, 4.0), (5.0, 4.0), (5.0, 0.0)),
        doors=(Opening(((5.0, 1.0), (5.0, 1.9))),),
    )
    walls = Obstacles.of_home(home_from_layouts([layout], 0))
    assert set(walls.owners) == {"wall"}
    through_wall, through_door, inside = np.array([[5.05, 1.0, 3.0], [5.05, 1.0, 1.45], [4.9, 1.0, 3.0]])
    depth = walls.depth(np.array([through_wall, through_door, inside]))
    assert depth[0] == pytest.approx(0.05, abs=1e-6)
    assert depth[1] < -0.3, depth
    assert depth[2] == pytest.approx(-0.1, abs=1e-6)
