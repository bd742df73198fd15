"""Near-copies: clips that show what another one shows, though they are said to be of different subjects.

An excerpt, or one recording carried over to another skeleton, must not be trained on and tested with. Poses are
compared by where limbs, trunk and the vertical point as the pelvis sees them: places, headings and sizes do not matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.dataset_file import Entry
from motion_backend.mocap.rest_pose import LIMBS
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

SAME = 3.0
"""Degrees between directions, on average over the shorter clip, up to which it is a copy; what they are always apart
is not counted, as bodies rest differently."""
_PROBE = float(np.cos(np.radians(3 * SAME)))
"""Mean cosine from which a single pose may be one of a copy."""
MIN_COPY_FRAMES = 15
"""Frames: less is a pose that bodies have in common."""
MOVING = 3.0
"""Degrees that directions turn about their mean, on average, in a clip that tells something."""
_TRIED = 8
"""Places of the longer clip that are compared in full."""
_DIRECTIONS = (*LIMBS, ("pelvis", "neck"))


@dataclass(frozen=True)
class Copy:
    """A clip that is nearly a part of another."""

    clip: str
    of: str
    subjects: tuple[str, str]
    degrees: float
    """Between the directions of their limbs, on average."""
    start: int
    """The frame of the longer clip where the shorter begins."""


def near_copies(entries: Sequence[Entry]) -> list[Copy]:
    """Clips whose whole length is nearly in a clip of another subject; of each pair the best place."""
    poses = [_directions(entry.motion) for entry in entries]
    if not poses:
        return []
    whole = np.concatenate(poses).astype(np.float32)  # (N, directions, 3)
    flat = whole.reshape(len(whole), -1)
    owner = np.repeat(np.arange(len(poses)), [len(pose) for pose in poses])
    subjects = np.unique([entry.subject for entry in entries], return_inverse=True)[1]
    found: dict[tuple[int, int], Copy] = {}
    for number, pose in enumerate(poses):
        length = len(pose)
        if length < MIN_COPY_FRAMES or _turning(pose) < MOVING:
            continue
        middle, places = length // 2, len(whole) - length + 1
        probes = pose[[0, middle, -1]].reshape(3, -1).astype(np.float32)
        alike = flat @ probes.T / whole.shape[1]  # (N, 3) mean cosines
        shifted = (alike[:places, 0], alike[middle : middle + places, 1], alike[length - 1 :, 2])
        hits = np.flatnonzero(np.logical_and.reduce([one > _PROBE for one in shifted]))
        one_clip = owner[hits] == owner[hits + length - 1]
        hits = hits[one_clip & (subjects[owner[hits]] != subjects[number])]
        closeness = np.sum([one[hits] for one in shifted], axis=0)
        for other in np.unique(owner[hits]):
            pair = (min(number, int(other)), max(number, int(other)))
            mine = hits[owner[hits] == other]
            tried = mine[np.argsort(-closeness[owner[hits] == other], kind="stable")[:_TRIED]]
            apart = [_apart(pose, whole[place : place + length]) for place in tried]
            best = int(np.argmin(apart))
            if apart[best] <= SAME and pair not in found:
                a, b = entries[number], entries[int(other)]
                start = int(tried[best]) - int(np.searchsorted(owner, other))
                found[pair] = Copy(a.name, b.name, (a.subject, b.subject), round(apart[best], 2), start)
    return list(found.values())


def joined_subjects(subjects: Sequence[str], copies: Sequence[Copy]) -> dict[str, str]:
    """Every subject's group, named by its first subject in alphabetical order: those with copies are one group."""
    group = {subject: subject for subject in subjects}
    for copy in copies:
        first, second = sorted(group[subject] for subject in copy.subjects)
        group = {subject: first if name == second else name for subject, name in group.items()}
    return group


def _directions(motion: Motion) -> Array:
    """Unit vectors of limbs, trunk and the vertical in the pelvis's frame. (T, directions + 1, 3)."""
    positions = motion.joint_positions().astype(np.float64)
    ends = [[INDEX[joint] for joint in bone] for bone in zip(*_DIRECTIONS, strict=True)]
    bones = rotations.normalize(positions[:, ends[1]] - positions[:, ends[0]])
    vertical = np.broadcast_to([0.0, 1.0, 0.0], (len(bones), 1, 3))
    turned = rotations.inverse(rotations.normalize(motion.local_rotations[:, :1].astype(np.float64)))
    return rotations.rotate(turned, np.concatenate([bones, vertical], axis=1))


def _turning(pose: Array) -> float:
    """Mean degrees of directions from their mean over time."""
    return _apart(pose, np.zeros_like(pose))


def _apart(pose: Array, other: NDArray[np.floating]) -> float:
    """Mean degrees between the directions of two stretches of poses, each moved by what it is apart on average."""
    return float(np.degrees(np.linalg.norm(pose - pose.mean(axis=0) - other + other.mean(axis=0), axis=-1)).mean())
