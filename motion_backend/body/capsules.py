"""The body as 15 capsules (the contact bodies of SIMS 3.3), and points on their skin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from motion_backend import rotations
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Capsule:
    """A round bar fixed to a joint: its ends in that joint's frame and its radius (metres at 1.70 m)."""

    name: str
    joint: str
    start: Vector
    end: Vector
    radius: float


def _pair(name: str, joint: str, start: Vector, end: Vector, radius: float) -> tuple[Capsule, Capsule]:
    def mirror(v: Vector) -> Vector:
        return (-v[0], v[1], v[2])

    return (
        Capsule(f"left_{name}", f"left_{joint}", start, end, radius),
        Capsule(f"right_{name}", f"right_{joint}", mirror(start), mirror(end), radius),
    )


BODIES = (
    Capsule("pelvis", "pelvis", (-0.055, 0.01, 0.0), (0.055, 0.01, 0.0), 0.09),
    Capsule("torso", "spine2", (0.0, -0.06, 0.0), (0.0, 0.22, 0.0), 0.11),
    Capsule("head", "head", (0.0, 0.03, 0.01), (0.0, 0.09, 0.01), 0.09),
    *_pair("upper_arm", "shoulder", (0.03, 0.0, 0.0), (0.272, 0.0, 0.0), 0.042),
    *_pair("lower_arm", "elbow", (0.02, 0.0, 0.0), (0.228, 0.0, 0.0), 0.034),
    *_pair("hand", "wrist", (0.03, 0.0, 0.0), (0.13, 0.0, 0.0), 0.024),
    *_pair("thigh", "hip", (0.0, -0.06, 0.0), (0.0, -0.37, 0.0), 0.068),
    *_pair("shin", "knee", (0.0, -0.04, 0.0), (0.0, -0.37, 0.0), 0.046),
    *_pair("foot", "ankle", (0.0, -0.034, -0.02), (0.0, -0.036, 0.14), 0.03),
)
SOLE = np.array([[0.0, -0.066, -0.055], [0.0, -0.066, 0.19], [-0.04, -0.066, 0.09], [0.04, -0.066, 0.09]])
"""Heel, toe tip, inner and outer edge of a sole, in the ankle's frame."""


def placed(skeleton: Skeleton, positions: Array, world: Array) -> tuple[Array, Array, Array]:
    """Ends of all capsules in the world, (T, 15, 3) twice, and radii (15,)."""
    joints = [INDEX[body.joint] for body in BODIES]
    starts = np.array([body.start for body in BODIES]) * skeleton.scale
    ends = np.array([body.end for body in BODIES]) * skeleton.scale
    origin, turn = positions[:, joints], world[:, joints]
    radii = np.array([body.radius for body in BODIES]) * skeleton.scale
    return origin + rotations.rotate(turn, starts), origin + rotations.rotate(turn, ends), radii


@lru_cache(maxsize=1)
def _unit() -> tuple[Array, Array, Array]:
    """64 skin points of a capsule: share of the axis, outward direction across it, outward direction along it."""
    angles = np.arange(8) * np.pi / 4
    share, across, along = [], [], []
    for ring in range(8):
        cap = -1 if ring == 0 else 1 if ring == 7 else 0
        for angle in angles + (ring % 2) * np.pi / 8:
            share.append(min(max((ring - 1) / 5, 0.0), 1.0))
            across.append(np.array([np.cos(angle), np.sin(angle)]) * (np.sqrt(0.5) if cap else 1.0))
            along.append(cap * np.sqrt(0.5))
    return np.array(share), np.array(across), np.array(along)


def skin_points(start: Array, end: Array, radius: Array) -> Array:
    """64 points on each of N capsules. (N, 3), (N, 3), (N,) to (N, 64, 3)."""
    share, across, along = _unit()
    axis = rotations.normalize(end - start)
    helper = np.where(np.abs(axis[:, :1]) < 0.8, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = rotations.normalize(rotations.cross(axis, helper))
    second = rotations.cross(axis, first)
    outward = (
        across[:, 0, None] * first[:, None] + across[:, 1, None] * second[:, None] + along[:, None] * axis[:, None]
    )
    return np.asarray(start[:, None] + share[:, None] * (end - start)[:, None] + radius[:, None, None] * outward)
