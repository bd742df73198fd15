"""Every published threshold from both sides: just within it counts, just beyond it does not, or the other way round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each
from sample_motions import standing_still

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.joint_limits import limits_share
from motion_backend.body.scene_collision import WALL, Obstacles
from motion_backend.metrics import contact_error, foot_skate, smoothness, story_metrics
from motion_backend.metrics.gait_features import windows
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.motion import FPS, Action, ContactGoal, Emotion, Motion, Skill
from motion_backend.skeleton import INDEX
from motion_backend.state_machine import shortfall, time_limit

NOTHING = Obstacles(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=bool))
JOINT = {Skill.SITDOWN: "pelvis", Skill.LIEDOWN: "pelvis", Skill.TOUCH: "right_wrist"}
WITHIN = {Skill.SITDOWN: 0.20, Skill.LIEDOWN: 0.30, Skill.TOUCH: 0.20}
"""What the paper says is near enough (metres)."""


def gliding(speed: float, height: float = 0.0, frames: int = 60, tall: float = 1.70) -> Kinematics:
    """A body of some size that slides over the floor, or that far above it (m/s, metres)."""
    root = np.outer(np.arange(frames) / FPS, [speed, 0.0, 0.0])
    root[:, 1] = height
    return Kinematics.of(standing_still(root=root, height=tall))


def with_foot(offsets: np.ndarray, side: str = "left") -> Kinematics:
    """A standing body, one of whose toe joints is moved by (T, 3)."""
    body = Kinematics.of(standing_still(len(offsets)))
    positions = body.positions.copy()
    positions[:, INDEX[f"{side}_foot"]] += offsets
    return replace(body, positions=positions)


def box(center: tuple[float, float, float], size: tuple[float, float, float], owner: str = "0/box") -> Obstacles:
    return Obstacles(np.array([center]), np.array([size]) / 2, np.zeros(1), (owner,), np.zeros(1, dtype=bool))


def test_a_body_that_falls_through_the_air_slides_on_nothing_and_one_that_hovers_does() -> None:
    """Both are two to four centimetres up and go at 1.2 m/s; only the first is drawn down as bodies are."""
    time = np.arange(6) / FPS
    flies = gliding(1.2, 0.04, frames=6).motion.root_positions.copy()
    flies[:, 1] -= (9.81 / 2 * (time - time.mean()) ** 2).astype(np.float32)
    flight = Kinematics.of(standing_still(root=flies, height=1.70))
    assert foot_skate.in_flight(flight).all()
    assert foot_skate.skate_ratio(flight) == foot_skate.support_slip(flight) == 0.0
    assert foot_skate.skate_ratio(gliding(1.2, 0.03, frames=6)) == 1.0
    assert foot_skate.support_slip(gliding(1.2, 0.03, frames=1)) == 0.0  # it had no time to
    assert foot_skate.support_slip(gliding(1.2, 0.03, frames=6)) == pytest.approx(120, rel=1e-3)


# Seams


@pytest.mark.parametrize(("late", "counts"), [(-1, False), (0, True), (1, False)])
def test_only_what_happens_at_a_seam_is_a_jump_of_the_seam(late: int, counts: bool) -> None:
    """Frame 29 is the last of one action and 30 the first of the next; what comes a frame later is the body's own."""
    root = np.zeros((60, 3))
    root[30 + late :, 0] = 0.2
    motion = replace(standing_still(root=root), actions=np.repeat([0, 1], 30).astype(np.int32))
    assert smoothness.seam_jump(motion) == pytest.approx(0.2 if counts else 0.0, abs=1e-4)


@pytest.mark.parametrize(("late", "counts"), [(-1, False), (0, True), (1, True), (2, False)])
def test_only_a_change_of_pace_at_a_seam_is_one_of_the_seam(late: int, counts: bool) -> None:
    """Steps before, across and after the seam make two changes of pace that belong to it."""
    root = np.zeros((60, 3))
    root[:, 0] = np.cumsum(np.arange(60) >= 30 + late) / FPS
    motion = replace(standing_still(root=root), actions=np.repeat([0, 1], 30).astype(np.int32))
    assert smoothness.seam_speed_jump(motion) == pytest.approx(1.0 if counts else 0.0, abs=1e-2)


