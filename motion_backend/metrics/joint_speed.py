"""How fast joints turn: what pops from one frame to the next, though every place is reached."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS

MOST: Final = 20.0
"""Radians a second that no joint of a recorded person turns faster: runners' feet and arms come to 18."""
WILD: Final = frozenset({"dancing steps, arms swinging", "run and spin", "skip steps running"})
"""Captions that are wild by name: there joints may be as fast as they like."""


def joint_speeds(local_rotations: NDArray[np.floating], fps: float) -> Array:
    """How fast every joint turns in its parent's frame, the pelvis in the world's. (T, J, 4) to (T - 1, J) rad/s."""
    turns = np.asarray(local_rotations, dtype=np.float64)
    ahead, behind = turns[1:], turns[:-1]
    # Of a rotation and its negative, which are the same, the nearer one; by chords, small angles keep their digits.
    chord = np.minimum(np.linalg.norm(ahead - behind, axis=-1), np.linalg.norm(ahead + behind, axis=-1))
    return np.asarray(4 * np.arcsin(np.clip(chord / 2, 0.0, 1.0)) * fps)


def fastest_joint(local_rotations: NDArray[np.floating], fps: float) -> tuple[str, float]:
    """The joint that turns fastest in any frame, and how fast (rad/s); ("", 0) for a single frame."""
    if len(local_rotations) < 2:
        return "", 0.0
    most = joint_speeds(local_rotations, fps).max(axis=0)
    joint = int(most.argmax())
    return JOINTS[joint], float(most[joint])
