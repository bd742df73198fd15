"""How smoothly a body moves: jerk, jumps where segments meet, and bones that keep their length."""

from __future__ import annotations

import numpy as np

from motion_backend.metrics.contact_error import longest_run
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.mocap.resampling import low_pass
from motion_backend.motion import Motion
from motion_backend.rotations import Array

AROUND = 5
"""Frames to either side of a seam whose median it is compared with."""
RULER = 12.0
"""Hz at which whoever's positions are low-passed before their jerk is compared: above it cameras shake, not people."""
REAL_WALK = (80.0, 1.10)
"""Jerk of a recorded walk, on that ruler, is about the first times its speed (m/s) to the power of the second.

Measured by `ruled_jerk` on 64 walks and runs of the CMU database at 0.5 to 3.3 m/s, read at 12 Hz and put on our
skeleton at 30 frames a second; the residual is 10 %. Read at 6 Hz they have 51 times the speed to the power of 1.32.
"""
WALKS = 0.3
"""A pelvis this fast walks (m/s)."""


def jerks(positions: Array, fps: int) -> Array:
    """Size of the third difference of positions, as a rate. (T, J, 3) metres to (T - 3, J) m/s³."""
    return np.asarray(np.linalg.norm(np.diff(positions, n=3, axis=0), axis=-1) * fps**3)


def jerk(positions: Array, fps: int) -> float:
    """Mean jerk over joints and frames, m/s³."""
    return float(jerks(positions, fps).mean()) if len(positions) > 3 else 0.0


def ruled_jerk(positions: Array, fps: int) -> float:
    """Mean jerk over joints and frames of low-passed positions, m/s³: the one in which bodies are compared."""
    return jerk(low_pass(positions, fps, RULER), fps)


def jerk_peak(positions: Array, fps: int) -> float:
    """The 99th percentile of jerk over joints and frames, m/s³."""
    return float(np.quantile(jerks(positions, fps), 0.99)) if len(positions) > 3 else 0.0


def jerk_against_real(body: Kinematics) -> float | None:
    """Jerk of the longest stretch of walking over that of recorded walks at its speed; None for under half a second."""
    fps = body.motion.fps
    pace = np.linalg.norm(np.diff(body.positions[:, 0, [0, 2]], axis=0), axis=1) * fps
    start, stop = longest_run(pace > WALKS)
    if stop - start < fps / 2:
        return None
    factor, power = REAL_WALK
    usual = factor * float(pace[start:stop].mean()) ** power
    return float(ruled_jerk(body.positions[start : stop + 1], fps) / usual)


def seam_jump(motion: Motion) -> float:
    """Largest step of any joint from one segment to the next, beyond the median step around it (metres)."""
    return _at_seams(motion, 1)


def seam_speed_jump(motion: Motion) -> float:
    """Largest change of a joint's velocity where segments meet, beyond the median change around it (m/s)."""
    return _at_seams(motion, 2) * motion.fps


def _at_seams(motion: Motion, order: int) -> float:
    """The largest difference of positions across a seam less the median of those around it (metres)."""
    if len(motion) <= order:
        return 0.0
    positions = motion.joint_positions().astype(np.float64)
    changes = np.linalg.norm(np.diff(positions, n=order, axis=0), axis=-1).max(axis=1)
    jumps = []
    for seam in np.flatnonzero(np.diff(motion.actions)):
        across = changes[max(seam - order + 1, 0) : seam + 1].max(initial=0.0)
        jumps.append(max(across - np.median(changes[max(seam - AROUND, 0) : seam + AROUND + 1]), 0.0))
    return float(max(jumps, default=0.0))


def bone_deviation(body: Kinematics) -> float:
    """The most that any bone is longer or shorter than its skeleton's in any frame, metres."""
    skeleton = body.motion.skeleton
    parents = np.array(skeleton.parents[1:])
    bones = np.linalg.norm(body.positions[:, 1:] - body.positions[:, parents], axis=-1)
    return float(np.abs(bones - np.linalg.norm(skeleton.offsets[1:], axis=-1)).max(initial=0.0))
