"""Sixteen numbers of two seconds of a walk, from joint positions alone: what recorded and made walks are compared by.

They see neither where the walk is nor where it leads to; seen in a mirror, left and right arm change places and the
rest stays. A swing to and fro is told as 2 √2 times its standard deviation: from end to end of a sine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.metrics.smoothness import jerk
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

SECONDS: Final = 2.0
UNITS: Final = {
    "speed": "m/s", "stride_length": "m", "stride_rate": "1/s", "step_width": "m", "pelvis_bob": "m",
    "lateral_sway": "m", "trunk_pitch": "rad", "trunk_sway": "rad", "arm_swing_left": "rad",
    "arm_swing_right": "rad", "knee_range": "rad", "toe_clearance": "m", "duty_factor": "", "double_support": "",
    "log_jerk": "", "pelvis_yaw": "rad",
}  # fmt: skip
"""Every feature, in order, and its unit."""
MIN_WALKING_SPEED: Final = 0.3
"""A body slower than this (metres a second) does not walk."""
STEADY: Final = 0.7
"""No quarter of a window of steady walking is slower than this share of the whole."""
MAX_TURN: Final = np.radians(30)
"""And the way turns by no more than this in it."""
STANDS: Final = 0.5
"""A foot stands while its ankle or ball is slower than this share of the body."""
CLEAR: Final = 0.3
"""Ankles have passed each other when they are farther apart than this share of their usual distance: no jitter."""


@dataclass(frozen=True)
class _Way:
    """Where a window leads to: a parabola through the pelvis' places on the floor."""

    ahead: Array
    """(T, 2) unit vectors [x, z]."""
    speed: float
    """Metres a second."""

    @property
    def left(self) -> Array:
        """(T, 2) unit vectors."""
        return np.stack([self.ahead[:, 1], -self.ahead[:, 0]], axis=1)

    @property
    def turn(self) -> float:
        """Radians from the first frame to the last, without sign."""
        return float(np.arccos(np.clip(self.ahead[0] @ self.ahead[-1], -1.0, 1.0)))

    def forward(self, points: Array) -> Array:
        """How far along the way points (T, …, 3) lie, seen from the origin. (T, …)."""
        return np.asarray(np.einsum("t...c,tc->t...", points[..., [0, 2]], self.ahead))

    def aside(self, points: Array) -> Array:
        """How far to the left of the origin. (T, …)."""
        return np.asarray(np.einsum("t...c,tc->t...", points[..., [0, 2]], self.left))


@dataclass(frozen=True)
class _Strides:
    """When the ankles pass each other, and when they are farthest apart in between."""

    passing: Array
    """(N,) frames, with fractions."""
    farthest: NDArray[np.int64]
    """(N - 1,) frames."""

    def rate(self, fps: float) -> float:
        """Strides, of two steps each, a second."""
        return float((len(self.passing) - 1) / 2 / (self.passing[-1] - self.passing[0]) * fps)


