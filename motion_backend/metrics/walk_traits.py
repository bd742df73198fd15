"""What gives a made walk away: named numbers of one second of walking, and how well each alone tells it from people's.

Windows are turned to the way (`Seconds`): X is left, Y up and Z ahead.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.metrics.smoothness import jerks
from motion_backend.metrics.walk_classifier import auc
from motion_backend.metrics.walk_seconds import Seconds
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

SIDES: Final = {"left": 1.0, "right": -1.0}
"""And what makes an X of either point outwards."""
SHAKEN: Final = {"trunk": ("spine2", "spine3", "neck"), "wrists": ("left_wrist", "right_wrist")}
"""Parts whose jerk is told."""
Curves = Mapping[str, Array]
"""By names that end in their unit; (N, T) each."""


@dataclass(frozen=True)
class GiveAway:
    """How one trait differs."""

    name: str
    auc: float
    """0.5 where it tells nothing, 1 where it tells all, whichever way; everybody weighs the same."""
    people: tuple[float, float]
    """Mean and standard deviation of people's windows."""
    ours: tuple[float, float]


def give_aways(people: Seconds, body: Seconds) -> list[GiveAway]:
    """All traits, those that tell most first."""
    theirs, ours = traits(people.joints), traits(body.joints)
    found = [
        GiveAway(name, _alone(values, people, ours[name]), _summed(values), _summed(ours[name]))
        for name, values in theirs.items()
    ]
    return sorted(found, key=lambda one: -one.auc)


def traits(joints: Array) -> dict[str, Array]:
    """Numbers of windows of one second, (N, T, 22, 3), each (N,)."""
    frames = joints.shape[1]
    found = {"speed, m/s": np.linalg.norm(joints[:, -1, 0] - joints[:, 0, 0], axis=-1) * frames / (frames - 1)}
    for name, curve in _middle(joints).items():
        found |= _level_and_movement(name, (curve,))
    left, right = _side(joints, "left"), _side(joints, "right")
    for name in left:
        pair = (left[name], right[name])
        found |= _level_and_movement(name, pair)
        found[f"{name}: left beside right"] = np.abs(pair[0].mean(axis=1) - pair[1].mean(axis=1))
        found[f"{name}: movement, left beside right"] = np.abs(pair[0].std(axis=1) - pair[1].std(axis=1))
        if "height" in name:
            found[f"{name}: lowest"] = np.mean([curve.min(axis=1) for curve in pair], axis=0)
    found["arms, left with right: correlation"] = _correlation(left["arm forward, °"], right["arm forward, °"])
    found["arm with the other leg: correlation"] = np.mean(
        [
            _correlation(one["arm forward, °"], other["thigh forward, °"])
            for one, other in ((left, right), (right, left))
        ],
        axis=0,
    )
    for name, chosen in SHAKEN.items():
        part = joints[:, :, [INDEX[joint] for joint in chosen]]
        found[f"{name}, m/s³: jerk"] = np.array([jerks(window, frames).mean() for window in part])
    return found


def _middle(joints: Array) -> Curves:
    """What pelvis, trunk and head do."""
    at = _places(joints)
    pelvis, shoulders = at["left_hip"] - at["right_hip"], at["left_shoulder"] - at["right_shoulder"]
    trunk, head = at["neck"] - at["pelvis"], at["head"] - at["neck"]
    return {
        "pelvis height, cm": 100 * at["pelvis"][..., 1],
        "pelvis aside, cm": 100 * at["pelvis"][..., 0],
        "pelvis roll, °": _roll(pelvis),
        "pelvis yaw, °": _yaw(pelvis),
        "shoulder roll, °": _roll(shoulders),
        "shoulder yaw, °": _yaw(shoulders),
        "trunk twist, °": _yaw(shoulders) - _yaw(pelvis),
        "trunk pitch, °": _angle(trunk[..., 2], trunk[..., 1]),
        "trunk roll, °": _angle(trunk[..., 0], trunk[..., 1]),
        "head pitch, °": _angle(head[..., 2], head[..., 1]),
    }


def _side(joints: Array, side: str) -> Curves:
    """What one arm and one leg do; outwards is away from the middle."""
    at = {name.removeprefix(f"{side}_"): place for name, place in _places(joints).items()}
    thigh, shin, foot = at["knee"] - at["hip"], at["ankle"] - at["knee"], at["foot"] - at["ankle"]
    arm, upper, lower = at["wrist"] - at["shoulder"], at["elbow"] - at["shoulder"], at["wrist"] - at["elbow"]
    out = SIDES[side]
    return {
        "knee bend, °": _between(thigh, shin),
        "thigh forward, °": _angle(thigh[..., 2], -thigh[..., 1]),
        "ankle height, cm": 100 * at["ankle"][..., 1],
        "ball height, cm": 100 * at["foot"][..., 1],
        "ankle outwards, cm": 100 * out * (at["ankle"] - at["pelvis"])[..., 0],
        "toes outwards, °": out * _angle(foot[..., 0], np.hypot(foot[..., 1], foot[..., 2])),
        "arm forward, °": _angle(arm[..., 2], -arm[..., 1]),
        "arm outwards, °": out * _angle(arm[..., 0], -arm[..., 1]),
        "elbow bend, °": _between(upper, lower),
    }


def _places(joints: Array) -> dict[str, Array]:
    return {name: joints[:, :, index] for name, index in INDEX.items()}


def _level_and_movement(name: str, curves: tuple[Array, ...]) -> dict[str, Array]:
    """Mean and standard deviation over time, of both sides together."""
    return {
        f"{name}: mean": np.mean([curve.mean(axis=1) for curve in curves], axis=0),
        f"{name}: movement": np.mean([curve.std(axis=1) for curve in curves], axis=0),
    }


def _angle(across: Array, along: Array) -> Array:
    return np.asarray(np.degrees(np.arctan2(across, along)))


def _roll(line: Array) -> Array:
    return _angle(line[..., 1], np.hypot(line[..., 0], line[..., 2]))


def _yaw(line: Array) -> Array:
    return _angle(-line[..., 2], line[..., 0])


def _between(one: Array, other: Array) -> Array:
    """Degrees between two bones, 0 where they are in line."""
    lengths = np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    return np.asarray(np.degrees(np.arccos(np.clip(np.sum(one * other, axis=-1) / np.maximum(lengths, 1e-9), -1, 1))))


def _correlation(one: Array, other: Array) -> Array:
    """Over time. (N, T) each to (N,)."""
    one, other = (values - values.mean(axis=1, keepdims=True) for values in (one, other))
    size = np.sqrt(np.sum(one**2, axis=1) * np.sum(other**2, axis=1))
    return np.asarray(np.sum(one * other, axis=1) / np.maximum(size, 1e-9))


def _alone(values: Array, people: Seconds, ours: Array) -> float:
    told = np.mean([auc(values[people.people == person], ours) for person in np.unique(people.people)])
    return float(max(told, 1 - told))


def _summed(values: Array) -> tuple[float, float]:
    return float(values.mean()), float(values.std())
