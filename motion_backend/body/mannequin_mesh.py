"""The person we draw: a clothed mannequin made of blended shapes, with soft skin weights.

It is made for the reference skeleton's T-pose and scaled with the body. Collision and contact elsewhere rely on its
outlines: about 0.10 m from the pelvis to the back, 0.09 m to the seat.

Thin and stout, large heads and small: a mannequin whose flesh is more or less, on the same bones.

The flesh of every joint is stretched about the joint, across its bone, and skin weights blend what neighbours do. Only
the picture changes: motions, contacts and the solids of a body are those of the skeleton.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from motion_backend.body import mannequin_clothes
from motion_backend.body.implicit_surface import Field, gradient, to_triangles
from motion_backend.body.skinning import Material, SkinnedMesh, strongest_four
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, Skeleton, build_skeleton

MIN_PROPORTION, MAX_PROPORTION = 0.8, 1.25
_HIPS, _CHEST = ("pelvis", "spine1"), ("spine2", "spine3")
_LEGS, _ARMS = ("hip", "knee"), ("elbow", "shoulder")


@dataclass(frozen=True)
class Proportions:
    """Sizes against the average body, each from 0.8 to 1.25. ValueError names the one that is not."""

    girth: float = 1.0
    """Breadth and depth of the trunk."""
    chest: float = 1.0
    """Breadth of the chest alone."""
    hips: float = 1.0
    """Breadth of the hips alone."""
    limbs: float = 1.0
    """Thickness of arms and legs."""
    head: float = 1.0

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if not MIN_PROPORTION <= value <= MAX_PROPORTION:
                raise ValueError(
                    f"proportions.{one.name} must lie between {MIN_PROPORTION} and {MAX_PROPORTION}, got {value}"
                )


AVERAGE = Proportions()


def shaped(mesh: SkinnedMesh, proportions: Proportions) -> SkinnedMesh:
    """A mesh of the reference height with other proportions."""
    more = _stretches(proportions) - 1.0
    held = more[mesh.joints]  # (V, 4, 3)
    away = mesh.vertices[:, None] - build_skeleton().rest_positions[mesh.joints]
    shares = mesh.weights[..., None]
    normals = mesh.normals / (1.0 + np.sum(shares * held, axis=1))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = mesh.vertices + np.sum(shares * held * away, axis=1)
    return replace(mesh, vertices=vertices.astype(np.float32), normals=normals.astype(np.float32))


def _stretches(proportions: Proportions) -> Array:
    """How much the flesh of each joint is stretched along x, y and z of the T-pose. (J, 3)."""
    girth, limbs, head = proportions.girth, proportions.limbs, proportions.head
    stretches = np.ones((len(JOINTS), 3))
    for names, breadth in ((_HIPS, proportions.hips), (_CHEST, proportions.chest)):
        stretches[[INDEX[name] for name in names]] = (girth * breadth, 1.0, girth)
    for side in ("left_", "right_"):
        stretches[[INDEX[side + name] for name in _LEGS]] = (limbs, 1.0, limbs)
        stretches[[INDEX[side + name] for name in _ARMS]] = (1.0, limbs, limbs)
        # Between trunk and arm, and no thicker than the arm at the sleeve's seam.
        stretches[INDEX[side + "collar"]] = (1.0, 1.0, girth)
    stretches[INDEX["head"]] = head
    return stretches


Weights = dict[str, Array]

SKIN = Material("skin", (0.80, 0.59, 0.46), 0.7)
SHIRT = Material("shirt", (0.29, 0.47, 0.66), 0.9)
TROUSERS = Material("trousers", (0.23, 0.25, 0.31), 0.9)
SHOES = Material("shoes", (0.42, 0.27, 0.19), 0.6)
SOLES = Material("soles", (0.86, 0.83, 0.77), 0.8)
HAIR = Material("hair", (0.20, 0.14, 0.11), 0.75)
EYES = Material("eyes", (0.10, 0.09, 0.10), 0.4)
MATERIALS = (SKIN, SHIRT, TROUSERS, SHOES, SOLES, HAIR, EYES)
_COVERED = 0.006
"""Metres below another piece's surface from which a vertex counts as out of sight."""


