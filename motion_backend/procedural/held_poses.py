"""Poses that hold: standing and seated, from a style and the place they are held at, and the life in a held pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from motion_backend import rotations
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.walk.footsteps import drift, home_ankle
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, SEATED_REST, Skeleton
from scene_graphs.affordances.affordances import Spot

SHIN_REACH = 0.42
"""Seated pelvis to ankle on the floor with upright shins, at the reference height."""


FOOT_SPLAY = 0.10


FLOOR_REACH, LOW = 0.56, 0.30
"""The same where the pelvis comes to rest lower than `LOW`: hips do not fold any further (metres at 1.70 m)."""


UP = np.array([0.0, 1.0, 0.0])


MIRROR = np.array([-1.0, 1.0, 1.0])
"""What makes a left vector, in the body's own frame, a right one."""


def upright(yaw: float, pitch: Array | float = 0.0) -> Array:
    """Pelvis rotation heading `yaw`, bent forward by `pitch` (...) radians. (..., 4)."""
    return rotations.compose(rotations.yaw_to_quat(yaw), rotations.axis_to_quat("x", np.asarray(pitch)))


def bend(forward: float, side: float = 0.0, turn: float = 0.0) -> Array:
    """A rotation vector of spine or head: forward bend, turn to the left, side bend. (3,)."""
    return np.array([forward, turn, side])


def both_sides(left: ArrayLike) -> Array:
    """A vector of the left side (outwards to the left first), and its mirror image for the right. (2, 3)."""
    vector = np.asarray(left, dtype=np.float64)
    return np.stack([vector, vector * MIRROR])


def part_way(start: Array, end: Array, share: ArrayLike) -> Array:
    """So large a share of the way from start to end; at 1 the end itself, to the last bit."""
    shares = np.asarray(share, dtype=np.float64)
    return np.where(shares == 1.0, end, start + shares * (end - start))


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

    def is_low(self, scale: float) -> bool:
        """Whether one sits on the floor, or nearly."""
        return bool(self.pelvis[1] < LOW * scale)

    def standing_point(self, scale: float) -> tuple[float, float]:
        """[x, z] of the pelvis standing before it, over where the feet are when seated."""
        x, _, z = self.to_world((0.0, 0.0, (FLOOR_REACH if self.is_low(scale) else SHIN_REACH) * scale))
        return float(x), float(z)

    def to_world(self, left_up_ahead: ArrayLike) -> Array:
        """Points given to the sitter's left, up from the floor and ahead of the pelvis. (..., 3)."""
        left, up, ahead = np.moveaxis(np.asarray(left_up_ahead, dtype=np.float64), -1, 0)
        sin, cos = np.sin(self.yaw), np.cos(self.yaw)
        x = self.pelvis[0] + left * cos + ahead * sin
        z = self.pelvis[2] - left * sin + ahead * cos
        return np.stack([x, up, z], axis=-1)


def idle(pose: Pose, seconds: float, size: float, rng: np.random.Generator, fps: int) -> Pose:
    """Hold a single pose for a while, alive: breath, a slow shift of weight, a wandering gaze."""
    frames = max(round(seconds * fps), 1)
    held = pose.repeat(frames)
    ease = (1 - np.exp(-np.arange(1, frames + 1) / (0.4 * fps)))[:, None]
    breath = np.sin(2 * np.pi * 0.27 * np.arange(1, frames + 1) / fps)
    slow = [drift(frames, 0.16, fps, rng) for _ in range(4)]
    aside, up = _glances(frames, size, rng, fps)
    on_feet = bool(pose.planted.min() > 0 and pose.pelvis[1] > 0.7)
    spine = held.spine + ease * np.stack([0.018 * breath, 0.020 * size * slow[0], 0.016 * size * slow[1]], axis=1)
    gaze = [0.04 * size * slow[2] + up, 0.16 * size * slow[3] + aside, 0.015 * slow[0]]
    head = held.head + ease * np.stack(gaze, axis=1)
    sway = (0.006 if on_feet else 0.003) * size * ease * np.stack([slow[0], -0.25 * np.abs(slow[0]), slow[1]], axis=1)
    arms = held.arms.copy()
    arms[:, :, 2] += (0.02 * ease[:, 0] * breath)[:, None] * (1 - held.reaching)
    return replace(held, spine=spine, head=head, pelvis=held.pelvis + sway, arms=arms)


def _glances(frames: int, size: float, rng: np.random.Generator, fps: int) -> tuple[Array, Array]:
    """Looks at something aside, now and then, and back: turns of the head to the left and down, radians. (T,) twice."""
    aside, down = np.zeros(frames), np.zeros(frames)
    at = int(rng.uniform(0.8, 2.0) * fps)
    while at + 2 * fps < frames:
        stay, turn = int(rng.uniform(0.9, 1.6) * fps), int(0.4 * fps)
        time = np.arange(frames) - at
        look = smooth(time / turn) * smooth((stay + turn - time) / turn)
        aside += look * float(rng.choice([-1.0, 1.0]) * rng.uniform(0.15, 0.40)) * min(size, 1.3)
        down += look * float(rng.uniform(-0.06, 0.10)) * min(size, 1.3)
        at += stay + turn + int(rng.uniform(1.2, 3.0) * fps)
    return aside, down


def shoulders(pose: Pose, skeleton: Skeleton) -> Array:
    """World positions of both shoulders. (T, 2, 3)."""
    chest, position = chest_frame(pose, skeleton)
    found = []
    for name in ("left", "right"):
        offset = skeleton.offsets[INDEX[f"{name}_collar"]] + skeleton.offsets[INDEX[f"{name}_shoulder"]]
        found.append(position + rotations.rotate(chest, offset))
    return np.stack(found, axis=1)
