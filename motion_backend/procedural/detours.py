"""Ways that are not the shortest: a curve to the front left or right, and pacing to and fro."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from motion_backend.procedural.route import resample
from scene_graphs.navigation import Walkable

Array = NDArray[np.float64]
BOWS = (0.24, 0.18, 0.12, 0.07)
"""How far a curved way goes aside against its length, the widest that has room."""
ROOM = 0.02
"""What a detour leaves free beyond what the body needs (metres)."""
LONG_ENOUGH = 1.0
"""Ways shorter than this (metres) are gone straight and once."""
BEAT = 2.4
"""How far somebody who paces goes before turning round (metres)."""


def curved(path: Array, left: bool, walkable: Walkable) -> Array:
    """A path (N, 2) that bends to the left or right all the way, as far as there is room; else as it was."""
    points = resample(path)
    way = points[-1] - points[0]
    length = float(np.hypot(*way))
    if length < LONG_ENOUGH:
        return path
    # To end up on the left it first goes out on the right.
    outward = np.array([-way[1], way[0]]) / length * (1.0 if left else -1.0)
    arch = 4 * np.linspace(0, 1, len(points)) * np.linspace(1, 0, len(points))
    for bow in BOWS:
        curve = points + (bow * length * arch)[:, None] * outward
        if _is_free(curve, walkable):
            return np.asarray(curve)
    return path


def to_and_fro(path: Array, walkable: Walkable) -> list[Array]:
    """The ways of pacing along a path: there, back a good part of it, and there again; once where it is short."""
    points = resample(path)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if steps.sum() < LONG_ENOUGH:
        return [path]
    to_end = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    turn = int(np.argmax(to_end <= min(BEAT, 0.9 * float(steps.sum()))))
    back = points[turn:][::-1]
    return [points, back, points[turn:]] if _is_free(back, walkable) else [path]


def _is_free(points: Array | Sequence[Array], walkable: Walkable) -> bool:
    return bool((walkable.field.at(np.asarray(points[::3])) >= walkable.radius + ROOM).all())
