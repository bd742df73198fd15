"""How people walk, whatever the caption, the home and the seed: hips, trunk, arms, knees and feet in their order."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from acted import Body, walked

from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import BEARINGS

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
    *product(("steadily walking forward",), sorted(set(BEARINGS) - {"drunk"}), ("small",), (4,)),
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
            against = together(body.before("left_shoulder", "right_shoulder"), body.before("left_hip", "right_hip"))
            found.append((name, against < -0.3, against))
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
        found.append((name, 0.002 < rise < 0.08, rise))
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
        found.append(((*name, "alike"), bool(abs(share[0] - share[1]) < 0.15 and 0.5 < share.mean() < 0.85), share))
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
            found.append(((*name, side, "toes"), bool(-8 < np.median(out) < 25), np.median(out)))
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
    mood = {emotion: walked("steadily walking forward", emotion, seed=4) for emotion in BEARINGS}
    speed = {emotion: pace(body) for emotion, body in mood.items()}
    head = {emotion: head_height(body) for emotion, body in mood.items()}
    lean = {emotion: float(body.lean(body.way)[body.middle].mean()) for emotion, body in mood.items()}
    assert speed["hurried"] > speed["happy"] > speed["neutral"] * 0.98
    assert speed["neutral"] > speed["tired"] > 0.4
    assert speed["neutral"] > speed["sad"] > 0.4
    assert speed["happy"] > 1.15 * speed["sad"]
    assert head["happy"] > head["neutral"] > max(head["sad"], head["tired"]) + 0.005
    assert lean["happy"] < lean["neutral"] < min(lean["sad"], lean["tired"], lean["angry"], lean["hurried"])
    assert -10 < lean["happy"]
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
