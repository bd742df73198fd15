"""What is done at a thing: each deed has a shape of its own, and a body kneels wherever there is a way to."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_home import DIRECTOR, ROOM, after, small_home

from motion_backend import rotations
from motion_backend.backend_protocol import BodyState
from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.touch.hand_captions import FINGER, FINGERS, Laid, arms_on_the_way, holding
from motion_backend.procedural.touch.hand_contacts import KNOCKED, free_stroke, is_top, palm_on, suits, to_knock_on
from motion_backend.skeleton import HAND_REST, INDEX, build_skeleton
from scene_graphs.affordances.affordances import spots
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Placed

HOME = small_home()
OBSTACLES = Obstacles.of_home(HOME)
WRIST = INDEX["right_wrist"]


def act(home: Home, name: str, caption: str, height: str = "medium") -> Motion:
    spot = next(s for s in spots(home.object(f"0/{name}"), "touch") if s.height == height)
    walk = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=spot.standing, facing=spot.approach)
    action = Action(Skill.TOUCH, caption, Emotion.NEUTRAL, name, f"0/{name}", spot, hold=2.5)
    return DIRECTOR.act(home, action, after(home, walk))[0]


@cache
def done(caption: str) -> tuple[Motion, np.ndarray, np.ndarray]:
    """A caption at the table: its motion, world joints (T, 22, 3), and how far the wrist is from its goal (T,)."""
    motion = act(HOME, "table", caption)
    joints = motion.joint_positions().astype(np.float64)
    return motion, joints, np.linalg.norm(joints[:, WRIST] - np.array(motion.goals[0].position), axis=1)


def turned(motion: Motion, joint: str) -> np.ndarray:
    """Where a joint's own Z points. (T, 3)."""
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    return np.asarray(rotations.rotate(world[:, INDEX[joint]], np.array([0.0, 0.0, 1.0])))


def test_a_press_is_short_from_a_cocked_wrist_and_then_one_looks_up() -> None:
    pressed, _, gap = done("turn on with the right hand")
    _, _, resting = done("touch medium height")
    assert 3 <= (gap < 0.02).sum() < 20 < 60 < (resting < 0.02).sum()
    assert (gap < 0.20).sum() >= pressed.fps
    far = gap[np.argmin(gap) - 12]
    assert 0.04 < far < 0.12
    look = turned(pressed, "head")[:, 1]
    assert look[np.argmin(gap)] < -0.2
    assert look[np.argmin(gap) :].max() > 0.15


def test_a_slam_is_drawn_back_for_flies_is_stopped_by_the_thing_and_leaves() -> None:
    motion, joints, gap = done("slamming with the right hand")
    hit = int(np.argmax(gap < 0.01))
    speed = np.linalg.norm(np.diff(joints[:, WRIST], axis=0), axis=1) * motion.fps
    # Faster and faster, then stopped within a frame; it bounces, stays near and comes away.
    assert 2.0 < speed[hit - 1] < 4.5
    assert (np.diff(speed[hit - 5 : hit]) > -0.1).all()
    assert speed[hit] < 0.4 * speed[hit - 1]
    assert 0.01 < gap[hit : hit + 8].max() < 0.06
    assert gap[-1] > 0.3
    # Drawn back beside the shoulder, and the chest goes from there with it.
    before = joints[hit - 15 : hit, WRIST]
    assert np.linalg.norm(before - joints[hit, WRIST], axis=1).max() > 0.4
    chest = turned(motion, "spine3")
    assert chest[hit, 1] < chest[hit - 12, 1] - 0.1
    # A hand that is only laid there is seen to be none.
    limp, _, _ = done("touch medium height")
    said = "slamming with the right hand"
    for shown, kept in ((motion, True), (limp, False)):
        verdict = judge_caption(shown, Action(Skill.TOUCH, said, Emotion.NEUTRAL))
        assert verdict is not None
        assert verdict.kept == kept


def test_wiping_goes_wide_and_the_trunk_goes_along() -> None:
    motion, joints, gap = done("wash with both hands")
    there = gap < 0.11
    assert there.sum() > 2 * motion.fps
    wide = np.ptp(joints[there][:, WRIST], axis=0).max()
    assert 0.14 < wide < 0.22
    chest = turned(motion, "spine3")[there]
    assert np.ptp(np.arctan2(chest[:, 0], chest[:, 2])) > 0.25
    apart = joints[there][:, WRIST] - joints[there][:, INDEX["left_wrist"]]
    assert np.ptp(np.linalg.norm(apart, axis=1)) < 0.06


