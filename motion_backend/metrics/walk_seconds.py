"""Seconds of steady walking as a classifier sees them: where the joints are and how they move, turned to the way.

Neither where a walk is nor where it leads to can be seen in them: a window lies with its pelvis' mean way ahead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.metrics.gait_features import windows
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS

STARTS: Final = (0.0, 0.5, 1.0)
"""Seconds into two seconds of steady walking at which a window of one begins."""
INSTANTS: Final = 10
"""At which a window is looked at."""
VELOCITY: Final = 0.15
"""Seconds: what a velocity is multiplied by to weigh about as much as a place."""
ARM: Final = ("collar", "shoulder", "elbow", "wrist")
LEG: Final = ("hip", "knee", "ankle", "foot")
WHOLE: Final = "whole body"
LIMBS: Final = {
    WHOLE: JOINTS,
    "legs": tuple(f"{side}_{joint}" for side in ("left", "right") for joint in LEG),
    "knees": ("left_knee", "right_knee"),
    "feet": ("left_foot", "right_foot"),
    "arms": tuple(f"{side}_{joint}" for side in ("left", "right") for joint in ARM),
    "trunk and head": ("spine1", "spine2", "spine3", "neck", "head"),
    "pelvis": ("pelvis",),
}  # fmt: skip
"""Joints of which a body can be judged alone."""


@dataclass(frozen=True)
class Seconds:
    """Windows of one second of some people's walking. A body that is made counts as one more person."""

    joints: Array
    """(N, 30, 22, 3) metres: turned to the way and begun at the origin."""
    people: NDArray[np.str_]
    """(N,) whose each is."""
    takes: NDArray[np.str_]
    """(N,) what it was cut from: windows of one recording, seed or room are alike."""

    def __len__(self) -> int:
        return len(self.joints)

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.int64]) -> Seconds:
        return Seconds(self.joints[chosen], self.people[chosen], self.takes[chosen])

    def of_one(self, name: str) -> Seconds:
        """All of them as one person's."""
        return replace(self, people=np.full(len(self), name))

    def spread(self, most: int) -> Seconds:
        """At most so many of one person, from the first to the last."""
        kept: list[int] = []
        for person in np.unique(self.people):
            own = np.flatnonzero(self.people == person)
            kept += own[np.unique(np.linspace(0, len(own) - 1, min(len(own), most)).round().astype(int))].tolist()
        return self[np.array(sorted(kept), dtype=np.int64)]

    def features(self, limb: str = WHOLE) -> Array:
        """Places over the floor under the pelvis and velocities of a limb's joints at `INSTANTS`. (N, F)."""
        chosen, fps = [INDEX[name] for name in LIMBS[limb]], self.joints.shape[1]
        step = fps // INSTANTS
        places = (self.joints - self.joints[:, :, :1] * [1.0, 0.0, 1.0])[:, :, chosen]
        speeds = VELOCITY * fps * np.diff(self.joints[:, :, chosen], axis=1)
        seen = np.concatenate([places[:, :-1:step], speeds[:, ::step]], axis=-1)
        return np.asarray(seen.reshape(len(self), -1))


def seconds_of(walks: Sequence[tuple[str, str, Array]], fps: int) -> Seconds:
    """All windows of walks: whose, what take, and joints (T, 22, 3) at that rate."""
    found = [
        (turned_to_the_way(positions[start : start + fps]), person, take)
        for person, take, positions in walks
        for start in _starts(positions, fps)
    ]
    joints = np.array([row[0] for row in found]).reshape(-1, fps, len(JOINTS), 3)
    return Seconds(
        joints, np.array([row[1] for row in found], dtype=str), np.array([row[2] for row in found], dtype=str)
    )


def turned_to_the_way(positions: Array) -> Array:
    """A window (T, 22, 3) with the pelvis' first place over the origin and its last one straight ahead, on +Z."""
    first, last = positions[0, 0], positions[-1, 0]
    x, z = (last - first)[[0, 2]] / max(float(np.hypot(*(last - first)[[0, 2]])), 1e-9)
    turn = np.array([[z, 0.0, -x], [0.0, 1.0, 0.0], [x, 0.0, z]])
    return np.asarray((positions - first * [1.0, 0.0, 1.0]) @ turn.T)


def _starts(positions: Array, fps: int) -> list[int]:
    """Each once, though windows of two seconds overlap."""
    return sorted({start + round(after * fps) for start, _ in windows(positions, fps) for after in STARTS})
