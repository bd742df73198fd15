"""How people walk, whatever the caption, the home and the seed: hips, trunk, arms, knees and feet in their order."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from acted import Body, walked

from motion_backend.metrics.gait_features import UNITS, gait_features, windows
from motion_backend.motion import FPS, Emotion

PLAIN = (
    "steadily walking forward",
    "angrily walking",
    "head bowed and body bent while walking",
    "uplifted head walking",
    "walk with large steps",
    "walk with depression",
    "strolling with hands in pockets",
)
HIGH = ("marching with swinging arms", "stomping heavily")
"""Feet that come down flat."""
WALKS = [
    *product((*PLAIN, *HIGH), ("neutral",), ("small",), (3,)),
    *product((*PLAIN[:1], *PLAIN[4:6]), ("neutral",), ("hall",), (6,)),
    *product(("steadily walking forward",), sorted(set(Emotion) - {Emotion.DRUNK}), ("small",), (4,)),
]
"""Drunks sway too much for any of it."""
SIDES = ("left", "right")


def walks(captions: tuple[str, ...] = (*PLAIN, *HIGH)) -> list[tuple[tuple[str, ...], Body]]:
    """Those with some of the captions, with what they are called."""
    return [(tuple(map(str, walk)), walked(*walk)) for walk in WALKS if walk[0] in captions]


def together(one: np.ndarray, other: np.ndarray) -> float:
    """Correlation: 1 for what goes to and fro as one, -1 for what goes against each other."""
    return float(np.corrcoef(one, other)[0, 1])


def failures(found: Sequence[tuple[tuple[str, ...], object, object]]) -> list[tuple[tuple[str, ...], object]]:
    """What is not so, with its figure."""
    return [(name, figure) for name, fine, figure in found if not fine]


def test_the_hip_of_the_swinging_leg_goes_forward_with_it() -> None:
    found = []
    for name, body in walks():
        legs, hips = body.before("left_ankle", "right_ankle"), body.before("left_hip", "right_hip")
        turn = np.degrees(np.ptp(hips) / np.linalg.norm(body.at("left_hip")[0] - body.at("right_hip")[0]))
        figure = together(legs, hips), turn
        found.append((name, figure[0] > 0.8 and 3 < figure[1] < 45, figure))
    assert failures(found) == []


def test_the_chest_turns_against_the_pelvis() -> None:
    found = []
    for name, body in walks(PLAIN[:1] + PLAIN[3:5] + HIGH):
        if name[1] in ("neutral", "happy", "angry", "hurried"):
            hips = body.before("left_hip", "right_hip") / np.linalg.norm(
                body.at("left_hip")[0] - body.at("right_hip")[0]
            )
            across = body.at("left_shoulder")[0] - body.at("right_shoulder")[0]
            against = together(body.before("left_shoulder", "right_shoulder") / np.linalg.norm(across) - hips, hips)
            found.append((name, against < -0.5, against))
    assert found
    assert failures(found) == []


def test_each_arm_swings_with_the_other_leg() -> None:
    found = []
    for name, body in walks(tuple(caption for caption in (*PLAIN, *HIGH) if "pockets" not in caption)):
        for side, other in (("left", "right"), ("right", "left")):
            leg = body.before(f"{other}_ankle", f"{side}_ankle")
            with_it = together(body.before(f"{side}_wrist", f"{side}_shoulder"), leg)
            found.append(((*name, side), with_it > 0.4, with_it))
    assert failures(found) == []


def test_the_pelvis_is_highest_over_the_standing_foot_and_lowest_when_both_stand() -> None:
    found = []
    for name, body in walks():
        apart, height = np.abs(body.before("left_ankle", "right_ankle")), body.at("pelvis")[body.middle, 1]
        rise = height[apart < 0.3 * apart.max()].mean() - height[apart > 0.85 * apart.max()].mean()
        found.append((name, 0.002 < rise < 0.082, rise))
    assert failures(found) == []


def test_the_knee_bends_more_in_swing_than_in_stance_and_not_backwards() -> None:
    found = []
    for name, body in walks():
        for side, planted in zip(SIDES, body.planted[body.middle].T, strict=True):
            knee = body.knee(side)[body.middle]
            figure = knee[~planted].max(), knee[planted].max()
            found.append(((*name, side), figure[0] > figure[1] + 15 and figure[0] < 130, figure))
            ahead = body.before(f"{side}_knee", f"{side}_hip") - body.before(f"{side}_ankle", f"{side}_hip") * 0.5
            found.append(((*name, side, "forwards"), ahead.min() > -0.03, ahead.min()))
    assert failures(found) == []


def test_the_heel_comes_down_before_the_toes_and_leaves_before_them() -> None:
    found = []
    for name, body in walks(PLAIN):
        soles = body.kinematics.soles[:, :, :2, 1]  # (T, feet, heel and toe tip)
        for foot, side in enumerate(SIDES):
            planted = body.planted[:, foot]
            inside = slice(body.middle.start, body.middle.stop)
            landing = np.flatnonzero(planted[1:] & ~planted[:-1])[:-1] + 1
            leaving = np.flatnonzero(~planted[1:] & planted[:-1])[1:]
            for what, frames, sign in (("lands", landing, 1), ("leaves", leaving, -1)):
                for frame in frames[(frames >= inside.start) & (frames < inside.stop)]:
                    tilt = sign * (soles[frame, foot, 1] - soles[frame, foot, 0])
                    found.append(((*name, side, what), tilt > 0.02, tilt))
    assert len(found) > 60
    assert failures(found) == []


def test_feet_take_turns_and_one_of_them_always_stands() -> None:
    found = []
    for name, body in walks():
        planted = body.planted[body.middle]
        found.append(((*name, "stands"), bool(planted.any(axis=1).all()), planted.any(axis=1).mean()))
        landed = sorted((frame, foot) for foot in (0, 1) for frame in np.flatnonzero(np.diff(planted[:, foot] * 1) > 0))
        feet = [foot for _, foot in landed]
        found.append(((*name, "turns"), feet == [(feet[0] + step) % 2 for step in range(len(feet))], feet))
        share = planted.mean(axis=0)
        found.append(((*name, "alike"), bool(abs(share[0] - share[1]) < 0.17 and 0.5 < share.mean() < 0.85), share))
    assert failures(found) == []


def test_a_planted_foot_does_not_move() -> None:
    found = []
    for name, body in walks():
        for foot, side in enumerate(SIDES):
            standing = body.planted[1:, foot] & body.planted[:-1, foot]
            pace = np.linalg.norm(np.diff(body.at(f"{side}_foot")[:, [0, 2]], axis=0), axis=1)[standing] * FPS
            found.append(((*name, side), bool(np.median(pace) < 0.01 and np.quantile(pace, 0.98) < 0.45), pace.max()))
    assert failures(found) == []


def test_the_body_faces_where_it_goes() -> None:
    found = []
    for name, body in walks():
        for joint, least in (("pelvis", 0.9), ("spine3", 0.9), ("head", 0.8)):
            front = body.axis(joint, (0.0, 0.0, 1.0))[body.middle] * [1.0, 0.0, 1.0]
            along = (front @ body.way / np.linalg.norm(front, axis=1)).min()
            found.append(((*name, joint), along > least, along))
    assert failures(found) == []


def test_feet_point_ahead_and_a_little_outwards_beside_the_line_of_the_way() -> None:
    found = []
    for name, body in walks():
        left_of_way = np.array([body.way[2], 0.0, -body.way[0]])
        for side, sign in (("left", 1), ("right", -1)):
            foot = (body.at(f"{side}_foot") - body.at(f"{side}_ankle"))[body.middle]
            out = np.degrees(np.arctan2(sign * (foot @ left_of_way), foot @ body.way))[
                body.planted[body.middle, SIDES.index(side)]
            ]
            found.append(((*name, side, "toes"), bool(-14 < np.median(out) < 25), np.median(out)))
            beside = sign * ((body.at(f"{side}_ankle") - body.at("pelvis"))[body.middle] @ left_of_way)
            found.append(((*name, side, "beside"), bool(0.01 < np.median(beside) < 0.16), np.median(beside)))
    assert failures(found) == []


def test_head_and_trunk_stay_nearly_level_in_a_plain_walk() -> None:
    body = walked("steadily walking forward", home="hall")
    for joint in ("head", "spine3"):
        up = body.axis(joint, (0.0, 1.0, 0.0))[body.middle]
        assert up[:, 1].min() > np.cos(np.radians(15))
    assert np.ptp(body.at("head")[body.middle, 1]) < 0.07


def pace(body: Body) -> float:
    ground = body.at("pelvis")[body.middle][:, [0, 2]]
    return float(np.linalg.norm(np.diff(ground, axis=0), axis=1).mean() * FPS)


def head_height(body: Body) -> float:
    return float((body.at("head") - body.at("pelvis"))[body.middle, 1].mean())


def test_moods_are_seen_in_pace_and_bearing() -> None:
    mood = {emotion.value: walked("steadily walking forward", emotion, seed=4) for emotion in Emotion}
    speed = {emotion: pace(body) for emotion, body in mood.items()}
    head = {emotion: head_height(body) for emotion, body in mood.items()}
    lean = {emotion: float(body.lean(body.way)[body.middle].mean()) for emotion, body in mood.items()}
    assert speed["hurried"] > speed["happy"] > speed["neutral"] * 0.98
    assert speed["neutral"] > speed["tired"] > 0.4
    assert speed["neutral"] > speed["sad"] > 0.4
    assert speed["happy"] > 1.15 * speed["sad"]
    assert head["happy"] > head["neutral"] > max(head["sad"], head["tired"]) + 0.005
    look = {mood: body.axis("head", (0.0, 0.0, 1.0))[body.middle, 1].mean() for mood, body in mood.items()}
    assert look["happy"] > look["relaxed"] > look["neutral"] > look["tired"] > look["sad"]
    assert lean["happy"] < lean["neutral"] < min(lean["sad"], lean["tired"], lean["angry"], lean["hurried"])
    assert lean["happy"] > -10
    assert max(lean.values()) < 30


def test_captions_are_seen_in_the_body() -> None:
    plain, at = walked("steadily walking forward"), walked
    up = {caption: at(caption).axis("head", (0.0, 0.0, 1.0))[plain.middle, 1].mean() for caption in PLAIN}
    assert up["uplifted head walking"] > up["steadily walking forward"] + 0.1
    assert up["head bowed and body bent while walking"] < up["steadily walking forward"] - 0.3
    assert head_height(at("head bowed and body bent while walking")) < head_height(plain) - 0.02
    assert at("walk with the body leaning back").lean(plain.way)[plain.middle].mean() < -4
    assert pace(at("walking quickly")) > 1.15 * pace(plain) > 1.3 * pace(at("walk with depression"))
    steps = {caption: np.ptp(at(caption).before("left_ankle", "right_ankle")) for caption in (PLAIN[0], PLAIN[4])}
    assert steps[PLAIN[4]] > 1.2 * steps[PLAIN[0]]
    for side in SIDES:
        bent = at("walk with knees bent").knee(side)[plain.middle].min()
        assert bent > plain.knee(side)[plain.middle].min() + 15


@pytest.mark.parametrize("height", [1.5, 1.9])
def test_longer_legs_make_longer_steps(height: float) -> None:
    plain, other = (walked(PLAIN[0], home="hall", height=tall) for tall in (1.7, height))
    steps = [np.ptp(body.before("left_ankle", "right_ankle")) for body in (plain, other)]
    assert (steps[1] > steps[0]) == (height > 1.7)
    assert 0.85 < (steps[1] / steps[0]) / (height / 1.7) < 1.15


PEOPLE = {
    "speed": (1.05, 1.4), "stride_length": (1.2, 1.5), "stride_rate": (0.8, 1.0), "step_width": (0.03, 0.16),
    "pelvis_bob": (0.01, 0.045), "lateral_sway": (0.025, 0.075), "trunk_pitch": (0.03, 0.11),
    "trunk_sway": (0.02, 0.09), "arm_swing_left": (0.2, 1.25), "arm_swing_right": (0.2, 1.25),
    "knee_range": (0.95, 1.2),
    "toe_clearance": (0.03, 0.075), "duty_factor": (0.55, 0.66), "double_support": (0.1, 0.26), "log_jerk": (4.0, 5.3),
    "pelvis_yaw": (0.05, 0.28),
}  # fmt: skip
"""Between what most adults of 1.70 m do who walk as they like to (metres, seconds, radians): who sets the feet close
together sways less."""


def test_a_neutral_walk_has_the_measures_of_people() -> None:
    for seed in (3, 6):
        body = walked("steadily walking forward", home="hall", seed=seed)
        positions = body.kinematics.positions
        told = [gait_features(positions[start:stop], FPS) for start, stop in windows(positions, FPS)]
        measures = np.mean([one for one in told if one is not None], axis=0)
        outside = {
            name: value
            for name, value in zip(UNITS, measures, strict=True)
            if not PEOPLE[name][0] < value < PEOPLE[name][1]
        }
        assert outside == {}


def test_thighs_elbows_and_shoulders_turn_as_far_as_those_of_people() -> None:
    body = walked("steadily walking forward", home="hall")
    for side in SIDES:
        ahead = body.before(f"{side}_knee", f"{side}_hip")
        down = (body.at(f"{side}_hip") - body.at(f"{side}_knee"))[body.middle, 1]
        thigh = np.degrees(np.arctan2(ahead, down))
        assert 28 < thigh.max() < 42
        assert -28 < thigh.min() < -12
        elbow = body.elbow(side)[body.middle]
        assert 8 < elbow.min() < 32
        assert 26 < elbow.max() < 55
        # An arm is bent most where it is farthest forward.
        assert together(elbow, body.before(f"{side}_wrist", f"{side}_shoulder")) > 0.7
        assert 0.19 < body.at(f"{side}_ankle")[body.middle, 1].max() < 0.28
        hand = (body.at(f"{side}_wrist") - body.at("pelvis"))[body.middle] @ np.array([body.way[2], 0.0, -body.way[0]])
        assert 0.2 < np.abs(hand).mean() < 0.36
    chest = np.degrees(np.ptp(body.before("left_shoulder", "right_shoulder")) / 0.36)
    assert 3 < chest < 10


def test_how_far_one_goes_in_a_step_and_how_quickly_grow_together() -> None:
    paces = [walked(caption, home="hall") for caption in ("walk with depression", PLAIN[0], "walking quickly")]
    speed, rate, swing = [], [], []
    for body in paces:
        positions = body.kinematics.positions
        told = [gait_features(positions[start:stop], FPS) for start, stop in windows(positions, FPS)]
        mean = dict(zip(UNITS, np.mean([one for one in told if one is not None], axis=0), strict=True))
        speed.append(mean["stride_length"])
        rate.append(mean["stride_rate"])
        swing.append(mean["arm_swing_left"])
    for grows in (speed, rate, swing):
        assert grows[0] < grows[1] < grows[2]
    assert 1.4 < speed[2] < 1.8
    assert 0.95 < rate[2] < 1.2
    assert 0.6 < speed[0] < 1.0


def test_a_walk_starts_and_ends_standing_and_neither_lunges_nor_stops_dead() -> None:
    for caption in (*PLAIN[:2], *HIGH, PLAIN[5]):
        body = walked(caption)
        ground = np.linalg.norm(np.diff(body.at("pelvis")[:, [0, 2]], axis=0), axis=1) * FPS
        assert ground[:2].max() < 0.35
        assert ground[-4:].max() < 0.15
        change = np.abs(np.diff(np.convolve(ground, np.ones(8) / 8, "valid"))).max() * FPS
        assert change < 5.0, caption
        for side, sign in (("left", 1), ("right", -1)):
            foot = body.at(f"{side}_ankle")[-1] - body.at("pelvis")[-1]
            facing = body.axis("pelvis", (1.0, 0.0, 0.0))[-1]
            assert 0.05 < sign * (foot @ facing) < 0.13
        assert 0.96 < body.at("pelvis")[-1, 1] / body.motion.skeleton.standing_height <= 1.0
        assert np.linalg.norm(body.at("pelvis")[-1, [0, 2]] - np.array(body.action.goal)) < 0.06
