"""A body that stands or glides along upright, for cameras to look at."""

from __future__ import annotations

import numpy as np

from motion_backend.motion import Motion
from motion_backend.rotations import axis_to_quat, yaw_to_quat
from motion_backend.skeleton import INDEX, build_skeleton


def walking(at: tuple[float, float, float], metres: float, frames: int = 60) -> Motion:
    """A body that goes straight on from a place [x, z, yaw], upright."""
    skeleton, (x, z, yaw) = build_skeleton(1.7), at
    gone = np.linspace(0.0, metres, frames)
    height = np.full(frames, skeleton.standing_height)
    roots = np.stack([x + gone * np.sin(yaw), height, z + gone * np.cos(yaw)], axis=1)
    turns = np.zeros((frames, len(skeleton.names), 4), np.float32)
    turns[..., 3] = 1.0
    turns[:, 0] = yaw_to_quat(yaw)
    for side, down in (("left", -1.3), ("right", 1.3)):  # arms hang
        turns[:, INDEX[f"{side}_shoulder"]] = axis_to_quat("z", np.array(down))
    contacts, actions = np.ones((frames, 4), np.float32), np.zeros(frames, np.int32)
    return Motion(roots.astype(np.float32), turns, contacts, skeleton, actions)
