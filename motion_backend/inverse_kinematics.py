"""Two-bone inverse kinematics in closed form, over whole motions at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.rotations import Array

STRAIGHTEST = 0.999
"""Share of a limb's length that is used at most: a limb pulled quite straight snaps its hinge."""

FOLDED = 0.45
"""No limb folds up further than to this angle between its bones (radians): 154 degrees of elbow and knee."""


class Limb(NamedTuple):
    """A solved limb: unit directions of both bones and of the hinge between them. Each (..., 3)."""

    upper: Array
    lower: Array
    hinge: Array


def two_bone(root: Array, target: Array, pole: Array, lengths: tuple[float, float]) -> Limb:
    """Bend a limb so that its end comes to `target`, its middle joint towards `pole`; out of reach, or nearer to its
    root than it folds, it points there.

    root, target: (..., 3) world positions; pole: (..., 3) direction, need not be unit or perpendicular.
    """
    upper_length, lower_length = lengths
    reach = target - root
    distance = rotations.length(reach)
    along = reach / np.maximum(distance, 1e-9)
    longest = STRAIGHTEST * (upper_length + lower_length)
    squares, product = upper_length**2 + lower_length**2, 2 * upper_length * lower_length
    distance = np.clip(distance, np.sqrt(squares - product * np.cos(FOLDED)), longest)
    aside = _aside(pole, along)
    cosine = (upper_length**2 + distance**2 - lower_length**2) / (2 * upper_length * distance)
    sine = np.sqrt(np.maximum(1 - cosine**2, 0.0))
    upper = cosine * along + sine * aside
    lower = rotations.normalize(distance * along - upper_length * upper)
    return Limb(upper, lower, rotations.cross(aside, along))


def _aside(pole: Array, along: Array) -> Array:
    """Unit vectors towards the pole at right angles to the reach; any such vector where the pole lies along it."""
    across = pole - rotations.dot(pole, along) * along
    lost = rotations.length(across) < 1e-6
    if lost.any():
        helper = np.where(np.abs(along[..., 2:]) < 0.7, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
        across = np.where(lost, helper - rotations.dot(helper, along) * along, across)
    return rotations.normalize(across)


def leg_rotations(leg: Limb) -> tuple[Array, Array]:
    """World rotations of hip and knee; at rest both bones point down (-Y) and the hinge is +X. (..., 4) each."""
    bones = -np.stack([leg.upper, leg.lower])
    hinge = np.broadcast_to(leg.hinge, bones.shape)
    hip, knee = rotations.basis_to_quat(hinge, bones, rotations.cross(hinge, bones))
    return hip, knee


def arm_rotations(arm: Limb, side: int) -> tuple[Array, Array]:
    """World rotations of shoulder and elbow; at rest bones point to ±X (side +1 left, -1 right). (..., 4) each."""
    y = -side * arm.hinge
    bones = side * np.stack([arm.upper, arm.lower])
    shoulder, elbow = rotations.basis_to_quat(bones, np.broadcast_to(y, bones.shape), rotations.cross(bones, y))
    return shoulder, elbow
