"""Poses that hold: standing and seated, from a style and the place they are held at, and the life in a held pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.kinematics import two_bone
from motion_backend.procedural.footsteps import home_ankle
from motion_backend.procedural.gait import drift
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.sit_styles import Seated
from motion_backend.procedural.solving import chest_frame
from motion_backend.procedural.styles import THIGHS, Bearing, arm_arrays
from motion_backend.skeleton import INDEX, SEATED_REST, Skeleton
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]


SHIN_REACH = 0.42
"""Seated pelvis to ankle on the floor with upright shins, at the reference height."""


FOOT_SPLAY = 0.10


TAILOR_HEIGHT = 0.30
"""Below this pelvis height crossed legs are folded on the floor (metres at 1.70 m)."""


UP = np.array([0.0, 1.0, 0.0])


def upright(yaw: float, pitch: float = 0.0) -> Array:
    """Pelvis rotation heading `yaw`, bent forward by `pitch` radians. (4,)."""
    return rotations.compose(rotations.yaw_to_quat(yaw), rotations.rotvec_to_quat(np.array([pitch, 0.0, 0.0])))


def bend(forward: float, side: float = 0.0, turn: float = 0.0) -> Array:
    """A rotation vector of spine or head: forward bend, turn to the left, side bend. (3,)."""
    return np.array([forward, turn, side])


def standing(position: tuple[float, float], yaw: float, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """Standing on both feet at [x, z]."""
    ground = np.asarray(position, dtype=np.float64)
    ankles = np.stack([home_ankle(ground, yaw, index, 0.085, skeleton) for index in (0, 1)])
    wrists, elbows = arm_arrays(*bearing.arms)
    lean = np.radians(bearing.lean)
    height = skeleton.standing_height * 0.998 - 0.004 * skeleton.scale
    return Pose(
        pelvis=np.array([ground[0], height, ground[1]]),
        hips=upright(yaw, 0.3 * lean),
        spine=bend(0.7 * lean),
        head=bend(np.radians(bearing.head)),
        ankles=ankles,
        feet=np.stack([rotations.yaw_to_quat(yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        toes=np.zeros(2),
        knees=np.stack([_ahead(yaw + side * 0.06) for side in (1, -1)]),
        arms=wrists,
        elbows=elbows,
        reach=ankles + UP,
        reaching=np.zeros(2),
        palms=np.tile(rotations.IDENTITY, (2, 1)),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _ahead(yaw: float) -> Array:
    return np.array([np.sin(yaw), 0.0, np.cos(yaw)])


@dataclass(frozen=True)
class Seat:
    """A place to sit, as the body needs it."""

    pelvis: Array
    """(3,) where the pelvis joint rests."""
    yaw: float
    back: float
    """Distance from the pelvis to the backrest behind it."""
    edge: float = 0.0
    """Distance from the pelvis to the front edge."""

    @staticmethod
    def of(spot: Spot) -> Seat:
        """The seat of a sit spot."""
        pelvis = np.asarray(spot.point) + SEATED_REST * np.asarray(spot.normal)
        return Seat(pelvis, spot.facing, spot.back, spot.edge)

    def to_world(self, right_up_ahead: tuple[float, float, float]) -> Array:
        """A point given to the sitter's left, up from the floor and ahead of the pelvis. (3,)."""
        left, up, ahead = right_up_ahead
        sin, cos = np.sin(self.yaw), np.cos(self.yaw)
        x = self.pelvis[0] + left * cos + ahead * sin
        z = self.pelvis[2] - left * sin + ahead * cos
        return np.array([x, up, z])


def seated(start: Pose, seat: Seat, style: Seated, skeleton: Skeleton, reach: tuple[float, float]) -> Pose:
    """Settled on a seat; feet where `legs` puts them, `reach` metres ahead at most for left and right."""
    limit = np.pi if np.isinf(seat.back) else np.arcsin(np.clip((seat.back - 0.12) / 0.42, 0.0, 0.9))
    back = min(np.radians(style.recline), float(limit) + 0.03, np.radians(10 if np.isinf(seat.back) else 40))
    wrists, elbows = arm_arrays(*style.arms)
    laid = np.array([1.0 if name == THIGHS else 0.0 for name in style.arms])
    ankles, feet, knees = _seated_legs(seat, style, skeleton, reach)
    return replace(
        start,
        pelvis=seat.pelvis.copy(),
        hips=upright(seat.yaw, -0.6 * back if back > 0 else -0.45 * back),
        spine=bend(-0.4 * back if back > 0 else -0.55 * back),
        head=bend(np.radians(style.head) + (0.5 * back if back > 0 else 0.0)),
        ankles=ankles,
        feet=feet,
        toes=np.zeros(2),
        knees=knees,
        arms=wrists,
        elbows=elbows,
        reaching=laid,
        palms=np.stack([_palm_down(seat.yaw, side) for side in (1, -1)]),
        pressing=laid,
        planted=np.ones(2),
    )


def _palm_down(yaw: float, side: int) -> Array:
    """World rotation of a hand lying flat with its fingers pointing along yaw; at rest fingers point to ±X. (4,)."""
    return rotations.yaw_to_quat(yaw - side * np.pi / 2)


