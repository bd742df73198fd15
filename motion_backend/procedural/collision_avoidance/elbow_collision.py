"""Elbows swung out of what is solid, round the line from shoulder to hand, which stays where it is."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.joint_limits import out_of_cone
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import Limb, arm_rotations
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

SWINGS: Final = np.radians(np.arange(-105.0, 106.0, 15.0))
"""Angles that an elbow may be swung by (radians)."""
SKIN: Final = np.array([0.042, 0.042, 0.042, 0.034, 0.034, 0.024, 0.024])
"""Radii of an arm and its hand where they are looked at (metres at 1.70 m)."""
UPPER, FORE = (0.35, 0.7, 1.0), (0.4, 0.75)
"""Where the first of them are: shares of the upper arm, and of the forearm beyond the elbow."""
HAND: Final = (0.08, 0.13)
"""Middle and fingertips of a hand from its wrist (metres at 1.70 m)."""
TRUNK: Final = np.array([[0.0, -0.18, 0.0], [0.0, 0.10, 0.0]])
"""Ends of the middle of the trunk, from the chest (metres at 1.70 m)."""
TRUNK_WIDTH: Final = 0.10
"""Half of what a trunk is thick (metres at 1.70 m)."""
SEEN: Final = 0.01
"""An arm this deep in something is swung out (metres)."""
STRAINED: Final = float(np.radians(3))
"""An arm whose shoulder is so far beyond its range is swung back (radians)."""
SMOOTHED: Final = 3.0
"""Width of the bell that swings are smoothed by (frames)."""
BEGINS: Final = 8
"""Frames in which a segment's swings grow from none: it begins in the pose that the one before left."""
LEAD: Final = 20
"""Frames in which an elbow swings out, and back."""
DEEP, BEYOND, FAR, FAST = 60.0, 40.0, 0.5, 30.0
"""What counts in a frame: a metre of depth, a radian beyond the range, a swing and its change (radians²)."""


def _swung(arm: Arm, angles: Array) -> Limb:
    """An arm's bones with its elbow swung by angles (A,) or (T, 1). (T, A, 3) each."""
    axis = rotations.normalize(arm.way)[:, None]
    return Limb(*(_about(bone[:, None], axis, angles) for bone in arm.limb))


def arm_points(arm: Arm, limb: Limb, scale: float) -> Array:
    """Places along the middle of upper arm, forearm and hand. (7, ..., 3)."""
    upper, lower = arm.lengths[0] * limb.upper, arm.lengths[1] * limb.lower
    shoulder = arm.shoulder if limb.upper.ndim == 2 else arm.shoulder[:, None]
    hand = arm.hand(limb) * scale
    along = [*(share * upper for share in UPPER), *(upper + share * lower for share in FORE)]
    return np.asarray(shoulder + np.stack([*along, *(upper + lower + reach * hand for reach in HAND)]))


def _beyond(arm: Arm, limb: Limb) -> Array:
    """How far the shoulder of swung bones (T, 3) or (T, A, 3) is beyond its range. (T) or (T, A) radians."""
    bone, _ = arm_rotations(limb, arm.side)
    clavicle = arm.clavicle if bone.ndim == 2 else arm.clavicle[:, None]
    return out_of_cone(f"{arm.name}_shoulder", rotations.compose(rotations.inverse(clavicle), bone))


def elbows_clear(pose: Pose, skeleton: Skeleton, obstacles: Obstacles) -> Pose:
    """The same motion with elbows swung where an arm, or a hand that it cannot lay flat, would be in something, and
    where a shoulder would be beyond its range.
    """
    chest, scale = chest_frame(pose, skeleton), skeleton.scale
    elbows = pose.elbows.copy()
    for index in (0, 1):
        arm = Arm.of(pose, skeleton, index, chest)
        before = _depth(arm_points(arm, arm.limb, scale), obstacles, scale)
        strained = _beyond(arm, arm.limb)
        for frames in _about_each((before >= SEEN) | (strained > STRAINED)):
            part, body = arm.part(frames), (chest[0][frames], chest[1][frames])
            swing = _swing(part, body, obstacles, scale, ends=frames.stop < len(pose))
            swung = _swung(part, swing[:, None])
            after, strain = _depth(arm_points(part, swung, scale), obstacles, scale), _beyond(part, swung)
            # A hand that cannot follow its forearm may turn over on the way: then it is better left alone.
            deep = before[frames].max()
            if after.max() <= deep and (deep >= SEEN or strain.max() <= strained[frames].max()):
                axis = rotations.rotate(rotations.inverse(body[0]), rotations.normalize(part.way))
                elbows[frames, index] = _about(elbows[frames, index], axis, swing)
    return replace(pose, elbows=elbows)


