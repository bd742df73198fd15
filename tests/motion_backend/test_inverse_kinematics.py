"""Inverse kinematics put limbs where they should be, and bones keep their length."""

from __future__ import annotations

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from motion_backend import rotations
from motion_backend.inverse_kinematics import arm_rotations, leg_rotations, two_bone
from motion_backend.skeleton import INDEX, build_skeleton

DIRECTION = hnp.arrays(np.float64, 3, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 0.1)
LENGTHS = (0.4, 0.35)
FEW = tries(80)


@FEW
@given(DIRECTION, st.floats(0.18, 0.745), DIRECTION)
def test_a_limb_reaches_every_target_within_its_length(way: np.ndarray, distance: float, pole: np.ndarray) -> None:
    target = rotations.normalize(way) * distance
    limb = two_bone(np.zeros(3), target, pole, LENGTHS)
    np.testing.assert_allclose(LENGTHS[0] * limb.upper + LENGTHS[1] * limb.lower, target, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(limb.upper), 1.0, atol=1e-9)


@FEW
@given(DIRECTION, st.floats(0.8, 3.0), DIRECTION)
def test_a_limb_points_at_what_is_too_far(way: np.ndarray, distance: float, pole: np.ndarray) -> None:
    limb = two_bone(np.zeros(3), rotations.normalize(way) * distance, pole, LENGTHS)
    end = LENGTHS[0] * limb.upper + LENGTHS[1] * limb.lower
    assert np.linalg.norm(end) == pytest.approx(0.999 * sum(LENGTHS), abs=1e-6)
    np.testing.assert_allclose(rotations.normalize(end), rotations.normalize(way), atol=1e-6)


@FEW
@given(DIRECTION, st.floats(0.01, 0.17), DIRECTION, st.sampled_from([1, -1]))
def test_no_limb_folds_up_further_than_flesh_lets_it(
    way: np.ndarray, distance: float, pole: np.ndarray, side: int
) -> None:
    target = (rotations.normalize(way) * distance)[None]
    limb = two_bone(np.zeros((1, 3)), target, pole[None], LENGTHS)
    for upper, lower in (arm_rotations(limb, side), leg_rotations(limb)):
        bend = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(upper), lower))[0]
        assert 150 <= np.degrees(np.linalg.norm(bend)) <= 155


def test_a_bent_knee_points_forward_and_turns_about_its_hinge_alone() -> None:
    leg = two_bone(np.zeros((1, 3)), np.array([[0.0, -0.6, 0.0]]), np.array([[0.0, 0.0, 1.0]]), LENGTHS)
    hip, knee = leg_rotations(leg)
    assert leg.upper[0, 2] > 0.1
    bend = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(hip), knee))[0]
    assert bend[0] > 0.3, "flexion is about +X"
    np.testing.assert_allclose(bend[1:], 0.0, atol=1e-9)


@pytest.mark.parametrize("side", [1, -1])
def test_an_elbow_is_a_hinge_too(side: int) -> None:
    target = np.array([[0.3 * side, -0.3, 0.3]])
    arm = two_bone(np.zeros((1, 3)), target, np.array([[0.2 * side, 0.0, -1.0]]), LENGTHS)
    shoulder, elbow = arm_rotations(arm, side)
    for turn, bone in ((shoulder, arm.upper), (elbow, arm.lower)):
        np.testing.assert_allclose(rotations.rotate(turn, np.array([side, 0.0, 0.0])), bone, atol=1e-9)
    bend = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(shoulder), elbow))[0]
    np.testing.assert_allclose(bend[[0, 2]], 0.0, atol=1e-9)


@FEW
@given(hnp.arrays(np.float64, (4, 22, 3), elements=st.floats(-2, 2)), st.floats(1.3, 2.1))
def test_bones_keep_their_length_in_every_pose(vectors: np.ndarray, height: float) -> None:
    skeleton = build_skeleton(height)
    positions, _ = skeleton.forward_kinematics(np.zeros((4, 3)), rotations.rotvec_to_quat(vectors))
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            length = np.linalg.norm(positions[:, joint].astype(float) - positions[:, parent], axis=1)
            np.testing.assert_allclose(length, np.linalg.norm(skeleton.offsets[joint]), atol=1e-5)


def test_the_body_is_as_tall_as_asked_and_mirrored() -> None:
    tall = build_skeleton(1.87)
    assert tall.scale == pytest.approx(1.1)
    assert tall.standing_height + tall.rest_positions[INDEX["head"], 1] == pytest.approx(1.54 * 1.1, abs=0.02)
    for name in tall.names:
        if name.startswith("left_"):
            mirror = tall.rest_positions[INDEX["right_" + name[5:]]] * [-1, 1, 1]
            np.testing.assert_allclose(tall.rest_positions[INDEX[name]], mirror)


@pytest.mark.parametrize("height", [0.5, 3.0, float("nan")])
def test_a_body_of_impossible_height_is_refused(height: float) -> None:
    with pytest.raises(ValueError, match=r"character\.height"):
        build_skeleton(height)
