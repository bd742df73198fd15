"""Feet and floor: skating, soles in the floor, and bodies in the air (GMD, PhysDiff)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.scene_collision import WALL, Obstacles
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

IN_AIR, FALLS = 0.01, 3.0
"""A body no point of whose soles is lower than this (metres at 1.70 m), and whose pelvis is drawn down by more than
this (m/s²), as bodies in the air are, is in flight: its feet slide on nothing. One that hovers slides all the same."""
REACH_UP = 0.10
"""A surface holds up what is at most this far below its top (metres): bodies sink into cushions."""
LOW = 0.05
"""Toes, and points of a sole, that are lower than this (metres for a body of 1.70 m) may be what the body stands on: as
GMD has it, for one size of body. Children's toes pass the floor so much nearer as they are smaller."""


def skate_ratio(body: Kinematics) -> float:
    """GMD's foot skating ratio, heights from the toe joints' rest height, its 0.25 s window at our frame rate, its
    5 cm as the body is tall; of who runs, without flight."""
    motion = body.motion
    toes = body.positions[:, [INDEX["left_foot"], INDEX["right_foot"]]]
    if len(toes) < 3:
        return 0.0
    rest = motion.skeleton.ankle_height + motion.skeleton.offsets[INDEX["left_foot"], 1]
    low = toes[..., 1] - rest < LOW * motion.skeleton.scale
    speed = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1) * motion.fps
    window = max(round(0.25 * motion.fps) // 2 * 2 - 1, 1)
    from scipy.ndimage import uniform_filter1d

    mean = uniform_filter1d(speed, window, axis=0, mode="nearest")
    skating = low[:-1] & low[1:] & (speed > 0.5) & (mean > 0.5) & ~in_flight(body)[:, None]
    return float(skating.any(axis=1).mean())


def in_flight(body: Kinematics) -> NDArray[np.bool_]:
    """Whether a body flies in a frame or the next, as in a run. (T - 1,)."""
    if len(body.positions) < 2:  # which falls nowhere
        return np.zeros(0, dtype=bool)
    drawn = np.gradient(np.gradient(body.positions[:, 0, 1])) * body.motion.fps**2
    air = (body.soles[..., 1].min(axis=(1, 2)) > IN_AIR * body.motion.skeleton.scale) & (drawn < -FALLS)
    return np.asarray(air[1:] | air[:-1])


def skate_speed(body: Kinematics) -> float:
    """Mean horizontal speed of sole corners lower than 1 cm in two neighbouring frames, cm/s."""
    low = body.soles[..., 1] < 0.01
    on = low[1:] & low[:-1]
    speed = np.linalg.norm(np.diff(body.soles[..., [0, 2]], axis=0), axis=-1) * body.motion.fps * 100
    return float(speed[on].mean()) if on.any() else 0.0


def support_slip(body: Kinematics) -> float:
    """Mean horizontal speed of the best supported point of the soles, cm/s: of those that are low in two neighbouring
    frames the one that moves least. Toes that swing low are not taken for a foot that slides; recorded walkers have 3.
    """
    return _slip(body, np.ones((len(body.soles), 2), dtype=bool))


def carried_slip(body: Kinematics) -> float:
    """The same of feet that carry, as the motion's contacts say: of a simulated body those that press on something.
    Heels that swing over a floor to where one lies are no slip in it, and heels that lie on it and are drawn up are."""
    return _slip(body, body.motion.contacts.reshape(-1, 2, 2).max(axis=2) > 0.5)


def _slip(body: Kinematics, counts: NDArray[np.bool_]) -> float:
    """Of feet that count, by frame and side (T, 2)."""
    soles = body.soles.reshape(len(body.soles), -1, 3)
    low = soles[..., 1] < LOW * body.motion.skeleton.scale
    low &= np.repeat(counts, soles.shape[1] // 2, axis=1)
    speed = np.linalg.norm(np.diff(soles[..., [0, 2]], axis=0), axis=-1) * body.motion.fps * 100
    least = np.where(low[1:] & low[:-1] & ~in_flight(body)[:, None], speed, np.inf).min(axis=1)
    stands = np.isfinite(least)
    return float(least[stands].mean()) if stands.any() else 0.0


def floor_penetration(body: Kinematics) -> float:
    """Mean over frames of the depth of the lowest sole corner below the floor, metres."""
    return float(np.maximum(-body.soles[..., 1].min(axis=(1, 2)), 0).mean())


def height_above_support(body: Kinematics, obstacles: Obstacles) -> Array:
    """How far the body is above whatever is under it: floor, seat or mattress. (T,) metres, 0 where it touches.

    PhysDiff's float, on sole corners and the undersides of the capsules instead of on vertices.
    """
    start, end, radii = body.capsules
    down = np.stack([np.zeros_like(radii), -radii, np.zeros_like(radii)], axis=-1)
    points = np.concatenate([body.soles.reshape(len(start), -1, 3), start + down, end + down], axis=1)  # (T, 38, 3)
    flat = points.reshape(-1, 3)
    under = np.zeros(len(flat))
    close = obstacles.solid().near(flat.min(axis=0) - REACH_UP, flat.max(axis=0))
    for index, owner in enumerate(close.owners):
        top = close.centers[index, 1] + close.halves[index, 1]
        if owner != WALL:
            level = flat.copy()
            level[:, 1] = close.centers[index, 1]
            held = (close.inside(level, index) >= 0) & (flat[:, 1] >= top - REACH_UP)
            under = np.where(held, np.maximum(under, top), under)
    gap = (flat[:, 1] - under).reshape(points.shape[:2]).min(axis=1)
    return np.asarray(np.maximum(gap, 0.0))