# Feet


@pytest.mark.parametrize(("height", "ratio"), [(0.0, 1.0), (0.048, 1.0), (0.052, 0.0)])
def test_a_toe_skates_lower_than_five_centimetres(height: float, ratio: float) -> None:
    assert foot_skate.skate_ratio(gliding(1.2, height)) == ratio


@pytest.mark.parametrize(("height", "share"), [(1.19, 0.7), (1.36, 0.8)])
def test_what_is_low_for_a_toe_is_told_in_the_size_of_its_body(height: float, share: float) -> None:
    """Else a child, whose steps are an adult's in small, skates all the way."""
    for up, ratio in ((0.048 * share, 1.0), (0.052 * share, 0.0)):
        assert foot_skate.skate_ratio(gliding(1.2, up, tall=height)) == ratio


@pytest.mark.parametrize(("speed", "ratio"), [(0.48, 0.0), (0.52, 1.0)])
def test_a_toe_skates_faster_than_half_a_metre_a_second(speed: float, ratio: float) -> None:
    assert foot_skate.skate_ratio(gliding(speed)) == ratio


@pytest.mark.parametrize("side", ["left", "right"])
def test_one_skating_foot_is_enough(side: str) -> None:
    assert foot_skate.skate_ratio(with_foot(np.outer(np.arange(60), [0.0, 0.0, 1.0 / FPS]), side)) == 1.0


@pytest.mark.parametrize(("jump", "frames"), [(3.3, 0), (3.7, 1)])
def test_what_skates_is_fast_over_a_quarter_of_a_second_too(jump: float, frames: int) -> None:
    """One step of a foot at so many m/s, in a window of 7 frames: its mean is a seventh of that."""
    moved = np.outer(np.arange(60) >= 30, [jump / FPS, 0.0, 0.0])
    assert foot_skate.skate_ratio(with_foot(moved)) == pytest.approx(frames / 59)


def test_a_foot_skates_where_it_is_low_before_and_after_a_step_alone() -> None:
    moved = np.outer(np.arange(60), [1.0 / FPS, 0.0, 0.0])
    moved[::2, 1] = 0.06
    assert foot_skate.skate_ratio(with_foot(moved)) == 0.0


def test_two_frames_do_not_skate_and_three_can() -> None:
    assert foot_skate.skate_ratio(gliding(1.2, frames=2)) == 0.0
    assert foot_skate.skate_ratio(gliding(1.2, frames=3)) == 1.0


@pytest.mark.parametrize(("height", "speed"), [(0.0, 80.0), (0.009, 80.0), (0.011, 0.0)])
def test_soles_are_on_the_floor_lower_than_a_centimetre(height: float, speed: float) -> None:
    assert foot_skate.skate_speed(gliding(0.8, height)) == pytest.approx(speed, rel=1e-3)


def test_soles_in_the_floor_count_by_their_depth_and_those_above_it_do_not() -> None:
    assert foot_skate.floor_penetration(gliding(0.0, -0.02)) == pytest.approx(0.02, abs=1e-5)
    assert foot_skate.floor_penetration(gliding(0.0, 0.02)) == 0.0
    root = np.zeros((60, 3))
    root[::2, 1], root[1::2, 1] = -0.04, 0.3
    assert foot_skate.floor_penetration(Kinematics.of(standing_still(root=root))) == pytest.approx(0.02, abs=1e-5)


@for_each(("height", "above"), [(0.38, 0.08), (0.3, 0.0), (0.21, 0.0), (0.13, 0.13)])
def test_a_surface_holds_what_is_at_most_ten_centimetres_in_it(height: float, above: float) -> None:
    top = box((0.0, 0.15, 0.0), (3.0, 0.30, 3.0))
    assert foot_skate.height_above_support(gliding(0.0, height), top) == pytest.approx(above, abs=1e-4)


