"""All frames of recorded walking with what is looked for in them: where a body went next, and what its feet did.

Features are those of Clavet (GDC 2016): the way over the floor in 10, 20 and 30 frames and where it led, ankles and
their velocities, and the pelvis' velocity, all in the frame of the body's heading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.augmentation import mirror
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import Dataset
from motion_backend.mocap.plain_walks import recorded_walks
from motion_backend.mocap.resampling import low_pass
from motion_backend.motion import FPS, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton, build_skeleton
from motion_backend.walk_generator import yaw_of

Indices = NDArray[np.int64]
HORIZONS: Final = (10, 20, 30)
"""Frames ahead at which the way is compared."""
FACING_WEIGHT, ANKLES_WEIGHT, STEPS_WEIGHT, PELVIS_WEIGHT = 0.5, 1.5, 0.15, 0.4
"""What a turn (as sine and cosine), a metre of an ankle, and a metre a second of ankle and pelvis count beside a metre
of the way."""
HEADING_HZ: Final = 1.0
"""Above which the pelvis' turning to and fro with each step is no change of heading."""
ENDS: Final = 12
"""The last frames of a clip are not jumped to: soon there would be nothing left to play."""
SHORTEST: Final = 40
"""Frames of a clip that is of any use."""
LEAST_SECONDS: Final = 20.0
"""Of recorded walking, both sides of the mirror counted once: with less the same steps come again and again."""
_ANKLES: Final = [INDEX["left_ankle"], INDEX["right_ankle"]]
WAY: Final = slice(0, 4 * len(HORIZONS))
"""Features that say where a body goes."""


@dataclass(frozen=True)
class WalkDatabase:
    """N frames of walking, clips one after the other, each also seen in a mirror. Bodies of 1.70 m."""

    root: Array
    """(N, 3) pelvis."""
    local: Array
    """(N, 22, 4) rotations."""
    heading: Array
    """(N,) yaw of the body, continuous within a clip."""
    features: Array
    """(N, F)."""
    left: Indices
    """(N,) frames that its clip still has after each."""
    clips: tuple[str, ...]
    """Names, without those in the mirror."""
    people: tuple[str, ...]
    """Who walked them."""

    def __len__(self) -> int:
        return len(self.root)

    @cached_property
    def entries(self) -> Indices:
        """Frames that may be jumped to: each has one before it in its clip, and some after it. (M,)."""
        first = np.concatenate([[True], self.left[:-1] == 0])
        return np.flatnonzero((self.left >= ENDS) & ~first)

    @cached_property
    def paces(self) -> Array:
        """Metres that a body gets on in the second after each of `entries`. (M,)."""
        return np.asarray(np.linalg.norm(self.features[self.entries, WAY.stop - 4 : WAY.stop - 2], axis=1))

    @cached_property
    def _sought(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        features = self.features[self.entries].astype(np.float32)
        return features, np.sum(features**2, axis=1)

    def nearest(self, wanted: Array) -> tuple[int, float]:
        """The frame whose features are nearest to those wanted (F,), and their squared distance."""
        features, squares = self._sought
        costs = squares - 2 * features @ wanted.astype(np.float32)
        best = int(costs.argmin())
        return int(self.entries[best]), float(costs[best]) + float(wanted @ wanted)


def build_walk_database(dataset: Dataset, split: str | None = None) -> WalkDatabase:
    """Of all plain recorded walks of a collection, or of the people of one split. ClipError for too little of them."""
    chosen = [entry for entry in recorded_walks(dataset, split) if len(entry.motion) >= SHORTEST]
    seconds = sum(entry.motion.duration for entry in chosen)
    if seconds < LEAST_SECONDS:
        raise ClipError(
            f"{seconds:.0f} s of plain recorded walking in pieces of {SHORTEST / FPS:.1f} s or more, "
            f"{LEAST_SECONDS:.0f} s are needed",
            "add walks of people (skill loco, style neutral) to what `sims clips build` reads",
        )
    if not np.allclose(dataset.skeleton.offsets, build_skeleton().offsets, atol=1e-4):
        raise ClipError("its bodies are not 1.70 m tall", "build it again with `sims clips build`")
    motions = [way for entry in chosen for way in (entry.motion, mirror(entry.motion))]
    return _of(motions, tuple(entry.name for entry in chosen), tuple(dict.fromkeys(e.subject for e in chosen)))


def _of(motions: Sequence[Motion], clips: tuple[str, ...], people: tuple[str, ...]) -> WalkDatabase:
    columns: list[tuple[Array, ...]] = []
    for motion in motions:
        root, local = motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64)
        heading = heading_of(local[:, 0])
        left = np.arange(len(root), dtype=np.float64)[::-1]
        columns.append((root, local, heading, features_of(root, local, heading, motion.skeleton), left))
    root, local, heading, features, left = (np.concatenate(column) for column in zip(*columns, strict=True))
    return WalkDatabase(root, local, heading, features, left.astype(np.int64), clips, people)


