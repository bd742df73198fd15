"""Skinned meshes: vertices that follow the skeleton's joints, and where they are in a pose (linear blend skinning)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.skeleton import Skeleton

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Material:
    """One look: sRGB colour and how matt it is."""

    name: str
    color: tuple[float, float, float]
    roughness: float = 0.85


@dataclass(frozen=True)
class Morphs:
    """Ways to move some vertices of a mesh, each by a share: what a face does. They hang on one joint alone."""

    names: tuple[str, ...]
    first: int
    """The first vertex that is moved; all behind it are."""
    offsets: Floats
    """(K, F, 3) metres in the rest pose at a share of 1."""
    joint: int
    """What these vertices hang on."""

    def scaled(self, by: float) -> Morphs:
        """The same for a mesh of another size."""
        return replace(self, offsets=(self.offsets * by).astype(np.float32))


@dataclass(frozen=True)
class SkinnedMesh:
    """A body's surface in the rest pose (pelvis at the origin, T-pose facing +Z) and how it hangs on the joints."""

    vertices: Floats
    """(V, 3) metres."""
    normals: Floats
    """(V, 3) unit."""
    faces: NDArray[np.uint32]
    """(F, 3) counter-clockwise seen from outside, sorted by material."""
    joints: NDArray[np.uint16]
    """(V, 4) joint indices; unused ones are 0 with weight 0."""
    weights: Floats
    """(V, 4), each row sums to 1."""
    materials: tuple[Material, ...]
    face_materials: NDArray[np.uint8]
    """(F,) index into `materials`."""
    morphs: Morphs | None = None
    """None for a mesh without a face that moves."""

    @property
    def face_colors(self) -> Floats:
        """(F, 3) sRGB."""
        return np.array([m.color for m in self.materials], dtype=np.float32)[self.face_materials]


def strongest_four(weights: NDArray[np.floating]) -> tuple[NDArray[np.uint16], Floats]:
    """Dense weights (V, J) to the four largest a vertex: joints (V, 4) and weights (V, 4) that sum to 1."""
    order = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, order, axis=1)
    kept = np.where(kept < 1e-3, 0.0, kept)
    kept = kept / kept.sum(axis=1, keepdims=True)
    return np.where(kept > 0, order, 0).astype(np.uint16), kept.astype(np.float32)


def skin(
    mesh: SkinnedMesh,
    skeleton: Skeleton,
    root_positions: NDArray[np.floating],
    local_rotations: NDArray[np.floating],
    shares: NDArray[np.floating] | None = None,
) -> tuple[Floats, Floats]:
    """World vertices (T, V, 3) and normals (T, V, 3) of a mesh in T poses; `shares` (T, K) of its morphs."""
    from motion_backend.body.skinning_kernel import skin_poses

    positions, world = skeleton.forward_kinematics(np.asarray(root_positions), np.asarray(local_rotations))
    turn = rotations.quat_to_matrix(world)  # (T, J, 3, 3)
    shift = positions - np.einsum("tjab,jb->tja", turn, skeleton.rest_positions)
    frames = np.concatenate([turn, shift[..., None]], axis=-1).astype(np.float64)  # (T, J, 3, 4)
    points, turned = (np.empty((len(frames), *mesh.vertices.shape), dtype=np.float32) for _ in range(2))
    skin_poses(mesh.vertices, mesh.normals, mesh.joints, mesh.weights, frames, points, turned)
    if shares is not None and mesh.morphs is not None:
        moved = np.einsum("tk,kfc->tfc", shares, mesh.morphs.offsets)
        points[:, mesh.morphs.first :] += np.einsum("tab,tfb->tfa", turn[:, mesh.morphs.joint], moved)
    return points, turned