def test_walls_hold_nobody_and_neither_does_what_is_beside() -> None:
    for other in (box((0.0, 0.15, 0.0), (3.0, 0.3, 3.0), WALL), box((3.0, 0.15, 0.0), (3.0, 0.3, 3.0))):
        assert foot_skate.height_above_support(gliding(0.0, 0.5), other) == pytest.approx(0.5, abs=1e-4)


# Furniture


@pytest.mark.parametrize(("depth", "share"), [(0.014, 0.0), (0.027, 1.0)])
def test_two_centimetres_are_clearly_in(depth: float, share: float) -> None:
    motion = standing_still(6)
    crown = Kinematics.of(motion).positions[0, INDEX["head"], 1] + 0.09 + 0.09 * np.sqrt(0.5)
    ceiling = box((0.0, crown - depth + 0.5, 0.0), (4.0, 1.0, 4.0))
    figures = story_metrics.judge(motion, Action(Skill.LOCO, "walk", Emotion.NEUTRAL), ceiling)
    assert figures.pen_share == share
    assert figures.pen_max == pytest.approx(depth, abs=3e-3)
    assert figures.pen_mean == pytest.approx(figures.pen_max)


def test_the_deepest_of_all_frames_counts_and_their_mean_beside_it() -> None:
    still = standing_still(6)
    motion = standing_still(root=np.repeat([[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]], 3, axis=0))
    crown = Kinematics.of(still).positions[0, INDEX["head"], 1] + 0.09 + 0.09 * np.sqrt(0.5)
    ceiling = box((0.0, crown + 0.5, 0.0), (4.0, 1.0, 4.0))
    figures = story_metrics.judge(motion, Action(Skill.LOCO, "walk", Emotion.NEUTRAL), ceiling)
    assert figures.pen_max > 1.5 * figures.pen_mean > 0


@for_each(
    ("skill", "owner", "allowed"),
    [(Skill.SITDOWN, "0/box", 0.05), (Skill.STANDUP, "0/box", 0.05), (Skill.LIEDOWN, "0/box", 0.05),
     (Skill.GETUP, "0/box", 0.05), (Skill.TOUCH, "0/box", 0.0), (Skill.LOCO, "0/box", 0.0),
     (Skill.SITDOWN, "0/other", 0.0)],
)  # fmt: skip
def test_who_rests_on_a_piece_may_sink_five_centimetres_into_that_piece(
    skill: Skill, owner: str, allowed: float
) -> None:
    body = Kinematics.of(standing_still(4))
    hand = body.positions[0, INDEX["right_wrist"]]
    under = box((hand[0], hand[1] - 0.5, 0.0), (0.3, 1.0, 0.3), owner)
    free = penetration(body, under, None)
    assert free.min() > 0.01
    action = Action(skill, "", Emotion.NEUTRAL, object_id="0/box")
    np.testing.assert_allclose(penetration(body, under, action), np.maximum(free - allowed, 0.0), atol=1e-9)


def test_feet_may_sink_into_a_bed_and_not_into_a_seat() -> None:
    body = Kinematics.of(standing_still(4))
    step = box((0.0, 0.0, 0.1), (0.5, 0.04, 0.5))
    free = penetration(body, step, None)
    assert 0.005 < free.min() < 0.05
    sit, lie = (Action(skill, "", Emotion.NEUTRAL, object_id="0/box") for skill in (Skill.SITDOWN, Skill.LIEDOWN))
    np.testing.assert_allclose(penetration(body, step, sit), free)
    assert penetration(body, step, lie).max() == 0.0


# Reaching


