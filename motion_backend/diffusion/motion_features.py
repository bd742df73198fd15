"""Motion as the diffusion model sees it: 202 numbers a frame, 10 frames a second, in the frame of the last known one.

The heading frame of a window is that of its second frame, the last of its history: origin on the floor under the
pelvis, yaw of the pelvis about +Y. Lengths are those of the body of 1.70 m, whatever the size of the character.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS, Skeleton

WINDOW: Final = 16
"""Frames of a window (LINGO A.1), 1.6 s."""
HISTORY: Final = 2
"""Of these the first, which are the last of the window before, clean."""
RATE: Final = 10
"""Frames a second."""
STRIDE: Final = FPS // RATE
"""Frames of motion from one frame of a window to the next."""
JOINT_COUNT: Final = len(JOINTS)
ROOT: Final = slice(0, 3)
TURNS: Final = slice(3, 3 + 6 * JOINT_COUNT)
PLACES: Final = slice(TURNS.stop, TURNS.stop + 3 * (JOINT_COUNT - 1))
CONTACTS: Final = slice(PLACES.stop, PLACES.stop + 4)
FEATURES: Final = CONTACTS.stop
"""Root, 22 rotations as six numbers, 21 joint positions over the floor under the pelvis, and four contacts."""
_OVER_FLOOR: Final = np.array([1.0, 0.0, 1.0])


@dataclass(frozen=True)
class Poses:
    """Frames of a body, or of many at once, in the world."""

    roots: Array
    """(…, T, 3) metres."""
    local: Array
    """(…, T, 22, 4) local rotations, xyzw."""
    contacts: Array
    """(…, T, 4) of feet: left ankle, left toe, right ankle, right toe."""

    def __len__(self) -> int:
        return int(self.roots.shape[-2])

    def frames(self, chosen: slice) -> Poses:
        """Some of the frames."""
        return Poses(self.roots[..., chosen, :], self.local[..., chosen, :, :], self.contacts[..., chosen, :])

    def followed_by(self, later: Poses) -> Poses:
        """These and then those."""
        return Poses(
            np.concatenate([self.roots, later.roots], axis=-2),
            np.concatenate([self.local, later.local], axis=-3),
            np.concatenate([self.contacts, later.contacts], axis=-2),
        )


@dataclass(frozen=True)
class HeadingFrame:
    """Where features are measured from; of one window, or of many."""

    origin: Array
    """(…, 3) on the floor under the pelvis."""
    yaw: Array
    """(…)."""
    scale: float = 1.0
    """Of the body against that of 1.70 m."""

    @staticmethod
    def of(poses: Poses, scale: float = 1.0, frame: int = HISTORY - 1) -> HeadingFrame:
        """That of one frame, by default the last of a window's history."""
        return HeadingFrame(poses.roots[..., frame, :] * _OVER_FLOOR, twist(poses.local[..., frame, 0, :]), scale)

    def inward(self, points: Array) -> Array:
        """Points of the world (…, 3) in this frame, in lengths of the body of 1.70 m."""
        turn = rotations.yaw_to_quat(-self.yaw)
        return rotations.rotate(turn, points - self.origin) / self.scale

    def outward(self, points: Array) -> Array:
        """The inverse of `inward`."""
        return rotations.rotate(rotations.yaw_to_quat(self.yaw), points * self.scale) + self.origin

    def along_time(self) -> HeadingFrame:
        """The same with an axis for the frames of a window."""
        return HeadingFrame(self.origin[..., None, :], np.asarray(self.yaw)[..., None], self.scale)


def twist(turns: Array) -> Array:
    """The part of rotations (…, 4) that is about +Y: their yaw, defined for a body that lies on its back as well."""
    return np.asarray(2.0 * np.arctan2(turns[..., 1], turns[..., 3]))


def to_features(poses: Poses, frame: HeadingFrame, skeleton: Skeleton) -> Array:
    """What the model sees of poses. (…, T, 202)."""
    shape = poses.roots.shape[:-1]
    frames = frame.along_time()
    flat_roots, flat_local = poses.roots.reshape(-1, 3), poses.local.reshape(-1, JOINT_COUNT, 4)
    positions = skeleton.forward_kinematics(flat_roots, flat_local)[0].astype(np.float64)
    positions = positions.reshape(*shape, JOINT_COUNT, 3)
    local = poses.local.copy()
    local[..., 0, :] = rotations.compose(rotations.yaw_to_quat(-frames.yaw), local[..., 0, :])
    under = HeadingFrame(poses.roots * _OVER_FLOOR, np.broadcast_to(frames.yaw, shape), frame.scale).along_time()
    places = under.inward(positions[..., 1:, :])
    parts = (frames.inward(poses.roots), quat_to_six(local).reshape(*shape, -1), places.reshape(*shape, -1))
    return np.concatenate([*parts, poses.contacts], axis=-1)


def from_features(features: Array, frame: HeadingFrame) -> Poses:
    """Poses in the world from root and rotations; positions follow by forward kinematics, so bones cannot stretch."""
    frames = frame.along_time()
    local = six_to_quat(features[..., TURNS].reshape(*features.shape[:-1], JOINT_COUNT, 6))
    turn = np.broadcast_to(rotations.yaw_to_quat(frames.yaw), local[..., 0, :].shape)
    local[..., 0, :] = rotations.compose(turn, local[..., 0, :])
    return Poses(frames.outward(features[..., ROOT]), local, features[..., CONTACTS])


def quat_to_six(turns: Array) -> Array:
    """The first two columns of rotation matrices, one after the other (Zhou et al. 2019). (…, 4) to (…, 6)."""
    matrix = rotations.quat_to_matrix(turns)
    return np.concatenate([matrix[..., 0], matrix[..., 1]], axis=-1)


def six_to_quat(six: Array) -> Array:
    """Rotations from two columns that need be neither of unit length nor upright on each other. (…, 6) to (…, 4)."""
    first = rotations.normalize(six[..., :3])
    second = rotations.normalize(six[..., 3:] - rotations.dot(first, six[..., 3:]) * first)
    return rotations.basis_to_quat(first, second, rotations.cross(first, second))


def thinned(motion: Motion, start: int = 0) -> Poses:
    """Every third frame of a motion from `start`: 10 a second."""
    chosen = slice(start, None, STRIDE)
    return Poses(
        motion.root_positions[chosen].astype(np.float64),
        motion.local_rotations[chosen].astype(np.float64),
        motion.contacts[chosen].astype(np.float64),
    )


def smoothly_joined(poses: Poses) -> Poses:
    """Frames at 30 a second through frames (T, …) at 10: natural cubic splines, smooth in velocity and acceleration.

    Straight ways and slerp between frames cost as much realism as a bad model: half of what strangers differ by.
    """
    from scipy.interpolate import CubicSpline

    count = len(poses)
    if count < 2:
        return poses
    keys, times = np.arange(count), np.arange((count - 1) * STRIDE + 1) / STRIDE
    roots = CubicSpline(keys, poses.roots, bc_type="natural")(times)
    turns = CubicSpline(keys, rotations.continuous(poses.local), bc_type="natural")(times)
    contacts = poses.contacts[np.minimum(np.round(times).astype(int), count - 1)]
    return Poses(np.asarray(roots), rotations.normalize(turns), contacts)
