"""Going to a thing and laying a hand on it: the performer of touch."""

from __future__ import annotations

import numpy as np

from motion_backend.motion import Action
from motion_backend.procedural.body import Body, spot_of
from motion_backend.procedural.going import go
from motion_backend.procedural.handling import LONGER, Laid, handling_of, with_both_hands
from motion_backend.procedural.kneeling import feet_behind
from motion_backend.procedural.moods import bearing_of
from motion_backend.procedural.palms import free_palm, other_hand
from motion_backend.procedural.reaching import Manner, touch
from motion_backend.skeleton import HAND_REST

REACHED_DOWN = 1.12
"""An arm goes down to what is lower than this (metres at 1.70 m), so that its fingers point down a front."""
FOOT = 0.06
"""Room around an ankle that a foot needs (metres)."""


def touch_spot(body: Body, action: Action) -> None:
    """From standing: to the thing, the hand onto it, what the hand does there, and back."""
    bearing = bearing_of(action.emotion, action.caption)
    spot = spot_of(action)
    go(body, spot.standing, spot.facing, action)
    normal = np.asarray(spot.normal, dtype=np.float64)
    goal = np.asarray(spot.point) + HAND_REST * normal
    obstacles, scale = body.scene.obstacles, body.skeleton.scale
    depth = obstacles.solid().depth
    prone = "prone" in action.caption and float(depth(feet_behind(body.pose, body.skeleton)).max()) < -FOOT
    down = bool(normal[1] < 0.7 and goal[1] < REACHED_DOWN * scale and not prone)
    palm = free_palm(obstacles, spot, goal, action.hand, down)
    doing = handling_of(action.caption)
    hold = max(action.hold, 1.2, LONGER.get(doing, 0.0))
    other = other_hand(obstacles, spot, (goal, action.hand, down), scale) if with_both_hands(action.caption) else None
    laid = Laid(goal, palm, normal, action.hand, down, other)
    body.add(touch(body.pose, laid, Manner(bearing, hold, doing, prone), body.skeleton, depth))
