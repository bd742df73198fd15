"""Motions as bare numbers: world joint positions, (T, 22, 3) float32, little-endian, nothing before or after."""

from __future__ import annotations

import numpy as np

from motion_backend.motion import Array, Motion


def raw_bytes(motion: Motion) -> bytes:
    """World positions of all joints, frame by frame, metres."""
    return np.ascontiguousarray(motion.joint_positions(), dtype="<f4").tobytes()


def read_raw(data: bytes, joints: int = 22) -> Array:
    """The positions (T, joints, 3); ValueError when the length is not a whole number of frames."""
    if len(data) % (12 * joints):
        raise ValueError(f"{len(data)} bytes are not a whole number of frames of {joints} joints (12 bytes each)")
    return np.frombuffer(data, dtype="<f4").reshape(-1, joints, 3).astype(np.float32)
