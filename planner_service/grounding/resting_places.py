"""Where what somebody has in hand may lie before and after: the nearest top beside where they sit, lie or stand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.body.cast import UPWARD, Rest
from motion_backend.motion import Skill
from scene_graphs.affordances.affordances import spots

if TYPE_CHECKING:
    from motion_backend.motion import Action
    from scene_graphs.affordances.spot import Spot
    from scene_graphs.home import Home

WITHIN: Final = 1.3
"""Metres on the floor from somebody to a place of theirs."""
AROUND: Final = 2.5
"""Metres from them to the middle of a piece that may reach so near."""
HEIGHTS: Final = (0.3, 1.25)
"""Metres that a top is high on which something is laid in passing."""


def resting_places(actions: Sequence[Action], home: Home) -> dict[int, Rest]:
    """The place of every keyframe whose hands do not reach for anything, where there is one."""
    found: dict[int, Rest] = {}
    here: tuple[float, float] | None = None
    for action in actions:
        goal = action.goal if action.spot is None else action.spot.standing
        here = goal or here  # who goes nowhere stays where they were
        if here is None or action.skill is Skill.TOUCH:
            continue
        near = [(away, spot) for spot in _tops(here, home, action.object_id) if (away := _away(here, spot)) < WITHIN]
        if near:
            _, spot = min(near, key=lambda one: (round(one[0], 4), one[1].point))
            found[action.keyframe] = Rest(spot.point, spot.facing)
    return found


def _tops(here: tuple[float, float], home: Home, taken: str | None) -> Iterator[Spot]:
    """Where a hand reaches the tops of pieces about somebody, but for what they are on, and for seats and beds."""
    for placed in home.objects:
        if np.hypot(placed.position[0] - here[0], placed.position[2] - here[1]) > AROUND or placed.id == taken:
            continue
        if spots(placed, "lie") or any(seat.back < np.inf for seat in spots(placed, "sit")):
            continue
        for spot in spots(placed, "touch"):
            if spot.normal[1] > UPWARD and HEIGHTS[0] < spot.point[1] < HEIGHTS[1]:
                yield spot


def _away(here: tuple[float, float], spot: Spot) -> float:
    return float(np.hypot(spot.point[0] - here[0], spot.point[2] - here[1]))
