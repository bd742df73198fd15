"""How people lie: level, on the side that is said, on the surface and not in it, head where the pillow is."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from acted import Body, got_up, lain
from layers import sampled

from motion_backend.body.self_collision import self_penetration
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.joint_speed import MOST, fastest_joint
from motion_backend.motion import FPS, PhaseKind
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.lie.lie_keys import lie_keys
from motion_backend.procedural.lie.lie_on_floor import Mat, kneel_down
from motion_backend.procedural.lie.lie_own import CHARACTER, NOBODY
from motion_backend.procedural.lie.lie_pose import Bed
from motion_backend.procedural.own_way import drawn_way
from motion_backend.skeleton import HAND_REST, LYING_REST, build_skeleton
from scene_graphs.affordances.affordances import floor_spot

BACK = ("hands on belly", "lying down, legs straight", "lying on the back, arms spread wide", "lying still")
SIDE = {"side-lie on left, legs bent": 1, "curled up on the left side, knees drawn up": 1, "side-lie on right": -1}
PLACES = [("bed", "small"), ("sofa", "small"), ("floor", "small"), ("bed", "hall")]
UP = np.array([0.0, 1.0, 0.0])
EVERYWHERE = pytest.mark.parametrize("everywhere", sampled([False, True], 2))


def lying(captions: tuple[str, ...], everywhere: bool = False) -> list[tuple[tuple[str, ...], Body]]:
    """Every caption on the bed, and one of a kind elsewhere: or each of them in each place of the small home."""
    return [
        ((place, home, caption), lain(place, caption, home=home))
        for (place, home), caption in product(PLACES, captions)
        if caption in (BACK[0], "side-lie on right") or (home == "small" and (everywhere or place == "bed"))
    ]


def above(body: Body, joint: str) -> np.ndarray:
    """How far a joint is above the surface in the last second. (30,)."""
    assert body.action.spot is not None
    return body.at(joint)[-FPS:, 1] - body.action.spot.point[1]


@EVERYWHERE
def test_a_lying_body_is_level_and_rests_on_the_surface(everywhere: bool) -> None:
    for name, body in lying(BACK, everywhere):
        trunk = body.at("neck") - body.at("pelvis")
        assert abs(np.degrees(np.arcsin(trunk[-1, 1] / np.linalg.norm(trunk[-1])))) < 8, name
        assert np.abs(above(body, "pelvis") - LYING_REST).max() < 0.03, name
        for joint in ("spine3", "neck", "left_shoulder", "right_shoulder", "left_hip", "right_hip"):
            assert 0.02 < above(body, joint).min() <= above(body, joint).max() < 0.2, (name, joint)
        low = np.minimum(*(ends[-1, :, 1] for ends in body.kinematics.capsules[:2])) - body.kinematics.capsules[2]
        assert body.action.spot is not None
        assert -0.05 < low.min() - body.action.spot.point[1] < 0.03, name


@EVERYWHERE
def test_who_lies_on_the_back_looks_up_and_who_lies_on_a_side_looks_to_the_other(everywhere: bool) -> None:
    for name, body in lying(BACK, everywhere):
        for joint in ("pelvis", "spine3"):
            assert (body.axis(joint, (0.0, 0.0, 1.0))[-FPS:] @ UP).min() > 0.9, (name, joint)
    for name, body in lying(tuple(SIDE), everywhere):
        # The left of a body that lies on its left points down.
        down = -SIDE[name[2]] * (body.axis("pelvis", (1.0, 0.0, 0.0))[-FPS:] @ UP)
        assert down.min() > 0.85, name
        lower, upper = ("left", "right") if SIDE[name[2]] > 0 else ("right", "left")
        assert above(body, f"{upper}_shoulder").min() > above(body, f"{lower}_shoulder").max() + 0.1, name
        assert above(body, f"{upper}_hip").min() > above(body, f"{lower}_hip").max() + 0.1, name


@EVERYWHERE
def test_straight_legs_are_straight_bent_ones_bent_and_curled_ones_more(everywhere: bool) -> None:
    for place, home in PLACES[: 3 if everywhere else 1]:
        straight = lain(place, "lying down, legs straight", home=home)
        bent = lain(place, "Legs are bent while lying flat", home=home)
        curled = lain(place, "curled up on the left side, knees drawn up", home=home)
        for side in ("left", "right"):
            assert straight.knee(side)[-1] < 25, place
            assert straight.hip(side)[-1] < 25, place
            assert bent.knee(side)[-1] > 60, place
            assert curled.knee(side)[-1] > 60, place
            assert curled.hip(side)[-1] > 35, place
    left = lain("bed", "left leg bent")
    assert left.knee("left")[-1] > left.knee("right")[-1] + 40


def test_hands_lie_where_the_caption_says() -> None:
    for place, home in PLACES[:3]:
        belly = lain(place, "hands on belly", home=home)
        for side in ("left", "right"):
            middle = (belly.at("pelvis") + belly.at("spine3"))[-1] / 2
            assert np.linalg.norm(belly.at(f"{side}_wrist")[-1] - middle) < 0.3, (place, side)
            assert above(belly, f"{side}_wrist").min() > 0.1, (place, side)
    spread = lain("floor", "lying on the back, arms spread wide")
    wide = np.linalg.norm(spread.at("left_wrist")[-1] - spread.at("right_wrist")[-1])
    assert wide > 1.0


def test_a_body_lies_along_the_bed_with_its_head_away_from_where_its_feet_are() -> None:
    for name, body in lying(BACK[:1]):
        trunk = (body.at("head") - body.at("pelvis"))[-1] * [1.0, 0.0, 1.0]
        legs = (body.at("left_ankle") + body.at("right_ankle") - 2 * body.at("pelvis"))[-1] * [1.0, 0.0, 1.0]
        along = trunk @ legs / np.linalg.norm(trunk) / np.linalg.norm(legs)
        assert along < -0.95, name
        assert np.linalg.norm(legs) / 2 > 0.6, name


def test_who_lies_down_sits_on_the_edge_first_and_comes_down_gently() -> None:
    for name, body in lying((BACK[0], "side-lie on right")):
        if name[0] == "floor":
            continue
        edge, down = body.phase(PhaseKind.EDGE), body.phase(PhaseKind.LIEDOWN)
        seated = body.at("neck")[down.start] - body.at("pelvis")[down.start]
        assert seated[1] / np.linalg.norm(seated) > 0.8, name
        assert body.at("pelvis")[down.start, 1] < body.at("pelvis")[edge.start, 1] - 0.2, name
        speed = np.linalg.norm(np.diff(body.at("head"), axis=0), axis=1).max() * FPS
        assert 0.3 < speed < 2.5, name


def test_the_head_rests_on_what_is_lain_on_and_looks_where_the_chest_does() -> None:
    for name, body in lying(BACK[:2]):
        # The back of the head touches mattress or pillow.
        assert 0.07 < above(body, "head").min() <= above(body, "head").max() < 0.17, name
        assert body.axis("head", (0.0, 0.0, 1.0))[-1] @ UP > 0.85, name
    for name, body in lying(("side-lie on right",)):
        assert 0.12 < above(body, "head").min() <= above(body, "head").max() < 0.28, name


def test_who_gets_up_comes_over_the_edge_onto_both_feet_and_bears_on_a_hand() -> None:
    for place, home in PLACES:
        body = got_up(place, BACK[0], home=home)
        end = body.phase(PhaseKind.GETUP).stop - 1
        trunk = body.at("neck")[end] - body.at("pelvis")[end]
        assert trunk[1] / np.linalg.norm(trunk) > 0.9, place
        assert body.action.spot is not None
        hands = [body.at(f"{side}_wrist")[: end + 1, 1] - body.action.spot.point[1] for side in ("left", "right")]
        assert max(int((hand < 0.085).sum()) for hand in hands) > 4, place
        if place != "floor":
            feet = [body.at(f"{side}_ankle")[end] for side in ("left", "right")]
            assert 0.13 < np.linalg.norm(feet[0] - feet[1]) < 0.21, place
            for side, foot in zip(("left", "right"), feet, strict=True):
                assert abs(foot[1] - body.motion.skeleton.ankle_height) < 0.01, place
                assert 60 < body.hip(side)[end] < 125, place
                assert 60 < body.knee(side)[end] < 115, place
        height = body.at("head")[:, 1]
        assert np.abs(np.diff(height)).sum() < 1.45 * (height[-1] - height[0]), place
        assert abs(np.linalg.norm((body.at("left_ankle") - body.at("right_ankle"))[-1]) - 0.17) < 0.03, place
        assert np.linalg.norm(np.diff(body.kinematics.positions, axis=0), axis=2).max() * FPS < 4.5, place


def test_the_hurried_are_up_sooner_than_the_tired() -> None:
    seconds = [got_up("bed", BACK[0], mood).phase(PhaseKind.GETUP).stop for mood in ("hurried", "neutral", "tired")]
    assert seconds[0] < seconds[1] < seconds[2]
    slow = [lain("bed", BACK[0], mood).phase(PhaseKind.LIEDOWN) for mood in ("hurried", "tired")]
    assert slow[0].stop - slow[0].start < slow[1].stop - slow[1].start


def test_who_leaves_a_bed_rolls_onto_the_side_of_the_edge_and_pushes_with_both_hands() -> None:
    for place, home in [("bed", "small"), ("sofa", "small"), ("bed", "hall")]:
        body = got_up(place, BACK[0], home=home)
        assert body.action.spot is not None
        up, surface = body.phase(PhaseKind.GETUP), body.action.spot.point[1]
        trunk = (body.at("neck") - body.at("pelvis"))[up]
        raised = np.degrees(np.arcsin(trunk[:, 1] / np.linalg.norm(trunk, axis=1)))
        left_down = -body.axis("pelvis", (1.0, 0.0, 0.0))[up, 1]
        assert np.abs(left_down[raised < 20]).max() > 0.9, place
        rising = (raised > 12) & (raised < 40)
        hands = [body.at(f"{side}_wrist")[up, 1] - surface - HAND_REST for side in ("left", "right")]
        assert all((np.abs(hand[rising]) < 0.03).mean() > 0.6 for hand in hands), place
        feet = np.maximum(body.at("left_ankle"), body.at("right_ankle"))[up, 1] - surface
        assert feet[rising].max() < 0.3, place
        assert feet[raised > 60].max() < 0.0, place


def test_nobody_who_lies_down_or_gets_up_flips_a_joint() -> None:
    for place, home in PLACES:
        for body in (lain(place, BACK[0], home=home), got_up(place, BACK[0], home=home)):
            assert fastest_joint(body.motion.local_rotations, FPS)[1] < MOST, place


def test_nobody_lies_twice_alike() -> None:
    for caption in (BACK[0], "side-lie on right"):
        one, other = (lain("bed", caption, seed=seed) for seed in (3, 4))
        assert np.linalg.norm(one.kinematics.positions[-1] - other.kinematics.positions[-1], axis=1).max() > 0.03


def test_how_one_lies_is_partly_a_characters_own() -> None:
    own = lie_keys().own
    spread = {name.rpartition("_")[0]: deviation for name, deviation in own.spread.items()}

    def drawn(seed: int, time: int) -> np.ndarray:
        way = drawn_way(NOBODY, own.spread, (seed, CHARACTER), np.random.default_rng(1000 + time))
        return np.concatenate([np.atleast_1d(value) / spread[name] for name, value in vars(way).items()])

    ways = np.array([[drawn(seed, 2 * seed + time) for time in (0, 1)] for seed in range(40)])
    assert 0.3 < np.mean(ways[:, 0] * ways[:, 1]) < 0.7
    assert abs(np.mean(ways[:-1, 0] * ways[1:, 1])) < 0.15


def test_a_head_that_an_arm_supports_is_off_the_mattress_on_that_hand() -> None:
    body = lain("bed", "Lie down with legs crossed and right arm supporting the head")
    assert above(body, "right_elbow").max() < 0.08
    assert above(body, "head").min() > 0.25
    assert np.linalg.norm(body.at("right_wrist")[-1] - body.at("head")[-1]) < 0.22
    assert self_penetration(body.motion.skeleton, body.kinematics.positions, body.kinematics.world)[-1] < 0.03


@pytest.mark.parametrize("where", ["bed", "sofa"])
def test_feet_are_lifted_off_the_floor_before_they_swing_onto_what_is_lain_on(where: str) -> None:
    assert support_slip(lain(where, "lying still").kinematics) < 3.0
    assert support_slip(got_up(where, "lying still").kinematics) < 4.0, (
        "and are over where they will stand before they come down"
    )


def test_who_kneels_down_leaves_each_foot_where_it_stands_until_it_steps() -> None:
    mat = Mat(Bed.of(floor_spot("lie", (3.0, 2.6), 0.7)), build_skeleton())
    start = standing(mat.standing_point, 0.7, Bearing(), mat.skeleton)
    down = kneel_down(start, mat, Bearing(), lie_keys().floor_down)
    for foot in (0, 1):
        steps = int(np.argmin(down.planted[:, foot]))
        away = np.linalg.norm(down.ankles[:, foot] - start.ankles[foot], axis=1)
        assert away[:steps].max() < 0.005, foot
        assert away[-1] > 0.3, foot
        assert np.linalg.norm(np.diff(down.ankles[:, foot], axis=0), axis=1).max() < 0.08, foot


@EVERYWHERE
def test_the_head_of_who_lies_on_a_side_stays_on_what_is_under_it(everywhere: bool) -> None:
    for name, body in lying(tuple(SIDE), everywhere):
        height = body.at("head")[-round(body.action.hold * FPS) :, 1]
        assert np.ptp(height) < 0.015, name
