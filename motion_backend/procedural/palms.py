"""How hands are laid on a surface: palms against it, fingers clear of what stands there, the other hand beside."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.obstacles import Obstacles
from motion_backend.skeleton import HAND_REST
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]
FINGER: Final = 0.02
"""Half a finger's thickness (metres)."""
APART: Final = 0.24
"""Between two hands laid side by side (metres at 1.70 m)."""


def other_hand(
    obstacles: Obstacles, spot: Spot, laid: tuple[Array, str, bool], scale: float
) -> tuple[Array, Array] | None:
    """Wrist and palm of the other hand, beside the first on the same surface; None where that is too narrow.

    `laid` is the first hand's wrist, its side, and whether its fingers point down.
    """
    wrist, hand, down = laid
    normal = np.asarray(spot.normal, dtype=np.float64)
    side, other = (-1.0, "right") if hand == "left" else (1.0, "left")
    ahead = np.array([np.sin(spot.facing), 0.0, np.cos(spot.facing)])
    along = side * rotations.normalize(np.cross([0.0, 1.0, 0.0], ahead))
    for apart in APART * scale * np.array([1.0, 0.75, 0.5]):
        beside = wrist + apart * along
        inside = float(obstacles.depth((beside - (HAND_REST + FINGER) * normal)[None])[0])
        if inside > 0:
            return beside, free_palm(obstacles, spot, beside, other, down)
    return None


def free_palm(obstacles: Obstacles, spot: Spot, wrist: Array, hand: str, down: bool = False) -> Array:
    """The hand laid straight ahead, or turned aside where its fingers would be in something else."""
    others = obstacles.solid()
    others = others.only(np.array([owner != spot.object_id for owner in others.owners], dtype=bool))
    fingers = np.array([[0.05, 0.0, 0.0], [0.10, 0.0, 0.0], [0.14, 0.0, 0.0]]) * (1.0 if hand == "left" else -1.0)
    inward = -1.0 if hand == "left" else 1.0
    best: tuple[float, Array] | None = None
    for turn in (0.0, 0.5 * inward, -0.5 * inward, 1.0 * inward, -1.0 * inward):
        palm = palm_on(np.asarray(spot.normal), spot.facing + turn, hand, down)
        depth = float(np.max(others.depth(wrist + rotations.rotate(palm, fingers)), initial=-1.0))
        if depth < -FINGER:
            return palm
        if best is None or depth < best[0]:
            best = (depth, palm)
    return best[1] if best else palm_on(np.asarray(spot.normal), spot.facing, hand, down)


def palm_on(normal: Array, facing: float, hand: str, down: bool = False) -> Array:
    """World rotation of a hand laid flat on a surface: palm against it, fingers forwards, or up or down it. (4,)."""
    side = 1.0 if hand == "left" else -1.0
    ahead = np.array([np.sin(facing), 0.0, np.cos(facing)])
    fingers = ahead if normal[1] > 0.7 else np.array([0.0, -0.8 if down else 0.8, 0.0]) + 0.2 * ahead
    fingers = rotations.normalize(fingers - (fingers @ normal) * normal)
    x, y = side * fingers, normal
    return rotations.basis_to_quat(x, y, rotations.cross(x, y))