def test_a_turning_hand_turns_far_with_its_elbow_while_the_other_keeps_still() -> None:
    motion, joints, gap = done("rotate with the right hand")
    there = gap < 0.10
    hand = turned(motion, "right_wrist")[there]
    assert np.degrees(np.arccos(np.clip(hand @ hand.T, -1, 1)).max()) > 50
    elbow, other = (joints[there][:, INDEX[name]] for name in ("right_elbow", "left_wrist"))
    assert np.ptp(elbow, axis=0).max() > 0.06
    assert np.ptp(other[20:-20], axis=0).max() < 0.03


def test_a_front_is_turned_as_far_as_a_top_with_the_wrist_near_its_place() -> None:
    wardrobe = Placed("wardrobe", "wardrobe", (2.5, 0.0, 0.3), (1.5, 2.1, 0.6), 0.0)
    motion = act(home_from_layouts([replace(ROOM, objects=(wardrobe,))], 0), "wardrobe", "rotate with the right hand")
    joints = motion.joint_positions().astype(np.float64)
    gap = np.linalg.norm(joints[:, WRIST] - np.array(motion.goals[0].position), axis=1)
    hand = turned(motion, "right_wrist")[gap < 0.10]
    assert np.degrees(np.arccos(np.clip(hand @ hand[0], -1, 1)).max()) > 25
    assert gap[gap < 0.10].mean() < 0.03


def test_knuckles_knock_from_the_wrist() -> None:
    motion, _, gap = done("knocking with the right hand")
    there = gap < 0.12
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    fingers = rotations.rotate(world[there, WRIST], np.array([-1.0, 0.0, 0.0]))
    assert np.ptp(np.degrees(np.arcsin(fingers[:, 1]))) > 20


def test_what_is_put_down_comes_from_above_with_the_forearm_up() -> None:
    motion, joints, gap = done("put down with the right hand")
    first = int(np.argmax(gap < 0.02))
    before = joints[:first]
    assert before[:, WRIST, 1].max() > joints[first, WRIST, 1] + 0.20
    raised = np.argmax(before[:, WRIST, 1] - before[:, INDEX["right_elbow"], 1])
    assert before[raised, WRIST, 1] > before[raised, INDEX["right_elbow"], 1] - 0.05
    slow = np.linalg.norm(np.diff(joints[first - 8 : first, WRIST], axis=0), axis=1).max() * motion.fps
    assert slow < 0.5


def test_the_eyes_follow_what_is_picked_up() -> None:
    motion, joints, gap = done("pick up with the right hand")
    last = int(np.flatnonzero(gap < 0.02)[-1])
    held = slice(last + 40, last + 60)
    towards = rotations.normalize(joints[held, WRIST] - joints[held, INDEX["head"]])
    look = turned(motion, "head")[held]
    assert (np.sum(towards * look, axis=1) > 0.6).all()
    assert joints[held, WRIST, 1].min() > joints[last, WRIST, 1] + 0.10


def _walled(ways: tuple[float, float, float]) -> Home:
    """A low stand with wardrobes standing so far behind, left and right of who would kneel before it."""
    behind, left, right = ways
    stand = Placed("low", "tv_stand", (3.0, 0, 2.5), (1.2, 0.45, 0.4), np.pi)
    walls = (
        Placed("behind", "wardrobe", (3.0, 0, 2.3 - behind), (1.4, 2.0, 0.2), 0.0),
        Placed("left", "wardrobe", (3.0 - left, 0, 1.9), (0.2, 2.0, 1.6), 0.0),
        Placed("right", "wardrobe", (3.0 + right, 0, 1.9), (0.2, 2.0, 1.6), 0.0),
    )
    return home_from_layouts([replace(ROOM, objects=(stand, *walls))], 0)


