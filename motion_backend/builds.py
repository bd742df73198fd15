"""Thin and stout, large heads and small: a mannequin whose flesh is more or less, on the same bones.

The flesh of every joint is stretched about the joint, across its bone, and skin weights blend what neighbours do. Only
the picture changes: motions, contacts and the solids of a body are those of the skeleton.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend.skeleton import INDEX, JOINTS, build_skeleton
from motion_backend.skinning import SkinnedMesh

Array = NDArray[np.float64]

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
