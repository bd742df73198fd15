"""How a body carries itself in an emotion, and how arms are held (SIMS 4.1, 8.1, 9): rows of data/styles.

Angles are degrees here, since people tune them; everything else is metres, seconds and shares.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

import numpy as np

from motion_backend.motion import Emotion
from motion_backend.procedural.style_sheet import Degrees, Ratio, read_style_sheet
from motion_backend.rotations import Array
from scene_graphs.data_tables import read_table, table


@table
class ArmPose:
    """Where a left arm is, in the chest's frame: to the left, up, ahead."""

    wrist_arm_lengths: tuple[float, float, float]
    """From its shoulder."""
    elbow_direction: tuple[float, float, float]
    """Where its elbow points."""
    over_arm_lengths: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """How the right wrist goes past the left one where arms cross."""


@table
class ArmPoses:
    """Ways to hold an arm, by name."""

    poses: dict[str, ArmPose]


@cache
def arm_poses() -> Mapping[str, ArmPose]:
    """All ways to hold an arm, by name."""
    read: ArmPoses = read_table("motion_backend", "styles/arms.toml", ArmPoses)
    return read.poses


THIGHS = "thighs"
"""Hands laid on the thighs: their place follows the legs, so it is not in the table."""


def arm_arrays(left: str, right: str) -> tuple[Array, Array]:
    """Wrist offsets and elbow directions of two named arm poses. (2, 3) each; right is mirrored."""
    mirror = np.array([-1.0, 1.0, 1.0])
    chosen = [arm_poses().get(name, arm_poses()["hang"]) for name in (left, right)]
    wrists = np.array([pose.wrist_arm_lengths for pose in chosen])
    elbows = np.array([pose.elbow_direction for pose in chosen])
    wrists[1] *= mirror
    elbows[1] *= mirror
    if left == right:
        wrists[1] += chosen[1].over_arm_lengths
    return wrists, elbows


@dataclass(frozen=True)
class Bearing:
    """How the body carries itself: posture, pace and restlessness, whatever it does; as it stands here, at ease."""

    lean: Degrees = 2.0
    """Forward bend of the trunk."""
    head: Degrees = 3.0
    """Forward bend of the head."""
    tempo: Ratio = 1.0
    """Speed of sitting, rising and reaching."""
    restless: Ratio = 1.0
    """Size of idle movement."""
    arms: tuple[str, str] = ("hang", "hang")
    waits: tuple[str, str] = ("hips", "hang")
    """How arms are held by who stands about with nothing to do."""


AT_EASE = Bearing()
"""A body in no particular mood."""


@cache
def bearings() -> Mapping[Emotion, Bearing]:
    """The bearing of every emotion."""
    rows = read_style_sheet("bearing.toml", Bearing).emotions
    return {emotion: Bearing(**rows.get(emotion, {})) for emotion in Emotion}


@table
class Pace:
    """What the words of a caption change of a bearing."""

    words: str
    """The pattern they fit."""
    min_tempo_ratio: float = 0.0
    max_tempo_ratio: float = 10.0
    restless_ratio: float = 1.0
    """Against the emotion's restlessness."""


@table
class Paces:
    """The first whose words a caption has counts."""

    paces: tuple[Pace, ...]


def bearing_of(emotion: Emotion, caption: str = "") -> Bearing:
    """Posture and pace of an emotion; "slowly" and "abruptly" in the caption change the pace."""
    bearing = bearings()[emotion]
    read: Paces = read_table("motion_backend", "styles/pace.toml", Paces)
    for pace in read.paces:
        if re.search(pace.words, caption.lower()):
            tempo = min(max(bearing.tempo, pace.min_tempo_ratio), pace.max_tempo_ratio)
            return replace(bearing, tempo=tempo, restless=pace.restless_ratio * bearing.restless)
    return bearing


def carried(bearing: Bearing, changes: dict[str, Any], style: type) -> tuple[Bearing, dict[str, Any]]:
    """A bearing with those of the changes that are its own, and the others, which are fields of `style`."""
    theirs = {field.name for field in fields(style)}
    own = {name: value for name, value in changes.items() if name not in theirs}
    return replace(bearing, **own), {name: value for name, value in changes.items() if name in theirs}
