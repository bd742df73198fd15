"""Sitting and rising: every caption its own pose, hands on what they lie on, feet on the floor, limbs within limits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from layers import sampled
from small_home import DIRECTOR, after, contact, rise, small_home, to

from motion_backend.body.joint_limits import CLEARLY, beyond_limits
from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.self_collision import self_penetration
from motion_backend.metrics import story_metrics
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.procedural.emotion_style import Bearing, arm_poses
from motion_backend.procedural.held_poses import Seat, standing
from motion_backend.procedural.pose_solver import hips_within, solve
from motion_backend.procedural.sit.sit_keys import sit_keys
from motion_backend.procedural.sit.sit_legs import WAYS, Room, seated_legs
from motion_backend.procedural.sit.sit_pose import SURFACES, Place
from motion_backend.procedural.sit.sit_pose import seated as settled
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.touch.hand_rests import HOLDS, at_rest, lay_hands
from motion_backend.procedural.touch.handholds import Handholds, handholds
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.scripts.captions import captions
from scene_graphs.affordances.affordances import floor_spot
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout, Placed

HOME = small_home()
SKELETON = build_skeleton(1.7)
HELD = 30
"""The last frames, in which the pose is held."""


def studio(*objects: Placed) -> Home:
    room = Layout("studio", "bedroom", ((0.0, 0.0), (0.0, 5.0), (5.0, 5.0), (5.0, 0.0)), objects=objects)
    return home_from_layouts([room], 0)


CHAIR = Placed("chair", "dining_chair", (2.5, 0.0, 2.0), (0.47, 0.87, 0.54), 0.0)
ARMCHAIR = Placed("armchair", "armchair", (2.5, 0.0, 2.0), (0.85, 0.85, 0.85), 0.0)
TABLE = Placed("table", "dining_table", (2.5, 0.0, 2.95), (1.2, 0.75, 0.7), 0.0)
AT_TABLE, WITH_ARMS = studio(CHAIR, TABLE), studio(ARMCHAIR)


@cache
def seated(
    caption: str, name: str = "chair", home: Home = HOME, emotion: Emotion = Emotion.NEUTRAL
) -> tuple[Motion, np.ndarray]:
    """Sitting down on a thing ("floor" too) and holding it: the motion and its joints (T, 22, 3)."""
    if name == "floor":
        action = Action(Skill.SITDOWN, caption, emotion, "floor", "floor", floor_spot("sit", (3.0, 3.0), 0.0))
    else:
        action = contact(home, Skill.SITDOWN, name, caption, emotion)
    motion, _ = DIRECTOR.act(home, replace(action, keyframe=1, hold=2.5), after(home, to(action)))
    return motion, motion.joint_positions().astype(np.float64)


def held(caption: str, name: str = "chair", home: Home = HOME) -> dict[str, np.ndarray]:
    """Joints in the middle of the held pose."""
    _, joints = seated(caption, name, home)
    return {joint: joints[-HELD // 2, index] for joint, index in INDEX.items()}


def test_every_caption_names_hands_and_legs_that_there_are() -> None:
    for caption in captions()["sitdown"]:
        style = sit_style(Emotion.NEUTRAL, caption)
        assert all(arm in arm_poses() or arm in HOLDS or arm in SURFACES for arm in style.arms), caption
        assert style.legs in WAYS, caption


CAPTIONS = (
    "arms crossed, straight legs, feet crossed",
    "cross-legged, hands on knees",
    "hands on thighs",
    "hands support on seat, legs straight",
    "legs straight, hands support body",
    "leaning back, legs straight, hands supporting head",
    "hands behind head, legs straight",
    "leaning forward, elbows on knees",
    "leaning forward, forearms on the table",
    "left leg straightened",
    "right leg held, left leg stretched out",
    "sitting still",
)


@pytest.mark.parametrize("caption", sampled(CAPTIONS, 4))
def test_a_seated_body_is_within_its_limits_and_not_in_itself_or_the_seat(caption: str) -> None:
    motion, _ = seated(caption)
    positions, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    assert self_penetration(motion.skeleton, positions[-HELD:].astype(np.float64), world[-HELD:]).max() < 0.05
    assert beyond_limits(motion.local_rotations).max() < CLEARLY
    action = replace(contact(HOME, Skill.SITDOWN, "chair", caption), keyframe=1)
    figures = story_metrics.judge(motion, action, Obstacles.of_home(HOME))
    assert figures.reached
    assert figures.contact_error is not None
    assert figures.contact_error < 0.01
    assert figures.pen_max < 0.05


@pytest.mark.sweep
def test_captions_that_say_different_things_look_different() -> None:
    # Who leans on a table leans on the thighs where there is none, and that is said.
    alike = {"leaning forward, forearms on the table"}
    poses = {caption: np.stack(list(held(caption).values())) for caption in CAPTIONS if caption not in alike}
    for one, other in combinations(poses, 2):
        apart = np.linalg.norm((poses[one] - poses[one][0]) - (poses[other] - poses[other][0]), axis=1).max()
        assert apart > 0.06, (one, other)


def test_hands_lie_on_what_the_caption_says() -> None:
    pose = held("leaning forward, elbows on knees")
    for side in ("left", "right"):
        assert np.linalg.norm(pose[f"{side}_elbow"] - pose[f"{side}_knee"]) < 0.20
    pose = held("Resting hands on the armrests, legs spread apart", "armchair", WITH_ARMS)
    for side in ("left", "right"):
        assert pose[f"{side}_wrist"][1] == pytest.approx(0.60 + 0.04, abs=0.035)
        assert abs(pose[f"{side}_wrist"][0] - 2.5) > 0.25
    pose = held("right leg held, left leg stretched out")
    for side in ("left", "right"):
        assert np.linalg.norm(pose[f"{side}_wrist"] - pose["right_knee"]) < 0.24
    assert pose["right_ankle"][1] > pose["left_ankle"][1] + 0.15


def test_forearms_are_on_a_table_in_reach_and_on_the_thighs_without_one() -> None:
    caption = "leaning forward, forearms on the table"
    at_table, without = held(caption, "chair", AT_TABLE), held(caption)
    for side in ("left", "right"):
        assert at_table[f"{side}_wrist"][1] == pytest.approx(0.75 + 0.045, abs=0.03)
        assert np.linalg.norm(without[f"{side}_elbow"] - without[f"{side}_knee"]) < 0.2


def test_without_a_table_the_head_is_in_the_hands_and_they_on_the_thighs() -> None:
    pose = held("head on folded arms on the table")
    for side in ("left", "right"):
        assert np.linalg.norm(pose[f"{side}_elbow"] - pose[f"{side}_knee"]) < 0.2
        assert np.linalg.norm(pose[f"{side}_wrist"] - pose["head"]) < 0.25


def test_who_sits_still_on_the_floor_has_the_arms_about_the_knees() -> None:
    pose = held("sitting still", "floor")
    for side in ("left", "right"):
        assert pose[f"{side}_knee"][1] > pose["pelvis"][1] + 0.2
        assert np.linalg.norm(pose[f"{side}_wrist"] - pose[f"{side}_knee"]) < 0.25


@pytest.mark.parametrize(
    "caption", ["hands on thighs", "cross-legged, hands on knees", "hands behind head, legs straight"]
)
def test_one_can_sit_on_the_floor(caption: str) -> None:
    motion, joints = seated(caption, "floor")
    assert beyond_limits(motion.local_rotations).max() < CLEARLY
    assert joints[-HELD:, INDEX["pelvis"], 1].max() < 0.12
    assert joints[-HELD:, [INDEX["left_foot"], INDEX["right_foot"]], 1].min() > 0.0


def test_feet_of_a_sitter_stay_where_they_stand_and_hang_where_a_stool_is_high() -> None:
    _, joints = seated("sitting still")
    feet = joints[-HELD:, [INDEX["left_ankle"], INDEX["right_ankle"]]]
    assert np.ptp(feet, axis=0).max() < 0.002
    high = Seat(np.array([0.0, 0.92, 0.0]), 0.0, np.inf, 0.2)
    legs = seated_legs(high, "rest", SKELETON, (Room(0.8, 0.3), Room(0.8, 0.3)), sit_keys().pose.legs)
    assert (legs.ankles[:, 1] > 0.3).all()
    assert not legs.planted.any()


HEIGHTS = st.floats(0.38, 0.62)


@tries(12)
@given(caption=st.sampled_from(captions()["sitdown"]), height=HEIGHTS, ahead=st.floats(0.5, 0.8))
def test_no_way_of_sitting_bends_a_joint_beyond_its_range(caption: str, height: float, ahead: float) -> None:
    seat = Seat(np.array([0.0, height + 0.09, 0.0]), 0.0, 0.2, 0.33)
    place = Place(seat, Handholds(), (Room(ahead, 0.4), Room(ahead, 0.4)))
    stood, style = standing((0.0, 0.42), 0.0, Bearing(), SKELETON), sit_style(Emotion.NEUTRAL, caption)
    pose, _ = settled(stood, place, style, SKELETON, sit_keys().pose)
    _, local = solve(hips_within(pose.repeat(1), SKELETON), SKELETON)
    assert beyond_limits(local).max() < CLEARLY


@pytest.mark.parametrize(("caption", "name"), [("stand up", "floor"), ("stand up slowly", "chair")])
def test_who_rises_passes_hands_round_the_thighs_and_stays_within_limits(caption: str, name: str) -> None:
    if name == "floor":
        action = Action(
            Skill.SITDOWN, "sitting still", Emotion.NEUTRAL, "floor", "floor", floor_spot("sit", (3.0, 3.0), 0.0)
        )
    else:
        action = contact(HOME, Skill.SITDOWN, name, "sitting still")
    state = after(HOME, to(action), replace(action, keyframe=1))
    motion, _ = DIRECTOR.act(HOME, replace(rise(action), caption=caption, keyframe=2), state)
    positions, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    assert self_penetration(motion.skeleton, positions.astype(np.float64), world).max() < 0.05
    assert beyond_limits(motion.local_rotations).max() < CLEARLY


def test_legs_and_elbows_stay_inside_what_stands_beside_a_seat() -> None:
    beside = Placed("shelf", "wardrobe", (3.2, 0.0, 2.2), (0.6, 1.9, 1.4), 0.0)
    home = studio(CHAIR, beside)
    for caption in ("hands behind head, legs straight", "arms loosely, legs open"):
        motion, _ = seated(caption, "chair", home)
        action = replace(contact(home, Skill.SITDOWN, "chair", caption), keyframe=1)
        assert story_metrics.judge(motion, action, Obstacles.of_home(home)).pen_max < 0.04


def test_the_pose_is_taken_after_the_seat_is_touched() -> None:
    _, joints = seated("hands behind head, legs straight")
    on_seat = int(np.argmax(joints[:, 0, 1] < joints[-1, 0, 1] + 0.02))
    assert joints[: on_seat + 1, INDEX["left_wrist"], 1].max() < joints[on_seat, INDEX["left_shoulder"], 1]
    trunk = joints[:on_seat, INDEX["neck"]] - joints[:on_seat, 0]
    lean = np.degrees(np.arccos(trunk[:, 1] / np.linalg.norm(trunk, axis=1)))
    assert lean.max() > 20


def test_slow_rising_leans_on_the_knees_and_abrupt_rising_is_quicker() -> None:
    times, near = {}, {}
    for caption in ("stand up", "stand up abruptly", "stand up slowly"):
        action = contact(HOME, Skill.SITDOWN, "chair", "crossing arms")
        state = after(HOME, to(action), replace(action, keyframe=1))
        motion, _ = DIRECTOR.act(HOME, replace(rise(action), caption=caption, keyframe=2), state)
        joints = motion.joint_positions().astype(np.float64)
        times[caption] = len(motion)
        near[caption] = np.linalg.norm(joints[:, INDEX["left_wrist"]] - joints[:, INDEX["left_knee"]], axis=1).min()
        assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() * 30 < 7
    assert times["stand up abruptly"] < times["stand up"] < times["stand up slowly"]
    assert near["stand up slowly"] < 0.2 < near["stand up"]


@for_each("name", sorted(HOLDS))
def test_a_hand_at_rest_keeps_its_place_on_the_body_however_that_moves(name: str) -> None:
    pose = standing((0.0, 0.0), 0.4, Bearing(), SKELETON)
    hold = HOLDS[name]
    rested = at_rest(pose, (hold, hold), SKELETON)
    many = rested.repeat(5)
    turned = replace(many, spine=many.spine + np.linspace(0, 0.2, 5)[:, None])
    laid = lay_hands(turned, (hold, hold), SKELETON)
    positions, _ = SKELETON.forward_kinematics(*solve(laid, SKELETON))
    gaps = np.linalg.norm(laid.reach[:, 0] - positions[:, INDEX[hold.part]], axis=1)
    np.testing.assert_allclose(gaps, gaps[0], atol=0.03)


def test_a_bare_room_offers_only_the_floor() -> None:
    seat = Seat(np.array([2.5, 0.09, 2.5]), 0.0, np.inf)
    around = handholds(seat, Obstacles.of_home(studio()), 1.0)
    assert around.armrests == (None, None)
    assert around.table is None
    assert all(point is not None and point[1] == 0.0 for point in around.beside)
