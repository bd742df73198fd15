"""The mannequin is a person's shape that follows the skeleton without tearing."""

from __future__ import annotations

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.body.mannequin_mesh import Proportions, build_mannequin
from motion_backend.body.skinning import skin, strongest_four
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()
MESH = build_mannequin(SKELETON)
REST = np.tile(rotations.IDENTITY, (1, 22, 1))


def posed(**turns: tuple[float, float, float]):
    """Vertices with some joints turned, in degrees, the pelvis at the origin."""
    rotation = REST.copy()
    for name, degrees in turns.items():
        rotation[0, INDEX[name]] = rotations.rotvec_to_quat(np.radians(degrees))
    return skin(MESH, SKELETON, np.zeros((1, 3)), rotation)[0][0]


def test_it_has_the_size_of_the_body():
    low, high = MESH.vertices.min(axis=0), MESH.vertices.max(axis=0)
    assert low[1] == pytest.approx(-SKELETON.standing_height, abs=0.004)
    assert high[1] - low[1] == pytest.approx(1.70, abs=0.02)
    assert high[0] == pytest.approx(0.72 + 0.17, abs=0.02)


def test_another_height_scales_it():
    small = build_mannequin(build_skeleton(1.5))
    np.testing.assert_allclose(small.vertices, MESH.vertices * (1.5 / 1.7), atol=1e-6)


def test_it_is_the_same_on_both_sides():
    mirrored = MESH.vertices * np.array([-1, 1, 1], dtype=np.float32)
    keys = {tuple(v) for v in np.round(MESH.vertices, 3).tolist()}
    near = sum(tuple(v) in keys for v in (np.round(mirrored, 3) + 0.0).tolist())
    assert near > 0.5 * len(MESH.vertices)


def test_weights_sum_to_one_over_at_most_four_joints():
    np.testing.assert_allclose(MESH.weights.sum(axis=1), 1.0, atol=1e-5)
    assert (MESH.weights >= 0).all()
    assert (MESH.joints[MESH.weights == 0] == 0).all()
    assert MESH.joints.max() < 22


def test_only_the_strongest_joints_are_kept():
    joints, weights = strongest_four(np.array([[0.1, 0.2, 0.3, 0.25, 0.15]]))
    assert set(joints[0].tolist()) == {1, 2, 3, 4}
    assert weights.sum() == pytest.approx(1.0)


def test_normals_are_unit_and_point_out():
    np.testing.assert_allclose(np.linalg.norm(MESH.normals, axis=1), 1.0, atol=1e-4)
    a, b, c = np.moveaxis(MESH.vertices[MESH.faces], 1, 0)
    face = np.cross(b - a, c - a)
    agree = np.sum(face * MESH.normals[MESH.faces].mean(axis=1), axis=1) > 0
    assert agree.mean() > 0.995


def test_the_face_looks_forward_and_toes_point_forward():
    names = [m.name for m in MESH.materials]
    centre = {}
    for index, name in enumerate(names):
        centre[name] = MESH.vertices[np.unique(MESH.faces[MESH.face_materials == index])].mean(axis=0)
    assert centre["eyes"][2] > centre["hair"][2] + 0.05
    assert centre["shoes"][2] > 0.02


def test_the_rest_pose_leaves_every_vertex_where_it_is():
    np.testing.assert_allclose(posed(), MESH.vertices, atol=1e-6)


def test_skinning_moves_with_the_root():
    turned = REST.copy()
    turned[0, 0] = rotations.yaw_to_quat(np.pi / 2)
    vertices, normals = skin(MESH, SKELETON, np.array([[1.0, 2.0, 3.0]]), turned)
    np.testing.assert_allclose(vertices[0], MESH.vertices[:, [2, 1, 0]] * [1, 1, -1] + [1, 2, 3], atol=1e-5)
    np.testing.assert_allclose(normals[0], MESH.normals[:, [2, 1, 0]] * [1, 1, -1], atol=1e-5)


@for_each(
    "turns",
    [
        {"left_shoulder": (0.0, 0.0, -78.0), "right_shoulder": (0.0, 0.0, 78.0)},
        {"left_hip": (-90.0, 0.0, 0.0), "left_knee": (90.0, 0.0, 0.0)},
        {"left_elbow": (0.0, -110.0, 0.0)},
        {"spine1": (25.0, 0.0, 0.0), "spine2": (20.0, 15.0, 0.0), "neck": (20.0, 0.0, 0.0)},
    ],
)
def test_no_triangle_is_torn_when_joints_bend(turns):
    def longest(vertices):
        corners = vertices[MESH.faces]
        return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max(axis=1)

    before, after = longest(MESH.vertices), longest(posed(**turns))
    assert after.max() < 0.15
    assert (after > 3 * before + 0.01).mean() < 0.01


def test_a_bent_knee_keeps_its_thickness():
    bent = posed(left_knee=(90.0, 0.0, 0.0))
    knee = SKELETON.rest_positions[INDEX["left_knee"]]
    ring = np.linalg.norm(MESH.vertices - knee, axis=1) < 0.075
    assert np.linalg.norm(bent[ring] - knee, axis=1).min() > 0.03


def test_a_seated_body_rests_on_its_seat():
    seated = posed(left_hip=(-90.0, 0.0, 0.0), right_hip=(-90.0, 0.0, 0.0))
    assert seated[:, 1].min() == pytest.approx(-0.09, abs=0.03)


STOUT = Proportions(girth=1.25, chest=0.9, hips=1.1, limbs=1.2, head=0.9)


def breadth(mesh, material: str) -> float:
    index = [m.name for m in mesh.materials].index(material)
    x = mesh.vertices[np.unique(mesh.faces[mesh.face_materials == index]), 0]
    return float(np.ptp(x))


def test_proportions_change_the_flesh_and_not_the_height():
    stout = build_mannequin(SKELETON, STOUT)
    assert breadth(stout, "trousers") > 1.08 * breadth(MESH, "trousers")
    assert breadth(stout, "hair") == pytest.approx(0.9 * breadth(MESH, "hair"), rel=0.02)
    assert stout.vertices[:, 1].min() == MESH.vertices[:, 1].min()
    np.testing.assert_allclose(np.linalg.norm(stout.normals, axis=1), 1.0, atol=1e-4)
    np.testing.assert_array_equal(build_mannequin(SKELETON, Proportions()).vertices, MESH.vertices)


def test_no_triangle_is_torn_by_other_proportions():
    for mesh in (build_mannequin(SKELETON, STOUT), build_mannequin(SKELETON, Proportions(0.8, 0.8, 0.8, 0.8, 1.25))):
        corners, before = mesh.vertices[mesh.faces], MESH.vertices[MESH.faces]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max(axis=1)
        assert (longest < 2 * np.linalg.norm(before - np.roll(before, 1, axis=1), axis=-1).max(axis=1)).all()


@for_each("field", ["girth", "chest", "hips", "limbs", "head"])
def test_proportions_of_no_person_are_refused_by_name(field: str):
    with pytest.raises(ValueError, match=rf"proportions\.{field}"):
        Proportions(**{field: 1.5})
