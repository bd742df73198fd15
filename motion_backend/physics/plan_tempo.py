"""The tempo of a plan that a body with mass cannot keep: getting up from the floor is done more slowly.

From the back to hands and knees the kinematic body takes two seconds. A simulated one has to push its trunk up with
its arms for that, comes late, is beside its plan when its hips are to rise, and falls.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS, Motion, PhaseKind
from motion_backend.rotations import Array

SLOWER: Final = 1.7
"""How many times longer it takes."""
EASES: Final = 0.4
"""Seconds in which the tempo changes."""
LOW: Final = 0.35
"""A pelvis below this share of its standing height at the beginning gets up from the floor, and not from a bed."""


def feasible(motion: Motion) -> Motion:
    """The same motion, more slowly where it gets up from the floor."""
    slow = from_floor(motion)
    if not slow.any():
        return motion
    times = _times(slow)
    before = np.minimum(times.astype(int), len(motion) - 1)
    after, share = np.minimum(before + 1, len(motion) - 1), times - before
    local = motion.local_rotations.astype(np.float64)
    turned = rotations.slerp(local[before], local[after], share[:, None])
    roots = motion.root_positions.astype(np.float64)
    moved = roots[before] + share[:, None] * (roots[after] - roots[before])
    nearest = np.where(share < 0.5, before, after)
    return replace(
        motion,
        root_positions=moved.astype(np.float32),
        local_rotations=turned.astype(np.float32),
        contacts=motion.contacts[nearest],
        actions=motion.actions[nearest],
        phases=tuple(
            replace(phase, start=_frame(phase.start, times), stop=_frame(phase.stop, times)) for phase in motion.phases
        ),
    )


def from_floor(motion: Motion) -> NDArray[np.bool_]:
    """In which frames a motion gets up from the floor. (T,)."""
    found = np.zeros(len(motion), dtype=bool)
    low = LOW * motion.skeleton.standing_height
    for phase in motion.phases:
        if phase.kind is PhaseKind.GETUP and motion.root_positions[phase.start, 1] < low:
            found[phase.start : phase.stop] = True
    return found


def _times(slow: NDArray[np.bool_]) -> Array:
    """The frame of the plan (a fraction) that every frame of the slower motion shows. (T',)."""
    width = round(EASES * FPS)
    bell = np.hanning(2 * width + 1)
    eased = np.convolve(np.pad(slow.astype(np.float64), width, "edge"), bell / bell.sum(), "valid")
    taken = np.concatenate([[0.0], np.cumsum(1 + (SLOWER - 1) * (eased[1:] + eased[:-1]) / 2)])
    return np.asarray(np.interp(np.arange(int(taken[-1]) + 1), taken, np.arange(len(slow))))


def _frame(frame: int, times: Array) -> int:
    """Where a frame of the plan has come to."""
    return len(times) if frame > times[-1] else int(np.searchsorted(times, frame))