@pytest.mark.parametrize("ways", [(2.0, 1.6, 1.6), (1.05, 1.6, 1.6)])
def test_a_body_kneels_straight_before_or_from_aside_where_there_is_room(ways: tuple[float, float, float]) -> None:
    motion = act(_walled(ways), "low", "Low touch from a prone position", "low")
    knees = motion.joint_positions()[:, [INDEX["left_knee"], INDEX["right_knee"]], 1].max(axis=1)
    assert knees.min() < 0.12
    assert motion.notes == ()
    assert motion.completed


def test_a_body_that_cannot_kneel_squats_and_says_so() -> None:
    home = _walled((0.85, 0.45, 0.45))
    spot = next(one for one in spots(home.object("0/low"), "touch") if one.height == "low")
    action = Action(Skill.TOUCH, "Low touch from a prone position", Emotion.NEUTRAL, "low", "0/low", spot)
    there = BodyState.standing(spot.standing, spot.facing, Character(), 3)
    motion, _ = DIRECTOR.act(home, action, there)
    knees = motion.joint_positions()[:, [INDEX["left_knee"], INDEX["right_knee"]], 1].max(axis=1)
    assert knees.min() > 0.25
    assert [note.words for note in motion.notes] == ["no room to kneel: squats"]


@given(angle=st.floats(0.0, 1.2), facing=st.floats(-3.0, 3.0), hand=st.sampled_from(["left", "right"]))
def test_fingers_turned_into_a_surface_stay_out_of_it(angle: float, facing: float, hand: str) -> None:
    ahead = np.array([np.sin(facing), 0.0, np.cos(facing)])
    for normal in (np.array([0.0, 1.0, 0.0]), -ahead):
        palm = palm_on(normal, facing, hand)
        laid = Laid(HAND_REST * normal, palm, normal, hand).tilted(angle)
        fingers = np.array([FINGERS if hand == "left" else -FINGERS, 0.0, 0.0])
        tip = laid.wrist + rotations.rotate(laid.palm, fingers)
        assert tip @ normal >= FINGER - 1e-9
        assert laid.wrist @ normal >= HAND_REST - 1e-9


def test_things_are_picked_up_from_tops_and_two_hands_have_room() -> None:
    table = spots(HOME.object("0/table"), "touch")
    shelf = spots(HOME.object("0/shelf"), "touch")
    solid = OBSTACLES.solid()
    for caption in ("pick up with the left hand", "wash with both hands", "touch low height"):
        assert any(suits(spot, caption, solid) for spot in table)
    assert not any(suits(spot, "put down", solid) for spot in shelf if spot.normal[1] < 0.5)
    assert not any(suits(spot, "turn on", solid) for spot in shelf if spot.normal[1] < 0.5 and spot.height == "low")
    for spot in table:
        laid = Laid(np.asarray(spot.point) + HAND_REST * np.asarray(spot.normal), np.array([0.0, 0, 0, 1]),
                    np.asarray(spot.normal), "right")  # fmt: skip
        stroke = free_stroke(OBSTACLES, spot, laid)
        assert abs(stroke @ np.asarray(spot.normal)) < 1e-9
        assert 0.02 < np.linalg.norm(stroke) < 0.15


def test_where_two_hands_have_no_room_one_does_it_and_says_so() -> None:
    lamp = Placed("lamp", "floor_lamp", (3.0, 0, 2.5), (0.4, 1.6, 0.4), 0.0)
    motion = act(home_from_layouts([replace(ROOM, objects=(lamp,))], 0), "lamp", "wash with both hands")
    assert [note.words for note in motion.notes] == ["no room for both hands: one hand"]
    assert done("wash with both hands")[0].notes == ()


def test_a_knock_is_three_raps_a_pause_in_which_one_listens_and_three_more() -> None:
    _, _, gap = done("knocking with the right hand")
    at_it = np.flatnonzero(gap < 0.02)
    off = gap[at_it[0] : at_it[-1] + 1] > 0.05
    raps = np.flatnonzero(np.diff(off.astype(int)) == 1)
    assert len(raps) == 6
    assert np.diff(raps).argmax() == 2
    assert np.diff(raps).max() > 2 * np.delete(np.diff(raps), 2).max()


