"""What a hand does, found in where it goes: it reaches out; or it is drawn, flies, and is stopped by what it hits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.motion import FPS
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

FLIES: Final = 1.6
"""Metres a second of a hand that hits, just before it does."""
STOPPED: Final = (0.6, 4)
"""Metres a second of a hand that was stopped, and the frames in which it was: one that only comes takes longer."""
REST, STAYS = 0.4, 0.10
"""Seconds after a blow in which the hand goes no farther than so many metres: where it is drawn to it does not stay."""
DRAWN: Final = 0.65
"""Metres a second up to which a hand is drawn, and flies no more or not yet."""
SWING: Final = 0.25
"""Metres from where it is drawn to where it hits, at least: who knocks has less."""
HANDS: Final = (INDEX["left_wrist"], INDEX["right_wrist"])
_ELBOWS: Final = (INDEX["left_elbow"], INDEX["right_elbow"])
_SHOULDERS: Final = (INDEX["left_shoulder"], INDEX["right_shoulder"])


def from_hanging(joints: Array) -> Array:
    """How far each hand of bodies (T, 22, 3) is from where it would hang (metres): a hand that touches is, bent or
    stretched, and one that hangs beside it is not, though its arm may be the longer. (T, 2)."""
    shoulders, elbows, wrists = joints[:, _SHOULDERS], joints[:, _ELBOWS], joints[:, HANDS]
    length = np.linalg.norm(elbows - shoulders, axis=-1) + np.linalg.norm(wrists - elbows, axis=-1)
    hanging = shoulders - length[..., None] * np.array([0.0, 1.0, 0.0])
    return np.asarray(np.linalg.norm(wrists - hanging, axis=-1))


@dataclass(frozen=True)
class Blow:
    """The last blow in some frames of a motion."""

    drawn: int
    """The frame in which the hand is drawn, right before it flies."""
    hit: int
    """That in which it is stopped."""
    hand: int
    """The wrist's joint."""

    @staticmethod
    def of(joints: Array, start: int, stop: int) -> Blow | None:
        """Within frames start to stop (exclusive) of joints (T, 22, 3) in the world; None where no hand hits."""
        found = [blow for hand in HANDS if (blow := _blow(joints, start, stop, hand)) is not None]
        return max(found, key=lambda blow: blow.hit, default=None)


def _blow(joints: Array, start: int, stop: int, hand: int) -> Blow | None:
    way = joints[start:stop, hand]
    speed = FPS * np.linalg.norm(np.diff(way, axis=0), axis=1)  # to the next frame
    slow, frames = STOPPED
    rest = round(REST * FPS)
    for at in range(len(speed) - rest - 1, frames, -1):
        flying = speed[at - frames : at]
        if speed[at] > slow or flying.max() < FLIES or flying[-1] <= slow:
            continue
        stays = np.linalg.norm(way[at : at + rest] - way[at], axis=1).max() < STAYS
        drawn = np.flatnonzero(speed[: at - frames] < DRAWN)
        if stays and len(drawn) and np.linalg.norm(way[drawn[-1]] - way[at]) > SWING:
            return Blow(start + int(drawn[-1]), start + at, hand)
    return None