@dataclass(frozen=True)
class _Piece:
    """One closed surface of one material: its field, the box it lies in, and how fine it is cut."""

    material: Material
    field: Field
    box: tuple[tuple[float, float, float], tuple[float, float, float]]
    cell: tuple[float, float, float]
    weigh: Callable[[Array], Weights]
    two_sided: bool = False
    """Modelled on the left and mirrored to the right."""


@lru_cache(maxsize=4)
def _reference_mesh() -> SkinnedMesh:
    """The mannequin of the reference height."""
    vertices, normals, faces, weights, looks = [], [], [], [], []
    count = 0
    pieces = _pieces()
    for piece in pieces:
        points, triangles = to_triangles(piece.field, *piece.box, piece.cell)
        points, triangles = _without_hidden(points, triangles, [p.field for p in pieces if p is not piece])
        slope = gradient(piece.field, points)
        slope /= np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-9)
        dense = _dense(piece.weigh(points), len(points))
        sides = [(points, slope, triangles, dense)]
        if piece.two_sided:
            flip = np.array([-1.0, 1.0, 1.0])
            sides.append((points * flip, slope * flip, triangles[:, ::-1], dense[:, _OTHER_SIDE]))
        for side_points, side_normals, side_faces, side_weights in sides:
            vertices.append(side_points)
            normals.append(side_normals)
            faces.append(side_faces + count)
            weights.append(side_weights)
            looks.append(np.full(len(side_faces), MATERIALS.index(piece.material)))
            count += len(side_points)
    joints, shares = strongest_four(np.concatenate(weights))
    order = np.argsort(np.concatenate(looks), kind="stable")
    return SkinnedMesh(
        vertices=np.concatenate(vertices).astype(np.float32),
        normals=np.concatenate(normals).astype(np.float32),
        faces=np.concatenate(faces)[order].astype(np.uint32),
        joints=joints,
        weights=shares,
        materials=MATERIALS,
        face_materials=np.concatenate(looks)[order].astype(np.uint8),
    )


def build_mannequin(skeleton: Skeleton, proportions: Proportions = AVERAGE) -> SkinnedMesh:
    """The mannequin for a skeleton of our proportions, scaled to its height."""
    mesh = _reference_mesh()
    if proportions != AVERAGE:
        mesh = shaped(mesh, proportions)
    return replace(mesh, vertices=(mesh.vertices * skeleton.scale).astype(np.float32))


_OTHER_SIDE = [
    INDEX[name.replace("left_", "right_") if name.startswith("left_") else name.replace("right_", "left_")]
    for name in JOINTS
]


def _without_hidden(points: Array, faces: NDArray[np.int64], covers: list[Field]) -> tuple[Array, NDArray[np.int64]]:
    """What other pieces do not cover: no one sees the arm inside the sleeve."""
    deep = np.any([field(points) < -_COVERED for field in covers], axis=0)
    faces = faces[~deep[faces].all(axis=1)]
    used, renumbered = np.unique(faces, return_inverse=True)
    return points[used], renumbered.reshape(-1, 3)


def _dense(weights: Weights, count: int) -> Array:
    dense = np.zeros((count, len(JOINTS)))
    for joint, share in weights.items():
        dense[:, INDEX[joint]] = share
    return dense