def windows(positions: Array, fps: float) -> list[tuple[int, int]]:
    """Starts and stops of 2 s windows, each half over the last, in which (T, 22, 3) walks steadily and straight on."""
    size = round(SECONDS * fps)
    starts = range(0, len(positions) - size + 1, size // 2)
    return [(start, start + size) for start in starts if _walks_steadily(positions[start : start + size], fps)]


def gait_features(positions: Array, fps: float) -> Array | None:
    """The features of one window, (T, 22, 3) metres to (16,) in the order of `UNITS`; None for under one stride."""
    way, strides = _way(positions, fps), None
    if way.speed > 0:
        strides = _strides(way.forward(_of(positions, "left_ankle") - _of(positions, "right_ankle")))
    if strides is None:
        return None
    rate, times = strides.rate(fps), np.arange(len(positions)) / fps
    trunk = _of(positions, "neck") - positions[:, 0]
    pelvis = _of(positions, "left_hip") - _of(positions, "right_hip")
    # As seen from the left of the way: the angle keeps its meaning whichever way that leads.
    yaw = np.arctan2(-way.forward(pelvis), way.aside(pelvis))
    across = np.einsum("tc,tc->t", _off_the_way(positions[:, 0], times, rate), way.left)
    standing = _standing(positions, way.speed, fps)
    found = {
        "speed": way.speed,
        "stride_length": way.speed / rate,
        "stride_rate": rate,
        "step_width": _step_width(positions, way, strides),
        "pelvis_bob": _swing(positions[:, 0, 1], times, rate),
        "lateral_sway": float(2 * np.sqrt(2) * across.std()),
        "trunk_pitch": float(np.arctan2(way.forward(trunk), trunk[:, 1]).mean()),
        "trunk_sway": _swing(np.arctan2(way.aside(trunk), trunk[:, 1]), times, rate),
        "arm_swing_left": _arm_swing(positions, "left", way, times, rate),
        "arm_swing_right": _arm_swing(positions, "right", way, times, rate),
        "knee_range": float(np.mean([np.ptp(_flexion(positions, side)) for side in ("left", "right")])),
        "toe_clearance": _toe_clearance(positions, strides),
        "duty_factor": float(standing.mean()),
        "double_support": float(standing.all(axis=1).mean()),
        "log_jerk": float(np.log(max(jerk(positions, round(fps)), 1e-3))),
        "pelvis_yaw": _swing(yaw, times, rate),
    }
    return np.array([found[name] for name in UNITS])


def _of(positions: Array, joint: str) -> Array:
    """Places of one joint. (T, 3)."""
    return np.asarray(positions[:, INDEX[joint]], dtype=np.float64)


def _way(positions: Array, fps: float) -> _Way:
    ground = positions[:, 0, [0, 2]].astype(np.float64)
    times = np.arange(len(ground)) / fps
    curve = np.polynomial.polynomial.polyfit(times - times.mean(), ground, 2)
    velocity = curve[1] + 2 * np.outer(times - times.mean(), curve[2])
    pace = np.linalg.norm(velocity, axis=1, keepdims=True)
    return _Way(velocity / np.maximum(pace, 1e-9), float(pace.mean()))


def _walks_steadily(positions: Array, fps: float) -> bool:
    quarters = positions[:: len(positions) // 4, 0][:, [0, 2]]
    ends = np.concatenate([quarters[:4], positions[-1:, 0][:, [0, 2]]])
    paces = np.linalg.norm(np.diff(ends, axis=0), axis=1) / (SECONDS / 4)
    way = _way(positions, fps)
    return bool(paces.mean() > MIN_WALKING_SPEED and paces.min() > STEADY * paces.mean() and way.turn < MAX_TURN)


def _strides(apart: Array) -> _Strides | None:
    """From how far the left ankle is before the right one, (T,); None where they pass less than three times."""
    about = apart - apart.mean()
    clear = np.flatnonzero(np.abs(about) > CLEAR * about.std())
    changes = np.flatnonzero(np.diff(np.sign(about[clear])))
    before, after = clear[changes], clear[changes + 1]
    if len(before) < 3:
        return None
    passing = before + (after - before) * about[before] / (about[before] - about[after])
    farthest = [int(after[k] + np.abs(about[after[k] : before[k + 1] + 1]).argmax()) for k in range(len(before) - 1)]
    return _Strides(passing, np.array(farthest, dtype=np.int64))


def _trend(values: Array, times: Array, rate: float) -> Array:
    """The slow part of values (T, …): a parabola, fitted with the sines of stride and step lest it follow them."""
    beats = [wave(2 * np.pi * rate * beat * times) for beat in (1, 2) for wave in (np.sin, np.cos)]
    slow = [(times - times.mean()) ** power for power in range(3)]
    basis = np.stack(slow + beats, axis=1)  # (T, 7)
    return np.asarray(basis[:, :3] @ np.linalg.lstsq(basis, values, rcond=None)[0][:3])


def _swing(values: Array, times: Array, rate: float) -> float:
    """How far values (T,) go to and fro about their slow part, from end to end."""
    return float(2 * np.sqrt(2) * (values - _trend(values, times, rate)).std())


def _off_the_way(pelvis: Array, times: Array, rate: float) -> Array:
    """How far the pelvis is from the slow part of its way, on the floor. (T, 3) to (T, 2)."""
    ground = pelvis[:, [0, 2]].astype(np.float64)
    return np.asarray(ground - _trend(ground, times, rate))


def _step_width(positions: Array, way: _Way, strides: _Strides) -> float:
    """How far the left ankle is left of the right one when they are farthest apart along the way."""
    gap = way.aside(_of(positions, "left_ankle") - _of(positions, "right_ankle"))
    return float(gap[strides.farthest].mean())


def _toe_clearance(positions: Array, strides: _Strides) -> float:
    """How much higher the swinging ball is than the standing one as the ankles pass each other."""
    gap = np.abs(_of(positions, "left_foot")[:, 1] - _of(positions, "right_foot")[:, 1])
    return float(np.interp(strides.passing, np.arange(len(gap)), gap).mean())


def _arm_swing(positions: Array, side: str, way: _Way, times: Array, rate: float) -> float:
    """Swing of the line from shoulder to wrist, forward and back."""
    arm = _of(positions, f"{side}_wrist") - _of(positions, f"{side}_shoulder")
    return _swing(np.arctan2(way.forward(arm), -arm[:, 1]), times, rate)


def _flexion(positions: Array, side: str) -> Array:
    """How far a knee is bent. (T,) radians, 0 straight."""
    hip, knee, ankle = (_of(positions, f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
    thigh, shin = knee - hip, ankle - knee
    lengths = np.linalg.norm(thigh, axis=1) * np.linalg.norm(shin, axis=1)
    return np.asarray(np.arccos(np.clip(np.sum(thigh * shin, axis=1) / np.maximum(lengths, 1e-9), -1.0, 1.0)))


def _standing(positions: Array, speed: float, fps: float) -> NDArray[np.bool_]:
    """Whether left and right foot stand. (T - 1, 2)."""
    feet = np.stack([[_of(positions, f"{side}_{of}") for of in ("ankle", "foot")] for side in ("left", "right")])
    paces = np.linalg.norm(np.diff(feet[..., [0, 2]], axis=2), axis=-1) * fps  # (2 sides, 2 joints, T - 1)
    slower = paces.min(axis=1).T
    return np.asarray(slower < STANDS * speed)
