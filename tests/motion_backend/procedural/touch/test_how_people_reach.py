"""How people reach: the asked hand at the surface, the elbow bent, the trunk as low as the thing, the eyes on it."""

from __future__ import annotations

import numpy as np
import pytest
from acted import Body, touched

from motion_backend.body.joint_limits import limits_share
from motion_backend.motion import FPS
from motion_backend.rotations import normalize
from motion_backend.skeleton import HAND_REST, INDEX

REACHES = [
    ("shelf", "high", "An act of reaching high"),
    ("shelf", "medium", "touch medium height"),
    ("shelf", "low", "touch low height"),
    ("table", "medium", "touch medium height"),
]
HANDS = ("left", "right")


def reaches() -> list[tuple[str, Body]]:
    """Every reach with each hand."""
    return [(hand, touched(*reach, hand=hand)) for reach in REACHES for hand in HANDS]


def held(body: Body, hand: str) -> np.ndarray:
    """The frames in which the hand is there."""
    goal = np.array(body.motion.goals[0].position)
    return np.flatnonzero(np.linalg.norm(body.at(f"{hand}_wrist") - goal, axis=1) < 0.02)


def test_a_reach_ends_with_the_palm_at_the_surface_and_the_elbow_within_its_range() -> None:
    for hand, body in reaches():
        frames, spot = held(body, hand), body.action.spot
        assert spot is not None
        assert len(frames) >= FPS, body.action
        assert (np.diff(frames) == 1).all(), "it lets go in between"
        off = body.at(f"{hand}_wrist")[frames] - np.array(spot.point)
        assert np.abs(off @ np.array(spot.normal) - HAND_REST).max() < 0.02
        assert np.linalg.norm(off - HAND_REST * np.array(spot.normal), axis=1).max() < 0.02
        assert 15 < body.elbow(hand)[frames].min() <= body.elbow(hand)[frames].max() < 120
        assert limits_share(body.motion.local_rotations) <= 0.02


def test_the_other_hand_stays_away_and_the_named_one_comes_back() -> None:
    for hand, body in reaches():
        other = HANDS[1 - HANDS.index(hand)]
        goal = np.array(body.motion.goals[0].position)
        assert np.linalg.norm(body.at(f"{other}_wrist") - goal, axis=1).min() > 0.2
        assert np.linalg.norm(body.at(f"{hand}_wrist")[-1] - goal) > 0.3
        assert np.linalg.norm(body.at(f"{hand}_wrist")[0] - goal) > 0.3
        for side in HANDS:
            assert body.at(f"{side}_wrist")[-1, 1] < body.at("pelvis")[-1, 1] + 0.1


def test_the_lower_the_thing_the_lower_the_body() -> None:
    for hand in HANDS:
        high, medium, low = (touched(*reach, hand=hand) for reach in REACHES[:3])
        at = [body.at("head")[held(body, hand)].mean(axis=0)[1] for body in (high, medium, low)]
        assert at[0] > at[1] > at[2] + 0.2
        lean = [body.lean(body.facing)[held(body, hand)].mean() for body in (high, medium, low)]
        assert lean[0] < 15
        assert lean[0] < lean[1] < lean[2] < 80
        pelvis = [body.at("pelvis")[held(body, hand), 1].mean() for body in (medium, low)]
        assert pelvis[0] > pelvis[1]


def test_the_body_turns_to_what_it_touches_and_looks_at_it() -> None:
    for hand, body in reaches():
        frames, goal = held(body, hand), np.array(body.motion.goals[0].position)
        front = body.axis("pelvis", (0.0, 0.0, 1.0))[frames] * [1.0, 0.0, 1.0]
        assert (normalize(front) @ body.facing).min() > 0.8
        look = body.axis("head", (0.0, 0.0, 1.0))[frames[0]]
        assert look @ normalize(goal - body.at("head")[frames[0]]) > 0.6, body.action


def test_one_foot_steps_up_and_back_and_the_body_stands_upright_again() -> None:
    for _, body in reaches():
        for foot, side in enumerate(HANDS):
            standing = body.planted[1:, foot] & body.planted[:-1, foot]
            step = np.linalg.norm(np.diff(body.at(f"{side}_foot")[:, [0, 2]], axis=0), axis=1)
            assert standing.mean() > 0.55
            assert step[standing].max() < 0.01
            assert np.linalg.norm((body.at(f"{side}_foot")[-1] - body.at(f"{side}_foot")[0])[[0, 2]]) < 0.01
        stepped = [not body.planted[:, foot].all() for foot in (0, 1)]
        assert sum(stepped) <= 1
        assert body.at("pelvis")[-1, 1] > 0.95 * body.motion.skeleton.standing_height
        assert abs(body.lean(body.facing)[-1]) < 8


def test_the_hand_speeds_up_and_slows_down_once_on_its_way() -> None:
    for hand, body in reaches():
        frames = held(body, hand)
        pace = np.linalg.norm(np.diff(body.at(f"{hand}_wrist"), axis=0), axis=1) * FPS
        assert 0.5 < pace.max() < 4.5
        assert pace[frames[2] : frames[-3]].max() < 0.15
        assert pace[0] < 0.3
        assert pace[-1] < 0.3


@pytest.mark.parametrize("hand", HANDS)
def test_each_hand_reaches_as_the_other_would_in_a_mirror(hand: str) -> None:
    body = touched(*REACHES[0], hand=hand)
    frames = held(body, hand)
    left = np.array([body.facing[2], 0.0, -body.facing[0]])
    shoulder = body.kinematics.positions[frames[0], INDEX[f"{hand}_shoulder"]]
    other = body.kinematics.positions[frames[0], INDEX[f"{HANDS[1 - HANDS.index(hand)]}_shoulder"]]
    assert ((shoulder - other) @ left > 0) == (hand == "left")


def test_two_times_differ_before_and_after_and_the_contact_is_the_same() -> None:
    for reach in (REACHES[0], REACHES[3]):
        one, other = touched(*reach, seed=3), touched(*reach, seed=4)
        begins = [held(body, "right")[0] for body in (one, other)]
        ends = [held(body, "right")[-1] for body in (one, other)]
        for at, way in ((begins, -1), (ends, 1)):
            apart = [
                np.linalg.norm(
                    one.kinematics.positions[at[0] + way * n] - other.kinematics.positions[at[1] + way * n], axis=-1
                )
                for n in range(6, 18)
            ]
            assert np.max(apart) > 0.03
        wrists = [body.at("right_wrist")[frame] for body, frame in zip((one, other), begins, strict=True)]
        assert np.linalg.norm(wrists[0] - wrists[1]) < 0.03


def test_who_touches_at_hand_height_steps_up_to_it_and_hardly_bends() -> None:
    for hand in HANDS:
        body = touched(*REACHES[3], hand=hand)
        assert body.lean(body.facing)[held(body, hand)].mean() < 30
        body = touched(*REACHES[1], hand=hand)
        assert body.lean(body.facing)[held(body, hand)].mean() < 15


def test_no_elbow_snaps_as_the_body_rises_from_what_is_low() -> None:
    for hand in HANDS:
        body = touched("shelf", "low", "touch low height", hand=hand)
        changes = np.linalg.norm(np.diff(body.at(f"{hand}_elbow").astype(np.float64), n=2, axis=0), axis=1) * FPS
        assert changes.max() < 0.4
