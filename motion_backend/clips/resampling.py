"""Timelines: smoothing what a camera shook, and moving samples to another rate. Rotations are xyzw, (T, …, 4)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations

Array = NDArray[np.float64]
CUTOFF = 6.0
"""Hz above which a captured body's movement is mostly noise (Winter)."""
FAST_ENOUGH = 60.0
"""Frames a second from which a recording is smoothed: slower ones hold little beyond the cutoff."""


def low_pass(values: Array, fps: float, cutoff: float = CUTOFF) -> Array:
    """Fourth-order Butterworth run forwards and backwards along time, so that nothing is delayed. (T, …)."""
    from scipy.signal import sosfiltfilt

    padding = min(len(values) - 1, round(fps / 2))
    return np.asarray(sosfiltfilt(_sections(fps, cutoff), values, axis=0, padlen=padding)) if padding > 0 else values


@lru_cache(maxsize=32)
def _sections(fps: float, cutoff: float) -> Array:
    from scipy.signal import butter

    return np.asarray(butter(2, cutoff, fs=fps, output="sos"))


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
