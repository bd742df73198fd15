"""Timelines: smoothing what a camera shook, and moving samples to another rate. Rotations are xyzw, (T, …, 4).

Keys may lie at any times. Stray frames before a motion begins are no part of it: T-poses put in front, and markers
that were not yet found.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.clip import MAX_FRAMES, Clip, ClipError
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.rest_pose import is_t_pose
from motion_backend.rotations import Array

CUTOFF = 12.0
"""Hz above which a captured body's movement is mostly noise: 6 Hz (Winter) is meant for walking and takes most of the
jerk that people have."""
FAST_ENOUGH = 60.0
"""Frames a second from which a recording is smoothed: slower ones hold little beyond the cutoff."""


def low_pass(values: Array, fps: float, cutoff: float = CUTOFF) -> Array:
    """Fourth-order Butterworth run forwards and backwards along time, so that nothing is delayed. (T, …).

    What `scipy.signal.sosfiltfilt` gives, with half a second reflected through either end: to import that takes longer
    than all that is filtered in a story. ValueError for a cutoff that no such rate holds.
    """
    padding = min(len(values) - 1, round(fps / 2))
    if padding <= 0:
        return values
    first, last = values[:1], values[-1:]
    before, after = 2 * first - values[padding:0:-1], 2 * last - values[-2 : -padding - 2 : -1]
    forwards = _filtered(np.concatenate([before, values, after]), fps, cutoff)
    return _filtered(forwards[::-1], fps, cutoff)[::-1][padding:-padding]


def _filtered(values: Array, fps: float, cutoff: float) -> Array:
    """One pass of a second-order Butterworth filter, as if the first value had stood for ever. (T, …)."""
    if not 0 < cutoff < fps / 2:
        raise ValueError(f"a cutoff of {cutoff} Hz needs more than {2 * cutoff} frames a second, not {fps}")
    # The bilinear transform of 1 / (s² + √2 s + 1), its frequency warped so that the cutoff stays where it is.
    warped = math.tan(math.pi * cutoff / fps)
    scale = 1 / (1 + math.sqrt(2) * warped + warped**2)
    gain, near, far = warped**2 * scale, 2 * (warped**2 - 1) * scale, (1 - math.sqrt(2) * warped + warped**2) * scale
    filtered = np.empty(values.shape)
    one, two = (2 * gain - near + gain - far) * values[0], (gain - far) * values[0]
    for index, value in enumerate(values):
        passed = gain * value
        result = filtered[index] = passed + one
        one = 2 * passed - near * result + two
        two = passed - far * result
    return filtered


def smooth_rotations(turns: Array, fps: float, cutoff: float = CUTOFF) -> Array:
    """Rotations smoothed component by component; neighbours are brought into one hemisphere first."""
    return rotations.normalize(low_pass(rotations.continuous(turns), fps, cutoff))


def sample_times(frames: int, fps: float, wanted: float) -> Array:
    """Where the frames of the wanted rate lie, counted in frames of the given one; the last may fall away."""
    count = int(np.floor((frames - 1) / fps * wanted + 1e-6)) + 1
    return np.asarray(np.minimum(np.arange(count) * (fps / wanted), frames - 1))


def sample_positions(values: Array, times: Array) -> Array:
    """Positions at fractional frames, on straight lines between neighbours. (T, …) to (len(times), …)."""
    before, after, share = _between(times, len(values))
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(values[before] * (1 - share) + values[after] * share)


def sample_rotations(turns: Array, times: Array) -> Array:
    """Rotations at fractional frames, on the shorter arc between neighbours. (T, J, 4) to (len(times), J, 4)."""
    before, after, share = _between(times, len(turns))
    if not share.any():
        return turns[before]
    return rotations.slerp(turns[before], turns[after], share[:, None])


def _between(times: Array, frames: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    before = np.floor(times + 1e-9).astype(np.intp)
    share = np.maximum(times - before, 0.0)
    return before, np.minimum(before + 1, frames - 1), np.where(share < 1e-6, 0.0, share)


SAME = 1e-5
"""Seconds within which two times are one: key times are single precision."""


def uniform_times(times: Array, fps: float) -> Array:
    """Seconds of whole frames from the first key to the last."""
    frames = (times[-1] - times[0]) * fps + 1e-6
    if not 0 <= frames < MAX_FRAMES:
        raise ClipError(f"{frames:.0f} frames between the first key and the last; {MAX_FRAMES} can be read")
    return np.asarray(times[0] + np.arange(int(frames) + 1) / fps)


def resampled_positions(times: Array, values: Array, wanted: Array, stepped: bool = False) -> Array:
    """Values at the wanted times, on straight lines between keys, or each key's until the next. (K, …) to (T, …)."""
    before, after, share = _key_interval(times, wanted, stepped)
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(values[before] + (values[after] - values[before]) * share)


def resampled_rotations(times: Array, turns: Array, wanted: Array, stepped: bool = False) -> Array:
    """Rotations at the wanted times, on the shorter arc between keys. (K, …, 4) to (T, …, 4)."""
    before, after, share = _key_interval(times, wanted, stepped)
    if not share.any():
        return np.asarray(turns[before])
    return rotations.slerp(turns[before], turns[after], share.reshape(-1, *[1] * (turns.ndim - 2)))


def _key_interval(times: Array, wanted: Array, stepped: bool) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """The key before, the key after and the share of the way; before the first key and after the last it stays."""
    after = np.searchsorted(times, wanted + SAME, side="right").clip(min(1, len(times) - 1), len(times) - 1)
    before = np.maximum(after - 1, 0)
    if stepped:
        return before, after, (wanted + SAME >= times[after]).astype(np.float64)
    gap = times[after] - times[before]
    return before, after, np.clip((wanted - times[before]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)


MAX_JOINT_SPEED = 15.0
"""Metres a second: no joint of a person moves faster; what does is a jump of the data."""
_LEAD = 0.25
"""Seconds at the start in which such frames are looked for."""
_MIN_FRAMES = 4


def without_stray_frames(clip: Clip, given: JointMap | None = None) -> Clip:
    """The clip from where no joint moves faster than 15 m/s, with a note of what was dropped.

    A T-pose that stands in front is the source's own, better than one made of its rest pose.
    """
    steps = min(len(clip) - 2, max(_MIN_FRAMES, round(_LEAD * clip.fps)))
    positions, _ = clip.bones.forward_kinematics(clip.root_positions[: steps + 1], clip.local_rotations[: steps + 1])
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1) * clip.fps  # (steps,)
    jumps = np.flatnonzero(speeds > MAX_JOINT_SPEED)
    if len(jumps) == 0:
        return clip
    first = int(jumps[-1]) + 1
    fastest = speeds[jumps].max()
    note = f"{first} leading frame{'s' * (first > 1)} dropped: a T-pose or stray (a joint moved {fastest:.0f} m/s)"
    kept = replace(clip.part(first, len(clip)), notes=(*clip.notes, note))
    lead = np.concatenate([clip.tpose[:1], clip.local_rotations[0, 1:]])
    return replace(kept, tpose=lead) if is_t_pose(clip.bones, lead, given) else kept
