"""Keys at any times, and what lies between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.clips.clip import MAX_FRAMES, Array, ClipError

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
