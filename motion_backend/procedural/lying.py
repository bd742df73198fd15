"""Lying: on the back or a side, on a bed, a sofa or the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.lie_styles import Lying
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.stances import UP, bend
from motion_backend.procedural.styles import arm_arrays
from motion_backend.skeleton import LYING_REST, Skeleton
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bed:
    """A place to lie, as the body needs it."""

    pelvis: Array
    """(3,) where the pelvis joint rests when lying on the back."""
    head_yaw: float
    """Direction from pelvis to head."""

    @staticmethod
    def of(spot: Spot) -> Bed:
        """The bed of a lie spot."""
        return Bed(np.asarray(spot.point) + LYING_REST * np.asarray(spot.normal), spot.facing)

    def hips(self, side: str) -> Array:
        """Pelvis rotation lying on the back, or on the left or right side. (4,)."""
        up_the_bed = np.array([np.sin(self.head_yaw), 0.0, np.cos(self.head_yaw)])
        supine = rotations.basis_to_quat(np.cross(up_the_bed, UP), up_the_bed, UP)
        roll = {"back": 0.0, "left": np.radians(66), "right": -np.radians(66)}[side]
        return rotations.compose(supine, rotations.rotvec_to_quat(np.array([0.0, roll, 0.0])))


def lying(start: Pose, bed: Bed, style: Lying, skeleton: Skeleton, pillow: float) -> Pose:
    """Settled on a bed, sofa or the floor; `pillow` is how far the head is raised (metres)."""
    hips = bed.hips(style.side)
    on_side = style.side != "back"
    pelvis = bed.pelvis + (0.025 * UP if on_side else 0.0)
    legs = _SIDE_LEGS if on_side else _BACK_LEGS
    rows: Sequence[Sequence[float]] = legs.get(style.legs, legs["straight"])
    if style.side == "right":
        rows = [(-x, y, z, pitch) for x, y, z, pitch in reversed(rows)]
    local = np.array([row[:3] for row in rows]) * skeleton.scale
    pitch = np.array([row[3] for row in rows])
    ankles = pelvis + rotations.rotate(hips, local)
    feet = np.stack([rotations.compose(hips, rotations.rotvec_to_quat(np.array([p, 0.0, 0.0]))) for p in pitch])
    wrists, elbows = _lying_arms(style)
    lift = np.arctan2(pillow, 0.30)
    return replace(
        start,
        pelvis=pelvis,
        hips=hips,
        spine=bend(np.radians(style.prop) + (0.0 if on_side else 0.25 * lift), side=0.24 * _off_the_bed(style.side)),
        head=bend(0.25 if on_side else 0.6 * lift, side=(0.3 * lift - 0.2) * _off_the_bed(style.side)),
        ankles=ankles,
        feet=feet,
        toes=np.zeros(2),
        knees=np.stack([rotations.rotate(hips, np.array([0.12 * side, 0.0, 1.0])) for side in (1, -1)]),
        arms=wrists,
        elbows=elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.zeros(2),
    )


def _off_the_bed(side: str) -> float:
    """Sign of the side bend that lifts the trunk off the shoulder it lies on."""
    return {"back": 0.0, "left": 1.0, "right": -1.0}[side]


# Ankles in the pelvis frame (left, towards the head, forwards) and foot pitch: left row, right row.
_BACK_LEGS = {
    "straight": ((0.11, -0.822, -0.035, 0.35), (-0.11, -0.822, -0.035, 0.35)),
    "left_bent": ((0.11, -0.47, -0.02, 1.45), (-0.11, -0.822, -0.035, 0.35)),
    "right_bent": ((0.11, -0.822, -0.035, 0.35), (-0.11, -0.47, -0.02, 1.45)),
    "bent": ((0.11, -0.47, -0.02, 1.45), (-0.11, -0.47, -0.02, 1.45)),
    "crossed": ((-0.02, -0.81, 0.06, 0.35), (0.015, -0.822, -0.035, 0.35)),
}


_SIDE_LEGS = {
    "straight": ((0.03, -0.815, 0.02, 0.4), (-0.09, -0.80, 0.05, 0.4)),
    "bent": ((0.04, -0.60, -0.10, 0.5), (-0.08, -0.58, -0.06, 0.5)),
    "left_bent": ((0.04, -0.55, -0.10, 0.5), (-0.08, -0.80, 0.05, 0.4)),
    "right_bent": ((0.04, -0.80, 0.02, 0.4), (-0.03, -0.55, 0.06, 0.5)),
    "crossed": ((0.03, -0.80, 0.10, 0.4), (-0.08, -0.78, -0.05, 0.4)),
}


def _lying_arms(style: Lying) -> tuple[Array, Array]:
    wrists, elbows = arm_arrays(*style.arms)
    if style.side == "back":
        for index, name in enumerate(style.arms):
            if name == "sides":
                wrists[index, 2], wrists[index, 0] = -0.03, wrists[index, 0] * 1.25
            if name == "wide":
                elbows[index] = (0.0, -0.5, 0.4)
            if name == "behind_head":
                # Elbows point up rather than out, where a backrest may be.
                elbows[index] = (0.5 if index == 0 else -0.5, 0.2, 0.85)
        return wrists, elbows
    below, above = (0, 1) if style.side == "left" else (1, 0)
    inward = np.array([-1.0 if above == 0 else 1.0, 1.0, 1.0])
    wrists[below], elbows[below] = (-0.10 if below == 0 else 0.10, 0.36, 0.30), (0.0, -0.4, 0.9)
    if style.arms[above] != "belly":
        wrists[above] = np.array([0.52, -0.42, 0.52]) * inward
        elbows[above] = np.array([0.4, -0.8, 0.4]) * inward
    else:
        wrists[above] = np.array([0.14, -0.55, 0.42]) * inward
        elbows[above] = np.array([-1.0, -0.3, -0.2]) * inward
    return wrists, elbows
