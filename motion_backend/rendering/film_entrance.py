"""The outer door by which a motion comes in: the first shot of a film has it in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home

BEFORE: Final = 1.5
"""Metres from the middle of a door at most at which one stands who has just come in by it."""
AWAY: Final = 0.5
"""The cosine from which on somebody looks away from a door."""
SILL: Final = 0.3
"""An opening that begins higher than this is a window (metres)."""


@dataclass(frozen=True)
class Entrance:
    """A door in the wall of a room."""

    corners: Array
    """Of the door, at floor and lintel. (4, 3)."""
    side: Side
    """The wall, as its room sees it."""

    @staticmethod
    def of(home: Home, motion: Motion) -> Entrance | None:
        """The nearest outer door that the body has at its back, and near, in its first frame."""
        here = motion.root_positions[0, [0, 2]].astype(np.float64)
        turn = motion.local_rotations[0, 0].astype(np.float64)
        ahead = rotations.rotate(turn, np.array([0.0, 0.0, 1.0]))[[0, 2]]
        found: list[tuple[float, Entrance]] = []
        for wall in home.walls:
            side = Side.of(wall, home)
            if side is None or -ahead @ side.outward < AWAY:
                continue
            for door in (one for one in wall.openings if one.bottom <= SILL and not home.leads_on(one)):
                ends = np.asarray(door.segment, dtype=np.float64)
                away = float(np.linalg.norm(ends.mean(axis=0) - here))
                if away <= BEFORE:
                    corners = np.array([(x, y, z) for x, z in ends for y in (door.bottom, door.top)])
                    found.append((away, Entrance(corners, side)))
        return min(found, key=lambda one: one[0])[1] if found else None
