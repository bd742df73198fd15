"""Bodies, their clothes and their faces are those that somebody last looked at."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from recorded import agrees
from sample_motions import tumbling

from motion_backend.body.capsules import placed
from motion_backend.body.cast import Look, Role, cast
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import face_track
from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.segment_masses import centres_of_mass
from motion_backend.body.self_collision import deepest_pair, self_penetration
from motion_backend.body.skinning import SkinnedMesh, skin
from motion_backend.body.zero_moment import zero_moment_points
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Character, Emotion
from motion_backend.skeleton import build_skeleton

PEOPLE: Final = (
    Character(member="kenji"),
    Character(member="amina", outfit="nurse"),
    Character(member="walter", outfit="doctor"),
    Character(member="mia"),
    Character(member="leo", outfit="pyjamas", hair="long"),
)
"""Of every build, with most hairstyles and garments."""


def test_bodies_are_as_recorded() -> None:
    agrees("bodies", {f"{one.member} {one.outfit}".strip(): drawn(one) for one in PEOPLE} | {"moved": moved()})


def drawn(one: Character) -> dict[str, Any]:
    """What is seen of one body, by material, and how far its face can move."""
    look = Look.of(one)
    mesh = build_character(build_skeleton(cast().ages[look.age].height_m), look)
    assert mesh.morphs is not None
    far = np.linalg.norm(mesh.morphs.offsets, axis=-1)  # (units, vertices of the face)
    return {
        **{material.name: measured(mesh, index) for index, material in enumerate(mesh.materials)},
        "face": dict(zip(mesh.morphs.names, (short(unit.max(), unit.mean()) for unit in far), strict=True)),
        "hangs on": short(*np.bincount(mesh.joints.ravel(), mesh.weights.ravel(), minlength=22)),
    }


def measured(mesh: SkinnedMesh, material: int) -> list[float]:
    """Triangles, area, volume, both corners of the box around them, and the mean of their normals."""
    faces = mesh.faces[mesh.face_materials == material]
    corners = mesh.vertices.astype(np.float64)[faces]  # (faces, 3, 3)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    low, high, normal = corners.min(axis=(0, 1)), corners.max(axis=(0, 1)), mesh.normals[faces].mean(axis=(0, 1))
    return short(len(faces), area, np.linalg.det(corners).sum() / 6, *low, *high, *normal)


def moved() -> dict[str, Any]:
    """A body in a motion: its skin, its capsules, its centre of mass, what is in what, and its face."""
    motion = tumbling(height=1.6)
    body = Kinematics.of(motion)
    positions, world = body.positions, body.world
    look = Look.of(Character(member="tom"))
    mesh = build_character(motion.skeleton, look)
    role = Role(look, {0: Emotion.HAPPY, 2: Emotion.ANGRY}, frozenset({3}))
    track = face_track(motion, role)
    poses = motion.skeleton, motion.root_positions[::13], motion.local_rotations[::13]
    points, mannequin = skin(mesh, *poses, track[::13])[0], skin(build_mannequin(motion.skeleton), *poses)[0]
    centres = centres_of_mass(motion.skeleton, positions, world)
    starts, ends, radii = placed(motion.skeleton, positions[::13], world[::13])
    return {
        "skin": [short(*one.mean(axis=1).ravel(), *one.std(axis=1).ravel()) for one in (points, mannequin)],
        "face": [short(*row) for row in track[::5]],
        "capsules": short(*starts.mean(axis=(0, 1)), *ends.mean(axis=(0, 1)), *radii),
        "mass": [short(*row) for row in centres[::8]],
        "carried": [short(*row) for row in zero_moment_points(centres, motion.fps)[::8]],
        "deepest": [*deepest_pair(motion.skeleton, positions, world)],
        "deep": short(*self_penetration(motion.skeleton, positions, world)[::4]),
    }  # fmt: skip


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
