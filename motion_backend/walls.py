"""Which side of a wall is in a room, and which walls a camera must look through, as into a doll's house."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array

if TYPE_CHECKING:
    from scene_graphs.home import Home, Wall
    from scene_graphs.layout import Placed

SHORT = 0.97
"""Sight lines end this share of the way to a point: a wall that a hand lies on does not hide it."""
TALL = 1.2
"""What reaches as high hides who stands behind it (metres)."""
AGAINST = 0.35
"""What stands as near to a wall stands against it (metres)."""


@dataclass(frozen=True)
class Side:
    """A wall of at least some length as its room sees it, in [x, z]."""

    start: Array
    """(2,)."""
    end: Array
    """(2,)."""
    outward: Array
    """Unit vector away from the room. (2,)."""
    room: int | None
    """The room it bounds."""

    @staticmethod
    def of(wall: Wall, home: Home) -> Side | None:
        """The side of one wall of a home; None for a wall without length."""
        start, end = (np.asarray(point, dtype=np.float64) for point in wall.segment)
        length = float(np.linalg.norm(end - start))
        if length < 1e-6:
            return None
        along = (end - start) / length
        outward = np.array([along[1], -along[0]])
        beside = (start + end) / 2 + 0.05 * outward
        if home.room_at((float(beside[0]), float(beside[1]))) is not None:
            outward = -outward
        inside = (start + end) / 2 - 0.05 * outward
        return Side(start, end, outward, home.room_at((float(inside[0]), float(inside[1]))))

    def distance(self, point: Array) -> float:
        """How far a point (2,) is from the line of the wall on the floor, in metres."""
        along = self.end - self.start
        share = float(np.clip((point - self.start) @ along / (along @ along), 0.0, 1.0))
        return float(np.linalg.norm(self.start + share * along - point))

    def bears(self, placed: Placed) -> bool:
        """Whether a tall piece of furniture stands against it: from behind it is a board, and goes with the wall."""
        outline = placed.footprint
        inside = ((outline - self.start) @ self.outward).max() < AGAINST
        return bool(placed.top > TALL and inside and min(map(self.distance, outline)) < AGAINST)

    def faces(self, eye: Array) -> bool:
        """Whether an eye (2,) is on the room's side of the wall."""
        return float((eye - self.start) @ self.outward) <= 0.0

    def crosses(self, eye: Array, points: NDArray[np.floating]) -> bool:
        """Whether a line from an eye (2,) to any of the points (N, 2) goes through the wall, seen from above."""
        ways, along = SHORT * (points - eye), self.end - self.start
        level = ways[:, 0] * along[1] - ways[:, 1] * along[0]
        level = np.where(np.abs(level) < 1e-12, 1e-12, level)
        gap = self.start - eye
        on_way = (gap[0] * along[1] - gap[1] * along[0]) / level
        on_wall = (gap[0] * ways[:, 1] - gap[1] * ways[:, 0]) / level
        return bool(((on_way > 0) & (on_way < 1) & (on_wall > 0) & (on_wall < 1)).any())
