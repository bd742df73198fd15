"""Where the floor is under a body that was never told: levels, slopes, toy bodies and walks on the spot.

Heights are those of the lowest point of the body's skin: soles, and the capsules of all the rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend import capsules
from motion_backend.clips.planting import Feet, no_faster
from motion_backend.clips.resampling import low_pass
from motion_backend.skeleton import Skeleton

Array = NDArray[np.float64]
SHARE = 10.0
"""Percentile of the lowest points that lies on the floor: a body walks on it, and now and then scuffs it."""
CLIMB = 0.03
"""Metres that a floor must climb over a clip to be a fault of the recording."""
WINDOW = 0.45
"""Seconds in which a walking body touches the floor at least once."""
SOFT, RISE = 0.01, 0.5
"""Metres that skin gives, and metres a second at which a body is raised out of the floor."""
STEADY = 0.52
"""Share of what standing feet do that is in one direction, for a walk."""
_NOT_FEET = [index for index, body in enumerate(capsules.BODIES) if not body.name.endswith("foot")]
ON_THE_SPOT = (0.25, 0.1)
"""Metres a second: a standing foot faster than the first under a pelvis slower than the second walks on the spot."""


def lowest_skin(skeleton: Skeleton, positions: Array, world: Array) -> Array:
    """Height of the lowest point of all but the feet in each frame. (T,)."""
    starts, ends, radii = capsules.placed(skeleton, positions, world)
    bars = np.minimum(starts[..., 1], ends[..., 1]) - radii
    return np.asarray(bars[:, _NOT_FEET].min(axis=1))


def out_of_floor(lowest: Array, fps: float) -> Array:
    """How far a body must rise so that none of its skin is deep in the floor, without a jerk. (T,) metres."""
    lift = no_faster(np.maximum(-lowest - SOFT, 0.0), RISE / fps)
    return np.maximum(low_pass(lift, fps, cutoff=4.0), 0.0) if lift.any() and len(lift) > 8 else lift


def floor_under(lowest: Array, fps: float) -> Array:
    """Height of the floor in each frame: one level, or a straight climb where the recording plainly drifts. (T,)."""
    level = np.full(len(lowest), np.percentile(lowest, SHARE))
    size = round(WINDOW * fps)
    count = len(lowest) // size
    if count < 4:
        return level
    windows = lowest[: count * size].reshape(count, size)
    middles = (np.arange(count) + 0.5) * size
    lows = windows.min(axis=1)
    i, j = np.triu_indices(count, 1)
    slope = float(np.median((lows[j] - lows[i]) / (middles[j] - middles[i])))
    straight = slope * (np.arange(len(lowest)) - len(lowest) / 2)
    over = np.abs(lows - np.median(lows)).mean()
    left = np.abs(lows - slope * middles - np.median(lows - slope * middles)).mean()
    if abs(slope) * len(lowest) < CLIMB or left > 0.4 * over:
        return level
    return np.asarray(straight + np.percentile(lowest - straight, SHARE))


def always_down(lowest: Array, fps: float) -> Array:
    """The floor where a path says nothing of heights: under the lowest point of every frame, smoothly. (T,)."""
    return low_pass(lowest, fps, cutoff=5.0) if len(lowest) > 8 else lowest


def travel(feet: Feet, pelvis: Array) -> Array | None:
    """Where a walk on the spot would have come by now, from the foot that stands. (T, 3); None for other clips."""
    if len(pelvis) < 8:
        return None
    speed = np.gradient(feet.balls[..., [0, 2]], axis=0) * feet.fps
    height = feet.soles[..., 1].min(axis=2)
    # The lower foot carries the body: what it does backwards, the body does forwards.
    weight = np.exp(-np.maximum(height - height.min(axis=1, keepdims=True), 0.0) / 0.01)
    carried = -np.sum(speed * (weight / weight.sum(axis=1, keepdims=True))[..., None], axis=1)
    mean, span = carried.mean(axis=0), len(pelvis) / feet.fps
    drift = np.linalg.norm(pelvis[-1, [0, 2]] - pelvis[0, [0, 2]]) / span
    steady = np.linalg.norm(mean) > STEADY * np.linalg.norm(carried, axis=1).mean()
    if np.linalg.norm(mean) < ON_THE_SPOT[0] or drift > ON_THE_SPOT[1] or not steady:
        return None
    smooth = low_pass(carried, feet.fps, cutoff=3.0)
    path = np.zeros_like(pelvis)
    path[1:, [0, 2]] = np.cumsum((smooth[1:] + smooth[:-1]) / 2, axis=0) / feet.fps
    return path