def near_for(skill: Skill, gap: float, frames: int, total: int = 75) -> tuple[Action, Kinematics]:
    """A body whose joint is that far from its goal for so many frames, and a metre from it before and after."""
    root = np.zeros((total, 3))
    start = (total - frames) // 2
    root[:start, 1] = root[start + frames :, 1] = 1.0
    motion = standing_still(root=root)
    at = Kinematics.of(standing_still(1)).positions[0, INDEX[JOINT[skill]]]
    goal = ContactGoal(JOINT[skill], (float(at[0]), float(at[1]) - gap, float(at[2])))
    return Action(skill, "", Emotion.NEUTRAL), Kinematics.of(replace(motion, goals=(goal,)))


@for_each("skill", list(WITHIN))
@for_each(("more", "reached"), [(-0.005, True), (0.005, False)])
def test_a_contact_counts_within_its_radius(skill: Skill, more: float, reached: bool) -> None:
    found = contact_error.outcome(*near_for(skill, WITHIN[skill] + more, 40))
    assert (found.reached, found.reached_any, found.seconds is not None) == (reached, reached, reached)
    assert found.error == pytest.approx(WITHIN[skill] + more, abs=1e-5)


@for_each("skill", list(WITHIN))
@for_each(("frames", "held"), [(29, False), (30, True)])
def test_a_contact_is_held_for_a_second(skill: Skill, frames: int, held: bool) -> None:
    action, body = near_for(skill, 0.05, frames)
    found = contact_error.outcome(action, body)
    assert (found.reached, found.reached_any, found.reached_strict) == (held, True, held)
    assert (shortfall(action, body) == "") == held


@for_each("skill", list(WITHIN))
@for_each(("more", "done"), [(-0.005, True), (0.005, False)])
def test_the_state_machine_asks_for_the_same_radius(skill: Skill, more: float, done: bool) -> None:
    assert (shortfall(*near_for(skill, WITHIN[skill] + more, 40)) == "") == done


@pytest.mark.parametrize(("gap", "strict"), [(0.097, True), (0.103, False)])
def test_ten_centimetres_are_strict(gap: float, strict: bool) -> None:
    for skill in WITHIN:
        found = contact_error.outcome(*near_for(skill, gap, 40))
        assert (found.reached, found.reached_strict) == (True, strict)


@for_each("speed", [0.6, 1.5])
@for_each(("past", "aside", "reached"),
          [(0.0, 0.0, True), (0.45, 0.29, True), (0.45, 0.31, False), (0.9, 0.0, False)])  # fmt: skip
def test_who_walks_on_has_passed_the_place_near_enough_and_has_not_gone_far_since(
    speed: float, past: float, aside: float, reached: bool
) -> None:
    body = gliding(speed)  # m/s, for 2 s along x
    end = body.positions[-1, 0]
    walk = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(float(end[0]) - past, float(end[2]) + aside))
    assert contact_error.outcome(walk, body).reached is reached


def test_the_error_is_the_smallest_of_the_last_second_of_the_contact_and_the_time_when_it_began() -> None:
    gaps = np.concatenate([np.full(20, 0.9), np.full(40, 0.01), np.linspace(0.05, 0.15, 30), np.full(10, 0.9)])
    root = np.zeros((100, 3))
    root[:, 1] = gaps
    motion = standing_still(root=root)
    x, y, z = standing_still(1).root_positions[0].tolist()
    body = Kinematics.of(replace(motion, goals=(ContactGoal("pelvis", (x, y, z)),)))
    found = contact_error.outcome(Action(Skill.SITDOWN, "", Emotion.NEUTRAL), body)
    assert found.error == pytest.approx(0.05, abs=1e-5)
    assert found.seconds == pytest.approx(20 / FPS)


