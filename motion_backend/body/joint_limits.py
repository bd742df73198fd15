"""How far each joint of a healthy adult turns, and how far a motion goes beyond that.

Ranges are those of the American Academy of Orthopaedic Surgeons (Joint Motion, 1965: active ranges from the anatomical
position, averages of adults), with three differences: our rest pose is the T-pose, so shoulders are a cone about the
middle of what they reach; the range of neck and trunk is shared out over their joints, and one of them may bend beyond
its share while they all together do not; and what a loaded joint does beyond its active range counts as well (ankles of
a crouching body, hips of one who sits cross-legged, toes), or what recorded people do as a matter of course.
Angles are Cardan angles in the order of the International Society of Biomechanics (Wu et al. 2002, 2005): first the
joint's main hinge, last the turn about the bone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS

Range = tuple[float, float]
CLEARLY = float(np.radians(5))
"""Beyond its range by more than this (radians) a joint is counted as outside."""


@dataclass(frozen=True)
class Hinges:
    """A joint with a range (degrees) about each of its axes, for a joint of the left side or the middle."""

    order: str
    """The axes as Cardan angles turn about them, outermost first."""
    x: Range
    y: Range
    z: Range


@dataclass(frozen=True)
class Cone:
    """A joint whose bone (+X at rest) may point anywhere within a cone, and turns about itself within a range."""

    middle: tuple[float, float, float]
    widest: float
    """Degrees between the bone and the middle of the cone."""
    twist: Range
    """Degrees about the bone, from where the shortest arc from the T-pose brings it; inwards is positive."""


_ANATOMY: dict[str, Hinges | Cone] = {
    # Thoracolumbar: flexion 80, extension 25, to the side 35, rotation 45.
    "spine1": Hinges("xzy", x=(-10, 32), y=(-12, 12), z=(-14, 14)),
    "spine2": Hinges("xzy", x=(-10, 32), y=(-16, 16), z=(-14, 14)),
    "spine3": Hinges("xzy", x=(-10, 32), y=(-20, 20), z=(-14, 14)),
    # Cervical: flexion 45, extension 45 (70 of who looks up at what the hands do), to the side 45, rotation 60 (of the
    # young 80).
    "neck": Hinges("xzy", x=(-35, 30), y=(-40, 40), z=(-25, 25)),
    "head": Hinges("xzy", x=(-35, 30), y=(-40, 40), z=(-25, 25)),
    "collar": Hinges("zyx", x=(-30, 30), y=(-30, 25), z=(-20, 45)),
    # Flexion and abduction 180 with the shoulder blade, extension 60; inward rotation 70, outward 90, and 30 more of
    # either by the shoulder blade, which our collar only lifts: hands reach behind head and back.
    "shoulder": Cone((0.50, -0.45, 0.74), 115, twist=(-120, 100)),
    # Flexion 150; pronation and supination 80, which may sit in either joint of the forearm.
    "elbow": Hinges("yzx", x=(-90, 90), y=(-155, 5), z=(-15, 15)),
    # Flexion 80, extension 70, towards the thumb 20, away from it 30.
    "wrist": Hinges("xzy", x=(-90, 90), y=(-25, 40), z=(-85, 75)),
    # Flexion 120, extension 30, abduction 45, adduction 30, rotation 45.
    "hip": Hinges("xzy", x=(-130, 30), y=(-45, 60), z=(-30, 50)),
    # Flexion 135 (150 passively); a bent knee also turns.
    "knee": Hinges("xzy", x=(-5, 150), y=(-40, 40), z=(-10, 10)),
    # Dorsiflexion 20 (45 under load, as in a lunge or squat), plantar flexion 50, inversion 35, eversion 15; who sneaks
    # or crawls turns the foot in by 40.
    "ankle": Hinges("xzy", x=(-45, 50), y=(-40, 40), z=(-35, 20)),
    # Big toe: extension 70, flexion 45.
    "foot": Hinges("xzy", x=(-70, 45), y=(-15, 15), z=(-15, 15)),
}  # fmt: skip
COLUMNS = (("spine1", "spine2", "spine3"), ("neck", "head"))
"""Joints among which a range is shared out: skeletons differ in which of them bends most."""


def beyond_limits(local_rotations: NDArray[np.floating]) -> Array:
    """How far every joint is beyond its range. (T, 22, 4) xyzw to (T, 22) radians; 0 inside, and for the pelvis."""
    local = np.asarray(local_rotations, dtype=np.float64)
    beyond = np.zeros(local.shape[:2])
    for group in _hinge_groups():
        angles = cardan(local[:, group.joints] * group.mirrored, group.order)
        excess = _excess(angles, group.low, group.high)
        for column in group.columns:
            together = _excess(*(np.sum(values, axis=-2) for values in _of(column, angles, group.low, group.high)))
            excess[:, column] = np.minimum(excess[:, column], together[:, None])
        beyond[:, group.joints] = np.linalg.norm(excess, axis=-1)
    for part, limit in _ANATOMY.items():
        if isinstance(limit, Cone):
            joints = _joints_of(part)
            beyond[:, joints] = _beyond_cone(local[:, joints] * _mirrored(joints), limit)
    return beyond


def overbent(joint: str, turn: Array) -> Array:
    """How far a hinged joint is beyond its range about each of its axes as they are turned about, its main hinge
    first, its bone last; signed, of the right as seen in a mirror. (T, 4) to (T, 3) radians."""
    group, place = _group_of(joint)
    angles = cardan(turn * group.mirrored[place], group.order)
    return np.asarray(angles - np.clip(angles, group.low[place], group.high[place]))


def out_of_cone(joint: str, turn: Array) -> Array:
    """How far a joint that has a cone is beyond its range. (..., 4) to (...) radians."""
    limit = _ANATOMY[joint.rpartition("_")[2]]
    if not isinstance(limit, Cone):
        raise ValueError(f"{joint} has no cone but hinges: ask overbent")
    return _beyond_cone(turn * _mirrored([INDEX[joint]]), limit)


def within(joint: str, turn: Array, loaded: NDArray[np.bool_] | bool = False) -> Array:
    """A hinged joint's rotations with all angles brought within their ranges. (T, 4).

    Where it is `loaded` (T,) it may go below the lower end of its main hinge's, as shins over feet that stand do.
    """
    group, place = _group_of(joint)
    angles = cardan(turn * group.mirrored[place], group.order)
    low = np.where(np.asarray(loaded)[..., None] & (np.arange(3) == 0), -np.inf, group.low[place])
    angles = np.clip(angles, low, group.high[place])
    parts = [rotations.axis_to_quat(axis, angles[..., column]) for column, axis in enumerate(group.order)]
    return np.asarray(rotations.compose(rotations.compose(parts[0], parts[1]), parts[2]) * group.mirrored[place])


def limits_share(local_rotations: NDArray[np.floating]) -> float:
    """Share of frames in which a joint is `CLEARLY` beyond its range."""
    return float((beyond_limits(local_rotations).max(axis=1) > CLEARLY).mean()) if len(local_rotations) else 0.0


def worst_joint(local_rotations: NDArray[np.floating]) -> tuple[str, float]:
    """The joint that goes farthest beyond its range, and how far (radians); ("", 0) when none does."""
    most = beyond_limits(local_rotations).max(axis=0)
    joint = int(most.argmax())
    return (JOINTS[joint], float(most[joint])) if most[joint] > 0 else ("", 0.0)


_MIRRORED = np.array([1.0, -1.0, -1.0, 1.0])
"""A rotation of the right side seen in a mirror is one of the left."""


class _Group(NamedTuple):
    """Joints whose hinges are told in the same order of axes, and their ranges (joints, 3) in radians."""

    order: str
    joints: list[int]
    mirrored: Array
    low: Array
    high: Array
    columns: list[list[int]]
    """Places of joints that share a range."""


@cache
def _hinge_groups() -> tuple[_Group, ...]:
    hinges = {part: limit for part, limit in _ANATOMY.items() if isinstance(limit, Hinges)}
    found = []
    for order in dict.fromkeys(limit.order for limit in hinges.values()):
        limits = [(j, limit) for part, limit in hinges.items() if limit.order == order for j in _joints_of(part)]
        joints = [joint for joint, _ in limits]
        ranges = np.radians([[getattr(limit, axis) for axis in order] for _, limit in limits])  # (joints, 3, 2)
        columns = [[joints.index(INDEX[name]) for name in column] for column in COLUMNS if INDEX[column[0]] in joints]
        found.append(_Group(order, joints, _mirrored(joints), ranges[..., 0], ranges[..., 1], columns))
    return tuple(found)


def _of(places: list[int], *values: Array) -> list[Array]:
    """Rows of joints (..., joints, 3) at these places."""
    return [rows[..., places, :] for rows in values]


def _group_of(joint: str) -> tuple[_Group, int]:
    """The group that a joint's range is in, and its place there."""
    group = next(group for group in _hinge_groups() if INDEX[joint] in group.joints)
    return group, group.joints.index(INDEX[joint])