def heading_of(turns: Array) -> Array:
    """Yaw of a body from the turns of its pelvis (T, 4), without what each step turns it. (T,), continuous."""
    return low_pass(np.unwrap(yaw_of(turns)), FPS, HEADING_HZ)


def features_of(root: Array, local: Array, heading: Array, skeleton: Skeleton) -> Array:
    """Features of all frames of a clip, (T, 3), (T, 22, 4), (T,) to (T, F); beyond its end it goes on as it ended."""
    positions = skeleton.forward_kinematics(root, local)[0].astype(np.float64)
    velocity = np.gradient(root, axis=0)
    frames, way = np.arange(len(root)), []
    for horizon in HORIZONS:
        then = np.minimum(frames + horizon, len(root) - 1)
        beyond = (frames + horizon - then)[:, None] * velocity[then]
        way.append(_way_features(root[then] + beyond - root, heading[then] - heading, heading))
    pose = pose_features(root, positions[:, _ANKLES], np.gradient(positions[:, _ANKLES], axis=0), velocity, heading)
    return np.concatenate([*way, pose], axis=1)


def wanted_way(places: Array, yaws: Array, place: Array, heading: float) -> Array:
    """The features of a way whose coming places (LOOK, 2) and directions (LOOK,) are given, for a body at (2,)."""
    at = np.array(HORIZONS) - 1
    steps = np.zeros((len(at), 3))
    steps[:, [0, 2]] = places[at] - place
    turned = np.full(len(at), heading)
    return _way_features(steps, yaws[at] - heading, turned).ravel()


def _way_features(steps: Array, turns: Array, heading: Array) -> Array:
    """(T, 3) and (T,) to (T, 4)."""
    ahead = rotations.rotate(rotations.yaw_to_quat(-heading), steps)[:, [0, 2]]
    return np.concatenate([ahead, FACING_WEIGHT * np.stack([np.sin(turns), np.cos(turns)], axis=1)], axis=1)


def pose_features(root: Array, ankles: Array, steps: Array, velocity: Array, heading: Array) -> Array:
    """Of ankles (T, 2, 3), their movement and the pelvis' (T, 3) in a frame. (T, 15)."""
    back = rotations.yaw_to_quat(-heading)
    hung = rotations.rotate(back[:, None], ankles - root[:, None] * [1.0, 0.0, 1.0])
    moved = rotations.rotate(back[:, None], steps) * FPS
    return np.concatenate(
        [
            ANKLES_WEIGHT * hung.reshape(len(root), -1),
            STEPS_WEIGHT * moved.reshape(len(root), -1),
            PELVIS_WEIGHT * FPS * rotations.rotate(back, velocity),
        ],
        axis=1,
    )


def features_now(root: Array, local: Array, skeleton: Skeleton) -> Array:
    """What a body's pose and movement are in the last of some frames, (T, 3) and (T, 22, 4). (15,)."""
    if len(root) == 1:
        root, local = np.repeat(root, 2, axis=0), np.repeat(local, 2, axis=0)
    ankles = skeleton.forward_kinematics(root[-2:], local[-2:])[0][:, _ANKLES].astype(np.float64)
    heading = yaw_of(local[-1:, 0])
    found = pose_features(root[-1:], ankles[-1:], ankles[1:] - ankles[:1], root[-1:] - root[-2:-1], heading)
    return np.asarray(found[0])