def _seated_legs(
    seat: Seat, style: Seated, skeleton: Skeleton, reach: tuple[float, float]
) -> tuple[Array, Array, Array]:
    scale, ankle = skeleton.scale, skeleton.ankle_height
    drop = seat.pelvis[1] - ankle
    longest = _stretch(seat, drop, scale)
    ankles, feet, knees = [], [], []
    for index, side in ((0, 1), (1, -1)):
        wide, ahead, up, pitch, outward = 0.10 * scale, SHIN_REACH * scale, ankle, 0.0, 0.10
        stretched = style.legs in ("straight", "feet_crossed") or style.legs == f"{('left', 'right')[index]}_straight"
        if stretched:
            ahead = float(np.clip(longest, 0.2, max(reach[index], SHIN_REACH * scale)))
            straight = np.clip((ahead / scale - SHIN_REACH) / 0.25, 0, 1)
            pitch, up = -0.55 * straight, ankle + 0.012 * straight
        if style.legs == "feet_crossed":
            wide, up = (-0.035 if side > 0 else 0.005) * scale, up + (0.14 if side > 0 else 0.0) * scale
            ahead += (0.04 if side > 0 else 0.0) * scale
        if style.legs == "open":
            wide, outward = 0.21 * scale, 0.45
        tailor = style.legs == "crossed" and seat.pelvis[1] < TAILOR_HEIGHT * scale
        if tailor:
            wide, ahead, outward = -0.07 * scale, (0.27 if side > 0 else 0.34) * scale, 1.15
        elif style.legs == "crossed" and side < 0:
            wide, ahead, up, pitch = -0.13 * scale, 0.56 * scale, seat.pelvis[1] - 0.21 * scale, 0.45
        if style.legs == "drawn":
            ahead = 0.30 * scale
        ankles.append(seat.to_world((side * wide, max(up, ankle), min(ahead, max(reach[index], 0.34 * scale)))))
        feet.append(upright(seat.yaw + side * FOOT_SPLAY, pitch))
        raised = 0.55 if style.legs == "crossed" and side < 0 and not tailor else 0.25
        knees.append(_ahead(seat.yaw + side * outward) + raised * UP)
    return np.stack(ankles), np.stack(feet), np.stack(knees)


def _stretch(seat: Seat, drop: float, scale: float) -> float:
    """How far ahead a stretched foot goes: as far as the thigh clears the seat's front edge (metres)."""
    thigh, shank = 0.4165 * scale, 0.418 * scale
    for ahead in np.arange(0.80, SHIN_REACH, -0.01) * scale:
        reach = float(np.hypot(ahead, drop))
        if reach > 0.80 * scale:
            continue
        # The knee lies above the line from hip to ankle: the thigh's slope follows from the triangle they make.
        inner = np.arccos(np.clip((thigh**2 + reach**2 - shank**2) / (2 * thigh * reach), -1.0, 1.0))
        sinks = np.tan(np.arctan2(drop, ahead) - inner) * seat.edge
        if sinks < 0.055 * scale:
            return float(ahead)
    return SHIN_REACH * scale


def hands_on_thighs(pose: Pose, skeleton: Skeleton) -> Pose:
    """Point `reach` of every frame at the thighs, for hands that lie on them as far as `reaching` says."""
    names = ("left", "right")
    reach = pose.reach.copy()
    lengths = (
        -float(skeleton.offsets[INDEX["left_knee"], 1]),
        -float(skeleton.offsets[INDEX["left_ankle"], 1]),
    )
    for index, name in enumerate(names):
        hip = pose.pelvis + rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{name}_hip"]])
        leg = two_bone(hip, pose.ankles[:, index], pose.knees[:, index], lengths)
        reach[:, index] = hip + 0.68 * lengths[0] * leg.upper + 0.105 * skeleton.scale * UP
    return replace(pose, reach=reach)


def idle(pose: Pose, seconds: float, size: float, rng: np.random.Generator, fps: int) -> Pose:
    """Hold a single pose for a while, alive: breath, a slow shift of weight, a wandering gaze."""
    frames = max(round(seconds * fps), 1)
    held = pose.repeat(frames)
    ease = (1 - np.exp(-np.arange(1, frames + 1) / (0.4 * fps)))[:, None]
    breath = np.sin(2 * np.pi * 0.27 * np.arange(1, frames + 1) / fps)
    slow = [drift(frames, 0.16, fps, rng) for _ in range(4)]
    on_feet = bool(pose.planted.min() > 0 and pose.pelvis[1] > 0.7)
    spine = held.spine + ease * np.stack([0.018 * breath, 0.020 * size * slow[0], 0.016 * size * slow[1]], axis=1)
    head = held.head + ease * np.stack([0.04 * size * slow[2], 0.16 * size * slow[3], 0.015 * slow[0]], axis=1)
    sway = (0.006 if on_feet else 0.003) * size * ease * np.stack([slow[0], -0.25 * np.abs(slow[0]), slow[1]], axis=1)
    arms = held.arms.copy()
    arms[:, :, 2] += (0.02 * ease[:, 0] * breath)[:, None] * (1 - held.reaching)
    return replace(held, spine=spine, head=head, pelvis=held.pelvis + sway, arms=arms)


def shoulders(pose: Pose, skeleton: Skeleton) -> Array:
    """World positions of both shoulders. (T, 2, 3)."""
    chest, position = chest_frame(pose, skeleton)
    found = []
    for name in ("left", "right"):
        offset = skeleton.offsets[INDEX[f"{name}_collar"]] + skeleton.offsets[INDEX[f"{name}_shoulder"]]
        found.append(position + rotations.rotate(chest, offset))
    return np.stack(found, axis=1)
