"""How different the body sits and lies from one time to the next: APD (SIMS Table 3)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.metrics.contact_error import THRESHOLDS, contact_distance, longest_run
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill
from motion_backend.rotations import Array

FRAMES: Final = 60
"""Two seconds from the start of the contact, at 30 frames a second."""
SAMPLES, REPEATS = 64, 10


def contact_frames(motion: Motion, skill: Skill) -> NDArray[np.float32] | None:
    """Joint positions in the pelvis' place and heading from the start of its contact on. (60, 22, 3) metres.

    None for a body that does not stay in contact that long.
    """
    body = Kinematics.of(motion)
    if not motion.goals:
        return None
    start, stop = longest_run(contact_distance(body) <= THRESHOLDS[skill])
    if stop - start < FRAMES:
        return None
    return local_positions(body, slice(start, start + FRAMES)).astype(np.float32)


def local_positions(body: Kinematics, frames: slice) -> Array:
    """Joint positions as seen from the pelvis, turned to its heading. (T, 22, 3)."""
    positions = body.positions[frames]
    forward = rotations.rotate(body.world[frames, 0], np.array([0.0, 0.0, 1.0]))
    heading = np.arctan2(forward[:, 0], forward[:, 2])
    return rotations.rotate(rotations.yaw_to_quat(-heading)[:, None], positions - positions[:, :1])


def pairwise_distances(samples: Array) -> tuple[float, float]:
    """APD of N samples (N, T, 22, 3): the mean distance of two flattened ones, and that a frame and joint (metres)."""
    flat = samples.reshape(len(samples), -1)
    first, second = np.triu_indices(len(samples), 1)
    whole = np.linalg.norm(flat[first] - flat[second], axis=1)
    joints = [np.linalg.norm(samples[a] - samples[b], axis=-1).mean() for a, b in zip(first, second, strict=True)]
    return float(whole.mean()), float(np.mean(joints))


def diversity(samples: Sequence[NDArray[np.float32]], seed: int = 0) -> dict[str, float] | None:
    """APD of samples drawn by chance, ten times: mean and spread. None for fewer than two samples."""
    if len(samples) < 2:
        return None
    rng, every = np.random.default_rng(seed), np.asarray(samples, dtype=np.float64)
    size = min(SAMPLES, len(every))
    drawn = [pairwise_distances(every[rng.choice(len(every), size, replace=False)]) for _ in range(REPEATS)]
    (apd, frame), spread = np.mean(drawn, axis=0), float(np.std([one for one, _ in drawn]))
    return {"apd_pos": float(apd), "apd_pos_spread": spread, "apd_pos_frame": float(frame), "samples": float(size)}
