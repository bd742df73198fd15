"""Quaternions keep the axioms of a group and agree with scipy."""

from __future__ import annotations

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from motion_backend import rotations

VECTORS = hnp.arrays(np.float64, 3, elements=st.floats(-3.0, 3.0))
FEW = tries(60)


def same(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(np.allclose(a, b, atol=1e-7) or np.allclose(a, -b, atol=1e-7))


@FEW
@given(VECTORS, VECTORS, VECTORS)
def test_composing_is_associative_and_has_inverses(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    p, q, r = (rotations.rotvec_to_quat(v) for v in (a, b, c))
    left = rotations.compose(rotations.compose(p, q), r)
    assert same(left, rotations.compose(p, rotations.compose(q, r)))
    assert same(rotations.compose(p, rotations.inverse(p)), rotations.IDENTITY)


@FEW
@given(VECTORS, hnp.arrays(np.float64, (2, 1, 3), elements=st.floats(-3.0, 3.0)))
def test_cross_products_are_those_of_numpy_to_the_bit(a: np.ndarray, b: np.ndarray) -> None:
    np.testing.assert_array_equal(rotations.cross(a, b), np.cross(a, b))
    np.testing.assert_array_equal(rotations.cross(b, a), np.cross(b, a))


@FEW
@given(hnp.arrays(np.float64, (5, 3), elements=st.floats(-3.0, 3.0)), VECTORS)
def test_one_alone_is_turned_to_the_bit_as_among_many(many: np.ndarray, point: np.ndarray) -> None:
    turns = rotations.rotvec_to_quat(many)
    composed, turned = rotations.compose(turns, turns[::-1]), rotations.rotate(turns, point)
    for one in range(len(many)):
        np.testing.assert_array_equal(rotations.compose(turns[one], turns[4 - one : 5 - one]), composed[one : one + 1])
        np.testing.assert_array_equal(rotations.rotate(turns[one : one + 1], point), turned[one : one + 1])


@FEW
@given(hnp.arrays(np.float64, 4, elements=st.floats(-7.0, 7.0)), st.integers(0, 2))
def test_turns_about_an_axis_are_rotation_vectors_along_it_to_the_bit(angles: np.ndarray, axis: int) -> None:
    vectors = np.zeros((4, 3))
    vectors[:, axis] = angles
    np.testing.assert_array_equal(rotations.axis_to_quat("xyz"[axis], angles), rotations.rotvec_to_quat(vectors))


@FEW
@given(hnp.arrays(np.float64, (4, 3), elements=st.floats(-4.0, 4.0)))
def test_axes_of_a_rotation_give_it_back(vectors: np.ndarray) -> None:
    columns = Rotation.from_rotvec(vectors).as_matrix().transpose(2, 0, 1)
    found = rotations.basis_to_quat(*columns)
    np.testing.assert_allclose(np.abs(np.sum(found * Rotation.from_rotvec(vectors).as_quat(), axis=-1)), 1, atol=1e-12)
    np.testing.assert_array_equal(rotations.basis_to_quat(*columns[:, 2]), found[2])
    for axis, column in enumerate(columns):
        np.testing.assert_allclose(rotations.rotate(found, np.eye(3)[axis]), column, atol=1e-9)


@FEW
@given(VECTORS, VECTORS)
def test_rotation_vectors_and_turned_vectors_agree_with_scipy(v: np.ndarray, point: np.ndarray) -> None:
    ours = rotations.rotvec_to_quat(v)
    theirs = Rotation.from_rotvec(v)
    assert same(ours, theirs.as_quat())
    np.testing.assert_allclose(rotations.rotate(ours, point), theirs.apply(point), atol=1e-9)
    np.testing.assert_allclose(rotations.quat_to_rotvec(ours), Rotation.from_quat(ours).as_rotvec(), atol=1e-6)
    np.testing.assert_allclose(rotations.quat_to_matrix(ours), theirs.as_matrix(), atol=1e-9)


@FEW
@given(VECTORS, VECTORS, st.floats(0.0, 1.0))
def test_slerp_goes_the_share_of_the_way(a: np.ndarray, b: np.ndarray, share: float) -> None:
    p, q = rotations.rotvec_to_quat(a), rotations.rotvec_to_quat(b)
    whole = np.linalg.norm(rotations.quat_to_rotvec(rotations.compose(rotations.inverse(p), q)))
    part = rotations.compose(rotations.inverse(p), rotations.slerp(p, q, share))
    np.testing.assert_allclose(np.linalg.norm(rotations.quat_to_rotvec(part)), share * whole, atol=1e-6)


@given(st.floats(-20, 20))
def test_wrapped_angles_point_the_same_way(angle: float) -> None:
    wrapped = float(rotations.wrap(angle))
    assert -np.pi < wrapped <= np.pi + 1e-12
    np.testing.assert_allclose([np.sin(wrapped), np.cos(wrapped)], [np.sin(angle), np.cos(angle)], atol=1e-9)


def test_yaw_turns_counter_clockwise_seen_from_above() -> None:
    forward = rotations.rotate(rotations.yaw_to_quat(np.pi / 2), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(forward, [1.0, 0.0, 0.0], atol=1e-12)


def test_continuous_quaternions_never_jump_hemisphere() -> None:
    turn = rotations.rotvec_to_quat(np.linspace(0, 12, 50)[:, None] * np.array([0.0, 1.0, 0.0]))
    flipped = turn * np.where(np.arange(50) % 3 == 0, -1.0, 1.0)[:, None]
    fixed = rotations.continuous(flipped)
    assert (np.sum(fixed[1:] * fixed[:-1], axis=-1) > 0).all()
    assert all(same(a, b) for a, b in zip(fixed, turn, strict=True))


def test_arrays_of_other_widths_are_refused_and_not_read_beyond_their_ends() -> None:
    turns, points = np.ones((5, 4)), np.ones((5, 3))
    for wrong in (
        lambda: rotations.compose(turns, points),
        lambda: rotations.rotate(points, points),
        lambda: rotations.cross(points[:, :2], points),
        lambda: rotations.dot(turns, turns),
        lambda: rotations.basis_to_quat(points, points, points[:, :2]),
    ):
        with pytest.raises(ValueError, match=r"the last axes are|broadcast"):
            wrong()