@for_each(("held", "hovers", "error"), [(40, 0.15, 0.01), (20, 0.15, 0.15), (40, 0.25, 0.01), (20, 0.25, 0.01)])
@for_each("apart", [0, 5])
def test_a_hand_is_judged_where_it_held_for_a_second_however_long_it_stays_about(
    held: int, hovers: float, error: float, apart: int
) -> None:
    gaps = np.concatenate([np.full(20, 0.9), np.full(held, 0.01), np.full(apart, 0.3), np.full(90, hovers)])
    motion = standing_still(root=gaps[:, None] * [0.0, 1.0, 0.0])
    at = Kinematics.of(standing_still(1)).positions[0]
    for skill, joint in ((Skill.TOUCH, "right_wrist"), (Skill.SITDOWN, "pelvis")):
        x, y, z = at[INDEX[joint]].tolist()
        body = Kinematics.of(replace(motion, goals=(ContactGoal(joint, (x, y, z)),)))
        found = contact_error.outcome(Action(skill, "", Emotion.NEUTRAL), body)
        stays = hovers if hovers < WITHIN[skill] else 0.01
        assert found.error == pytest.approx(error if skill is Skill.TOUCH else stays, abs=1e-5)


def test_the_farthest_of_several_goals_decides() -> None:
    motion = standing_still(40)
    at = Kinematics.of(motion).positions[0]
    goals = tuple(
        ContactGoal(joint, (float(at[INDEX[joint], 0]), float(at[INDEX[joint], 1]) + gap, 0.0))
        for joint, gap in (("pelvis", 0.02), ("right_wrist", 0.12))
    )
    assert contact_error.contact_distance(Kinematics.of(replace(motion, goals=goals)))[0] == pytest.approx(0.12)


@pytest.mark.parametrize(("gap", "near", "strict"), [(0.09, True, True), (0.295, True, False), (0.305, False, False)])
def test_a_walk_hands_over_within_thirty_centimetres_on_the_floor(gap: float, near: bool, strict: bool) -> None:
    root = np.outer(np.clip(np.arange(60) / 40, 0, 1), [2.0, 0.0, 1.0])
    body = Kinematics.of(standing_still(root=root))
    aside = gap * np.array([1.0, -2.0]) / np.sqrt(5)
    action = Action(Skill.LOCO, "", Emotion.NEUTRAL, goal=(2.0 + float(aside[0]), 1.0 + float(aside[1])))
    found = contact_error.outcome(action, body)
    assert (found.reached, found.reached_any, found.reached_strict) == (near, near, strict)
    assert (shortfall(action, body) == "") == near


@pytest.mark.parametrize(("frames", "done"), [(2, False), (3, True)])
def test_a_walk_is_done_after_a_tenth_of_a_second_there(frames: int, done: bool) -> None:
    root = np.outer(np.concatenate([np.full(40, 2.0), np.zeros(frames)]), [1.0, 0.0, 0.0])
    action = Action(Skill.LOCO, "", Emotion.NEUTRAL, goal=(0.0, 0.0))
    assert (shortfall(action, Kinematics.of(standing_still(root=root))) == "") == done


def test_a_walk_without_a_goal_is_done_when_it_is_completed() -> None:
    action, motion = Action(Skill.LOCO, "", Emotion.NEUTRAL), standing_still(45)
    for completed in (True, False):
        found = contact_error.outcome(action, Kinematics.of(replace(motion, completed=completed)))
        assert (found.reached, found.reached_any, found.reached_strict) == (completed,) * 3
        assert found.seconds == (1.5 if completed else None)
    assert shortfall(action, Kinematics.of(motion)) == ""


def test_who_gave_up_has_reached_nothing_however_near() -> None:
    for skill in WITHIN:
        action, body = near_for(skill, 0.0, 60)
        found = contact_error.outcome(action, replace(body, motion=replace(body.motion, completed=False)))
        assert (found.reached, found.reached_any, found.reached_strict, found.seconds) == (False, False, False, None)
        assert found.error == pytest.approx(0.0, abs=1e-5)


# Rising


