"""Feet of made frames held where they stand, by the same lock that recordings go through."""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.foot_contacts import ANKLES, BALLS, Feet, above_floor, bend_legs
from motion_backend.mocap.foot_lock import from_nothing, locked, standing
from motion_backend.mocap.rest_pose import world_to_local
from motion_backend.motion import FPS
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

HOVERS = 0.012
"""Metres over the floor at which soles of recordings may stand once they were locked; a second lock would press them
flat, which nobody's are."""


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
    rise = from_nothing(above_floor(feet), fixed, FPS)
    if rise.any():
        world = bend_legs(skeleton, positions, world, feet.ankles + rise)
    turned = rotations.continuous(world_to_local(world))
    if fixed:
        turned[:fixed], root[:fixed] = local[:fixed], begun
        turned = rotations.continuous(turned)
    return root, turned


def _feet(root: Array, local: Array, skeleton: Skeleton) -> tuple[Feet, Array, Array]:
    """Its feet, world rotations (T, 22, 4) and joints (T, 22, 3)."""
    found, world = skeleton.forward_kinematics(root, local)
    positions = found.astype(np.float64)
    return Feet(positions[:, ANKLES], world[:, ANKLES], world[:, BALLS], skeleton, FPS), world, positions
