"""How deep a body is in furniture and walls that it must not go through (after DIMOS and LINGO, on capsules)."""

from __future__ import annotations

import numpy as np

from motion_backend.body import capsules
from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Motion, PhaseKind, Skill
from motion_backend.rotations import Array

CUSHION = 0.05
"""How deep a body may sink into what it sits or lies on."""
CLEARLY_IN = 0.02
_SITTING = (
    "pelvis",
    "torso",
    "left_thigh",
    "right_thigh",
    "left_hand",
    "right_hand",
    "left_lower_arm",
    "right_lower_arm",
)


def penetration(body: Kinematics, obstacles: Obstacles, action: Action | None) -> Array:
    """Depth of the deepest skin point of each frame inside solid furniture, cushion allowed for. (T,)."""
    start, end, radii = body.capsules
    deepest = np.zeros(len(start))
    close = obstacles.solid().near(
        np.minimum(start, end).min(axis=(0, 1)) - 0.15, np.maximum(start, end).max(axis=(0, 1)) + 0.15
    )
    flat_start, flat_end = start.reshape(-1, 3), end.reshape(-1, 3)
    radius = np.tile(radii, len(start))
    middle, half = (flat_start + flat_end) / 2, np.linalg.norm(flat_end - flat_start, axis=1) / 2
    for index, owner in enumerate(close.owners):
        touching = np.flatnonzero(close.inside(middle, index) > -(half + radius))
        if not len(touching):
            continue
        points = capsules.skin_points(flat_start[touching], flat_end[touching], radius[touching])
        depth = close.inside(points.reshape(-1, 3), index).reshape(len(touching), -1).max(axis=1)
        bodies = touching % len(capsules.BODIES)
        depth = depth - np.array([cushion(action, owner, capsules.BODIES[b].name, lies(body.motion)) for b in bodies])
        np.maximum.at(deepest, touching // len(capsules.BODIES), depth)
    return deepest


def lies(motion: Motion) -> bool:
    """Whether a body lies in a part of a motion: who sits up lay there."""
    return any(phase.kind in (PhaseKind.LIEDOWN, PhaseKind.GETUP) for phase in motion.phases)


def cushion(action: Action | None, owner: str, body: str, lay: bool = False) -> float:
    """Contact bodies may sink into their own target and nowhere else; all of them where the body lies, or `lay`."""
    if action is None or action.object_id != owner or action.skill in (Skill.LOCO, Skill.TOUCH):
        return 0.0
    lying = lay or action.skill in (Skill.LIEDOWN, Skill.GETUP)
    return CUSHION if lying or body in _SITTING else 0.0