def tilted(degrees: float, frames: int = 40) -> Motion:
    """Standing with the pelvis, and all that hangs on it, tipped forward."""
    motion = standing_still(frames)
    turned = motion.local_rotations.copy()
    turned[:, 0] = rotations.rotvec_to_quat(np.array([np.radians(degrees), 0.0, 0.0]))
    return replace(motion, local_rotations=turned)


@for_each(("degrees", "up"), [(29.0, True), (-29.0, True), (31.0, False), (-31.0, False)])
def test_who_has_risen_is_within_thirty_degrees_of_upright(degrees: float, up: bool) -> None:
    assert contact_error.risen(Kinematics.of(tilted(degrees))).all() == up


@pytest.mark.parametrize(("share", "up"), [(0.86, True), (0.84, False)])
def test_who_has_risen_has_the_pelvis_at_most_of_its_height(share: float, up: bool) -> None:
    for height in (1.5, 1.9):
        motion = standing_still(10, height=height)
        lower = (1 - share) * motion.skeleton.standing_height
        low = replace(motion, root_positions=motion.root_positions - np.array([0.0, lower, 0.0], np.float32))
        assert contact_error.risen(Kinematics.of(low)).all() == up


@for_each(("frames", "held"), [(2, False), (3, True)])
@for_each("skill", [Skill.STANDUP, Skill.GETUP])
def test_who_has_risen_stands_for_a_tenth_of_a_second_at_the_end(skill: Skill, frames: int, held: bool) -> None:
    root = np.zeros((60, 3))
    root[: 60 - frames, 1] = -0.4
    action, body = Action(skill, "", Emotion.NEUTRAL), Kinematics.of(standing_still(root=root))
    found = contact_error.outcome(action, body)
    assert (found.reached, found.reached_any, found.error) == (held, True, None)
    assert found.seconds == pytest.approx((60 - frames) / FPS)
    assert (shortfall(action, body) == "") == held
    again = Kinematics.of(standing_still(root=root[::-1]))
    assert not contact_error.outcome(action, again).reached, "it stood only at first"
    assert shortfall(action, again) != ""


# Time


def test_every_part_may_take_fifteen_seconds_its_hold_and_five_for_a_metre_of_way() -> None:
    sit = Part(PartKind.SIT, Action(Skill.SITDOWN, "", Emotion.NEUTRAL, hold=2.0))
    assert time_limit(sit, 0.0) == pytest.approx(15.0)
    assert time_limit(sit, 3.0) == pytest.approx(30.0)
    assert time_limit(replace(sit, kind=PartKind.HOLD, hold=2.0), 0.0) == pytest.approx(17.0)


# Smoothness


def test_jerk_is_the_third_difference_and_its_peak_the_worst_hundredth() -> None:
    positions = np.zeros((203, 1, 3))
    positions[:, 0, 0] = 4.0 / 6 * (np.arange(203) / FPS) ** 3
    assert smoothness.jerk(positions, FPS) == pytest.approx(4.0, rel=1e-6)
    assert smoothness.jerk_peak(positions, FPS) == pytest.approx(4.0, rel=1e-6)
    positions[100, 0, 1] += 1.0
    assert smoothness.jerk_peak(positions, FPS) > 1000
    assert smoothness.jerk(positions, 2 * FPS) == pytest.approx(8 * smoothness.jerk(positions, FPS))
    assert smoothness.jerk(positions[:3], FPS) == smoothness.jerk_peak(positions[:3], FPS) == 0.0
    assert smoothness.jerk(positions[:4], FPS) == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize(("speed", "walks"), [(0.29, False), (0.31, True)])
def test_only_who_walks_is_held_against_recorded_walks(speed: float, walks: bool) -> None:
    assert (smoothness.jerk_against_real(gliding(speed)) is not None) == walks


@pytest.mark.parametrize(("frames", "enough"), [(15, False), (16, True)])
def test_half_a_second_of_walking_is_enough(frames: int, enough: bool) -> None:
    assert (smoothness.jerk_against_real(gliding(1.0, frames=frames)) is not None) == enough


