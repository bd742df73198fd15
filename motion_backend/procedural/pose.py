"""The handles a body is posed by, and moving them from key pose to key pose.

A `Pose` holds what an animator would hold: pelvis, spine, head, feet on the ground, wrists and where elbows point.
Every field may carry leading time dimensions; a motion is a Pose whose arrays begin with T.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.rotations import Array

ROTATIONS = ("hips", "feet", "palms")
OPPOSITE, NO_SIZE = 1e-3, 1e-12
"""Arms that are turned right round have no shortest turn, vectors of no size no direction: kept from dividing by 0."""
HALF_TURN = 1.0
"""A turn smaller than this (radians) is never taken the other way round."""
BOWED_FROM, BOWED_WITHIN = 0.2, 0.25
"""A swing of an arm goes round the shoulder from so far apart on (0 together, 1 opposite), wholly from so much more."""
OUTWARD, BOW = np.array([[0.75, 0.0, 0.66], [-0.75, 0.0, 0.66]]), 2.4
"""Where arms swing past the shoulder, left and right in the chest frame, and how far for how far apart they are."""
ARMS_SETTLE = 1.5
"""Arms take so much longer than the rest to come into a motion."""


@dataclass(frozen=True)
class Pose:
    """Handles of the body. Index 0 of a pair is left, 1 is right; distances in metres."""

    pelvis: Array
    """(..., 3) world."""
    hips: Array
    """(..., 4) pelvis to world."""
    spine: Array
    """(..., 3) rotation vector of the chest against the pelvis, shared by three joints; +x bends forward."""
    head: Array
    """(..., 3) rotation vector of the head against the chest, shared by neck and head."""
    ankles: Array
    """(..., 2, 3) world."""
    feet: Array
    """(..., 2, 4) foot to world."""
    toes: Array
    """(..., 2) bend of the toes, positive upwards."""
    knees: Array
    """(..., 2, 3) world direction the knees point to."""
    arms: Array
    """(..., 2, 3) wrist from its shoulder in the chest frame, in arm lengths (1 = straight)."""
    elbows: Array
    """(..., 2, 3) direction the elbows point to, in the chest frame."""
    reach: Array
    """(..., 2, 3) world position for the wrist, in place of `arms` as far as `reaching` says."""
    reaching: Array
    """(..., 2) 0 to 1."""
    palms: Array
    """(..., 2, 4) hand to world, used as far as `pressing` says."""
    pressing: Array
    """(..., 2) 0 to 1."""
    planted: Array
    """(..., 2) 1 where the foot stands on its place."""

    def __len__(self) -> int:
        return int(self.pelvis.shape[0])

    def at(self, index: int | slice | NDArray[np.intp]) -> Pose:
        """One frame, a stretch of frames, or some frames."""
        return Pose(**{f.name: getattr(self, f.name)[index] for f in fields(self)})

    def repeat(self, frames: int) -> Pose:
        """The same single pose held for so many frames."""
        held = {f.name: np.repeat(getattr(self, f.name)[None], frames, axis=0) for f in fields(self)}
        return Pose(**held)

    def to_lists(self) -> dict[str, Any]:
        """Plain lists for a BodyState's memory."""
        return {f.name: np.round(getattr(self, f.name), 9).tolist() for f in fields(self)}

    @staticmethod
    def from_lists(memory: dict[str, Any]) -> Pose:
        """Back from `to_lists`."""
        return Pose(**{f.name: np.asarray(memory[f.name], dtype=np.float64) for f in fields(Pose)})


def concatenate(poses: list[Pose]) -> Pose:
    """One stretch of frames after the other."""
    return Pose(**{f.name: np.concatenate([getattr(p, f.name) for p in poses]) for f in fields(Pose)})


def smooth(u: NDArray[np.floating] | float) -> Array:
    """Minimum-jerk share of the way at share u of the time (0 to 1, clipped)."""
    u = np.minimum(np.maximum(u, 0.0), 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))


def interpolate(times: list[float], keys: list[Pose], fps: int) -> Pose:
    """Frames through key poses: cubic Hermite through every handle, at rest at both ends."""
    knots = np.asarray(times, dtype=np.float64)
    frames = max(round((knots[-1] - knots[0]) * fps), 1)
    at = knots[0] + np.arange(1, frames + 1) / fps
    values = _each(knots, keys, at)
    values["arms"] = _around_the_shoulder(knots, np.stack([key.arms for key in keys]), at, values["arms"])
    values["elbows"] = _carried_along(knots, keys, at, values["arms"])
    return Pose(**values)


