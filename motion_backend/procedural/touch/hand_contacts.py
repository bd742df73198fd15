"""Where hands are laid on a surface: which suit a caption, where the other hand lies, how far both may go on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.touch.hand_captions import Laid, handling_of, steadies, with_both_hands
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST
from scene_graphs.affordances.affordances import Spot

FINGER: Final = 0.02
"""Half a finger's thickness (metres)."""
APART: Final = 0.24
"""Between two hands laid side by side (metres at 1.70 m)."""
NARROWER: Final = (1.0, 0.85, 0.7)
"""Shares of `APART` that are tried where a surface is narrow."""
TWO_HANDS: Final = 0.8
"""A surface for two hands goes on to either side by this share of `APART`."""
TOP: Final = 0.7
"""A surface is a top where its normal has more of up in it than this, else a front (cosine)."""
UP_FRONT, INTO_FRONT = 0.8, 0.2
"""How much fingers laid on a front point up it, and how much into it before they are laid flat."""
ELBOW: Final = 0.11
"""From the middle of a forearm to what is beside it (metres)."""
STROKES: Final = (0.14, 0.11, 0.09, 0.07, 0.05, 0.03)
"""How far hands go to either side in wiping, the first that there is room for (metres)."""

ON_TOPS: Final = frozenset({"pick", "put", "stir", "pour"})
"""What is only done where things lie or stand."""
KNOCKED, KNOCKED_FROM, HIGHER = 1.36, 1.15, 0.04
"""Who knocks on a front does so this high, where it goes up so far, else lower in such steps, but no lower than the
second (metres at 1.70 m)."""
EDGEWISE: Final = 1.0
"""How far a hand that knocks is turned about its fingers, the palm to the body's middle (radians)."""
KNUCKLES: Final = 0.07
"""About the middle of a hand that knocks, so much of the front is there (metres)."""


def suits(spot: Spot, caption: str, solid: Obstacles) -> bool:
    """Whether a caption is done at such a spot: things lie on tops, a low front has no switch, two hands need width."""
    doing, front = handling_of(caption), not is_top(spot.normal)
    if front and (doing in ON_TOPS or (doing and spot.height == "low")):
        return False
    if not (with_both_hands(caption) or steadies(caption)):
        return True
    left, _ = along_surface(spot)
    under = np.asarray(spot.point) - FINGER * np.asarray(spot.normal)
    return bool((solid.depth(under + APART * np.array([[TWO_HANDS], [-TWO_HANDS]]) * left) > 0).any())


def to_knock_on(found: Sequence[Spot], solid: Obstacles, scale: float) -> list[Spot]:
    """The same spots, those on fronts as far up as one knocks; only these where there are any, else only tops."""
    raised = [_up_front(spot, solid, scale) for spot in found]
    tops = [spot for spot in raised if is_top(spot.normal)]
    return [spot for spot in raised if spot not in tops and spot.point[1] >= KNOCKED_FROM * scale] or tops or raised


def _up_front(spot: Spot, solid: Obstacles, scale: float) -> Spot:
    """The same front touched as high up as one knocks on it, or as it goes up from there; a top as it is."""
    if is_top(spot.normal):
        return spot
    x, y, z = spot.point
    heights = np.arange(KNOCKED * scale, y, -HIGHER)
    points = np.array([[x, up + over, z] for up in heights for over in (-KNUCKLES, 0.0, KNUCKLES)]).reshape(-1, 3)
    out = FINGER * np.asarray(spot.normal)
    there = (solid.depth(points - out) > 0) & (solid.depth(points + out) < 0)
    up = heights[there.reshape(-1, 3).all(axis=1)]
    return replace(spot, point=(x, float(up[0]), z)) if len(up) else spot


def is_top(normal: Array | tuple[float, float, float]) -> bool:
    """Whether a surface with that normal is one that things lie on, not a front."""
    return bool(normal[1] > TOP)


def other_hand(
    obstacles: Obstacles, spot: Spot, laid: tuple[Array, str], scale: float, is_free: Callable[[Array, Array], bool]
) -> tuple[Array, Array] | None:
    """Wrist and palm of the other hand, beside the first on the same surface; None where that is too narrow.

    `laid` is the first hand's wrist and its side; `is_free` says whether nothing stands where that palm would lie.
    """
    wrist, hand = laid
    normal = np.asarray(spot.normal, dtype=np.float64)
    left, _ = along_surface(spot)
    along, other = (-left, "right") if hand == "left" else (left, "left")
    for apart in APART * scale * np.array(NARROWER):
        beside = wrist + apart * along
        inside = float(obstacles.depth((beside - (HAND_REST + FINGER) * normal)[None])[0])
        over = float(obstacles.solid().depth((beside + ELBOW * normal)[None])[0])
        palm = palm_on(normal, spot.facing, other)
        if inside > 0 and over < -ELBOW and is_free(beside, palm):
            return beside, palm
    return None


def free_stroke(obstacles: Obstacles, spot: Spot, laid: Laid) -> Array:
    """The longest way along the surface, to both sides of all hands, with it under them and nothing in the way. (3,)"""
    others = obstacles.solid()
    others = others.only(np.array([owner != spot.object_id for owner in others.owners], dtype=bool))
    aside, on = along_surface(spot)
    for length in STROKES:
        for way in (aside, on):
            ends = np.concatenate([wrist + length * np.array([[-1.0], [1.0]]) * way for _, wrist, _ in laid.hands])
            under = obstacles.depth(ends - (HAND_REST + FINGER) * laid.normal)
            if under.min() > 0 and others.depth(ends).max() < -FINGER:
                return np.asarray(length * way)
    return np.asarray(STROKES[-1] * aside)


def along_surface(spot: Spot) -> tuple[Array, Array]:
    """Unit vectors along a surface, to the left of who stands before it and ahead, or up where it is a front."""
    left = np.array([np.cos(spot.facing), 0.0, -np.sin(spot.facing)])
    normal = np.asarray(spot.normal, dtype=np.float64)
    left = rotations.normalize(left - (left @ normal) * normal)
    return left, rotations.cross(left, normal)


def palm_on(normal: Array, facing: float, hand: str) -> Array:
    """World rotation of a hand laid flat on a surface: palm against it, fingers forwards, or up it. (4,)."""
    side = 1.0 if hand == "left" else -1.0
    ahead = np.array([np.sin(facing), 0.0, np.cos(facing)])
    up = np.array([0.0, UP_FRONT, 0.0])
    fingers = ahead if is_top(normal) else up + INTO_FRONT * ahead
    fingers = rotations.normalize(fingers - (fingers @ normal) * normal)
    x, y = side * fingers, normal
    return rotations.basis_to_quat(x, y, rotations.cross(x, y))


def on_edge(palm: Array, hand: str) -> Array:
    """The same hand (4,) turned half on its edge, the thumb off the surface: so it is held in knocking. (4,)."""
    side = 1.0 if hand == "left" else -1.0
    return rotations.compose(palm, rotations.axis_to_quat("x", side * EDGEWISE))
