"""An invented scanned room, Z up, as labelled boxes: what 3RScan and ScanNet files of it would hold."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


class Piece(NamedTuple):
    """A box as scans have it: middle, full lengths, heading about the vertical from +x."""

    label: str
    middle: tuple[float, float, float]
    lengths: tuple[float, float, float]
    heading: float = 0.0

    def points(self, steps: int = 4) -> Points:
        """A grid of points on and in the box. (steps ** 3, 3)."""
        ticks = np.linspace(-0.5, 0.5, steps)
        grid = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3) * self.lengths
        turn = np.array(
            [[cos(self.heading), -sin(self.heading), 0], [sin(self.heading), cos(self.heading), 0], [0, 0, 1]]
        )
        return np.asarray(grid @ turn.T + np.array(self.middle))


ROOM = (
    Piece("floor", (2.0, 1.5, 0.0), (4.0, 3.0, 0.02)),
    Piece("wall", (2.0, 3.0, 1.25), (4.0, 0.1, 2.5)),
    Piece("door", (2.0, 0.0, 1.0), (0.9, 0.1, 2.0)),
    Piece("window", (4.0, 1.5, 1.5), (0.1, 1.2, 1.0)),
    Piece("bed", (1.0, 2.4, 0.35), (2.0, 1.0, 0.5)),
    Piece("pillow", (0.3, 2.4, 0.65), (0.4, 0.6, 0.1)),
    Piece("desk", (3.4, 2.6, 0.55), (1.2, 0.6, 0.4)),
    Piece("office chair", (3.4, 2.0, 0.45), (0.5, 0.5, 0.9)),
    Piece("mug", (3.2, 2.6, 0.8), (0.08, 0.08, 0.1)),
)
"""In metres, walls along the axes, the floor at height 0; the desk's legs were not scanned."""