def _each(knots: Array, keys: list[Pose], at: Array) -> dict[str, Array]:
    """Every handle at the times `at`, each by itself; those that are splined share one spline."""
    stacked = {f.name: np.stack([getattr(key, f.name) for key in keys]) for f in fields(Pose)}
    standing = stacked.pop("planted")
    middles = {name: stacked[name][len(keys) // 2] for name in ROTATIONS}
    for name, middle in middles.items():
        turns = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(middle), stacked[name]))
        stacked[name] = _unwrapped(turns, len(keys) // 2)
    ends = np.cumsum([values[0].size for values in stacked.values()])
    flat = spline(knots, np.concatenate([values.reshape(len(keys), -1) for values in stacked.values()], axis=1), at)
    found = {
        name: part.reshape(len(at), *values.shape[1:])
        for (name, values), part in zip(stacked.items(), np.split(flat, ends[:-1], axis=1), strict=True)
    }
    for name, middle in middles.items():
        found[name] = rotations.compose(middle, rotations.rotvec_to_quat(found[name]))
    after = np.clip(np.searchsorted(knots, at, side="left"), 1, len(knots) - 1)
    # A foot stands only where it stood at both ends of a stretch; the last frame is the last key.
    found["planted"] = np.minimum(standing[after - 1], standing[after])
    found["planted"][-1] = standing[-1]
    return found


def _unwrapped(turns: Array, middle: int) -> Array:
    """Rotation vectors (K, ..., 3) of key poses, each the one of its rotation's that is nearer to its neighbour's.

    The neighbour is that on the way from the key `middle`: a body that turns on by more than half a turn turns on.
    """
    found = turns.copy()
    steps = [(key, key - 1) for key in range(middle + 1, len(turns))] + [(key, key + 1) for key in range(middle)][::-1]
    for key, neighbour in steps:
        size = np.maximum(rotations.length(found[key]), NO_SIZE)
        other = found[key] * (1 - 2 * np.pi / size)
        nearer = rotations.length(other - found[neighbour]) < rotations.length(found[key] - found[neighbour])
        found[key] = np.where(nearer & (size > HALF_TURN), other, found[key])
    return found


def _carried_along(knots: Array, keys: list[Pose], at: Array, arms: Array) -> Array:
    """Elbow directions carried along with the arm from key to key, so that an elbow never flips over. (T, 2, 3).

    Within a stretch the direction is turned as the arm turns, frame by frame, and what is then still missing to the
    next key's direction is made up for evenly.
    """
    before = np.clip(np.searchsorted(knots, at, side="left") - 1, 0, len(keys) - 2)
    way = rotations.normalize(arms)
    out = np.empty_like(arms)
    for index in range(len(keys) - 1):
        frames = np.flatnonzero(before == index)
        if not len(frames):
            continue
        here, following = keys[index], keys[index + 1]
        start, end = rotations.normalize(here.arms), rotations.normalize(following.arms)
        poles = _led(_square(here.elbows, start), start, way[frames])
        wanted = _square(following.elbows, end)
        got = _square(_turned_with(poles[-1], way[frames[-1]], end), end)
        turn = np.arctan2(np.sum(rotations.cross(got, wanted) * end, axis=-1), np.sum(got * wanted, axis=-1))  # (2,)
        share = smooth((at[frames] - knots[index]) / (knots[index + 1] - knots[index]))
        angle = (share[:, None] * turn)[..., None]
        out[frames] = poles * np.cos(angle) + rotations.cross(way[frames], poles) * np.sin(angle)
    return out


def _led(pole: Array, start: Array, way: Array) -> Array:
    """Poles (2, 3) of both arms, square to unit vectors `start`, led along the arms' `way` (T, 2, 3) of such."""
    sides = [_led_along(pole[side].tolist(), start[side].tolist(), way[:, side].tolist()) for side in (0, 1)]
    return np.array(sides).swapaxes(0, 1)


def _led_along(pole: list[float], start: list[float], way: list[list[float]]) -> list[tuple[float, float, float]]:
    """Each pole is the last one turned with the way and squared to it, as `_turned_with` and `_square` do.

    One follows from the other, and plain numbers take a thirtieth of the time of arrays of one vector.
    """
    (px, py, pz), (lx, ly, lz) = pole, start
    found = []
    for x, y, z in way:
        ax, ay, az = ly * z - lz * y, lz * x - lx * z, lx * y - ly * x
        scale = 1.0 / max(1.0 + (lx * x + ly * y + lz * z), OPPOSITE)
        cx, cy, cz = ay * pz - az * py, az * px - ax * pz, ax * py - ay * px
        tx = px + cx + scale * (ay * cz - az * cy)
        ty = py + cy + scale * (az * cx - ax * cz)
        tz = pz + cz + scale * (ax * cy - ay * cx)
        along = tx * x + ty * y + tz * z
        tx, ty, tz = tx - along * x, ty - along * y, tz - along * z
        size = max(sqrt(tx * tx + ty * ty + tz * tz), NO_SIZE)
        px, py, pz = tx / size, ty / size, tz / size
        lx, ly, lz = x, y, z
        found.append((px, py, pz))
    return found


def _square(vectors: Array, axes: Array) -> Array:
    """Unit vectors at right angles to unit axes, nearest to the given ones."""
    return rotations.normalize(vectors - rotations.dot(vectors, axes) * axes)


def _turned_with(vectors: Array, start: Array, end: Array) -> Array:
    """Vectors turned by the shortest rotation that takes unit vectors `start` to `end`."""
    axis = rotations.cross(start, end)
    scale = 1.0 / np.maximum(1.0 + rotations.dot(start, end), OPPOSITE)
    crossed = rotations.cross(axis, vectors)
    return np.asarray(vectors + crossed + scale * rotations.cross(axis, crossed))


def _around_the_shoulder(knots: Array, keys: Array, at: Array, straight: Array) -> Array:
    """Wrists on their way round the shoulder: a swing that would cut through it goes outwards and forwards. (T, 2, 3).

    `straight` is the plain spline; it is kept where a swing is small.
    """
    before = np.clip(np.searchsorted(knots, at, side="left") - 1, 0, len(keys) - 2)
    share = smooth((at - knots[before]) / (knots[before + 1] - knots[before]))[:, None, None]
    start, end = keys[before], keys[before + 1]
    apart = (1 - rotations.dot(rotations.normalize(start), rotations.normalize(end))) / 2
    wide = smooth((apart - BOWED_FROM) / BOWED_WITHIN)
    return np.asarray(straight + wide * (_swing(start, end, share) - straight))


def _swing(start: Array, end: Array, share: Array) -> Array:
    """Wrists on an arc from start to end about the shoulder, bowed outwards and forwards the wider it is. (T, 2, 3)."""
    lengths = [rotations.length(v) for v in (start, end)]
    first, last = rotations.normalize(start), rotations.normalize(end)
    apart = (1 - rotations.dot(first, last)) / 2  # 0 together, 1 opposite
    middle = rotations.normalize(first + last + BOW * apart * OUTWARD)
    way = rotations.normalize((1 - share) ** 2 * first + 2 * share * (1 - share) * middle + share**2 * last)
    return np.asarray(way * (lengths[0] + share * (lengths[1] - lengths[0])))


def spline(knots: Array, values: Array, at: Array) -> Array:
    """Shape-keeping cubic through values (K, ...), flat at both ends."""
    if len(knots) == 2:
        share = smooth((at - knots[0]) / (knots[1] - knots[0]))
        return np.asarray(values[0] + share.reshape(-1, *([1] * (values.ndim - 1))) * (values[1] - values[0]))
    from scipy.interpolate import CubicHermiteSpline

    steps = np.diff(knots).reshape(-1, *([1] * (values.ndim - 1)))
    slopes = np.diff(values, axis=0) / steps
    before, after = slopes[:-1], slopes[1:]
    # Harmonic mean where both slopes agree in sign (Fritsch-Carlson), else flat: no overshoot into furniture.
    agree = before * after > 0
    mean = np.where(agree, 2 * before * after / np.where(agree, before + after, 1.0), 0.0)
    flat = np.zeros_like(values[:1])
    return np.asarray(CubicHermiteSpline(knots, values, np.concatenate([flat, mean, flat]), axis=0)(at))


def settle_from(start: Pose, motion: Pose, fps: int, seconds: float = 0.45) -> Pose:
    """Let a motion begin in exactly `start`: the difference at its first frame fades out (inertialisation).

    Feet are left alone: who places them begins where they stand.
    """
    fade = 1 - smooth(np.arange(1, len(motion) + 1) / (seconds * fps))
    first = motion.at(0)
    changed: dict[str, Array] = {}
    for name in ("pelvis", "spine", "head", "knees", "reach", "reaching", "pressing"):
        offset = getattr(start, name) - getattr(first, name)
        values = getattr(motion, name)
        changed[name] = values + fade.reshape(-1, *([1] * (values.ndim - 1))) * offset
    changed |= _settle_arms(start, motion, ARMS_SETTLE * seconds * fps)
    for name in ("hips", "palms"):
        offset = rotations.quat_to_rotvec(
            rotations.compose(getattr(start, name), rotations.inverse(getattr(first, name)))
        )
        values = getattr(motion, name)
        turn = rotations.rotvec_to_quat(fade.reshape(-1, *([1] * (values.ndim - 1))) * offset)
        changed[name] = rotations.compose(turn, values)
    return replace(motion, **changed)


def _settle_arms(start: Pose, motion: Pose, frames: float) -> dict[str, Array]:
    """Arms led round the body from where they were into the motion, and elbows with them."""
    share = smooth(np.arange(1, len(motion) + 1) / frames)[:, None, None]
    arms = _swing(np.broadcast_to(start.arms, motion.arms.shape), motion.arms, share)
    elbows = motion.elbows.copy()
    led = slice(0, int(np.ceil(frames)))
    way, begin = rotations.normalize(arms[led]), rotations.normalize(start.arms)
    poles = _led(_square(start.elbows, begin), begin, way)
    elbows[led] = (1 - share[led]) * poles + share[led] * _square(elbows[led], way)
    return {"arms": arms, "elbows": elbows}
