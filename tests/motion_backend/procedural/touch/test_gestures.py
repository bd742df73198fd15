"""What hands do: gestures of who sits, lies or stands, and what is done at a surface."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from for_each import for_each
from layers import sampled
from small_home import DIRECTOR, after, contact, small_home, to

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics import story_metrics
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.metrics.joint_speed import MOST as FASTEST
from motion_backend.metrics.joint_speed import fastest_joint
from motion_backend.metrics.skin_penetration import THIN, skin_penetration
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, PhaseKind, Skill
from motion_backend.procedural.emotion_style import Bearing, arm_poses
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_pose import PILLOWS, SURFACES
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.touch.gestures import gesture, gesture_names, gesture_table
from motion_backend.procedural.touch.hand_captions import handling_of, with_both_hands
from motion_backend.procedural.touch.hand_rests import HOLDS
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.scripts.captions import captions
from scene_graphs.meshes.convex_shapes import convex_shapes

HOME = small_home()
OBSTACLES = Obstacles.of_home(HOME)
LEFT, RIGHT = INDEX["left_wrist"], INDEX["right_wrist"]
SITTING = {
    "writing at the table, right hand moving": "write",
    "typing, both hands on the keyboard": "type",
    "playing a game, controller held in both hands": "game",
    "talking on the phone with the left hand": "call_left",
    "drinking from a cup in the right hand": "drink",
    "eating at the table, right hand to the mouth": "eat",
    "listening to music, both hands at the ears": "music",
    "playing the piano, both hands on the keys": "piano",
    "sitting still": "",
    "laughing while seated, hands on belly": "laugh",
    "crying while seated, face in both hands": "cry",
    "clapping while seated": "clap",
    "talking while seated, with both hands": "talk",
    "hugging to the chest while seated": "hug",
    "knitting, both hands in the lap": "knit",
    "playing with toys, both hands in front": "toys",
    "playing the guitar": "guitar",
    "looking at the phone while seated, in the right hand": "phone",
    "bending to the feet, both hands at the ankles": "feet",
    "yawning while seated, right hand at the mouth": "yawn_seated",
    "wiping the face while seated, with the right hand": "wipe_face",
    "praying while seated, palms together": "pray",
    "raising a cup while seated, in the right hand": "toast",
    "sighing while seated, shoulders sinking": "sigh_seated",
    "asleep in the seat, head sunk to the chest": "doze",
    "head on folded arms on the table": "sleep_on_arms",
}
SPOT = [caption for caption in captions()[Skill.LOCO] if walk_style(Emotion.NEUTRAL, caption).doing]
SPOT = [caption for caption in SPOT if walk_style(Emotion.NEUTRAL, caption).stays]
TOUCHING = {
    "pick up with the right hand": "pick",
    "put down with the left hand": "put",
    "turn on with the right hand": "press",
    "wash with both hands": "wash",
    "rotate with the right hand": "rotate",
    "knocking with the right hand": "knock",
    "slamming with the right hand": "strike",
    "stirring with the right hand": "stir",
    "pouring with the right hand": "pour",
    "wiping with the right hand": "wash",
    "touch medium height": "",
    "An act of reaching high": "",
}


@cache
def performed(action: Action) -> tuple[Motion, np.ndarray]:
    """The action after the walk to it: its motion and world joints (T, 22, 3)."""
    state = after(HOME) if action.skill is Skill.LOCO else after(HOME, to(action))
    motion, _ = DIRECTOR.act(HOME, replace(action, keyframe=1), state)
    return motion, motion.joint_positions().astype(np.float64)


def moved(joints: np.ndarray, hand: int, frames: int) -> float:
    """How far a wrist gets from its own mean in the last frames, seen from the chest and turning with it (metres)."""
    left, right, neck, chest = (
        joints[-frames:, INDEX[name]] for name in ("left_shoulder", "right_shoulder", "neck", "spine3")
    )
    aside = rotations.normalize(left - right)
    ahead = rotations.normalize(np.cross(aside, neck - chest))
    axes = np.stack([aside, np.cross(ahead, aside), ahead], axis=1)
    way = np.einsum("tij,tj->ti", axes, joints[-frames:, hand] - chest)
    return float(np.linalg.norm(way - way.mean(axis=0), axis=1).max())


def seated(caption: str) -> tuple[Motion, np.ndarray]:
    return performed(replace(contact(HOME, Skill.SITDOWN, "chair", caption), hold=2.5))


@pytest.mark.parametrize("caption", sampled(list(SITTING), 3))
def test_a_caption_of_sitting_is_shown_by_the_hands(caption: str) -> None:
    style = sit_style(Emotion.NEUTRAL, caption)
    assert style.doing == SITTING[caption]
    assert all(arm in arm_poses() or arm in HOLDS or arm in SURFACES for arm in style.arms)
    motion, joints = seated(caption)
    figures = story_metrics.judge(
        motion, replace(contact(HOME, Skill.SITDOWN, "chair", caption), keyframe=1), OBSTACLES
    )
    assert figures.reached
    assert figures.pen_max <= 0.05
    busy = max(moved(joints, LEFT, 60), moved(joints, RIGHT, 60))
    still = style.doing in ("", "music", "hug", "doze", "sleep_on_arms")
    assert busy < 0.012 if still else 0.015 < busy < 0.45
    speed = np.linalg.norm(np.diff(joints[:, [LEFT, RIGHT]], axis=0), axis=-1) * 30
    assert speed.max() < 7.0


@pytest.mark.parametrize(
    "caption", ["drinking from a cup in the right hand", "eating at the table, right hand to the mouth"]
)
def test_a_cup_or_a_bite_comes_to_the_mouth_and_goes_back(caption: str) -> None:
    _, joints = seated(caption)
    gap = np.linalg.norm(joints[-75:, RIGHT] - joints[-75:, INDEX["head"]], axis=1)
    assert gap.min() < 0.27
    assert gap[0] > gap.min() + 0.08
    assert gap[-1] > gap.min() + 0.08


def test_hands_at_the_ears_and_the_phone_are_where_the_caption_says() -> None:
    _, listening = seated("listening to music, both hands at the ears")
    _, phoning = seated("talking on the phone with the left hand")
    for joints, hands in ((listening, (LEFT, RIGHT)), (phoning, (LEFT,))):
        for hand in hands:
            assert np.linalg.norm(joints[-20, hand] - joints[-20, INDEX["head"]]) < 0.25
    assert np.linalg.norm(phoning[-20, RIGHT] - phoning[-20, INDEX["head"]]) > 0.4


def test_who_lies_still_hardly_moves_and_who_reads_holds_a_book_up() -> None:
    _, still = performed(replace(contact(HOME, Skill.LIEDOWN, "bed", "lying still"), hold=2.0))
    assert np.abs(np.diff(still[-50:], axis=0)).max() < 0.004
    _, reads = performed(contact(HOME, Skill.LIEDOWN, "bed", "reading on the back, book held above the chest"))
    assert (reads[-10, [LEFT, RIGHT], 1] > reads[-10, INDEX["spine3"], 1] + 0.15).all()
    assert lie_style(Emotion.NEUTRAL, "hands on belly").arms == ("belly", "belly")


@pytest.mark.parametrize(("caption", "up"), [("stand still", False), ("wave with the right hand", True)])
def test_a_body_without_a_goal_stays_where_it_is(caption: str, up: bool) -> None:
    motion, joints = performed(Action(Skill.LOCO, caption, Emotion.NEUTRAL, hold=2.0))
    assert motion.completed
    assert a_foot_bears(motion).all()
    assert np.linalg.norm(joints[:, 0] - joints[0, 0], axis=1).max() < 0.08
    assert (joints[:, RIGHT, 1].max() > joints[0, INDEX["head"], 1] - 0.15) == up
    assert joints[:, LEFT, 1].max() < joints[0, INDEX["spine3"], 1]
    assert joints[-1, RIGHT, 1] < joints[0, INDEX["spine1"], 1]


@for_each("caption", SPOT)
def test_who_does_something_on_the_spot_is_seen_to_do_it_and_ends_where_they_stood(caption: str) -> None:
    style = walk_style(Emotion.NEUTRAL, caption)
    mood = list(Emotion)[len(caption) % len(Emotion)]
    action = Action(Skill.LOCO, caption, mood, hold=style.stays, keyframe=1)
    motion, joints = performed(action)
    verdict = judge_caption(motion, action)
    assert verdict is not None
    assert verdict.missed == (), (mood, verdict.missed)
    assert fastest_joint(motion.local_rotations, motion.fps)[1] < FASTEST
    off_floor = any(word in caption for word in ("jump", "kneeling", "running", "push-ups"))
    assert a_foot_bears(motion).all() if not off_floor else (motion.contacts == 0).any()
    # Who needs room goes there first.
    first = next(phase.start for phase in reversed(motion.phases) if phase.kind is PhaseKind.STAND)
    feet = joints[:, [INDEX["left_ankle"], INDEX["right_ankle"]]]
    assert np.linalg.norm(feet[-1] - feet[first], axis=-1).max() < 0.04
    # Arms hang again, and the trunk is as it was.
    axes = slice(1, 2) if first else slice(None)
    hung = joints[-1, [LEFT, RIGHT], axes] - joints[0, [LEFT, RIGHT], axes]
    assert np.linalg.norm(hung, axis=-1).max() < 0.12


def test_who_waits_steps_away_and_back_and_looks_at_the_watch() -> None:
    motion, joints = performed(Action(Skill.LOCO, "stand still, waiting", Emotion.NEUTRAL, hold=6.0, keyframe=1))
    assert a_foot_bears(motion).all()
    lifted = motion.contacts[:, :2].max(axis=1) == 0
    assert np.count_nonzero(np.diff(lifted.astype(int)) == 1) >= 2  # the left foot, there and back
    ankle = joints[:, INDEX["left_ankle"]]
    assert np.linalg.norm(ankle - ankle[0], axis=1).max() > 0.08
    watch = np.linalg.norm(joints[:, LEFT] - joints[:, INDEX["head"]], axis=1)
    assert watch.min() < 0.5 < watch[0]


def a_foot_bears(motion: Motion) -> Array:
    """In which frames a foot is on the floor: who stands sets now and then one anew. (T,)."""
    return np.asarray(motion.contacts.max(axis=1) == 1)


def test_who_jumps_falls_as_everything_falls() -> None:
    """Between take-off and landing the pelvis rises and sinks again at about 9.8 m/s², and no foot is on the floor."""
    action = Action(Skill.LOCO, "jumping up and down", Emotion.HAPPY, hold=3.6, keyframe=1)
    motion, joints = performed(action)
    flying = motion.contacts.max(axis=1) == 0
    starts = np.flatnonzero(np.diff(flying.astype(int)) == 1) + 1
    assert len(starts) >= 2
    for start in starts:
        stop = start + int(np.argmin(flying[start:]))
        time = np.arange(stop - start) / motion.fps
        curve = np.polyfit(time, joints[start:stop, 0, 1], 2)
        assert 0.2 < time[-1] < 0.5
        assert -2 * curve[0] == pytest.approx(9.8, rel=0.25)


def test_who_kneels_is_on_both_knees_on_the_heels_and_up_again() -> None:
    _, joints = performed(
        Action(Skill.LOCO, "kneeling on the floor, hands on thighs", Emotion.SAD, hold=9.0, keyframe=1)
    )
    knees = joints[:, [INDEX["left_knee"], INDEX["right_knee"]], 1]
    # One knee after the other goes down, and comes up.
    down = np.asarray(knees < 0.12)
    assert down.all(axis=1).mean() > 0.3
    assert (down.sum(axis=1) == 1).any()
    low = joints[:, 0, 1] < 0.4
    assert low.any()
    assert np.asarray(down.all(axis=1))[low].all()
    assert joints[-1, 0, 1] == pytest.approx(joints[0, 0, 1], abs=0.02)


def test_where_no_table_is_it_is_said_that_no_head_lies_on_it() -> None:
    caption = "head on folded arms on the table"
    motion, _ = seated(caption)
    assert any("no table" in note.words for note in motion.notes)
    assert sit_style(Emotion.NEUTRAL, caption).arms == PILLOWS


def test_who_goes_somewhere_to_do_it_there_walks_there_as_one_walks() -> None:
    spot = contact(HOME, Skill.TOUCH, "table", "x").spot
    assert spot is not None
    action = Action(Skill.LOCO, "clapping hands", Emotion.NEUTRAL, goal=spot.standing, stands=3.0, keyframe=1)
    motion, joints = performed(action)
    apart = np.linalg.norm(joints[:, LEFT] - joints[:, RIGHT], axis=1)
    walk = [phase for phase in motion.phases if phase.kind is PhaseKind.WALK]
    assert apart[walk[0].start : walk[-1].stop].min() > 0.3
    assert apart[walk[-1].stop :].min() < 0.2
    assert np.linalg.norm(joints[-1, 0, [0, 2]] - spot.standing) < 0.1


@pytest.mark.parametrize(
    ("caption", "name"),
    sampled([*((c, "table") for c in TOUCHING), *((c, "shelf") for c in list(TOUCHING)[2:5])], 2),
)
def test_whatever_is_done_at_a_surface_reaches_it_cleanly(caption: str, name: str) -> None:
    assert handling_of(caption) == TOUCHING[caption]
    action = replace(contact(HOME, Skill.TOUCH, name, caption), hand="left" if "left" in caption else "right")
    motion, joints = performed(action)
    figures = story_metrics.judge(motion, replace(action, keyframe=1), OBSTACLES)
    assert figures.reached
    goal = np.array(motion.goals[0].position)
    wrist = LEFT if action.hand == "left" else RIGHT
    # A hand whose wrist cannot bend as far comes off rather than have its fingers in the thing.
    assert np.linalg.norm(joints[:, wrist] - goal, axis=1).min() < 0.02
    assert skin_penetration(motion, action, convex_shapes(HOME, THIN)).most < 0.03
    assert figures.pen_max <= 0.05
    speed = np.linalg.norm(np.diff(joints[:, [LEFT, RIGHT]], axis=0), axis=-1) * 30
    assert speed.max() < 7.0


def test_both_hands_wash_the_table_side_by_side() -> None:
    _, joints = performed(contact(HOME, Skill.TOUCH, "table", "wash with both hands"))
    spot = contact(HOME, Skill.TOUCH, "table", "x").spot
    assert spot is not None
    goal = np.asarray(spot.point)
    low = np.abs(joints[:, [LEFT, RIGHT], 1] - goal[1]).max(axis=1) < 0.08
    assert low.sum() > 45
    apart = np.linalg.norm(joints[low][:, LEFT] - joints[low][:, RIGHT], axis=1)
    assert apart.min() > 0.08
    assert moved(joints[low], RIGHT, 45) > 0.02


def test_what_is_picked_up_is_held_before_the_body() -> None:
    _, picked = performed(contact(HOME, Skill.TOUCH, "table", "pick up with the right hand"))
    _, touched = performed(contact(HOME, Skill.TOUCH, "table", "touch medium height"))
    assert picked[-1, RIGHT, 1] > touched[-1, RIGHT, 1] + 0.15
    assert picked[-1, LEFT, 1] == pytest.approx(touched[-1, LEFT, 1], abs=0.05)


def test_what_is_picked_up_is_carried_on_the_way_until_it_is_put_down() -> None:
    backend, pick = DIRECTOR, contact(HOME, Skill.TOUCH, "table", "pick up with the right hand")
    put = contact(HOME, Skill.TOUCH, "shelf", "put down with the right hand")
    state = backend.begin(HOME, Character(), 3)
    least = []
    for action in (to(pick), pick, to(put), put, to(pick)):
        motion, state = backend.act(HOME, action, state)
        joints = motion.joint_positions().astype(np.float64)
        least.append(float((joints[:, RIGHT, 1] - joints[:, INDEX["spine1"], 1]).min()))
    assert max(least[0], least[4]) < -0.1
    assert least[2] > 0.05
    assert joints[-1, RIGHT, 1] < joints[-1, INDEX["spine1"], 1]


@pytest.mark.parametrize("caption", ["writing at the table", "typing", "eating at the table"])
def test_who_writes_types_or_eats_has_it_on_the_lap(caption: str) -> None:
    _, joints = seated(caption)
    held = joints[-60]
    for name, hand in (("left", LEFT), ("right", RIGHT))[: 1 if "eating" in caption else 2]:
        thigh = held[[INDEX[f"{name}_hip"], INDEX[f"{name}_knee"]]]
        assert thigh[:, 1].max() < held[hand, 1] < thigh[:, 1].max() + 0.20
        assert np.linalg.norm(held[hand] - thigh[1]) < 0.30


@pytest.mark.parametrize("height", [1.5, 1.9])
def test_a_body_of_other_height_steps_straight_to_where_it_sits_down(height: float) -> None:
    action = contact(HOME, Skill.SITDOWN, "chair", "sitting still")
    motion, _ = DIRECTOR.act(HOME, action, after(HOME, to(action), height=height))
    assert action.spot is not None
    x, _, z = action.spot.point
    # The seat faces along z: to the sides there is only the weight that goes over either foot.
    assert np.abs(motion.root_positions[:, 0] - x).max() < 0.04
    assert np.abs(np.diff(motion.root_positions[:, 2])).sum() < 0.42 * height / 1.7 + 0.08
    assert motion.root_positions[-1, 2] == pytest.approx(z, abs=0.02)


@for_each("doing", [*gesture_names(), "", "juggle"])
def test_a_gesture_begins_and_ends_in_the_held_pose(doing: str) -> None:
    pose = standing((0.0, 0.0), 0.0, replace(Bearing(), arms=("desk", "desk")), build_skeleton(1.7))
    move = gesture_table().moves.get(doing)
    pose = pose.repeat(80 if move is None else max(80, round(move.every_s * FPS)))
    made = gesture(pose, doing)
    assert np.isfinite(made.arms).all()
    np.testing.assert_allclose(made.arms[-1], pose.arms[-1], atol=1e-9)
    np.testing.assert_allclose(made.arms[0], pose.arms[0], atol=0.02)


def test_words_about_hands_are_read() -> None:
    assert with_both_hands("wash with both hands")
    assert not with_both_hands("wash with the right hand")
    assert walk_style(Emotion.NEUTRAL, "wave with the left hand").bearing.arms == ("wave", "hang")
    assert walk_style(Emotion.NEUTRAL, "walk").doing == ""
