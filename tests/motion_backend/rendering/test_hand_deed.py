"""A blow is told from where a hand goes, and what only touches, knocks or wipes is none."""

from __future__ import annotations

import numpy as np
import pytest
from acted import SMALL, touched
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from motion_backend import rotations
from motion_backend.motion import PhaseKind, Skill
from motion_backend.rendering.camera import FLAT, Sight, choose_camera, choose_frames
from motion_backend.rendering.film_cuts import Subject, film_cuts
from motion_backend.rendering.film_shots import film_shots
from motion_backend.rendering.hand_deed import FLIES, STAYS, SWING, Blow
from motion_backend.rendering.rasterizer import orbit
from motion_backend.skeleton import INDEX

SLAM = "slamming with the right hand"
THINGS = [("shelf", "medium"), ("shelf", "high"), ("table", "medium")]
WRIST = INDEX["right_wrist"]


def joints_of(name: str, height: str, caption: str) -> np.ndarray:
    return touched(name, height, caption).motion.joint_positions().astype(np.float64)


def blow_at(name: str, height: str, caption: str = SLAM) -> Blow | None:
    joints = joints_of(name, height, caption)
    return Blow.of(joints, 0, len(joints))


@for_each("name, height", THINGS)
def test_a_slam_is_drawn_flies_is_stopped_and_stays(name: str, height: str) -> None:
    joints, blow = joints_of(name, height, SLAM), blow_at(name, height)
    assert blow is not None
    assert blow.hand == WRIST
    speed = 30 * np.linalg.norm(np.diff(joints[:, WRIST], axis=0), axis=1)
    assert np.linalg.norm(joints[blow.drawn, WRIST] - joints[blow.hit, WRIST]) > SWING
    assert speed[blow.hit - 3 : blow.hit].max() >= FLIES > speed[blow.hit]
    after = joints[blow.hit : blow.hit + 10, WRIST]
    assert np.linalg.norm(after - after[0], axis=1).max() < STAYS


@for_each("name, height", THINGS)
@pytest.mark.parametrize(
    "caption",
    ["touch medium height", "knocking with the right hand", "wash with both hands", "turn on with the right hand"],
)
def test_what_only_touches_hits_nothing(name: str, height: str, caption: str) -> None:
    assert blow_at(name, height, caption) is None


@given(st.floats(-3.1, 3.1), st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.integers(0, 20))
def test_a_blow_is_the_same_wherever_and_whenever_it_is_done(yaw: float, x: float, z: float, later: int) -> None:
    joints, here = joints_of("shelf", "medium", SLAM), blow_at("shelf", "medium")
    moved = rotations.rotate(rotations.yaw_to_quat(yaw), joints) + np.array([x, 0.0, z])
    there = Blow.of(np.concatenate([np.repeat(moved[:1], later, axis=0), moved]), later, later + len(moved))
    assert here is not None
    assert there == Blow(here.drawn + later, here.hit + later, here.hand)


@for_each("name, height", THINGS)
def test_a_picture_of_a_blow_has_the_hand_where_it_is_highest_and_a_ghost_where_it_is_lowest(
    name: str, height: str
) -> None:
    motion, joints, blow = touched(name, height, SLAM).motion, joints_of(name, height, SLAM), blow_at(name, height)
    assert blow is not None
    shot = choose_frames(motion, joints, 0, len(motion), Skill.TOUCH)
    assert {shot.frame, *shot.ghosts} == {blow.drawn, blow.hit}
    assert joints[shot.frame, WRIST, 1] == max(joints[[blow.drawn, blow.hit], WRIST, 1])


@for_each("caption", [SLAM, "knocking with the right hand"])
def test_of_what_stands_up_before_a_hand_the_storyboard_and_the_film_show_the_front(caption: str) -> None:
    motion, joints = touched("shelf", "medium", caption).motion, joints_of("shelf", "medium", caption)
    shot = choose_frames(motion, joints, 0, len(motion), Skill.TOUCH)
    assert shot.touch is not None
    x, _, z = joints[shot.touch].tolist()
    front = Sight.at(SMALL, (x, z), 4.0).front(joints[shot.touch])
    assert front is not None
    assert front.outward @ [0.0, 0.0, 1.0] > 0.99, "the shelf stands at the wall of z = 0"
    assert front.seen(choose_camera(SMALL, motion, joints, shot, 4 / 3)) > 0.5
    for one in film_shots(SMALL, motion, [0], 16 / 9):
        if one.start <= shot.touch[0] < one.stop and one.subject is Subject.BODY:
            assert front.seen(one.camera) > 0.4


def test_a_front_is_seen_from_before_it_and_a_top_has_none() -> None:
    shelf = SMALL.object("0/shelf")
    hand = np.array([shelf.position[0], 1.0, shelf.position[2] + 0.2])
    front = Sight.at(SMALL, (hand[0], hand[2]), 4.0).front(hand)
    assert front is not None
    before, edgewise, behind = (front.seen(orbit(tuple(hand), 3.0, yaw, 0.0)) for yaw in (0.0, np.pi / 2, np.pi))
    assert (before, behind) == (1.0, -1.0)
    assert edgewise == pytest.approx(0.0, abs=1e-9)
    assert front.seen(orbit(tuple(hand), 3.0, np.pi / 2 - np.arcsin(FLAT), 0.0)) == pytest.approx(1.0)
    table = SMALL.object("0/table")
    top = np.array([table.position[0], 0.80, table.position[2]])
    assert Sight.at(SMALL, (top[0], top[2]), 4.0).front(top) is None
    wall = Sight.at(SMALL, (5.9, 4.6), 4.0).front(np.array([5.9, 1.2, 4.6]))
    assert wall is not None
    np.testing.assert_allclose(wall.outward, [-1.0, 0.0, 0.0], atol=1e-9)


def test_nothing_is_looked_at_from_near_while_a_hand_is_drawn_and_hits() -> None:
    motion, joints, blow = touched("shelf", "medium", SLAM).motion, joints_of("shelf", "medium", SLAM), None
    (touch,) = (phase for phase in motion.phases if phase.kind is PhaseKind.TOUCH)
    blow = Blow.of(joints, touch.start, touch.stop)
    assert blow is not None
    cut = next(one for one in film_cuts(motion, joints, [0]) if one.start <= blow.hit < one.stop)
    assert cut.close is None
    assert cut.reach is not None
    assert (cut.reach.start, cut.reach.hands) == (blow.drawn, (WRIST,))
    assert cut.reach.start < blow.hit < cut.reach.stop
