"""The T-pose of a source skeleton: arms along ±X, legs straight down, from a rest pose that may differ from it.

Limbs that are already within ten degrees stay as they are; what hangs on a limb goes along rigidly, as a foot does
that is straight for a leg set at an angle (Acclaim).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.clips.clip import Array, Bones
from motion_backend.clips.mapping import JointMap, joint_places

CLOSE: Final = np.cos(np.radians(10.0))
_DOWN: Final = np.array([0.0, -1.0, 0.0])
_SEGMENTS: Final = (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))


def t_posed(bones: Bones, rest: Array, given: JointMap | None = None) -> Array:
    """Local rotations (J, 4) of the T-pose; the rest pose where neither the map given nor a family names its joints."""
    pose = rest.copy()
    positions, world = _at_origin(bones, pose)
    for upper, lower, wanted in _limbs(bones, given):
        along = rotations.normalize(positions[lower] - positions[upper])
        if along.any() and along @ wanted < CLOSE:
            turned = rotations.compose(_shortest_turn(along, wanted), world[upper])
            above = bones.parents[upper]
            before = world[above] if above >= 0 else rotations.IDENTITY
            pose[upper] = rotations.compose(rotations.inverse(before), turned)
            positions, world = _at_origin(bones, pose)
    return pose


def is_t_pose(bones: Bones, pose: Array, given: JointMap | None = None) -> bool:
    """Whether every limb is near a T-pose's; False where neither the map given nor a family names its joints."""
    positions, _ = _at_origin(bones, pose)
    close = [
        bool(rotations.normalize(positions[lower] - positions[upper]) @ wanted >= CLOSE)
        for upper, lower, wanted in _limbs(bones, given)
    ]
    return bool(close) and all(close)


def _limbs(bones: Bones, given: JointMap | None) -> Iterator[tuple[int, int, Array]]:
    """Upper and lower joint of each limb's bones, from the trunk outwards, and where it points in a T-pose."""
    joints = joint_places(bones.names, given)
    if joints is None:
        return
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for upper, lower in _SEGMENTS:
            wanted = _DOWN if upper in ("hip", "knee") else np.array([sign, 0.0, 0.0])
            yield joints[f"{side}_{upper}"], joints[f"{side}_{lower}"], wanted


def _at_origin(bones: Bones, pose: Array) -> tuple[Array, Array]:
    positions, world = bones.forward_kinematics(np.zeros((1, 3)), pose[None])
    return positions[0], world[0]


def _shortest_turn(a: Array, b: Array) -> Array:
    """The least rotation from unit vector a to b, which are not opposite."""
    half = np.concatenate([np.cross(a, b), [1.0 + a @ b]])
    return rotations.normalize(half) if half[3] > 1e-6 else rotations.rotvec_to_quat(np.array([0.0, 0.0, np.pi]))
