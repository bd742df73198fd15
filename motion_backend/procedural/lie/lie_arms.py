"""Arms that bear a body that lies down or gets up: elbows stay on what is lain on, and not in it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.held_poses import UP
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

ELBOW: Final = 0.04
"""Height of an elbow over what it lies on (metres)."""
LEVEL: Final = 1e-6
"""An arm that points so straight up or down has no higher side."""


def elbows_over(pose: Pose, surface: float, skeleton: Skeleton) -> Pose:
    """The same motion with elbows swung up that would be in the mattress, as far as their hands are laid on it."""
    frame = chest_frame(pose, skeleton)
    elbows = pose.elbows.copy()
    for index in (0, 1):
        arm = Arm.of(pose, skeleton, index, frame)
        raised = _raised(arm, surface + ELBOW, pose.reaching[:, index, None])
        elbows[:, index] = arm.in_chest(raised)
    return replace(pose, elbows=elbows)


def _raised(arm: Arm, height: float, share: Array) -> Array:
    """Where the elbow points, swung round the line to the wrist no farther than until it is at that height. (T, 3).

    `share` (T, 1) is how much of that is done.
    """
    way, upper = rotations.normalize(arm.way), arm.lengths[0] * arm.limb.upper
    along = rotations.dot(upper, way) * way
    aside = upper - along
    high = UP - way[:, 1:2] * way
    steep = np.maximum(rotations.length(high), LEVEL)
    first = high / steep
    second = rotations.cross(way, first)
    angle = np.arctan2(rotations.dot(aside, second), rotations.dot(aside, first))
    middle = (arm.shoulder + along)[:, 1:2]
    wanted = (height - middle) / np.maximum(rotations.length(aside) * steep, LEVEL)
    most = np.arccos(np.clip(wanted, -1.0, 1.0))
    angle = angle + share * (np.clip(angle, -most, most) - angle)
    return np.asarray(np.cos(angle) * first + np.sin(angle) * second)
