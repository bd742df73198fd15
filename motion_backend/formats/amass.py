"""Motions as AMASS lays them out: rotation vectors a frame, Z up, in an npz that readers of AMASS open.

The joints have SMPL's first 22 names, parents and order, and SMPL's rest pose: a T-pose that faces +Z with Y up, which
the pelvis's rotation stands up in a world with Z up. The bones are ours: `joint_offsets` says how long they are, and a
SMPL body put on these poses has feet and hands elsewhere by the difference. `trans` is the pelvis itself, where a SMPL
model adds its own rest pelvis to what it is given; take that away first.
"""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.formats.npz import archive
from motion_backend.motion import Motion

_STAND_UP = rotations.rotvec_to_quat(np.array([np.pi / 2, 0.0, 0.0]))
"""From a world with Y up to one with Z up: (x, y, z) becomes (x, -z, y)."""
_SHAPES = 16


def amass_bytes(motion: Motion) -> bytes:
    """poses (T, 66) radians, trans (T, 3) metres, mocap_framerate, and the skeleton they belong to.

    `betas` are zeros and `gender` neutral since readers ask for them; they say nothing about our body.
    """
    turns = motion.local_rotations.astype(np.float64)
    turns[:, 0] = rotations.compose(_STAND_UP, turns[:, 0])
    vectors = rotations.quat_to_rotvec(rotations.normalize(turns))
    return archive(
        {
            "poses": vectors.reshape(len(motion), -1).astype(np.float32),
            "trans": rotations.rotate(_STAND_UP, motion.root_positions.astype(np.float64)).astype(np.float32),
            "mocap_framerate": np.array(float(motion.fps)),
            "gender": np.array("neutral"),
            "betas": np.zeros(_SHAPES),
            "joint_names": np.array(motion.skeleton.names),
            "joint_parents": np.array(motion.skeleton.parents, dtype=np.int32),
            "joint_offsets": motion.skeleton.offsets,
        }
    )