def test_one_knocks_on_a_front_at_the_height_of_the_shoulders_and_on_a_table_on_its_top() -> None:
    wardrobe = Placed("wardrobe", "wardrobe", (4.5, 0.0, 0.35), (1.2, 2.0, 0.6), 0.0)
    room = replace(ROOM, objects=(*ROOM.objects, wardrobe))
    home = home_from_layouts([room], 0)
    solid = Obstacles.of_home(home).solid()
    for scale in (0.8, 1.0):
        found = to_knock_on(spots(home.object("0/wardrobe"), "touch"), solid, scale)
        assert found
        assert not any(is_top(spot.normal) for spot in found)
        assert max(spot.point[1] for spot in found if spot.height == "medium") == pytest.approx(KNOCKED * scale)
    at_table = to_knock_on(spots(home.object("0/table"), "touch"), solid, 1.0)
    assert at_table
    assert all(is_top(spot.normal) for spot in at_table)


def test_who_knocks_on_a_front_has_the_elbow_below_the_hand() -> None:
    wardrobe = Placed("wardrobe", "wardrobe", (4.5, 0.0, 0.35), (1.2, 2.0, 0.6), 0.0)
    home = home_from_layouts([replace(ROOM, objects=(*ROOM.objects, wardrobe))], 0)
    found = to_knock_on(spots(home.object("0/wardrobe"), "touch"), Obstacles.of_home(home).solid(), 1.0)
    spot = next(one for one in found if one.height == "medium")
    walk = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=spot.standing, facing=spot.approach)
    knock = Action(Skill.TOUCH, "knocking with the right hand", Emotion.NEUTRAL, "wardrobe", "0/wardrobe", spot)
    motion, _ = DIRECTOR.act(home, knock, after(home, walk))
    joints = motion.joint_positions().astype(np.float64)
    there = np.linalg.norm(joints[:, WRIST] - np.array(motion.goals[0].position), axis=1) < 0.03
    assert there.sum() > motion.fps
    assert (joints[there, WRIST, 1] - joints[there, INDEX["right_elbow"], 1]).min() > 0.12


def test_a_grip_is_let_go_of_on_its_quick_way_back() -> None:
    motion, _, gap = done("rotate with the right hand")
    thumb = turned(motion, "right_wrist")
    yaw = np.unwrap(np.arctan2(thumb[:, 0], thumb[:, 2]))
    at_it = np.flatnonzero(gap < 0.06)
    held = slice(at_it[0] + motion.fps // 2, at_it[-1] - motion.fps // 2)
    turning = np.gradient(yaw[held])
    quick = turning * np.sign(turning[np.abs(turning).argmax()]) > 0
    assert 0.25 < quick.mean() < 0.5
    height = motion.joint_positions()[held, WRIST, 1]
    assert height[quick].mean() > height[~quick].mean() + 0.01


def test_who_works_at_a_low_table_squats_to_it() -> None:
    low = Placed("low", "coffee_table", (3.0, 0.0, 3.4), (1.1, 0.42, 0.6), 0.0)
    home = home_from_layouts([replace(ROOM, objects=(*ROOM.objects, low))], 0)
    for caption in ("stirring with the right hand", "knocking with the right hand"):
        motion = act(home, "low", caption, "low")
        joints = motion.joint_positions().astype(np.float64)
        lowest = joints[:, 0, 1].argmin()
        trunk = joints[lowest, INDEX["neck"]] - joints[lowest, 0]
        assert np.degrees(np.arccos(trunk[1] / np.linalg.norm(trunk))) < 58


def test_what_hangs_from_a_hand_is_carried_at_the_side_and_anything_else_before_the_body() -> None:
    def stood(*arms: str) -> Pose:
        return standing((0.0, 0.0), 0.0, replace(Bearing(), arms=(arms[0], arms[1])), build_skeleton(1.7))

    free = ("hang", "hang")
    assert arms_on_the_way(stood("hang", "carry"), free, "bag") == ("hang", "carry_low")
    assert arms_on_the_way(stood("hang", "carry"), free, "book") == ("hang", "carry")
    assert arms_on_the_way(stood("carry_low", "hang"), free) == ("carry_low", "hang")
    assert arms_on_the_way(stood("hang", "carry"), ("hang", "phone_right"), "bag") == ("hang", "phone_right")
    assert arms_on_the_way(stood(*free), free, "bag") == free
    assert holding(stood("carry_low", "hang")) == (True, False)
