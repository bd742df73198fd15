"""Everybody of the cast is a whole body on the same bones, told from the others at a glance."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.body.capsules import BODIES
from motion_backend.body.cast import Look, Role, cast
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face import UNITS
from motion_backend.body.face_track import expression, face_track
from motion_backend.body.skinning import SkinnedMesh, skin
from motion_backend.motion import Character, Emotion, Motion
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Solid, render
from motion_backend.skeleton import INDEX, REFERENCE_HEIGHT, Skeleton, build_skeleton

MEMBERS = [one.name for one in cast().member]
FEW = ["tom", "nora", "bruno", "mia", "leo"]
BY_NAME = [name if name in FEW else pytest.param(name, marks=pytest.mark.sweep) for name in MEMBERS]
SOME = pytest.mark.parametrize("names", [FEW, pytest.param(MEMBERS, marks=pytest.mark.sweep)], ids=len)
"""Of both sexes and all ages, in dresses, coats and beards; and everybody."""
LIDS, LEFT = UNITS.index("lids_down"), UNITS.index("gaze_left")


def body_of(name: str) -> tuple[Skeleton, SkinnedMesh]:
    look = Look.of(Character(member=name))
    skeleton = build_skeleton(cast().ages[look.age].height_m)
    return skeleton, build_character(skeleton, look)


def picture(name: str) -> np.ndarray:
    """From the front, in the T-pose, small. (H, W, 3)."""
    skeleton, mesh = body_of(name)
    vertices = mesh.vertices + np.array([0.0, skeleton.standing_height, 0.0])
    camera = Camera((1.5, 1.2, 4.0), (0.0, 0.85, 0.0), span=2.0)
    solid = Solid(vertices, mesh.faces, mesh.face_colors, mesh.normals)
    return render([solid], camera, (64, 64), ground=None, shadows=False).astype(np.float64)


@pytest.mark.parametrize("name", BY_NAME)
def test_a_body_is_as_tall_as_its_bones_and_stands_on_its_soles(name: str) -> None:
    skeleton, mesh = body_of(name)
    height = skeleton.scale * REFERENCE_HEIGHT
    low, high = mesh.vertices[:, 1].min(), mesh.vertices[:, 1].max()
    assert low == pytest.approx(-skeleton.standing_height, abs=0.006)
    assert height - 0.02 < high - low < 1.1 * height, "hair and a child's head stand out above"


@pytest.mark.parametrize("name", BY_NAME)
def test_nobody_is_seen_from_inside(name: str) -> None:
    """From all around, what is nearest is an outside: the surface is closed wherever one can look."""
    skeleton, mesh = body_of(name)
    assert np.isfinite(mesh.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-3)
    magenta = np.array([1.0, 0.0, 1.0])
    flipped = Solid(mesh.vertices, mesh.faces[:, ::-1], magenta, -mesh.normals)
    outside = Solid(mesh.vertices, mesh.faces, (0.5, 0.5, 0.5), mesh.normals)
    for yaw in (0.3, 2.4, 4.4):
        camera = Camera((4 * np.sin(yaw), 0.6, 4 * np.cos(yaw)), (0.0, -0.1 * skeleton.scale, 0.0), span=2.0)
        seen = render([outside, flipped], camera, (64, 64), ground=None, shadows=False).astype(int)
        inside = (seen[..., 0] - seen[..., 1] > 90).sum()
        assert inside < 3, f"{inside} pixels of an inside at {yaw}"


@pytest.mark.parametrize("name", BY_NAME)
def test_flesh_and_clothes_are_around_the_bones(name: str) -> None:
    """Every capsule that contacts are reckoned with has skin or cloth near it, and hardly any in its core."""
    skeleton, mesh = body_of(name)
    rest = skeleton.rest_positions
    for body in BODIES:
        start, end = (rest[INDEX[body.joint]] + np.array(p) * skeleton.scale for p in (body.start, body.end))
        axis = end - start
        share = np.clip((mesh.vertices - start) @ axis / max(axis @ axis, 1e-9), 0.0, 1.0)
        away = np.linalg.norm(mesh.vertices - start - share[:, None] * axis, axis=1)
        radius = body.radius * skeleton.scale
        assert away.min() < 1.5 * radius, body.name
        assert (away < 0.3 * radius).sum() < 40, body.name


@SOME
def test_all_differ_in_pixels(names: list[str]) -> None:
    pictures = {name: picture(name) for name in names}
    for one, other in combinations(names, 2):
        differs = (np.abs(pictures[one] - pictures[other]).max(axis=-1) > 40).sum()
        assert differs > 100, f"{one} and {other} differ in {differs} pixels"


def test_a_child_is_smaller_and_its_head_larger_for_its_size() -> None:
    def head(name: str) -> float:
        skeleton, mesh = body_of(name)
        face = mesh.vertices[mesh.morphs.first :] if mesh.morphs else mesh.vertices
        return float(np.ptp(face[:, 1])) / skeleton.scale

    (child, _), (man, _) = body_of("leo"), body_of("tom")
    assert child.scale < 0.75 * man.scale
    assert head("leo") > 1.1 * head("tom")


def test_the_bones_are_the_heights_alone() -> None:
    look = Look.of(Character(member="bruno"))
    tall, small = build_character(build_skeleton(1.9), look), build_character(build_skeleton(1.5), look)
    np.testing.assert_allclose(tall.vertices / 1.9, small.vertices / 1.5, atol=1e-6)
    assert tall.morphs is not None
    assert small.morphs is not None
    np.testing.assert_allclose(tall.morphs.offsets / 1.9, small.morphs.offsets / 1.5, atol=1e-6)


def test_a_look_is_what_is_said_and_else_the_members() -> None:
    look = Look.of(Character(member="nora", outfit="nurse", hair="bun"))
    assert (look.outfit, look.hair, look.hair_color, look.figure) == ("nurse", "bun", "blond", "curved")
    assert look.clothes.top == "tunic"
    assert Look.of(Character(member="bruno", age="child")).beard is False


def test_a_nurses_tunic_is_another_garment_and_not_another_colour() -> None:
    def lowest(outfit: str) -> float:
        mesh = build_character(build_skeleton(), Look.of(Character(member="tom", outfit=outfit)))
        index = [material.name for material in mesh.materials].index("top")
        return float(mesh.vertices[np.unique(mesh.faces[mesh.face_materials == index]), 1].min())

    assert lowest("nurse") < lowest("casual") - 0.08


def test_nine_emotions_are_nine_faces() -> None:
    """They differ in what is done, and where the face's vertices are, by more than a pixel of a close view."""
    _, mesh = body_of("tom")
    assert mesh.morphs is not None
    faces = {emotion: np.einsum("k,kfc->fc", expression(emotion), mesh.morphs.offsets) for emotion in Emotion}
    for one, other in combinations(Emotion, 2):
        assert np.linalg.norm(faces[one] - faces[other], axis=1).max() > 0.002, (one, other)


