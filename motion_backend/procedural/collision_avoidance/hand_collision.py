"""Keeping hands and forearms out of furniture: what would go into a solid part slides onto its face instead."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

HAND_LENGTH = 0.14
THICKNESS = 0.034
"""Radius of hand and wrist (metres)."""
FOLDED = np.radians(155)
"""So far an elbow bends (radians)."""
ALL_IN = 0.56
"""Arms are brought in altogether at this share of the clearance that they need."""
UPWARDS = 0.12
"""A way out upwards may be this much longer than the nearest way out sideways: hands rest on things."""

MOVED, NOWHERE = 1e-4, 1e-6
"""A hand pushed by less than this stays, and one this near to its shoulder has no direction (metres)."""
ALONG = 1e-9
"""A line that goes less than this along an axis is square to it (metres)."""
SPREAD_FROM, SPREAD_WITHIN = 0.9, 0.5
"""Arms are spread that point this far from hanging (cosine), wholly so from so much more."""
WIDEST, NARROWEST, ROOM_SMOOTHED = 7, 17, 4.0
"""Frames about each of which the widest push, and the narrowest place, counts; width of the bell for the latter."""
BEGINS, NARROWING = 8, 15
"""Frames in which a segment's pushes, and its narrowed arms, grow from none: it begins in what the one before left."""
PUSH_SMOOTHED, SIZE_SMOOTHED, MAX_GROWTH = 2.5, 2.0, 4.0
"""Widths of the bells that a push and its size are smoothed by (frames), and how much it is made up for at the most."""


def hands_clear(pose: Pose, skeleton: Skeleton, obstacles: Obstacles, touching: str | None = None) -> Pose:
    """The same motion with hands moved out of what is solid; those that touch ("left", "right", "both") stay there."""
    reach, reaching = pose.reach.copy(), pose.reaching.copy()
    frame = chest_frame(pose, skeleton)
    for index in (0, 1):
        arm = Arm.of(pose, skeleton, index, frame)
        elbow, wrist, shoulder = arm.elbow, arm.wrist, arm.shoulder
        tip = wrist + HAND_LENGTH * skeleton.scale * arm.limb.lower
        push = _way_out(np.stack([tip, wrist, 0.5 * (elbow + wrist)], axis=1), shoulder, obstacles)
        if touching in (arm.name, "both"):
            push = push * (1 - pose.pressing[:, index, None])
        moved = np.linalg.norm(push, axis=1) > MOVED
        if not moved.any():
            continue
        # A segment begins in the pose the one before left, which was cleared already.
        led = eased(push) * smooth(np.arange(len(push)) / BEGINS)[:, None]
        used = np.linalg.norm(led, axis=1) > MOVED
        reach[used, index] = _unfolded(wrist + led, shoulder, *arm.lengths)[used]
        reaching[used, index] = 1.0
    return replace(pose, reach=reach, reaching=reaching)


def _unfolded(wrists: Array, shoulder: Array, upper: float, lower: float) -> Array:
    """Wrists no nearer to the shoulder than an elbow can bend. (T, 3)."""
    away = wrists - shoulder
    length = np.linalg.norm(away, axis=1, keepdims=True)
    least = np.sqrt(upper**2 + lower**2 + 2 * upper * lower * np.cos(FOLDED))
    return np.asarray(shoulder + away * np.maximum(least / np.maximum(length, NOWHERE), 1.0))


def arms_in(pose: Pose, room: Array, narrow: str, wide: float) -> Pose:
    """Arms brought into the pose `narrow` where the way is: `room` (T,) is the clearance there, `wide` what they need.

    Both are metres for a body of 1.70 m, from its middle.
    """
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    least = gaussian_filter1d(minimum_filter1d(room, NARROWEST, mode="nearest"), ROOM_SMOOTHED, mode="nearest")
    share = smooth((wide - least) / (wide - ALL_IN * wide))
    # A segment begins in the pose the one before left.
    share = (share * smooth(np.arange(len(room)) / NARROWING))[:, None, None]
    wrists, elbows = arm_arrays(narrow, narrow)
    if narrow != "hang":
        # Only as far as they are spread: arms that have come down at the end of the way stay down.
        hang, _ = arm_arrays("hang", "hang")
        down = np.sum(rotations.normalize(pose.arms) * rotations.normalize(hang), axis=-1, keepdims=True)
        share = share * smooth((SPREAD_FROM - down) / SPREAD_WITHIN)
    lengths = np.linalg.norm(pose.arms, axis=-1, keepdims=True)
    along = rotations.normalize(pose.arms + share * (wrists - pose.arms))
    return replace(
        pose,
        arms=along * (lengths + share * (np.linalg.norm(wrists, axis=-1, keepdims=True) - lengths)),
        elbows=pose.elbows + share * (elbows - pose.elbows),
    )