@pytest.mark.parametrize(("degrees", "share"), [(4.5, 0.0), (5.5, 1.0)])
def test_five_degrees_beyond_a_joints_range_are_outside(degrees: float, share: float) -> None:
    motion = standing_still(4)
    turned = motion.local_rotations.copy()
    # Both knees straight already: they do not bend forwards.
    turned[:, INDEX["left_knee"]] = rotations.rotvec_to_quat(np.array([-np.radians(degrees) - knee_play(), 0.0, 0.0]))
    assert limits_share(turned) == share


def knee_play() -> float:
    """How far a knee may bend forwards within its range, radians."""
    from motion_backend.body.joint_limits import beyond_limits

    turns = np.tile(rotations.IDENTITY, (400, 22, 1))
    angles = np.radians(np.linspace(0, 40, 400))
    turns[:, INDEX["left_knee"]] = rotations.rotvec_to_quat(np.outer(-angles, [1.0, 0.0, 0.0]))
    return float(angles[np.argmax(beyond_limits(turns).max(axis=1) > 1e-6)])


# Windows of steady walking


def going(ground: np.ndarray) -> np.ndarray:
    """Joints (T, 22, 3) of a body that is at [x, z] (T, 2)."""
    positions = np.zeros((len(ground), 22, 3))
    positions[..., [0, 2]] = ground[:, None]
    return positions


@pytest.mark.parametrize(("speed", "found"), [(0.28, 0), (0.32, 1)])
def test_three_tenths_of_a_metre_a_second_are_walking(speed: float, found: int) -> None:
    assert len(windows(going(np.outer(np.arange(60) / FPS, [0.0, speed])), FPS)) == found


@pytest.mark.parametrize(("degrees", "found"), [(28.0, 1), (32.0, 0)])
def test_a_way_that_turns_by_thirty_degrees_is_not_straight_on(degrees: float, found: int) -> None:
    turn = np.radians(degrees) * (np.arange(60) / 59 - 0.5)
    ground = np.cumsum(np.stack([np.sin(turn), np.cos(turn)], axis=1), axis=0) / FPS
    assert len(windows(going(ground), FPS)) == found


@pytest.mark.parametrize(("share", "found"), [(0.62, 0), (0.78, 1)])
def test_no_quarter_of_steady_walking_is_slower_than_seven_tenths_of_the_whole(share: float, found: int) -> None:
    pace = np.ones(60)
    pace[15:30] = 3 * share / (4 - share)
    assert len(windows(going(np.outer(np.cumsum(pace / FPS), [0.0, 1.0])), FPS)) == found


# Stories


def test_a_summary_weighs_by_time_what_is_told_by_frame_and_by_trial_what_is_told_by_trial() -> None:
    short, long = (
        story_metrics.judge(
            standing_still(frames), Action(Skill.LOCO, "walk", Emotion.NEUTRAL, keyframe=index), NOTHING
        )
        for index, frames in enumerate((30, 90))
    )
    sat = replace(short, skill="sitdown", contact_error=0.04, reached=False, skate_ratio=1.0, execution_time=3.0)
    walked = replace(long, skate_ratio=0.2, pen_mean=0.01, pen_max=0.02, reached=True, execution_time=1.0)
    found = story_metrics.summarise([sat, walked])
    assert found["skate_ratio_loco"] == pytest.approx(0.2), "only walking counts"
    assert found["pen_mean"] == pytest.approx(0.0075)
    assert found["pen_max"] == pytest.approx(0.02)
    assert found["success"] == pytest.approx(0.5)
    assert found["reached"] == 1
    assert found["contact_error"] == pytest.approx(0.04)
    assert found["contact_error_success"] is None
    assert found["execution_time"] == pytest.approx(2.0)
    assert found["seconds"] == pytest.approx(4.0)
    assert found["by_skill"] == {"loco": {"keyframes": 1, "reached": 1}, "sitdown": {"keyframes": 1, "reached": 0}}
