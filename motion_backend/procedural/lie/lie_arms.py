"""Arms of a body that lies down or gets up: elbows stay on what is lain on and not in it, hands do not turn over."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.inverse_kinematics import arm_rotations
from motion_backend.procedural.held_poses import UP
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import SIDES, chest_frame, limb_of_arm, wrist_rotations
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

ELBOW: Final = 0.04
"""Height of an elbow over what it lies on (metres)."""
TURNS_OVER: Final = 0.4
"""A wrist that turns by more than this in a frame (radians) is led over."""
LED: Final = 8
"""Frames before and after in which it is."""
LEVEL: Final = 1e-6
"""An arm that points so straight up or down has no higher side."""


def forearms_over(pose: Pose, surface: float, skeleton: Skeleton) -> Pose:
    """The same motion with elbows swung up, round the line from shoulder to wrist, that would be in the mattress."""
    frame = chest_frame(pose, skeleton)
    elbows = pose.elbows.copy()
    for index, (name, side) in enumerate(SIDES):
        upper = abs(float(skeleton.offsets[INDEX[f"{name}_elbow"], 0]))
        limb, _, shoulder = limb_of_arm(pose, skeleton, (index, name, side), frame)
        lower = abs(float(skeleton.offsets[INDEX[f"{name}_wrist"], 0]))
        way = rotations.normalize(upper * limb.upper + lower * limb.lower)
        pole = _raised(shoulder, upper * limb.upper, way, surface + ELBOW, pose.reaching[:, index, None])
        elbows[:, index] = rotations.rotate(rotations.inverse(frame[0]), pole)
    return replace(pose, elbows=elbows)


def wrists_steady(pose: Pose, skeleton: Skeleton) -> Pose:
    """The same motion with hands that would turn over in a frame, for wrists turn only so far, led over in time."""
    frame = chest_frame(pose, skeleton)
    palms, pressing = pose.palms.copy(), pose.pressing.copy()
    for index, (name, side) in enumerate(SIDES):
        if not pressing[:, index].any():
            continue
        limb, _, _ = limb_of_arm(pose, skeleton, (index, name, side), frame)
        _, lower = arm_rotations(limb, side)
        wrists = wrist_rotations(lower, palms[:, index], pressing[:, index], side)
        turns = rotations.compose(rotations.inverse(wrists[:-1]), wrists[1:])
        for stretch in _about(np.flatnonzero(rotations.length(rotations.quat_to_rotvec(turns))[:, 0] > TURNS_OVER)):
            first, last = max(stretch[0], 0), min(stretch[1], len(pose) - 1)
            share = smooth(np.linspace(0.0, 1.0, last - first + 1))
            led = rotations.slerp(wrists[first][None], wrists[last][None], share)
            palms[first : last + 1, index] = rotations.compose(lower[first : last + 1], led)
            pressing[first : last + 1, index] = 1.0
    return replace(pose, palms=palms, pressing=pressing)


def _about(frames: NDArray[np.intp]) -> list[tuple[int, int]]:
    """First and last frames of the stretches about such frames, those that meet in one."""
    if not len(frames):
        return []
    groups = np.split(frames, np.flatnonzero(np.diff(frames) > 2 * LED) + 1)
    return [(int(group[0]) - LED, int(group[-1]) + LED + 1) for group in groups]


def _raised(shoulder: Array, upper: Array, way: Array, height: float, share: Array) -> Array:
    """Where elbows point, swung round `way` no farther than until they are at that height. (T, 3) each to (T, 3).

    `share` (T, 1) is how much of that is done.
    """
    along = rotations.dot(upper, way) * way
    aside = upper - along
    size = rotations.length(aside)
    high = UP - rotations.dot(np.broadcast_to(UP, way.shape), way) * way
    steep = np.maximum(rotations.length(high), LEVEL)
    first = high / steep
    second = rotations.cross(way, first)
    angle = np.arctan2(rotations.dot(aside, second), rotations.dot(aside, first))
    middle = (shoulder + along)[..., 1:2]
    wanted = np.clip((height - middle) / np.maximum(size * steep, LEVEL), -1.0, 1.0)
    most = np.arccos(wanted)
    angle = angle + share * (np.clip(angle, -most, most) - angle)
    return np.asarray(np.cos(angle) * first + np.sin(angle) * second)
