"""The numbers of a way to walk, sit, lie and hold the arms; moods.py fills them for an emotion and a caption.

Angles are degrees here, since people tune them; everything else is metres, seconds and shares.

How an emotion and a caption look: the style each asks for (SIMS 4.1, 8.1, 9).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion_backend.motion import Emotion
from motion_backend.rotations import Array


@dataclass(frozen=True)
class ArmPose:
    """Where a left wrist is, from its shoulder in the chest frame (arm lengths), and where its elbow points."""

    wrist: tuple[float, float, float]
    elbow: tuple[float, float, float]


ARMS: dict[str, ArmPose] = {
    "hang": ArmPose((0.15, -0.955, 0.07), (0.25, 0.0, -1.0)),
    "bent": ArmPose((0.12, -0.74, 0.42), (0.45, -0.2, -1.0)),
    "fists": ArmPose((0.24, -0.93, 0.10), (0.8, 0.0, -0.7)),
    "behind_back": ArmPose((-0.19, -0.74, -0.33), (0.8, 0.0, -0.6)),
    "crossed": ArmPose((-0.42, -0.27, 0.32), (0.6, -0.8, 0.1)),
    "behind_head": ArmPose((-0.14, 0.42, -0.16), (1.0, 0.25, 0.2)),
    "ear": ArmPose((0.06, 0.15, 0.15), (0.6, -1.0, 0.3)),
    "hips": ArmPose((0.09, -0.70, 0.08), (1.0, 0.0, -0.4)),
    "open": ArmPose((0.93, -0.02, 0.22), (0.0, -0.4, -1.0)),
    "face": ArmPose((-0.20, 0.26, 0.37), (0.35, -1.0, 0.35)),
    "belly": ArmPose((-0.16, -0.60, 0.33), (1.0, -0.2, -0.2)),
    "chest": ArmPose((-0.26, -0.14, 0.34), (0.8, -0.7, 0.0)),
    "props": ArmPose((0.20, -0.90, -0.27), (0.5, 0.0, -1.0)),
    "armrest": ArmPose((0.24, -0.62, 0.42), (0.7, -0.2, -0.8)),
    "sides": ArmPose((0.24, -0.93, 0.06), (0.8, 0.0, -0.5)),
    "chin": ArmPose((-0.24, 0.16, 0.26), (0.3, -1.0, 0.3)),
    "elbows": ArmPose((0.10, -0.62, 0.36), (0.35, -0.7, -0.8)),
    "balance": ArmPose((0.62, -0.62, 0.16), (0.2, -0.2, -1.0)),
    "pockets": ArmPose((0.04, -0.76, 0.10), (0.9, -0.1, -0.7)),
    "wrapped": ArmPose((-0.44, -0.44, 0.32), (0.7, -0.7, 0.0)),
    "on_knees": ArmPose((-0.06, -0.52, 0.66), (0.5, -0.9, -0.2)),
    "raised": ArmPose((0.40, 0.86, 0.14), (0.5, -0.4, -0.6)),
    "wide": ArmPose((0.95, 0.05, -0.06), (0.0, -0.6, -0.2)),
    "read": ArmPose((-0.10, -0.34, 0.58), (0.7, -0.8, -0.1)),
    "held_above": ArmPose((0.0, -0.08, 0.72), (0.45, -1.0, 0.0)),
    "keys": ArmPose((0.06, -0.51, 0.66), (0.45, -0.8, -0.3)),
    "gamepad": ArmPose((-0.15, -0.52, 0.48), (0.6, -0.7, -0.3)),
    "cup": ArmPose((-0.16, -0.40, 0.50), (0.7, -0.7, -0.1)),
    "mouth": ArmPose((-0.21, 0.03, 0.38), (0.75, -0.85, 0.2)),
    "ears": ArmPose((-0.01, 0.23, 0.10), (0.9, -0.8, 0.35)),
    "wave": ArmPose((0.30, 0.42, 0.30), (0.5, -1.0, -0.1)),
    "counter": ArmPose((0.40, -0.84, -0.10), (0.5, 0.0, -1.0)),
    "beside": ArmPose((0.24, -0.90, 0.16), (0.5, 0.0, -1.0)),
    "carry": ArmPose((-0.20, -0.48, 0.36), (0.7, -0.6, -0.5)),
}
THIGHS = "thighs"
"""Hands laid on the thighs: their place follows the legs, so it is not in the table."""


_OVER = {"crossed": (0.02, -0.115, 0.11), "wrapped": (0.0, -0.145, 0.105), "behind_back": (0.0, 0.0, -0.07)}
"""How the right wrist goes past the left one where arms cross (arm lengths)."""


def arm_arrays(left: str, right: str) -> tuple[Array, Array]:
    """Wrist offsets and elbow directions of two named arm poses. (2, 3) each; right is mirrored."""
    mirror = np.array([-1.0, 1.0, 1.0])
    chosen = [ARMS.get(left, ARMS["hang"]), ARMS.get(right, ARMS["hang"])]
    wrists = np.array([chosen[0].wrist, chosen[1].wrist])
    elbows = np.array([chosen[0].elbow, chosen[1].elbow])
    wrists[1] *= mirror
    elbows[1] *= mirror
    if left == right:
        wrists[1] += _OVER.get(left, (0.0, 0.0, 0.0))
    return wrists, elbows


@dataclass(frozen=True)
class Bearing:
    """How the body carries itself: posture, pace and restlessness, whatever it does."""

    lean: float = 2.0
    """Forward bend of the trunk."""
    head: float = 3.0
    """Forward bend of the head."""
    tempo: float = 1.0
    """Speed of sitting, rising and reaching against neutral."""
    restless: float = 1.0
    """Size of idle movement against neutral."""
    arms: tuple[str, str] = ("hang", "hang")


AT_EASE = Bearing()
"""A body in no particular mood."""


STILL = 0.3
"""Restlessness, against its mood, of who keeps still."""

BEARINGS: dict[Emotion, Bearing] = {
    Emotion.NEUTRAL: Bearing(),
    Emotion.HAPPY: Bearing(lean=-3, head=-7, tempo=1.2, restless=1.5),
    Emotion.ANGRY: Bearing(lean=9, head=10, tempo=1.3, restless=1.4, arms=("bent", "bent")),
    Emotion.HURRIED: Bearing(lean=7, head=2, tempo=1.4, restless=1.5),
    Emotion.TIRED: Bearing(lean=13, head=16, tempo=0.75, restless=0.7),
    Emotion.SAD: Bearing(lean=15, head=24, tempo=0.72, restless=0.5),
    Emotion.STRESSED: Bearing(lean=7, head=13, tempo=1.05, restless=1.8),
    Emotion.DRUNK: Bearing(lean=6, head=11, tempo=0.8, restless=3.5),
    Emotion.RELAXED: Bearing(lean=-2, head=0, tempo=0.9, restless=0.9),
}


def bearing_of(emotion: Emotion, caption: str = "") -> Bearing:
    """Posture and pace of an emotion; "slowly" and "abruptly" in the caption change the pace."""
    bearing = BEARINGS[emotion]
    if re.search(r"slow|weari", caption.lower()):
        return replace(bearing, tempo=min(bearing.tempo, 0.7))
    if re.search(r"abrupt|quick|sudden|leap|jump", caption.lower()):
        return replace(bearing, tempo=max(bearing.tempo, 1.5))
    if re.search(r"\bstill\b", caption.lower()):
        return replace(bearing, restless=STILL * bearing.restless)
    return bearing


Words = tuple[tuple[str, dict[str, Any]], ...]
"""Rows of what a caption says (a pattern) and what that changes. Later rows win: the particular after the general."""


def changes_of(caption: str, words: Words) -> dict[str, Any]:
    """What the rows whose pattern a caption has change, the later over the earlier."""
    changes: dict[str, Any] = {}
    for pattern, row in words:
        if re.search(pattern, caption.lower()):
            changes |= row
    return changes
