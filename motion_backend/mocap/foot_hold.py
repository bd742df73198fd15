"""Feet of made frames held where they stand, by the same lock that recordings go through."""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.foot_contacts import (
    ANKLES,
    BALLS,
    SLOW,
    Feet,
    above_floor,
    bend_legs,
    no_faster,
)
from motion_backend.mocap.foot_lock import PASSED, from_nothing, locked, standing
from motion_backend.mocap.resampling import low_pass
from motion_backend.mocap.rest_pose import world_to_local
from motion_backend.motion import FPS
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

HOVERS = 0.012
"""Metres over the floor at which soles of recordings may stand once they were locked; a second lock would press them
flat, which nobody's are."""


BRUSHES = 0.012
"""Metres under which a foot that swings brushes the floor: of recorded ones one in eight frames is lower."""
LIFTS = 0.2
"""Metres a second at which a foot that would brush the floor is lifted."""
ROUNDS = 2
"""Times that feet are held: the first is smooth and cut to a few centimetres, and the second takes what it leaves."""


def held(root: Array, local: Array, skeleton: Skeleton, fixed: int = 0) -> tuple[Array, Array, Array]:
    """Pelvis (T, 3), rotations (T, 22, 4) and contacts (T, 4) of a body whose standing feet stay where they stand.

    The first `fixed` frames are left as they are: a foot that stands in the last of them is held there.
    """
    for _ in range(ROUNDS):
        root, local = _once(root, local, skeleton, fixed)
    feet, _, _ = _feet(root, local, skeleton)
    heels, balls = standing(feet, root, grounded=True)
    return root, local, np.stack([heels, balls], axis=2).reshape(len(root), 4).astype(np.float64)


def _once(root: Array, local: Array, skeleton: Skeleton, fixed: int) -> tuple[Array, Array]:
    begun = root[:fixed].copy()
    feet, world, positions = _feet(root, local, skeleton)
    shift, carried = locked(feet, root, fixed, HOVERS, grounded=True)
    root = root + carried
    world = bend_legs(skeleton, positions + carried[:, None], world, feet.ankles + shift)
    feet, world, positions = _feet(root, world_to_local(world), skeleton)
    rise = from_nothing(np.maximum(above_floor(feet), _over_floor(feet)), fixed, FPS)
    if rise.any():
        world = bend_legs(skeleton, positions, world, feet.ankles + rise)
    turned = rotations.continuous(world_to_local(world))
    if fixed:
        turned[:fixed], root[:fixed] = local[:fixed], begun
        turned = rotations.continuous(turned)
    return root, turned


def _over_floor(feet: Feet) -> Array:
    """How far each ankle must rise for a foot that swings to pass over the floor and not along it. (T, 2, 3) metres."""
    rise = np.zeros_like(feet.ankles)
    if len(rise) > 1:
        ways = np.gradient(feet.soles[..., [0, 2]], axis=0) * feet.fps
        # A foot that rolls over its heel or toe is still there: the slowest point of its sole tells.
        speed = np.linalg.norm(ways, axis=-1).min(axis=2)
        wanted = BRUSHES * np.clip((speed - 2 * SLOW) / (4 * SLOW), 0.0, 1.0)
        lacking = np.maximum(wanted - feet.soles[..., 1].min(axis=2), 0.0)
        rise[..., 1] = no_faster(np.minimum(lacking, wanted), LIFTS / feet.fps)
    return low_pass(rise, feet.fps, PASSED) if len(rise) > 8 else rise


def _feet(root: Array, local: Array, skeleton: Skeleton) -> tuple[Feet, Array, Array]:
    """Its feet, world rotations (T, 22, 4) and joints (T, 22, 3)."""
    found, world = skeleton.forward_kinematics(root, local)
    positions = found.astype(np.float64)
    return Feet(positions[:, ANKLES], world[:, ANKLES], world[:, BALLS], skeleton, FPS), world, positions