def _pieces() -> tuple[_Piece, ...]:
    torso, leg = ((-0.42, -0.02, -0.2), (0.42, 0.6, 0.2)), ((-0.25, -0.85, -0.2), (0.25, 0.15, 0.2))
    head, eye = ((-0.12, 0.44, -0.14), (0.12, 0.84, 0.15)), ((0.0, 0.65, 0.04), (0.07, 0.73, 0.12))
    brow, hand = ((0.0, 0.69, 0.05), (0.06, 0.74, 0.11)), ((0.69, 0.42, -0.07), (0.91, 0.52, 0.09))
    arm, foot = ((0.27, 0.40, -0.09), (0.80, 0.56, 0.12)), ((0.0, -0.93, -0.12), (0.18, -0.75, 0.24))
    return (
        _Piece(TROUSERS, mannequin_clothes.trousers(), leg, (0.025, 0.034, 0.025), _weigh_trousers),
        _Piece(SHIRT, mannequin_clothes.shirt(), torso, (0.022, 0.026, 0.024), _weigh_shirt),
        _Piece(SKIN, mannequin_clothes.head(), head, (0.015, 0.015, 0.014), _weigh_spine),
        _Piece(HAIR, mannequin_clothes.hair(), head, (0.017, 0.017, 0.017), _weigh_head),
        _Piece(EYES, mannequin_clothes.eyes(), eye, (0.0042, 0.0045, 0.0042), _weigh_head, True),
        _Piece(HAIR, mannequin_clothes.brows(), brow, (0.0055, 0.0045, 0.0055), _weigh_head, True),
        _Piece(SKIN, mannequin_clothes.arm(), arm, (0.022, 0.014, 0.014), _weigh_arm, True),
        _Piece(SKIN, mannequin_clothes.hand(), hand, (0.0095, 0.0075, 0.0062), _weigh_arm, True),
        _Piece(SHOES, mannequin_clothes.shoe(), foot, (0.017, 0.016, 0.022), _weigh_shoe, True),
        _Piece(SOLES, mannequin_clothes.sole(), foot, (0.016, 0.0085, 0.019), _weigh_shoe, True),
    )


def _rise(x: Array, middle: float, half: float) -> Array:
    """From 0 to 1, smoothly, over middle ± half."""
    t = np.clip((x - middle + half) / (2 * half), 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _hand_on(weights: Weights, parent: str, child: str, share: Array) -> None:
    """Move a share of what hangs on the parent to its child."""
    weights[child] = weights[parent] * share
    weights[parent] = weights[parent] * (1 - share)


def _weigh_spine(p: Array) -> Weights:
    y = p[:, 1]
    weights = {"pelvis": np.ones(len(p))}
    chain = (("pelvis", "spine1", 0.10), ("spine1", "spine2", 0.22), ("spine2", "spine3", 0.34))
    for parent, child, middle in chain:
        _hand_on(weights, parent, child, _rise(y, middle, 0.07))
    # The neck turns only what is near the middle: shoulders are as high as its root.
    _hand_on(weights, "spine3", "neck", _rise(y - 0.5 * np.abs(p[:, 0]), 0.53, 0.04))
    _hand_on(weights, "neck", "head", _rise(y - 0.35 * p[:, 2], 0.615, 0.035))
    return weights


def _weigh_head(p: Array) -> Weights:
    return {"head": np.ones(len(p))}


def _weigh_shirt(p: Array) -> Weights:
    weights = _weigh_spine(p)
    for side, x in (("left_", p[:, 0]), ("right_", -p[:, 0])):
        # The band tilts, so that the armpit stays with the chest and the top of the shoulder goes with the arm.
        outward = x + 0.55 * (p[:, 1] - 0.485)
        _hand_on(weights, "spine3", side + "collar", _rise(outward, 0.11, 0.06))
        _hand_on(weights, side + "collar", side + "shoulder", _rise(outward, 0.185, 0.05))
    return weights


def _weigh_arm(p: Array) -> Weights:
    weights = {"left_shoulder": np.ones(len(p))}
    _hand_on(weights, "left_shoulder", "left_elbow", _rise(p[:, 0], 0.472, 0.045))
    _hand_on(weights, "left_elbow", "left_wrist", _rise(p[:, 0], 0.718, 0.028))
    return weights


def _weigh_trousers(p: Array) -> Weights:
    weights = {"pelvis": np.ones(len(p))}
    _hand_on(weights, "pelvis", "spine1", _rise(p[:, 1], 0.10, 0.07))
    for side, x in (("left_", p[:, 0]), ("right_", -p[:, 0])):
        below = 0.45 * (x - 0.088) - p[:, 1]
        _hand_on(weights, "pelvis", side + "hip", _rise(below, 0.015, 0.075) * _rise(x, 0.0, 0.03))
        _hand_on(weights, side + "hip", side + "knee", _rise(-p[:, 1], 0.4165, 0.06))
    return weights


def _weigh_shoe(p: Array) -> Weights:
    weights = {"left_ankle": np.ones(len(p))}
    _hand_on(weights, "left_ankle", "left_foot", _rise(p[:, 2], 0.115, 0.025))
    return weights
