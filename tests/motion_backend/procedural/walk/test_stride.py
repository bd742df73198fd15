"""Walks that lead on into the next: nobody stops at the seam, and nothing of the body jumps there."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import FPS, Emotion, Motion
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.footsteps import _clear_of
from motion_backend.procedural.walk.gait import walk_on
from motion_backend.procedural.walk.root_path import plan_route
from motion_backend.procedural.walk.stride import Stride
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.procedural.walk.way_junction import junction_table, through_way, way_from
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()
LENGTH = 2.4
STEADY, RUN = "steadily walking forward", "run with open arms"
PAIRS = {
    "straight on": (0.0, (STEADY, "neutral"), (STEADY, "neutral")),
    "a corner": (70.0, (STEADY, "neutral"), (STEADY, "neutral")),
    "round to the right": (-120.0, (STEADY, "tired"), (STEADY, "tired")),
    "about": (180.0, (STEADY, "neutral"), (STEADY, "neutral")),
    "joy to sorrow": (30.0, (STEADY, "happy"), (STEADY, "sad")),
    "into a run": (20.0, (STEADY, "neutral"), (RUN, "happy")),
    "out of a run": (20.0, (RUN, "happy"), (STEADY, "neutral")),
    "drunk": (40.0, ("drunkenly walking", "drunk"), ("drunkenly walking", "drunk")),
    "sideways": (0.0, (STEADY, "happy"), ("sidestepping", "neutral")),
    "into large steps": (20.0, ("walk on tiptoes", "tired"), ("walk with large steps", "neutral")),
    "on tiptoes": (40.0, ("walk on tiptoes", "neutral"), (STEADY, "neutral")),
}


def everywhere(points: np.ndarray) -> bool:
    return len(points) > 0


def in_a_passage(points: np.ndarray) -> bool:
    return bool(np.abs(points[:, 0]).max() < 0.1)


@cache
def two_walks(name: str) -> tuple[Pose, Pose, Stride]:
    """One after the other, and the stride between them as it comes back from a saved state."""
    degrees, first, second = PAIRS[name]
    turn, corner = np.radians(degrees), np.array([0.0, LENGTH])
    onward = np.array([corner, corner + LENGTH * np.array([np.sin(turn), np.cos(turn)])])
    way = through_way(np.array([[0.0, 0.0], corner]), onward, everywhere)
    assert way is not None
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    styles = [walk_style(Emotion(mood), caption) for caption, mood in (first, second)]
    one, left, _ = walk_on(start, way.points, None, styles[0], SKELETON, np.random.default_rng(0), cut_m=way.cut_m)
    assert left is not None
    stride = Stride.from_lists(json.loads(json.dumps(left.to_lists())))
    last = one.at(len(one) - 1)
    other, stopped, _ = walk_on(last, stride.rest, None, styles[1], SKELETON, np.random.default_rng(1), stride)
    assert stopped is None
    return one, other, stride


def moved(pose: Pose) -> Motion:
    root, local = solve(pose, SKELETON)
    contacts = np.repeat(pose.planted, 2, axis=1).astype(np.float32)
    return Motion(
        root.astype(np.float32), local.astype(np.float32), contacts, SKELETON, np.zeros(len(pose), dtype=np.int32)
    )


@for_each("name", PAIRS)
def test_nobody_stops_where_a_walk_goes_over_into_the_next(name: str) -> None:
    one, other, _ = two_walks(name)
    pace = np.linalg.norm(np.diff(concatenate([one, other]).pelvis[:, [0, 2]], axis=0), axis=1) * FPS
    assert pace[len(one) - 10 : len(one) + 10].min() > 0.3
    assert np.linalg.norm(other.pelvis[-1, [0, 2]] - two_walks(name)[2].rest[-1]) < 0.05
    assert other.planted[-1].min() == 1


@for_each("name", PAIRS)
def test_no_joint_jumps_at_the_seam(name: str) -> None:
    one, other, _ = two_walks(name)
    places, seam = moved(concatenate([one, other])).joint_positions().astype(np.float64), len(one)
    pushed = np.linalg.norm(np.diff(places, n=2, axis=0), axis=-1).max(axis=1) * FPS**2
    assert pushed[seam - 3 : seam + 2].max() < max(60.0, 1.2 * np.quantile(pushed[20:-20], 0.99))


@for_each("name", PAIRS)
def test_arms_go_on_as_fast_as_they_swing(name: str) -> None:
    one, other, _ = two_walks(name)
    steps = np.diff(np.concatenate([one.arms[-2:], other.arms[:1]]), axis=0)
    assert np.linalg.norm(steps[1] - steps[0], axis=-1).max() < 0.03


@for_each("name", PAIRS)
def test_the_way_that_is_left_leads_on_from_where_the_body_is(name: str) -> None:
    one, _, stride = two_walks(name)
    onward, gone = stride.rest[6] - stride.rest[0], one.pelvis[-1, [0, 2]] - one.pelvis[-6, [0, 2]]
    assert onward @ gone > 0.5 * np.linalg.norm(onward) * np.linalg.norm(gone)
    assert np.linalg.norm(np.diff(stride.rest, axis=0), axis=1).max() < 0.05


def test_no_step_is_longer_than_legs_where_the_next_walk_has_longer_ones() -> None:
    one, other, _ = two_walks("into large steps")
    whole = concatenate([one, other])
    stands = whole.planted.min(axis=1) > 0
    assert np.linalg.norm(whole.ankles[stands, 0] - whole.ankles[stands, 1], axis=1).max() < 0.92
    assert whole.pelvis[:, 1].min() > 0.72


@for_each("name", PAIRS)
def test_feet_that_stand_at_the_seam_stay_and_none_sinks_in(name: str) -> None:
    one, other, _ = two_walks(name)
    motion, seam = moved(concatenate([one, other])), len(one)
    body, planted = Kinematics.of(motion), motion.contacts[:, [0, 2]] > 0
    around = slice(seam - 8, seam + 8)
    assert body.soles[around, ..., 1].min() > -0.005
    for foot, side in enumerate(("left", "right")):
        pace = np.linalg.norm(np.diff(body.positions[:, INDEX[f"{side}_foot"]][:, [0, 2]], axis=0), axis=1) * FPS
        stays = planted[1:, foot] & planted[:-1, foot]
        assert np.median(pace[stays]) < 0.01
        # The ball of a foot that has just come down on its heel still comes down.
        assert pace[around][stays[around]].max(initial=0.0) < 0.6
        # A foot that is flagged as standing is on the floor.
        assert body.soles[around, foot][planted[around, foot]].reshape(-1, 4, 3)[..., 1].min(axis=1).max() < 0.01


def test_steps_go_on_in_turns_over_the_seam() -> None:
    for name in ("straight on", "a corner", "joy to sorrow"):
        one, other, _ = two_walks(name)
        planted = concatenate([one, other]).planted > 0
        landed = sorted((frame, foot) for foot in (0, 1) for frame in np.flatnonzero(np.diff(planted[:, foot] * 1) > 0))
        feet = [foot for _, foot in landed]
        assert feet == [(feet[0] + step) % 2 for step in range(len(feet))]
        between = np.diff([frame for frame, _ in landed])
        near = (np.array([frame for frame, _ in landed])[1:] > len(one) - 5).argmax()
        assert 0.6 < between[near] / np.median(between) < 1.6


@pytest.mark.parametrize("side", [1, -1])
def test_a_foot_beside_a_sofa_comes_down_before_the_other_rather_than_in_it(side: int) -> None:
    beside, apart = np.zeros(3), 0.095

    def landed(ahead: float, front: float) -> float:
        def room(places: np.ndarray) -> np.ndarray:
            return np.asarray(front - side * places[:, 0]) - 0.22

        target = np.array([-0.05 * side, 0.0, ahead])
        return float(side * _clear_of(beside, target, (0.0, side, 1.0), apart, room)[0])

    assert landed(0.3, 9.0) == pytest.approx(apart)
    assert -0.05 <= landed(0.3, 0.2) < 0.06
    # A foot that is beside the other has to keep off it all the same.
    assert landed(0.0, 0.2) == pytest.approx(apart)


@pytest.mark.parametrize("degrees", [20, 100, -160, 180])
def test_a_way_that_leads_on_keeps_both_ends_and_passes_the_place_between(degrees: float) -> None:
    turn, corner = np.radians(degrees), np.array([0.0, LENGTH])
    onward = np.array([corner, corner + LENGTH * np.array([np.sin(turn), np.cos(turn)])])
    way = through_way(np.array([[0.0, 0.0], corner]), onward, everywhere)
    assert way is not None
    np.testing.assert_allclose(way.points[[0, -1]], [[0.0, 0.0], onward[-1]], atol=1e-6)
    assert np.linalg.norm(way.points - corner, axis=1).min() <= junction_table().passes_m
    heading = np.unwrap(np.arctan2(*np.diff(way.points, axis=0).T))
    assert np.abs(np.diff(heading)).max() < 0.45
    assert abs(np.degrees(heading[-1] - heading[0])) == pytest.approx(abs(degrees), abs=1.0)


def test_where_there_is_no_room_one_way_does_not_lead_into_the_next() -> None:
    corner = np.array([[0.0, 0.0], [0.0, LENGTH]])
    back = corner[::-1]
    assert through_way(corner, back, in_a_passage) is None
    assert through_way(corner, np.array([[0.0, LENGTH], [0.2, LENGTH]]), everywhere) is None


@pytest.mark.parametrize("side", [1, -1])
def test_who_has_no_room_on_one_side_turns_about_on_the_other(side: int) -> None:
    def fits(points: np.ndarray) -> bool:
        return bool((side * points[:, 0]).min() > -0.12 and points[:, 1].max() < LENGTH + 0.3)

    corner = np.array([0.0, LENGTH])
    for degrees in (170, -170, 180):
        turn = np.radians(degrees)
        onward = np.array([corner, corner + LENGTH * np.array([abs(np.sin(turn)) * side, np.cos(turn)])])
        way = through_way(np.array([[0.0, 0.0], corner]), onward, fits)
        assert way is not None
        heading = np.unwrap(np.arctan2(*np.diff(way.points, axis=0).T))
        assert side * (heading[-1] - heading[0]) > 0
        assert np.linalg.norm(way.points - corner, axis=1).min() <= junction_table().passes_m


@pytest.mark.parametrize("degrees", [90, -150])
def test_who_faces_elsewhere_sets_out_in_an_arc_where_there_is_room(degrees: float) -> None:
    straight, yaw = np.array([[0.0, 0.0], [0.0, 4.0]]), float(np.radians(degrees))
    way = way_from(straight, yaw, everywhere)
    turned = np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(way, axis=0).T))))
    assert turned.max() < 0.45
    assert np.degrees(turned.sum()) > 0.8 * abs(degrees)
    np.testing.assert_allclose(way[[0, -1], 1], [0.0, 4.0], atol=1e-6)
    assert way_from(straight, yaw, in_a_passage) is straight


@pytest.mark.parametrize("length", [0.7, 0.9, 1.2, 2.0])
def test_a_short_way_that_is_set_out_on_in_an_arc_ends_where_it_did(length: float) -> None:
    straight = np.array([[0.0, 0.0], [0.0, length]])
    for yaw in np.radians([40.0, 90.0, 130.0, -170.0]):
        way = way_from(straight, float(yaw), everywhere)
        np.testing.assert_allclose(way[[0, -1]], straight, atol=1e-6)
        assert np.linalg.norm(np.diff(way, axis=0), axis=1).max() < max(0.05, length * (len(way) == 2) + 1e-6)


@pytest.mark.parametrize("bend", [-1.0, 1.0])
def test_who_arrives_from_aside_turns_to_what_is_faced_by_the_shorter_way(bend: float) -> None:
    # Along the front of a seat, which is faced away from, and in to it at the very end.
    path = np.array([[-3.0 * bend, 0.0], [-0.2 * bend, 0.0], [0.0, -0.4]])
    heading = plan_route(path, bend * np.pi / 2, 0.0, 1.0, FPS).heading
    assert abs(heading[-1]) < 0.01
    assert np.abs(np.diff(heading)).sum() < 1.2 * np.pi / 2


@for_each("length", [0.36, 0.45, 0.6, 0.9])
def test_a_way_however_short_is_ended_facing_what_it_is_to_face(length: float) -> None:
    path = np.array([[0.0, 0.0], [0.0, length]])
    for begins, ends in ((0.5, 0.8), (-0.8, 0.3), (2.5, 0.0), (3.1, 3.0)):
        route = plan_route(path, begins, ends, 1.0, FPS)
        assert abs(rotations.wrap(route.heading[-1] - ends)) < 0.01
        assert abs(rotations.wrap(route.heading[0] - begins)) < 0.15
        np.testing.assert_allclose(route.position[-1], path[-1], atol=1e-6)


def test_who_turns_off_out_of_a_run_hurries_so_that_no_foot_left_behind_holds_the_body_down() -> None:
    ran, _, stride = two_walks("out of a run")
    on, off = (np.array([np.sin(yaw), np.cos(yaw)]) for yaw in (stride.heading, stride.heading + np.radians(60)))
    way = np.stack([stride.place, stride.place + 0.6 * on, stride.place + 0.6 * on + LENGTH * off])
    style, start = walk_style(Emotion.NEUTRAL, "marching with swinging arms"), ran.at(len(ran) - 1)
    went, *_ = walk_on(start, way, None, style, SKELETON, np.random.default_rng(2), stride)
    assert went.pelvis[:, 1].min() > 0.78 * SKELETON.standing_height


def test_arms_held_out_come_down_where_a_wall_is_and_nowhere_else() -> None:
    style = walk_style(Emotion.NEUTRAL, "walk excitedly with arms opened")
    way, start = np.array([[0.0, 0.0], [0.0, 4.0]]), standing((0.0, 0.0), 0.0, Bearing(), SKELETON)

    def hands(wall: float) -> np.ndarray:
        seed = np.random.default_rng(0)
        went, *_ = walk_on(start, way, None, style, SKELETON, seed, depth=lambda points: points[:, 0] - wall)
        positions, _ = SKELETON.forward_kinematics(*solve(went, SKELETON))
        return np.stack([positions[:, INDEX[f"{side}_wrist"], 0] for side in ("left", "right")])

    free, beside = hands(9.0), hands(0.5)
    assert free[0].max() > 0.6
    assert beside[0].max() < 0.45
    assert beside[1].min() == pytest.approx(free[1].min(), abs=0.02)


def test_who_spins_on_the_way_goes_on_while_turning_round() -> None:
    style = replace(walk_style(Emotion.NEUTRAL, "walk"), spin=1.0, speed=0.9)
    way, start = np.array([[0.0, 0.0], [0.0, 4.0]]), standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    went, *_ = walk_on(start, way, None, style, SKELETON, np.random.default_rng(0))
    yaw = np.unwrap(2 * np.arctan2(went.hips[:, 1], went.hips[:, 3]))
    round_it = (yaw > yaw[0] + 0.5) & (yaw < yaw[0] + 2 * np.pi - 0.5)
    assert yaw[-1] - yaw[0] == pytest.approx(2 * np.pi, abs=0.3)
    assert went.pelvis[round_it][-1, 2] - went.pelvis[round_it][0, 2] > 0.5
    assert went.pelvis[-1, 2] == pytest.approx(4.0, abs=0.1)


def test_into_a_turn_the_head_leads_the_chest_and_the_chest_the_pelvis() -> None:
    style = walk_style(Emotion.NEUTRAL, STEADY)
    way, start = np.array([[0.0, 0.0], [0.0, 2.0], [2.5, 2.0]]), standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    went, *_ = walk_on(start, way, None, style, SKELETON, np.random.default_rng(0))
    _, world = SKELETON.forward_kinematics(*solve(went, SKELETON))
    ahead = rotations.rotate(
        world[:, [INDEX[name] for name in ("head", "spine3", "pelvis")]], np.array([0.0, 0.0, 1.0])
    )
    half = [int(np.argmax(one > np.pi / 4)) for one in np.arctan2(ahead[..., 0], ahead[..., 2]).T]
    assert half[0] + 2 < half[1] < half[2]
    assert half[2] - half[0] > 0.2 * FPS
