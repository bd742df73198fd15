"""The person we draw: a clothed mannequin made of blended shapes, with soft skin weights.

It is made for the reference skeleton's T-pose and scaled with the body. Collision and contact elsewhere rely on its
outlines: about 0.10 m from the pelvis to the back, 0.09 m to the seat.

Thin and stout, large heads and small: a mannequin whose flesh is more or less, on the same bones.

The flesh of every joint is stretched about the joint, across its bone, and skin weights blend what neighbours do. Only
the picture changes: motions, contacts and the solids of a body are those of the skeleton.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np

from motion_backend.body import mannequin_clothes
from motion_backend.body.mesh_pieces import Piece, assembled, cut_all
from motion_backend.body.skin_weights import weigh_arm, weigh_head, weigh_shirt, weigh_shoe, weigh_spine, weigh_trousers
from motion_backend.body.skinning import Material, SkinnedMesh
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


SKIN = Material("skin", (0.80, 0.59, 0.46), 0.7)
SHIRT = Material("shirt", (0.29, 0.47, 0.66), 0.9)
TROUSERS = Material("trousers", (0.23, 0.25, 0.31), 0.9)
SHOES = Material("shoes", (0.42, 0.27, 0.19), 0.6)
SOLES = Material("soles", (0.86, 0.83, 0.77), 0.8)
HAIR = Material("hair", (0.20, 0.14, 0.11), 0.75)
EYES = Material("eyes", (0.10, 0.09, 0.10), 0.4)


@lru_cache(maxsize=1)
def _reference_mesh() -> SkinnedMesh:
    """The mannequin of the reference height."""
    return assembled(cut_all(_pieces()))


def build_mannequin(skeleton: Skeleton, proportions: Proportions = AVERAGE) -> SkinnedMesh:
    """The mannequin for a skeleton of our proportions, scaled to its height."""
    mesh = _reference_mesh()
    if proportions != AVERAGE:
        mesh = shaped(mesh, proportions)
    return replace(mesh, vertices=(mesh.vertices * skeleton.scale).astype(np.float32))


def _pieces() -> tuple[Piece, ...]:
    torso, leg = ((-0.42, -0.02, -0.2), (0.42, 0.6, 0.2)), ((-0.25, -0.85, -0.2), (0.25, 0.15, 0.2))
    head, eye = ((-0.12, 0.44, -0.14), (0.12, 0.84, 0.15)), ((0.0, 0.65, 0.04), (0.07, 0.73, 0.12))
    brow, hand = ((0.0, 0.69, 0.05), (0.06, 0.74, 0.11)), ((0.69, 0.42, -0.07), (0.91, 0.52, 0.09))
    arm, foot = ((0.27, 0.40, -0.09), (0.80, 0.56, 0.12)), ((0.0, -0.93, -0.12), (0.18, -0.75, 0.24))
    return (
        Piece(TROUSERS, mannequin_clothes.trousers(), leg, (0.025, 0.034, 0.025), weigh_trousers),
        Piece(SHIRT, mannequin_clothes.shirt(), torso, (0.022, 0.026, 0.024), weigh_shirt),
        Piece(SKIN, mannequin_clothes.head(), head, (0.015, 0.015, 0.014), weigh_spine),
        Piece(HAIR, mannequin_clothes.hair(), head, (0.017, 0.017, 0.017), weigh_head),
        Piece(EYES, mannequin_clothes.eyes(), eye, (0.0042, 0.0045, 0.0042), weigh_head, True),
        Piece(HAIR, mannequin_clothes.brows(), brow, (0.0055, 0.0045, 0.0055), weigh_head, True),
        Piece(SKIN, mannequin_clothes.arm(), arm, (0.022, 0.014, 0.014), weigh_arm, True),
        Piece(SKIN, mannequin_clothes.hand(), hand, (0.0095, 0.0075, 0.0062), weigh_arm, True),
        Piece(SHOES, mannequin_clothes.shoe(), foot, (0.017, 0.016, 0.022), weigh_shoe, True),
        Piece(SOLES, mannequin_clothes.sole(), foot, (0.016, 0.0085, 0.019), weigh_shoe, True),
    )
