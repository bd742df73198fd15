"""Feet that a plan swings over the edge of a bed or a seat are lifted over it.

A kinematic leg may pass through a mattress' edge, or by it with nothing to spare: a simulated one is some centimetres
behind its plan, is caught there, and lets go with a jerk when the body has gone on.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS
from motion_backend.physics.hands_round_things import eased
from motion_backend.physics.mjcf_character import SIDES, SOLE_POINTS, TOES
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Joints = NDArray[np.floating]
"""Of every joint in every frame, in single precision or double."""
CLEAR: Final = 0.04
"""So high do moving feet pass over an edge, at 1.70 m (metres)."""
HIGHEST: Final = 0.12
"""What they would have to be lifted by more for (metres at 1.70 m), they are not over."""
NEAR: Final = 0.02
"""Feet this near to a thing, seen from above, are over it (metres at 1.70 m)."""
MOVES: Final = (0.2, 0.4)
"""Metres a second: a foot that is slower lies where it is, one that is quicker is on its way."""
EASES: Final = 8
"""Frames before and after in which a lift comes and goes."""


def lift_over_edges(positions: Joints, world: Joints, skeleton: Skeleton, things: Obstacles) -> Array:
    """By how much ankles are to be higher (T, 2; metres, left and right), of joints' places (T, 22, 3) and turns
    (T, 22, 4) in the world."""
    places, turns = positions.astype(np.float64), world.astype(np.float64)
    return np.stack([_lift(places, turns, side, skeleton, things) for side, _ in SIDES], axis=1)


def _lift(positions: Array, world: Array, side: str, skeleton: Skeleton, things: Obstacles) -> Array:
    soles, scale = _soles(positions, world, side, skeleton), skeleton.scale
    needed = np.zeros(len(soles))
    for index in range(len(things.owners)):
        top = things.centers[index, 1] + things.halves[index, 1]
        level = soles.reshape(-1, 3).copy()
        level[:, 1] = things.centers[index, 1]
        over = things.inside(level, index).reshape(soles.shape[:2]) > -NEAR * scale
        lowest = np.where(over, soles[..., 1], np.inf).min(axis=1)
        lift = top + CLEAR * scale - lowest
        needed = np.maximum(needed, np.where((lift > 0) & (lift < HIGHEST * scale), lift, 0.0))
    ankle = positions[:, INDEX[f"{side}_ankle"]]
    speed = np.linalg.norm(np.gradient(ankle, axis=0), axis=-1) * FPS if len(ankle) > 1 else np.zeros(len(ankle))
    slow, quick = MOVES
    share = np.clip((speed - slow) / (quick - slow), 0.0, 1.0)
    return eased(needed * share, EASES)


def _soles(positions: Array, world: Array, side: str, skeleton: Skeleton) -> Array:
    """Corners of a sole and the undersides of both ends of its toes. (T, 6, 3)."""
    ends = np.array([[x, y - TOES[2], z] for x, y, z in TOES[:2]])
    found = []
    for joint, points in (("ankle", SOLE_POINTS), ("foot", ends)):
        at, turn = positions[:, INDEX[f"{side}_{joint}"]], world[:, INDEX[f"{side}_{joint}"]]
        found += [at + rotations.rotate(turn, np.broadcast_to(point * skeleton.scale, at.shape)) for point in points]
    return np.stack(found, axis=1)
