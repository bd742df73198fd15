"""The procedural body: planted feet, exact contacts, no furniture crossed, and the same bytes for the same seed."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from for_each import for_each
from layers import sampled
from small_home import DIRECTOR, after, contact, rise, small_home, to

from motion_backend.backend_protocol import BodyState
from motion_backend.body.scene_collision import Obstacles
from motion_backend.director import Director
from motion_backend.metrics import story_metrics
from motion_backend.metrics.contact_error import risen
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.smoothness import seam_jump
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, Posture, Skill, join
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.skeleton import INDEX
from scene_graphs.home import Home

HOME = small_home()
OBSTACLES = Obstacles.of_home(HOME)


def perform(actions: list[Action], seed: int = 3, height: float = 1.70) -> tuple[list[Motion], BodyState]:
    backend = Director(ProceduralBackend())
    state = backend.begin(HOME, Character(height=height), seed)
    motions = []
    for index, action in enumerate(actions):
        motion, state = backend.act(HOME, replace(action, keyframe=index), state)
        motions.append(motion)
    return motions, state


def day() -> list[Action]:
    """A little of everything."""
    high = contact(HOME, Skill.TOUCH, "shelf", "An act of reaching high")
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "hands behind head, lean back", Emotion.RELAXED)
    bed = contact(HOME, Skill.LIEDOWN, "bed", "lying down, legs straight", Emotion.TIRED)
    chair = contact(HOME, Skill.SITDOWN, "chair", "supporting head with hands, head bowed", Emotion.SAD)
    table = contact(HOME, Skill.TOUCH, "table", "touch medium height", Emotion.SAD)
    return [
        to(high, "excited walk", Emotion.HAPPY), high, to(sofa), sofa, rise(sofa),
        to(bed, "walking drunkenly", Emotion.DRUNK), bed, rise(bed, Skill.GETUP),
        to(chair, "walk on tiptoes"), chair, rise(chair), to(table, "walk with depression", Emotion.SAD), table,
    ]  # fmt: skip


@cache
def motions() -> list[Motion]:
    """The day as it is done."""
    return perform(day())[0]


@for_each("index", range(13))
def test_every_action_of_a_day_is_reached_cleanly(index: int) -> None:
    action = replace(day()[index], keyframe=index)
    figures = story_metrics.judge(motions()[index], action, OBSTACLES)
    assert figures.reached, figures
    assert figures.contact_error is None or figures.contact_error < 0.01
    if action.skill is Skill.LOCO:
        assert figures.slip < 5.0, "recorded walkers slip at 3.4"
    else:
        assert figures.skate_ratio <= 0.06
    assert figures.skate < 4.0
    assert figures.pen_mean <= 0.01
    assert figures.pen_max <= 0.05
    assert figures.floor_pen < 0.005


def test_segments_join_without_a_jump() -> None:
    assert seam_jump(join(motions())) < 0.06


def test_no_joint_ever_snaps() -> None:
    positions = join(motions()).joint_positions().astype(np.float64)
    speed = np.linalg.norm(np.diff(positions, axis=0), axis=-1) * 30
    hands = [INDEX["left_wrist"], INDEX["right_wrist"], INDEX["left_elbow"], INDEX["right_elbow"]]
    assert speed[:, hands].max() < 7.0
    assert speed.max() < 9.0


def test_planted_feet_do_not_move() -> None:
    whole = join(motions())
    positions = whole.joint_positions().astype(np.float64)
    toes = positions[:, [INDEX["left_foot"], INDEX["right_foot"]]]
    step = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1)
    planted = whole.contacts[:, [1, 3]]
    standing = (planted[1:] > 0) & (planted[:-1] > 0)
    # A heel strike rolls the ball forward by a centimetre or two while the foot already counts as planted.
    assert np.quantile(step[standing], 0.99) < 0.012
    assert standing.mean() > 0.5


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_body() -> None:
    again, _ = perform(day()[:2])
    other, _ = perform(day()[:1], seed=4)
    for first, second in zip(motions()[:2], again, strict=True):
        assert first.root_positions.tobytes() == second.root_positions.tobytes()
        assert first.local_rotations.tobytes() == second.local_rotations.tobytes()
    assert other[0].root_positions.tobytes() != motions()[0].root_positions.tobytes()


def test_any_segment_can_be_made_again_from_a_stored_state() -> None:
    backend = Director(ProceduralBackend())
    actions = day()
    state = backend.begin(HOME, Character(), 3)
    for action in actions[:3]:
        _, state = backend.act(HOME, action, state)
    restored = BodyState.from_dict(json.loads(json.dumps(state.to_dict())))
    fresh, _ = Director(ProceduralBackend()).act(HOME, actions[3], restored)
    np.testing.assert_array_equal(fresh.local_rotations, motions()[3].local_rotations)


@pytest.mark.parametrize(("height", "count"), sampled([(1.45, 4), (1.45, 13), (1.95, 13)], 3))
def test_short_and_tall_bodies_reach_too(height: float, count: int) -> None:
    actions = day()[:count]
    motions, _ = perform(actions, height=height)
    for index, (motion, action) in enumerate(zip(motions, actions, strict=True)):
        figures = story_metrics.judge(motion, replace(action, keyframe=index), OBSTACLES)
        assert figures.reached, figures


def test_a_seated_body_stands_up_before_it_walks() -> None:
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "hands on thighs")
    motions, state = perform([sofa, Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(3.0, 3.0))])
    assert state.posture is Posture.STANDING
    assert risen(Kinematics.of(motions[1]))[-1]


def test_a_body_remembers_what_it_rests_on() -> None:
    bed = contact(HOME, Skill.LIEDOWN, "bed", "legs straight")
    _, state = perform([bed])
    assert (state.posture, state.rest) == (Posture.LYING, bed.spot)


def test_a_place_that_cannot_be_reached_is_said_and_not_faked() -> None:
    motions, state = perform([Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(30.0, 30.0))])
    assert not motions[0].completed
    assert "30" in motions[0].reason
    assert state.posture is Posture.STANDING


def test_an_action_without_a_place_is_not_completed() -> None:
    motions, _ = perform([Action(Skill.SITDOWN, "sit", Emotion.NEUTRAL)])
    assert not motions[0].completed


def test_a_held_pose_is_alive() -> None:
    held = motions()[3].joint_positions().astype(np.float64)[-35:]
    assert 1e-4 < np.linalg.norm(np.diff(held, axis=0), axis=-1).max() < 0.02


def walked(caption: str, emotion: str) -> Motion:
    start = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(2.6, 2.6), facing=0.0)
    way = Action(Skill.LOCO, caption, Emotion(emotion), goal=(4.2, 2.9))
    return perform([start, way])[0][1]


def mean_speed(motion: Motion) -> float:
    root = motion.root_positions.astype(np.float64)
    return float(np.linalg.norm(np.diff(root[:, [0, 2]], axis=0), axis=1).sum() * 30 / len(root))


@for_each(
    ("caption", "emotion"),
    [("walk", "neutral"), ("walk", "hurried"), ("walk with depression", "sad"), ("walk on tiptoes", "neutral")],
)
def test_nobody_lunges_into_a_walk(caption: str, emotion: str) -> None:
    height = walked(caption, emotion).root_positions[:, 1].astype(np.float64)
    assert height[:60].min() > 0.92 * np.median(height)
    assert np.abs(np.diff(height, n=2)).max() * 900 < 40


@for_each("caption", ["walk", "run and spin"])
@for_each("distance", [0.2, 1.4])
def test_every_walk_ends_on_both_feet(caption: str, distance: float) -> None:
    start = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(2.6, 2.6), facing=0.0)
    motions, _ = perform([start, Action(Skill.LOCO, caption, Emotion.HAPPY, goal=(2.6, 2.6 + distance), facing=0.0)])
    motion = motions[1]
    positions = motion.joint_positions().astype(np.float64)[-1]
    assert motion.contacts[-1].min() == 1
    for side, sign in (("left", 1), ("right", -1)):
        ankle = positions[INDEX[f"{side}_ankle"]]
        assert ankle[1] == pytest.approx(motion.skeleton.ankle_height, abs=0.008)
        assert ankle[0] - positions[0, 0] == pytest.approx(sign * 0.085, abs=0.03)
        assert ankle[2] - positions[0, 2] == pytest.approx(0.0, abs=0.03)


def test_standing_knees_are_nearly_straight() -> None:
    positions = motions()[2].joint_positions().astype(np.float64)[-1]
    for side in ("left", "right"):
        thigh = positions[INDEX[f"{side}_knee"]] - positions[INDEX[f"{side}_hip"]]
        shin = positions[INDEX[f"{side}_ankle"]] - positions[INDEX[f"{side}_knee"]]
        bent = np.degrees(np.arccos(thigh @ shin / np.linalg.norm(thigh) / np.linalg.norm(shin)))
        assert bent < 16


def test_emotions_show_in_speed_and_posture() -> None:
    happy, sad, hurried = (walked("walk", emotion) for emotion in ("happy", "sad", "hurried"))
    assert mean_speed(hurried) > mean_speed(happy) > mean_speed(sad)

    def bow(motion: Motion) -> float:
        positions = motion.joint_positions().astype(np.float64)
        rise = positions[:, INDEX["head"], 1] - positions[:, 0, 1]
        return float(np.median(rise))

    assert bow(happy) > bow(sad) + 0.015


def test_captions_change_what_is_seen() -> None:
    assert walk_style(Emotion.NEUTRAL, "walk on tiptoes").tiptoe > 0
    assert walk_style(Emotion.HAPPY, "run and spin").spin > 0
    assert sit_style(Emotion.NEUTRAL, "arms crossed, straight legs, feet crossed").legs == "feet_crossed"
    assert lie_style(Emotion.NEUTRAL, "side-lie on left, legs bent").side == "left"
    assert lie_style(Emotion.NEUTRAL, "side-lying on right").side == "right"


def test_a_home_is_not_changed_by_acting_in_it() -> None:
    before: Home = small_home()
    assert before == HOME


@for_each("emotion", list(Emotion))
def test_a_story_that_ends_on_its_feet_ends_in_a_pose_of_its_mood_that_lives(emotion: Emotion) -> None:
    """Not as soon as the feet have come to a stand, with arms that still hang from the walk."""
    walk = Action(Skill.LOCO, "smoothly forward walk", emotion, goal=(3.2, 3.4))
    stops, stays = (DIRECTOR.act(HOME, action, after(HOME))[0] for action in (walk, replace(walk, stands=1.5)))
    assert len(stays) == len(stops) + round(1.5 * FPS)
    np.testing.assert_array_equal(stays.root_positions[: len(stops)], stops.root_positions)
    assert stays.contacts[len(stops) :].all()
    places = stays.joint_positions()[:, [INDEX["left_wrist"], INDEX["right_wrist"]]]
    assert np.linalg.norm(places[-1] - places[len(stops) - 1], axis=1).max() > 0.1, "a hand has gone where it rests"
    last = np.linalg.norm(np.diff(stays.joint_positions()[-10:], axis=0), axis=-1).max(axis=1) * FPS
    assert 0.005 < last.max() < 0.5


@for_each("caption", ["hands behind head, legs straight", "sitting with legs crossed"])
def test_one_foot_stands_while_a_sitter_takes_the_other_one_back_from_afar(caption: str) -> None:
    sit = contact(HOME, Skill.SITDOWN, "sofa", caption)
    motion, _ = DIRECTOR.act(HOME, rise(sit), after(HOME, sit))
    assert support_slip(Kinematics.of(motion.part(0, FPS))) < 2.0


@for_each("seed", [0, 1, 2, 3, 4, 5])
def test_who_has_stepped_up_to_a_thing_has_stepped_back_when_the_walk_begins(seed: int) -> None:
    """Else both feet are in the air at once, the one on its way back and the walk's first."""
    touch = contact(HOME, Skill.TOUCH, "table", "touch medium height")
    walk = Action(Skill.LOCO, "smoothly forward walk", Emotion.NEUTRAL, goal=(3.2, 3.0))
    touched, state = DIRECTOR.act(HOME, touch, after(HOME, to(touch), seed=seed), walk)
    motion = join([touched, DIRECTOR.act(HOME, walk, state)[0]])
    seam = len(touched)
    assert support_slip(Kinematics.of(motion.part(seam - 24, seam + 24))) < 1.0
