"""A body weighs what it weighs, and its zero-moment point is where the force on it must act."""

from __future__ import annotations

import numpy as np
import pytest
from sample_motions import standing_still, tumbling
from scipy.spatial import ConvexHull

from motion_backend import rotations
from motion_backend.body.capsules import SOLE
from motion_backend.body.segment_masses import SEGMENTS, centres_of_mass
from motion_backend.body.zero_moment import GRAVITY, nearest_in_hull, zero_moment_points
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion
from motion_backend.skeleton import INDEX, build_skeleton


def centres(motion: Motion) -> np.ndarray:
    body = Kinematics.of(motion)
    return centres_of_mass(motion.skeleton, body.positions, body.world)


def test_the_parts_of_a_body_weigh_what_the_whole_does() -> None:
    assert sum(segment.share for segment in SEGMENTS) == pytest.approx(1, abs=2e-4)


def test_the_centre_of_each_limb_lies_where_de_leva_has_it_on_its_bone() -> None:
    """Shares of the way from its joint to the next; the mean of women and men."""
    known = {"shoulder": ("elbow", 0.576), "elbow": ("wrist", 0.457), "hip": ("knee", 0.385), "knee": ("ankle", 0.442)}
    bones = build_skeleton(1.70).offsets
    for segment in SEGMENTS:
        side, _, name = segment.joint.partition("_")
        if name not in known:
            continue
        end, share = known[name]
        bone = bones[INDEX[f"{side}_{end}"]]
        along = np.dot(segment.centre, bone) / np.dot(bone, bone)
        assert along == pytest.approx(share, abs=0.01), segment.joint
        assert np.linalg.norm(segment.centre - along * bone) < 0.01


def test_the_centres_of_trunk_head_hands_and_feet_lie_within_them() -> None:
    tops = {"pelvis": "spine1", "spine2": "spine3", "spine3": "neck"}
    bones, centres_of = build_skeleton(1.70).offsets, {one.joint: np.array(one.centre) for one in SEGMENTS}
    for joint, top in tops.items():
        assert 0.3 < centres_of[joint][1] / bones[INDEX[top]][1] < 0.7
    assert 0.03 < centres_of["head"][1] < 0.10
    for side, sign in (("left", 1), ("right", -1)):
        assert 0.05 < sign * centres_of[f"{side}_wrist"][0] < 0.09  # the palm
        foot, heel, toes = centres_of[f"{side}_ankle"], SOLE[0], SOLE[1]
        assert foot[2] - heel[2] == pytest.approx(0.43 * (toes[2] - heel[2]), abs=0.015)
        assert heel[1] < foot[1] < 0


def test_a_standing_body_has_its_centre_in_the_middle_at_the_height_that_people_have_it() -> None:
    for height in (1.2, 1.7, 2.1):
        found = centres(standing_still(1, height=height))[0]
        assert found[[0, 2]] == pytest.approx([0, 0], abs=0.01)
        assert 0.54 < found[1] / height < 0.60


def test_the_centre_of_mass_goes_and_turns_with_the_body() -> None:
    motion = tumbling(1)
    turn = rotations.yaw_to_quat(1.1)
    before, after = centres(motion), centres(_turned(motion, turn, np.array([3.0, 0.5, -2.0])))
    assert after == pytest.approx(rotations.rotate(turn, before) + np.array([3.0, 0.5, -2.0]), abs=1e-5)


def _turned(motion: Motion, turn: np.ndarray, by: np.ndarray) -> Motion:
    local = motion.local_rotations.astype(np.float64)
    local[:, 0] = rotations.compose(turn, local[:, 0])
    root = rotations.rotate(turn, motion.root_positions.astype(np.float64)) + by
    return Motion(root.astype(np.float32), local.astype(np.float32), motion.contacts, motion.skeleton, motion.actions)


def test_a_body_at_rest_or_at_a_steady_pace_has_its_zero_moment_point_under_it() -> None:
    steady = np.array([0.2, 0.95, 1.0]) + np.outer(np.arange(90) / 30, [1.1, 0.0, -0.4])
    found = zero_moment_points(steady, 30)
    assert found[10:-10] == pytest.approx(steady[10:-10, [0, 2]], abs=1e-9)


def test_a_body_that_speeds_up_leaves_its_zero_moment_point_behind_by_its_height() -> None:
    seconds = np.arange(90) / 30
    speeding = np.stack([0.5 * 2.0 * seconds**2, np.full(90, 0.9), np.zeros(90)], axis=1)
    behind = speeding[:, 0] - zero_moment_points(speeding, 30)[:, 0]
    assert behind[15:-15] == pytest.approx(0.9 / GRAVITY * 2.0, abs=0.01)


def test_the_nearest_place_in_a_hull_is_the_one_that_its_edges_give() -> None:
    rng = np.random.default_rng(3)
    corners, points = rng.normal(size=(200, 8, 2)), rng.normal(0, 1.5, size=(200, 2))
    carries = rng.random((200, 8)) < 0.7
    carries[:, :3] = True
    found = nearest_in_hull(points, corners, carries)
    for point, own, on, place in zip(points, corners, carries, found, strict=True):
        hull = ConvexHull(own[on])
        beyond = (hull.equations[:, :2] @ point + hull.equations[:, 2]).max()
        if beyond <= 0:
            assert place == pytest.approx(point)
        else:
            # The nearest place of a convex set sees all of it on the far side of the point.
            away = (point - place) / np.linalg.norm(point - place)
            assert ((own[on] - place) @ away).max() == pytest.approx(0, abs=1e-9)
            assert (hull.equations[:, :2] @ place + hull.equations[:, 2]).max() == pytest.approx(0, abs=1e-9)


def test_one_corner_and_two_are_hulls_too_and_none_is_not() -> None:
    corners = np.array([[[0.0, 0.0], [2.0, 0.0], [9.0, 9.0]]] * 3)
    carries = np.array([[True, False, False], [True, True, False], [False, False, False]])
    found = nearest_in_hull(np.array([[1.0, 1.0]] * 3), corners, carries)
    assert found[:2] == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0]]))
    assert np.isnan(found[2]).all()
