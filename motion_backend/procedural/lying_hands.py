"""Where hands rest on a lying body: on the skin or the mattress, palms against it, with elbows on the free side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.solving import chest_frame
from motion_backend.skeleton import Skeleton

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Rest:
    """A left hand at rest, in the chest's frame (left, towards the head, forwards); metres of a body of 1.70 m."""

    wrist: Vector
    elbow: Vector
    """Where the elbow points."""
    fingers: Vector
    back: Vector
    """Where the back of the hand looks: away from what the palm lies on."""
    with_head: bool = False
    """Whether it goes with the head when that is raised."""


SHOULDER: Final = np.array([0.18, 0.135, 0.0])
ARM: Final = 0.54
HEAD: Final = np.array([0.0, 0.35, 0.01])
"""Left shoulder, arm's length and middle of an unbent head in the chest's frame (metres)."""
UPPER_ARM, FOREARM = 0.292, 0.248
NECK, SKULL, MIDDLE = (0.0, 0.20, 0.0), (0.0, 0.09, 0.0), (0.0, 0.06, 0.01)
"""From chest to neck, neck to head joint, and on to the middle of the head."""

BACK: Final[dict[str, Rest]] = {
    "sides": Rest((0.265, -0.365, -0.05), (1.0, 0.0, -0.3), (-0.05, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "close": Rest((0.150, -0.225, 0.132), (0.5, 0.0, -0.85), (-0.80, -0.60, -0.05), (0.0, 0.0, 1.0)),
    "loose": Rest((0.40, -0.29, -0.045), (0.9, -0.5, -0.25), (0.35, -1.0, 0.05), (0.75, 0.0, 0.65)),
    "belly": Rest((0.105, -0.110, 0.155), (1.0, -0.35, -0.45), (-1.0, -0.12, -0.05), (0.0, 0.0, 1.0)),
    "chest": Rest((0.120, 0.010, 0.160), (1.0, -0.75, -0.30), (-1.0, 0.25, -0.05), (0.0, 0.0, 1.0)),
    "behind_head": Rest((0.125, 0.335, -0.085), (1.0, 0.35, 0.30), (-0.85, 0.45, -0.15), (0.0, -0.2, -1.0), True),
    "face": Rest((0.085, 0.275, 0.150), (0.6, -1.0, 0.45), (-0.40, 1.0, 0.0), (0.15, 0.0, 1.0), True),
    "held_above": Rest((0.115, 0.220, 0.390), (0.7, -1.0, 0.0), (-0.1, 0.8, 0.6), (0.95, 0.1, 0.2)),
    "goalpost": Rest((0.400, 0.330, -0.040), (0.8, -0.9, -0.2), (0.05, 1.0, 0.0), (0.0, 0.0, -1.0)),
    "wide": Rest((0.685, 0.130, -0.045), (0.1, -1.0, -0.25), (1.0, 0.05, 0.0), (0.0, 0.0, -1.0)),
}
"""Hands of who lies on the back."""
LOWER: Final = (0.0, -0.065, 0.0)
"""The right hand lies so much lower where both lie on the trunk."""
BELOW: Final[dict[str, Rest]] = {
    "pillow": Rest((0.120, 0.270, 0.125), (-0.35, -0.6, 1.0), (0.05, 0.75, -0.65), (1.0, 0.0, 0.1), True),
    "belly": Rest((0.020, -0.245, 0.190), (0.5, -0.8, 0.1), (-0.85, -0.45, -0.1), (0.0, -0.1, 1.0)),
    "tucked": Rest((0.080, 0.190, 0.265), (0.3, -1.0, 0.6), (-0.15, 0.9, -0.25), (1.0, 0.2, 0.1)),
}
ABOVE: Final[dict[str, Rest]] = {
    "belly": Rest((0.100, -0.155, 0.165), (1.0, -0.30, -0.55), (-1.0, -0.15, -0.15), (0.1, 0.0, 1.0)),
    "before": Rest((-0.085, 0.010, 0.345), (0.9, -0.5, 0.4), (-0.35, 0.55, 0.55), (1.0, 0.0, 0.1)),
    "along": Rest((0.315, -0.345, 0.060), (0.8, 0.2, -0.6), (-0.10, -1.0, 0.20), (1.0, -0.05, 0.1)),
    "tucked": Rest((0.060, 0.110, 0.250), (1.0, -0.8, 0.5), (-0.55, 0.75, -0.2), (0.6, 0.2, 0.8)),
}
"""Hands of who lies on the right side, so that the left arm is above; for the arm below, as if lying on the left."""


def hands_at_rest(pose: Pose, rests: tuple[Rest, Rest], skeleton: Skeleton) -> Pose:
    """A lying pose with its left and right hand at rest."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    raised = rotations.rotate(rotations.inverse(chest), head_middle(pose, skeleton) - place) / skeleton.scale - HEAD
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, rest in enumerate(rests):
        mirror = np.array([1.0 if index == 0 else -1.0, 1.0, 1.0])
        wrist = np.array(rest.wrist) * mirror + (raised if rest.with_head else 0.0)
        arms[index] = (wrist - SHOULDER * mirror) / ARM
        elbows[index] = np.array(rest.elbow) * mirror
        x = rotations.normalize(np.array(rest.fingers) * mirror) * mirror[0]
        back = np.array(rest.back) * mirror
        y = rotations.normalize(back - (back @ x) * x)
        palms[index] = rotations.compose(chest, rotations.basis_to_quat(x, y, rotations.cross(x, y)))
    return replace(pose, arms=arms, elbows=elbows, palms=palms, pressing=np.ones(2), reaching=np.zeros(2))


def head_middle(pose: Pose, skeleton: Skeleton) -> Array:
    """Where the middle of the head is in the world; `pose.head` may hold many tries. (..., 3)."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    half = rotations.rotvec_to_quat(pose.head / 2)
    on_neck = np.array(SKULL) + rotations.rotate(half, np.array(MIDDLE))
    local = np.array(NECK) + rotations.rotate(half, on_neck)
    return np.asarray(place + rotations.rotate(chest, local * skeleton.scale))


def propped(pose: Pose, height: float, skeleton: Skeleton) -> Pose:
    """On the elbows: they stand on the mattress (`height` in the world) under the shoulders, the forearms lie ahead."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    back = rotations.inverse(chest)
    ahead = rotations.normalize(rotations.rotate(pose.hips, np.array([0.0, -1.0, 0.0])) * [1.0, 0.0, 1.0])
    aside = rotations.rotate(pose.hips, np.array([1.0, 0.0, 0.0]))
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, side in enumerate((1.0, -1.0)):
        mirror = np.array([side, 1.0, 1.0])
        shoulder = place + rotations.rotate(chest, SHOULDER * mirror * skeleton.scale)
        drop = min(shoulder[1] - height - 0.04, 0.99 * UPPER_ARM * skeleton.scale)
        apart = np.sqrt((UPPER_ARM * skeleton.scale) ** 2 - drop**2)
        elbow = shoulder + apart * (0.8 * side * aside + 0.6 * ahead)
        elbow[1] = shoulder[1] - drop
        along = rotations.normalize(ahead - 0.25 * side * aside)
        wrist = elbow + FOREARM * skeleton.scale * along
        wrist[1] = height + 0.045
        arms[index] = rotations.rotate(back, wrist - shoulder) / (ARM * skeleton.scale)
        elbows[index] = rotations.rotate(back, elbow - 0.5 * (wrist + shoulder))
        x = rotations.normalize(along * [1.0, 0.0, 1.0]) * side
        up = np.array([0.0, 1.0, 0.0])
        palms[index] = rotations.basis_to_quat(x, up, rotations.cross(x, up))
    return replace(pose, arms=arms, elbows=elbows, palms=palms, pressing=np.ones(2), reaching=np.zeros(2))
