"""How far the zero-moment point of a body lies outside its planted soles, while it stands or walks and while it rises.

Judged are frames in which soles alone carry: not before a seat is left, not while sitting, lying, kneeling or bearing
on both hands, and not in the air. Recorded people are not at 0 either: the body counts as one mass, and soles are
judged by their labels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.segment_masses import centres_of_mass
from motion_backend.body.zero_moment import nearest_in_hull, zero_moment_points
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import PhaseKind
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

RESTING = frozenset({PhaseKind.GETUP, PhaseKind.EDGE, PhaseKind.SITDOWN, PhaseKind.LIEDOWN})
"""Parts in which something else than the soles carries."""
LEFT = 0.01
"""A seat is left when the pelvis is this much higher than it sat (metres)."""
RISEN = 0.85
"""A body has risen when its pelvis is at this share of its standing height."""
KNEELS = 0.12
"""A knee lower than this is knelt on (metres at 1.70 m)."""
ON_HANDS = 0.1
"""Wrists both lower than this are of hands that carry (metres at 1.70 m)."""


def outside_soles(body: Kinematics) -> Array:
    """How far the zero-moment point lies outside the planted soles. (T,) metres, not a number where none is planted."""
    motion = body.motion
    centres = centres_of_mass(motion.skeleton, body.positions, body.world)
    points = zero_moment_points(centres, motion.fps)
    nearest = nearest_in_hull(points, sole_corners(body), planted_corners(body))
    return np.asarray(np.linalg.norm(points - nearest, axis=1))


def sole_corners(body: Kinematics) -> Array:
    """Heel, toe tip, inner and outer edge of both soles on the floor. (T, 8, 2) x and z."""
    return np.asarray(body.soles[..., [0, 2]].reshape(len(body.soles), -1, 2))


def planted_corners(body: Kinematics) -> NDArray[np.bool_]:
    """Which of them carry: the heel with the ankle, the tip with the toes, the edges with either. (T, 8)."""
    heel, toes = body.motion.contacts[:, [0, 2]] > 0.5, body.motion.contacts[:, [1, 3]] > 0.5
    edge = heel | toes
    return np.stack([heel, toes, edge, edge], axis=-1).reshape(len(heel), -1)


def upright_frames(body: Kinematics) -> NDArray[np.bool_]:
    """Frames of standing and walking, nothing but soles on the floor. (T,)."""
    found = ~kneeling(body)
    for phase in body.motion.phases:
        if phase.kind in RESTING or phase.kind is PhaseKind.STANDUP:
            found[phase.start : phase.stop] = False
    return found


def rising_frames(body: Kinematics) -> NDArray[np.bool_]:
    """Frames of standing up, from where the seat is left to where the body has risen. (T,)."""
    found = np.zeros(len(body.motion), dtype=bool)
    low = body.positions[:, 0, 1] < RISEN * body.motion.skeleton.standing_height
    for phase in body.motion.phases:
        if phase.kind is PhaseKind.STANDUP:
            height = body.positions[phase.start : phase.stop, 0, 1]
            found[phase.start : phase.stop] = np.maximum.accumulate(height > height[:1] + LEFT)
    return np.asarray(found & low & ~kneeling(body))


def kneeling(body: Kinematics) -> NDArray[np.bool_]:
    """Frames in which a knee carries, or both hands. (T,)."""
    knees, wrists = (
        body.positions[:, [INDEX[f"left_{joint}"], INDEX[f"right_{joint}"]], 1] for joint in ("knee", "wrist")
    )
    scale = body.motion.skeleton.scale
    return np.asarray((knees.min(axis=1) < KNEELS * scale) | (wrists.max(axis=1) < ON_HANDS * scale))
