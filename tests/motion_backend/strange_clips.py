"""Clips of skeletons that are not ours, for the tests of putting them on ours."""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.clip import Clip, make_bones, make_clip
from motion_backend.mocap.joint_map import FAMILIES
from motion_backend.motion import Motion
from motion_backend.skeleton import INDEX, JOINTS, PARENTS, build_skeleton

GIANT = 1.3


def stranger(motion: Motion, rest: str, fps: float = 30.0, twist: float = 0.0) -> Clip:
    """A motion of ours told by another skeleton: larger, with Mixamo's names, another rest pose, joints' frames turned.

    rest: "t", or "n" for arms that hang.
    """
    family = next(family for family in FAMILIES if family.name == "Mixamo").joints()
    ours = build_skeleton(1.70)
    world_t = np.tile(rotations.IDENTITY, (22, 1))
    if rest == "n":
        for side, sign in (("left", -1), ("right", 1)):
            turn = rotations.rotvec_to_quat(np.array([0.0, 0.0, sign * np.pi / 2]))
            for name in ("shoulder", "elbow", "wrist"):
                world_t[INDEX[f"{side}_{name}"]] = turn
    positions, world = ours.forward_kinematics(motion.root_positions, motion.local_rotations)
    frames = rotations.rotvec_to_quat(np.random.default_rng(3).normal(size=(22, 3)) * twist)
    # A joint's frame of theirs is ours at their rest, turned by what nobody can see.
    their_world = rotations.compose(world, rotations.compose(rotations.inverse(world_t), frames))
    rest_world = frames
    rest_positions = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            bone = rotations.rotate(world_t[parent], ours.offsets[joint]) * GIANT
            rest_positions[joint] = rest_positions[parent] + bone
    offsets = np.zeros((22, 3))
    local = their_world.copy()
    rest_local = rest_world.copy()
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            back = rotations.inverse(rest_world[parent])
            offsets[joint] = rotations.rotate(back, rest_positions[joint] - rest_positions[parent])
            local[:, joint] = rotations.compose(rotations.inverse(their_world[:, parent]), their_world[:, joint])
            rest_local[joint] = rotations.compose(back, rest_world[joint])
    bones, order = make_bones([f"mixamorig:{family[name]}" for name in JOINTS], PARENTS, offsets)
    roots = positions[:, 0].astype(np.float64) * GIANT
    return make_clip("stranger", bones, roots, local[:, order], rest_local[order], fps, "bvh")
