"""Where one stands to touch something so that neither shoulders nor arms are in what is beside or between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.touch.hand_captions import steadies, with_both_hands
from scene_graphs.affordances.affordances import Spot
from scene_graphs.navigation.path_planner import Walkable

OFF, SHOULDER = 0.06, 0.55
"""A hand's joint from what it touches, and the shoulder of a bending body above it (metres)."""
LEG_ROOM: Final = 0.12
"""Clearance of a place where one stands to touch something (metres)."""
ENOUGH: Final = 0.28
"""Clearance beyond which more counts no more (metres)."""
ARMS: Final = 0.22
"""A hanging arm from the middle of the body (metres)."""
HEIGHTS: Final = (0.75, 1.05, 1.35)
"""Of a hand, an elbow and a shoulder above the floor (metres)."""
FREE: Final = 0.12
"""From the middle of an arm to what is beside it, so that an elbow can be bent (metres)."""
ASIDE: Final = (0.0, 0.05, 0.10, 0.15, 0.20)
"""How far one stands aside of what one touches (metres), to the other hand's side at most; to the hand's own less."""
ACROSS: Final = 0.12
BESIDE: Final = 0.24
"""From one hand to the other where both are laid (metres)."""
OTHER: Final = {"left": "right", "right": "left"}
TURNED: Final = 0.25
"""Share of the way round to what is touched that the body turns, standing aside of it."""


@dataclass(frozen=True)
class ElbowRoom:
    """A home as arms find it."""

    walkable: Walkable
    solid: Obstacles

    def within_arms_way(self, spot: Spot) -> bool:
        """Whether nothing solid, such as a chair's own back, is between a body's shoulder and what it touches."""
        end = np.asarray(spot.point) + OFF * np.asarray(spot.normal)
        shoulder = np.array([spot.standing[0], spot.point[1] + SHOULDER, spot.standing[1]])
        way = end + np.linspace(0.0, 1.0, 12)[:, None] * (shoulder - end)
        return float(self.solid.depth(way).max()) < 0.0

    def roomiest(self, found: Sequence[Spot]) -> list[Spot]:
        """Those with as much elbow room as any."""
        room = [self._around(spot) for spot in found]
        return [spot for spot, space in zip(found, room, strict=True) if space >= max(room) - 0.03]

    def freely(self, spot: Spot, hand: str, caption: str) -> tuple[str, Spot]:
        """The hand that is laid on a spot, and the spot from a place where both arms are free.

        The place is a little aside where an arm would be in a wall. Of two hands the one is laid on the spot itself
        that leaves the other more room beside it.
        """
        if with_both_hands(caption):
            hand = self._leading(spot, hand)
        return hand, self._aside(spot, hand, with_both_hands(caption) or steadies(caption))

    def _leading(self, spot: Spot, hand: str) -> str:
        room = {one: min(self._at(spot, BESIDE * _side(OTHER[one])), FREE) for one in (hand, OTHER[hand])}
        return OTHER[hand] if room[OTHER[hand]] > room[hand] + 0.02 else hand

    def _aside(self, spot: Spot, hand: str, both: bool) -> Spot:
        middle = 0.5 * BESIDE * _side(OTHER[hand]) if both else 0.0
        tries = [self._from(spot, middle, shift) for shift in _shifts(hand, middle)]
        free = [one for one in tries if self._stands(one, spot)] or [spot]
        room = [min(self._arms(one), FREE) for one in free]
        # The nearest of those with nearly as much room as any.
        return next(one for one, space in zip(free, room, strict=True) if space >= max(room) - 0.01)

    def _around(self, spot: Spot) -> float:
        """Clearance where a body stands and, since it may crouch, a step behind; more than enough counts alike."""
        back = -0.16 * np.array([np.sin(spot.approach), np.cos(spot.approach)])
        behind = (float(spot.standing[0] + back[0]), float(spot.standing[1] + back[1]))
        return min(self.walkable.clearance(spot.standing), self.walkable.clearance(behind), ENOUGH)

    def _arms(self, spot: Spot) -> float:
        """From either hanging arm to the nearest solid thing (metres); negative inside one."""
        left = np.array([np.cos(spot.facing), 0.0, -np.sin(spot.facing)])
        middle = np.array([[spot.standing[0], height, spot.standing[1]] for height in HEIGHTS])
        return -float(self.solid.depth(np.concatenate([middle + ARMS * left, middle - ARMS * left])).max())

    def _at(self, spot: Spot, left: float) -> float:
        """From a hand so far to the left of a spot, over or before its surface, to the nearest solid thing (metres)."""
        along = np.array([np.cos(spot.facing), 0.0, -np.sin(spot.facing)])
        hand = np.asarray(spot.point) + left * along + FREE * np.asarray(spot.normal)
        return -float(self.solid.depth(hand[None])[0])

    def _from(self, spot: Spot, middle: float, shift: float) -> Spot:
        """The spot touched from so far to the left (metres) of where one stands before it, and turned to `middle`."""
        x, z = spot.standing
        standing = (x + shift * float(np.cos(spot.facing)), z - shift * float(np.sin(spot.facing)))
        away = float(np.hypot(spot.point[0] - x, spot.point[2] - z))
        turn = TURNED * float(np.arctan2(middle - shift, away))
        return replace(spot, standing=standing, facing=spot.facing + turn, approach=spot.approach + turn)

    def _stands(self, spot: Spot, before: Spot) -> bool:
        """Whether one can stand there as well as before."""
        least = max(LEG_ROOM, min(self.walkable.clearance(before.standing), ENOUGH) - 0.02)
        clear = self.walkable.clearance(spot.standing) >= least
        return clear and self.walkable.sees(before.standing, spot.standing)


def _side(hand: str) -> float:
    return 1.0 if hand == "left" else -1.0


def _shifts(hand: str, middle: float) -> list[float]:
    """Places to the left, the nearest to the middle of the hands first."""
    side = _side(hand)
    ways = [way * shift for shift in ASIDE for way in (-side, side) if way == -side or middle or 0.0 < shift < ACROSS]
    return [middle + way for way in dict.fromkeys(ways)]
