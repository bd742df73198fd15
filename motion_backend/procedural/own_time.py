"""What is done again and again is never done twice in the same time, and on the whole a little quicker each time.

The numbers are in data/own_time.toml.
"""

from __future__ import annotations

import numpy as np

from motion_backend.motion import FPS
from motion_backend.procedural.walk.footsteps import drift
from motion_backend.rotations import Array
from scene_graphs.data_tables import read_table, table


@table
class OwnTime:
    """data/own_time.toml: shares of the usual tempo."""

    quicker_min_share: float
    quicker_max_share: float
    """By so much it is quicker in the end than on the whole, and slower in the beginning: bounds that chance keeps."""
    uneven_share: float
    uneven_hz: float


def own_time(time: Array, rng: np.random.Generator) -> Array:
    """Seconds (T,) of what is done, at so many seconds of the clock (T,): slower and quicker, over in the same time."""
    row: OwnTime = read_table("motion_backend", "own_time.toml", OwnTime)
    quicker = rng.uniform(row.quicker_min_share, row.quicker_max_share) * np.linspace(-1.0, 1.0, len(time))
    tempo = np.cumsum(1 + quicker + row.uneven_share * drift(len(time), row.uneven_hz, FPS, rng))
    return np.asarray(time[-1] * tempo / tempo[-1])
