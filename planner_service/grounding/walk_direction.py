"""Where a body looks after what it has done, and where walks go that lead to its front left or right."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

import numpy as np

from motion_backend.motion import Action, Skill
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
_FRONT: Final = re.compile(r"\b(?:front|forward|ahead)[ ,a-z]*?\b(left|right)\b", re.IGNORECASE)
_TO_THE_SIDE: Final = np.radians([40.0, 50.0, 30.0, 60.0, 70.0])
"""How far to the side of where the body looks its front left is, the best first."""
_AWAY: Final = (1.8, 1.5, 1.2, 0.9, 0.7)
"""How far a walk to the front goes, the best first (metres)."""
_ROOM: Final = 0.25
"""Clearance where it should end (metres)."""


def heading_after(done: Sequence[tuple[Action, Point | None]], walkable: Walkable) -> float | None:
    """Where a body looks after actions, each with where it began (yaw); None where nobody can know."""
    for action, at in reversed(done):
        if action.spot is not None and action.skill is not Skill.LOCO:
            return action.spot.approach if action.spot.affordance == "lie" else action.spot.facing
        if action.facing is not None:
            return action.facing
        if action.goal is not None:
            return _last_step(at, action.goal, walkable)
    return None


def _last_step(at: Point | None, goal: Point, walkable: Walkable) -> float | None:
    """The direction in which a walk arrives."""
    if at is None or not walkable.reachable(at, goal):
        return None
    step = np.diff(walkable.path(at, goal)[-2:], axis=0).sum(axis=0)
    return float(np.arctan2(step[0], step[1])) if np.hypot(*step) > 1e-6 else None


def in_front(
    caption: str, walkable: Walkable, at: Point | None, done: Sequence[tuple[Action, Point | None]]
) -> Point | None:
    """The goal of "walk to the front left" from where the body stands and looks; None where there is no such place."""
    side = _FRONT.search(caption)
    heading = heading_after(done, walkable) if side else None
    if side is None or at is None or heading is None:
        return None
    sign = 1.0 if side[1].lower() == "left" else -1.0
    for least in (_ROOM, 0.0):
        for away in _AWAY:
            for aside in _TO_THE_SIDE:
                yaw = heading + sign * aside
                goal = (float(at[0] + away * np.sin(yaw)), float(at[1] + away * np.cos(yaw)))
                if walkable.is_free(goal) and walkable.sees(at, goal) and walkable.clearance(goal) >= least:
                    return goal
    return None