def _way_out(points: Array, shoulder: Array, obstacles: Obstacles) -> Array:
    """The longest of the ways back out of solid boxes for K points a frame of an arm. (T, K, 3), (T, 3) to (T, 3)."""
    frames, count = points.shape[:2]
    flat = points.reshape(-1, 3)
    origin = np.repeat(shoulder, count, axis=0)
    total = np.zeros_like(flat)
    wide = np.sqrt(2) * THICKNESS
    low, high = np.minimum(flat, origin) - wide, np.maximum(flat, origin) + wide
    close = obstacles.near(flat.min(axis=0) - THICKNESS, flat.max(axis=0) + THICKNESS)
    for index, span in enumerate(close.spans):
        about = np.all((close.centers[index] + span >= low) & (close.centers[index] - span <= high), axis=1)
        met = np.flatnonzero(about | total.any(axis=1))
        if len(met):
            total[met] += _out_of_box(flat[met] + total[met], origin[met], close, index)
    ways = total.reshape(frames, -1, 3)
    longest = np.argmax(np.linalg.norm(ways, axis=2), axis=1)
    return np.asarray(ways[np.arange(frames), longest])


def _out_of_box(points: Array, origin: Array, boxes: Obstacles, index: int) -> Array:
    """Up out of a box, or back to the side the arm came from: through a wardrobe is no way out of it."""
    turn = rotations.yaw_to_quat(float(boxes.yaws[index]))
    back = rotations.inverse(turn)
    local = rotations.rotate(back, points - boxes.centers[index])
    source = rotations.rotate(back, origin - boxes.centers[index])
    half = boxes.halves[index] + THICKNESS
    inside = (np.abs(local) < half).all(axis=1) | _crosses(source, local, boxes.halves[index])
    out = np.zeros_like(local)
    if not inside.any():
        return out
    side = np.sign(source[:, [0, 2]])
    across = half[[0, 2]] - side * local[:, [0, 2]]
    entered = np.abs(source[:, [0, 2]]) > boxes.halves[index][[0, 2]]
    across = np.where(entered | ~entered.any(axis=1, keepdims=True), across, np.inf)
    axis = np.argmin(across, axis=1)
    distance = across[np.arange(len(across)), axis]
    up = half[1] - local[:, 1]
    upwards = inside & (up < distance + UPWARDS)
    out[upwards, 1] = up[upwards]
    aside = np.flatnonzero(inside & ~upwards)
    out[aside, 2 * axis[aside]] = (side[np.arange(len(side)), axis] * distance)[aside]
    return np.asarray(rotations.rotate(turn, out))


def _crosses(start: Array, end: Array, half: Array) -> NDArray[np.bool_]:
    """Whether the line from shoulder to point passes through a box about the origin: a thin wall is no gap. (N,)."""
    way = end - start
    way = np.where(np.abs(way) < ALONG, ALONG, way)
    first, second = (-half - start) / way, (half - start) / way
    enters = np.minimum(first, second).max(axis=1)
    leaves = np.maximum(first, second).min(axis=1)
    return np.asarray((enters < leaves) & (enters > 0) & (enters < 1))


def eased(push: Array) -> Array:
    """The push led in and out over a few frames, so that hands do not snap."""
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    size = np.linalg.norm(push, axis=1)
    wide = maximum_filter1d(size, WIDEST, mode="nearest")
    smoothed = gaussian_filter1d(push, PUSH_SMOOTHED, axis=0, mode="nearest")
    length = np.linalg.norm(smoothed, axis=1)
    wanted = np.maximum(gaussian_filter1d(wide, SIZE_SMOOTHED, mode="nearest"), 0.0)
    grow = np.where(length > NOWHERE, wanted / np.maximum(length, NOWHERE), 0.0)
    return np.asarray(smoothed * np.minimum(grow, MAX_GROWTH)[:, None])
