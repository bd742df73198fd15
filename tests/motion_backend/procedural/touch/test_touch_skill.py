"""Touching: the named hand gets there and stays, eyes go first, bodies kneel, bend or rise on tiptoes as it needs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from for_each import for_each
from layers import sampled
from small_home import DIRECTOR, ROOM, after

from motion_backend import rotations
from motion_backend.body.joint_limits import limits_share
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.touch.reach import _looking_there
from motion_backend.procedural.touch.touch_keys import touch_keys
from motion_backend.skeleton import INDEX, build_skeleton
from scene_graphs.affordances.affordances import spots
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Placed

HOME = home_from_layouts(
    [replace(ROOM, objects=(Placed("shelf", "bookshelf", (1.5, 0, 2.5), (0.9, 1.9, 0.35), 0.0),
                            Placed("low", "tv_stand", (4.5, 0, 2.5), (1.2, 0.45, 0.4), 0.0),
                            Placed("tall", "wardrobe", (0.9, 0, 4.6), (1.0, 2.0, 0.5), np.pi)))], 0
)  # fmt: skip


@cache
def act(caption: str, name: str, height: str, hand: str = "right", body: float = 1.70) -> Motion:
    spot = next(s for s in spots(HOME.object(f"0/{name}"), "touch") if s.height == height)
    walk = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=spot.standing, facing=spot.facing)
    action = Action(Skill.TOUCH, caption, Emotion.NEUTRAL, name, f"0/{name}", spot, hand=hand)
    return DIRECTOR.act(HOME, action, after(HOME, walk, seed=4, height=body))[0]


def gap(motion: Motion) -> np.ndarray:
    goal = motion.goals[0]
    at = motion.joint_positions()[:, INDEX[goal.joint]].astype(np.float64)
    return np.asarray(np.linalg.norm(at - np.array(goal.position), axis=1))


@pytest.mark.parametrize(
    ("caption", "name", "height", "hand"),
    sampled(
        [
            ("An act of reaching high", "shelf", "high", "right"),
            ("An act of reaching high", "shelf", "high", "left"),
            ("touch medium height", "shelf", "medium", "left"),
            ("touch medium height", "shelf", "medium", "right"),
            ("touch low height", "shelf", "low", "left"),
            ("touch low height", "shelf", "low", "right"),
            ("Low touch from a prone position", "low", "low", "right"),
            ("Low touch from a prone position", "low", "low", "left"),
        ],
        2,
    ),
)
def test_the_hand_gets_there_and_stays_within_the_joints_limits(
    caption: str, name: str, height: str, hand: str
) -> None:
    motion = act(caption, name, height, hand)
    assert motion.goals[0].joint == f"{hand}_wrist"
    assert (gap(motion) < 0.04).sum() >= motion.fps
    assert gap(motion).min() < 0.005
    assert limits_share(motion.local_rotations) <= 0.02


def test_the_eyes_go_to_it_before_the_hand_moves() -> None:
    motion = act("touch low height", "low", "low")
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    look = rotations.rotate(world[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
    came = gap(motion)[0] - gap(motion)
    still = int(np.argmax(came > 0.03))
    assert look[still, 1] < -0.15


def test_the_less_the_eyes_have_to_go_the_less_a_body_has_begun_to_bend_when_they_are_there() -> None:
    row, looks_rad = touch_keys().reach.approach, touch_keys().reach.arriving.looks_rad
    stands = standing((0.0, 0.0), 0.0, Bearing(), build_skeleton(1.7))
    bent = replace(stands, spine=np.array([0.5, 0.0, 0.0]), head=np.array([0.6, 0.0, 0.0]))
    rates = []
    for nod in (0.0, 0.3, 0.45, 0.55):
        away = replace(stands, head=np.array([nod, 0.0, 0.0]))
        lead, looks = _looking_there(away, bent, row, looks_rad)
        assert np.linalg.norm(lead.head - bent.head) <= np.linalg.norm(away.head - bent.head)
        rates.append(np.linalg.norm(lead.spine - away.spine) / looks)
    assert np.ptp(rates) < 1e-9
    assert rates[0] > 0


def test_a_prone_touch_is_on_the_knees_and_a_low_touch_on_the_feet() -> None:
    prone, low = act("Low touch from a prone position", "low", "low"), act("touch low height", "low", "low")
    knees = {
        name: motion.joint_positions()[np.argmin(gap(motion))] for name, motion in (("prone", prone), ("low", low))
    }
    for side in ("left", "right"):
        assert knees["prone"][INDEX[f"{side}_knee"], 1] < 0.10
        assert knees["low"][INDEX[f"{side}_knee"], 1] > 0.25
    assert prone.root_positions[-1, 1] > 0.95 * prone.skeleton.standing_height


def test_only_a_short_body_rises_on_its_tiptoes() -> None:
    heels = {}
    for body in (1.5, 1.75):
        motion = act("An act of reaching high", "shelf", "high", "right", body)
        at = motion.joint_positions()[np.argmin(gap(motion))]
        heels[body] = at[INDEX["left_ankle"], 1] - motion.skeleton.ankle_height
        assert gap(motion).min() < 0.02
    assert heels[1.5] > 0.02
    assert heels[1.75] < 0.01


@for_each("hand", ["left", "right"])
def test_to_what_is_overhead_heels_rise_and_the_eyes_go_up(hand: str) -> None:
    motion = act("An act of reaching high", "tall", "high", hand)
    frame, joints = int(np.argmin(gap(motion))), motion.joint_positions()
    assert motion.goals[0].position[1] > 1.7
    for side in ("left", "right"):
        assert joints[frame, INDEX[f"{side}_ankle"], 1] > motion.skeleton.ankle_height + 0.02
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    assert rotations.rotate(world[frame, INDEX["head"]], np.array([0.0, 0.0, 1.0]))[1] > 0.15
    assert motion.notes == ()
    assert [note.words for note in act("An act of reaching high", "shelf", "high").notes] == [
        "nothing overhead: no stretch"
    ]


def test_what_is_done_shows_in_the_other_arm() -> None:
    shapes = []
    for caption in (
        "pick up with the right hand",
        "put down with the right hand",
        "touch medium height with the right hand",
    ):
        motion = act(caption, "shelf", "medium")
        at = motion.joint_positions()[np.argmin(gap(motion))]
        shapes.append(at[INDEX["left_wrist"]] - at[INDEX["left_shoulder"]])
    for index, one in enumerate(shapes):
        for other in shapes[index + 1 :]:
            assert np.linalg.norm(one - other) > 0.05


def test_a_height_that_the_thing_lacks_is_said_and_no_other() -> None:
    said = [note.words for note in act("touch medium height", "low", "low").notes]
    assert said == ["nothing is there at medium height: it is done at low height"]
    assert act("touch medium height", "shelf", "medium").notes == ()
    assert act("turn on with the right hand", "low", "low").notes == ()
