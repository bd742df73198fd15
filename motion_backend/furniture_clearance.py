"""Arms of made frames out of furniture: the detours on which the procedural body's arms go, for anybody's.

Who learned to walk from recordings saw no furniture there, and swings his arms through it. What keeps the procedural
body's arms out of things (procedural/arm_clearance.py) is asked for the handles of the made pose; by what the arms turn
on their detour there, they turn here. Frames whose arms are in nothing stay as they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import arm_rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import penetration
from motion_backend.motion import Motion, Posture
from motion_backend.procedural.arm_clearance import Around, arms_out
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.takeover import poses_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, PARENTS, Skeleton

IN: Final = 0.005
"""Metres: a body that is deeper in furniture is looked at."""


def arms_aside(motion: Motion, part: Part, obstacles: Obstacles) -> Motion:
    """The motion of somebody who stands, walks or sits down, with his arms out of furniture where they can get out."""
    deep = penetration(Kinematics.of(motion), obstacles, part.action) > IN
    if not deep.any():
        return motion
    skeleton = motion.skeleton
    root, local = motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64)
    pose = poses_of(root, local, motion.contacts.astype(np.float64), skeleton)
    seat = part.action.spot if part.kind is PartKind.SIT else None
    posture = Posture.STANDING if seat is None else Posture.SEATED
    around = Around(part, posture, None if seat is None else seat.object_id, obstacles.solid())
    turned = _turned(local, pose, arms_out(pose, around, skeleton, deep), skeleton)
    return replace(motion, local_rotations=rotations.continuous(turned).astype(np.float32))


def _turned(local: Array, before: Pose, after: Pose, skeleton: Skeleton) -> Array:
    """Local rotations (T, 22, 4) whose arms turn as those of one pose do to come to another's."""
    world = _worlds(local)
    found = local.copy()
    frame = chest_frame(before, skeleton)
    for index in (0, 1):
        one, other = (Arm.of(pose, skeleton, index, frame) for pose in (before, after))
        bones = zip(arm_rotations(one.limb, one.side), arm_rotations(other.limb, one.side), strict=True)
        above = world[:, INDEX[f"{one.name}_collar"]]
        for joint, (was, turn) in zip(("shoulder", "elbow"), bones, strict=True):
            at = INDEX[f"{one.name}_{joint}"]
            aside = rotations.compose(rotations.compose(turn, rotations.inverse(was)), world[:, at])
            found[:, at] = rotations.compose(rotations.inverse(above), aside)
            above = aside
    return found


def _worlds(local: Array) -> Array:
    """World rotations. (T, 22, 4)."""
    world = np.empty_like(local)
    for joint, parent in enumerate(PARENTS):
        own = local[:, joint]
        world[:, joint] = own if parent < 0 else rotations.compose(world[:, parent], own)
    return world