def _joints_of(part: str) -> list[int]:
    return [joint for name, joint in INDEX.items() if name.rpartition("_")[2] == part]


def _mirrored(joints: list[int]) -> Array:
    """What makes rotations of right joints those of left ones. (joints, 4)."""
    return np.stack([_MIRRORED if JOINTS[joint].startswith("right") else np.ones(4) for joint in joints])


def _beyond_cone(turn: Array, limit: Cone) -> Array:
    bone = rotations.rotate(turn, np.array([1.0, 0.0, 0.0]))
    middle = rotations.normalize(np.array(limit.middle))
    away = np.maximum(np.arccos(np.clip(bone @ middle, -1.0, 1.0)) - np.radians(limit.widest), 0.0)
    twist = rotations.wrap(2 * np.arctan2(turn[..., 0], turn[..., 3]))
    low, high = np.radians(limit.twist)
    return np.asarray(np.hypot(away, _excess(twist, low, high)))


def _excess(angles: Array, low: Array | float, high: Array | float) -> Array:
    return np.asarray(np.maximum(np.maximum(low - angles, angles - high), 0.0))


def cardan(turn: Array, order: str) -> Array:
    """Angles about three different axes, outermost first, that together make a rotation. (..., 4) to (..., 3)."""
    first, second, third, sign = _axes(order)
    a, b, c, w = turn[..., first], turn[..., second], turn[..., third], sign * turn[..., 3]
    # The entries of the rotation's matrix that the angles are read from.
    middle = np.arcsin(np.clip(sign * (2 * (a * c + b * w)), -1.0, 1.0))
    outer = np.arctan2(-sign * (2 * (b * c - a * w)), 1 - 2 * (a * a + b * b))
    inner = np.arctan2(-sign * (2 * (a * b - c * w)), 1 - 2 * (b * b + c * c))
    return np.stack([outer, middle, inner], axis=-1)


@cache
def _axes(order: str) -> tuple[int, int, int, float]:
    first, second, third = ("xyz".index(axis) for axis in order)
    return first, second, third, 1.0 if (second - first) % 3 == 1 else -1.0