def standing(frames: int, skeleton: Skeleton, actions: np.ndarray | None = None) -> Motion:
    still = np.tile(rotations.IDENTITY, (frames, 22, 1)).astype(np.float32)
    served = np.zeros(frames, np.int32) if actions is None else actions
    return Motion(np.zeros((frames, 3), np.float32), still, np.zeros((frames, 4), np.float32), skeleton, served)


def test_a_face_blinks_and_feels_what_its_keyframe_feels() -> None:
    motion = standing(600, build_skeleton(), np.repeat(np.arange(2, dtype=np.int32), 300))
    role = Role(emotions={0: Emotion.HAPPY, 1: Emotion.SAD})
    track = face_track(motion, role)
    smile = track[:, UNITS.index("smile")]
    assert smile[100] == pytest.approx(1.0)
    assert smile[500] < -0.5
    assert np.abs(np.diff(smile)).max() < 0.15, "it passes softly from one to the next"
    shut = (track[1:, LIDS] > 0.99) & (track[:-1, LIDS] <= 0.99)
    assert 3 <= shut.sum() <= 10, "in twenty seconds"
    np.testing.assert_array_equal(track, face_track(motion, role))


def test_who_sleeps_has_shut_eyes() -> None:
    motion = standing(300, build_skeleton())
    assert (face_track(motion, Role(asleep=frozenset([0])))[:, LIDS] > 0.99).all()


def test_eyes_lead_the_head() -> None:
    """A head that begins to turn left is preceded by eyes that look left; where it stays, they come back."""
    motion = standing(90, build_skeleton())
    turning = np.clip((np.arange(90) - 40) / 15, 0, 1) * 0.8
    motion.local_rotations[:, INDEX["head"]] = rotations.yaw_to_quat(turning)
    looking = face_track(motion, Role())[:, LEFT]
    assert looking[:25] == pytest.approx(0.0)
    assert looking[38] > 0.3
    assert looking[-1] < 0.25


def test_morphs_go_with_the_head() -> None:
    skeleton, mesh = body_of("mia")
    assert mesh.morphs is not None
    pose = np.tile(rotations.IDENTITY, (1, 22, 1))
    pose[0, 0] = rotations.yaw_to_quat(np.pi / 2)
    shares = np.zeros((1, len(UNITS)))
    shares[0, LEFT] = 1.0
    moved = skin(mesh, skeleton, np.zeros((1, 3)), pose, shares)[0] - skin(mesh, skeleton, np.zeros((1, 3)), pose)[0]
    assert moved[0, :, 2].min() < -0.003, "the left of who looks along +X is -Z"
    assert np.abs(moved[0, : mesh.morphs.first]).max() == 0.0


@pytest.mark.parametrize("emotion", list(Emotion))
def test_nobody_scowls_but_who_is_angry(emotion: Emotion) -> None:
    _, mesh = body_of("tom")
    assert mesh.morphs is not None
    faces = expression(emotion) @ mesh.morphs.offsets.reshape(len(UNITS), -1)
    moved = mesh.vertices[mesh.morphs.first :] + faces.reshape(-1, 3)[: len(mesh.vertices) - mesh.morphs.first]
    names = [mesh.materials[index].name for index in mesh.face_materials]
    brow = np.unique(mesh.faces[[name == "face brow" for name in names]]) - mesh.morphs.first
    brow = brow[moved[brow, 0] > 0]  # the left one
    x, y = moved[brow, 0], moved[brow, 1]
    within, outside = y[x < np.quantile(x, 0.2)].mean(), y[x > np.quantile(x, 0.8)].mean()
    assert (within < outside - 0.004) == (emotion is Emotion.ANGRY)
    assert emotion is Emotion.ANGRY or within > outside - 0.001