def _about_each(frames: NDArray[np.bool_]) -> list[slice]:
    """Stretches of frames about those that a mask (T,) has, with time to swing out and back."""
    at = np.flatnonzero(frames)
    if not len(at):
        return []
    groups = np.split(at, np.flatnonzero(np.diff(at) > 2 * LEAD) + 1)
    return [slice(max(int(one[0]) - LEAD, 0), min(int(one[-1]) + LEAD + 1, len(frames))) for one in groups]


def _swing(arm: Arm, chest: tuple[Array, Array], obstacles: Obstacles, scale: float, ends: bool) -> Array:
    """How far the elbow of T frames is swung out of what is there; not at the first frame, and the last if it `ends`.

    (T,) radians.
    """
    tries = _swung(arm, SWINGS)
    points = arm_points(arm, tries, scale)
    deep = np.maximum(_depth(points, obstacles, scale) - SEEN, 0.0) + in_trunk(points, chest, scale)
    cost = DEEP * deep + BEYOND * _beyond(arm, tries) + FAR * SWINGS**2
    if ends:
        cost[-1, SWINGS != 0.0] = np.inf
    swing = _steady(cost)
    still = smooth(np.arange(len(swing)) / BEGINS)
    return np.asarray(swing * (still * still[::-1] if ends else still))


def _depth(points: Array, obstacles: Obstacles, scale: float) -> Array:
    """How deep an arm is in something, by its points (7, ..., 3). (...) metres."""
    deep = obstacles.depth(points.reshape(-1, 3)).reshape(points.shape[:-1])
    skin = scale * SKIN.reshape(-1, *[1] * (deep.ndim - 1))
    return np.asarray(np.maximum((deep + skin).max(axis=0), 0.0))


def in_trunk(points: Array, chest: tuple[Array, Array], scale: float) -> Array:
    """How deep elbow and forearm are in the body's own trunk, by an arm's points (7, T, A, 3). (T, A) metres."""
    waist, neck = (chest[1] + rotations.rotate(chest[0], end * scale) for end in TRUNK)
    away = _from_line(points[1:5], waist[:, None], neck[:, None])
    return np.asarray(np.maximum(scale * (TRUNK_WIDTH + SKIN[1:5, None, None]) - away, 0.0).max(axis=0))


def _from_line(points: Array, start: Array, end: Array) -> Array:
    """Distance of points (..., 3) from lines between two points."""
    way = end - start
    share = np.clip(rotations.dot(points - start, way) / rotations.dot(way, way), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - share * way, axis=-1))


def _about(vectors: Array, axes: Array, angles: Array) -> Array:
    """Vectors turned about unit axes (..., 3) by angles (...) (Rodrigues)."""
    cos, sin = np.cos(angles)[..., None], np.sin(angles)[..., None]
    along = np.sum(vectors * axes, axis=-1, keepdims=True) * axes
    return np.asarray(vectors * cos + rotations.cross(axes, vectors) * sin + along * (1 - cos))


def _steady(cost: Array) -> Array:
    """The swing of each frame with the least cost (T, A) and little change; none in the first. (T,)."""
    from scipy.ndimage import gaussian_filter1d

    cost = cost.copy()
    cost[0, SWINGS != 0.0] = np.inf
    change = FAST * (SWINGS[:, None] - SWINGS) ** 2
    before = np.zeros(cost.shape, dtype=np.int64)
    for frame in range(1, len(cost)):
        ways = cost[frame - 1] + change
        before[frame] = ways.argmin(axis=1)
        cost[frame] += ways.min(axis=1)
    best = np.empty(len(cost), dtype=np.int64)
    best[-1] = int(cost[-1].argmin())
    for frame in range(len(cost) - 1, 0, -1):
        best[frame - 1] = before[frame, best[frame]]
    return np.asarray(gaussian_filter1d(SWINGS[best], SMOOTHED, mode="nearest"))
