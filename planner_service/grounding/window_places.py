"""Windows of a home: where one stands to look out of one, and where a hand goes that opens it or draws its curtain.

Scripts name no windows, since these are no furniture: what the theme says, or a caption, tells that one is meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.motion import Skill
from motion_backend.walls import Side
from scene_graphs.affordances.affordances import Spot
from scene_graphs.home import Home, Wall
from scene_graphs.layout import Opening
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
WINDOW: Final = "window"
"""The object id of what is touched there."""
NO_WINDOW: Final = "no window that can be got to: it is done without one"
_LOOKS: Final = re.compile(
    r"\bwindows?\b|\b(?:look|gaz|star|peer|watch|glanc)\w*\b.*\b(?:outside|street|garden|rain|snow|sunset|sunrise|sky"
    r"|stars|moon)\b",
    re.IGNORECASE,
)
_HANDLES: Final = re.compile(
    r"\b(?:open|clos|shut|draw|pull|part|fling|throw|crack|latch|unlatch|wip|clean|wash)\w*\s"
    r"(?:(?!by|at|near|beside|under|from|to|on|in\b)\w+\s){0,3}(?:windows?|curtains?|blinds?|shutters?)\b",
    re.IGNORECASE,
)
_SILL: Final = 0.3
"""An opening that begins higher than this is a window, and no door (metres)."""
_TO_LOOK: Final = (0.45, 0.6, 0.8, 1.0, 1.25, 1.5, 1.8, 2.1)
_TO_REACH: Final = (0.45, 0.5, 0.55, 0.6)
"""How far from the wall one stands, the best first (metres)."""
_ALONG: Final = (0.0, -0.25, 0.25)
"""Where before a window: shares of its width from its middle."""
_HAND: Final = {"high": 1.78, "medium": 1.25, "low": 1.0}
"""Where on it a hand goes, at least so far from its edges (metres at 1.70 m):"""
_EDGE: Final = 0.1


def at_window(skill: Skill, said: str) -> bool:
    """Whether words of a keyframe, its caption or the theme's, ask for a window: to stand at it, or to touch it."""
    if skill is Skill.TOUCH:
        return bool(_HANDLES.search(said))
    return skill is Skill.LOCO and bool(_LOOKS.search(said))


@dataclass(frozen=True)
class WindowPlace:
    """Where one stands before a window."""

    standing: Point
    """[x, z] of the pelvis."""
    facing: float
    """Yaw straight out of it."""
    middle: Point
    """[x, z] of the wall straight ahead."""
    opening: Opening

    def spot(self, height: str, scale: float) -> Spot:
        """Where a hand goes at a height, low, medium or high, of a body of `scale` times 1.70 m."""
        low, high = self.opening.bottom + _EDGE, self.opening.top - _EDGE
        y = float(np.clip(_HAND[height] * scale, low, max(low, high)))
        inward = (-float(np.sin(self.facing)), 0.0, -float(np.cos(self.facing)))
        point = (self.middle[0], y, self.middle[1])
        return Spot("touch", WINDOW, point, inward, self.facing, self.standing, self.facing, height=height)


def has_window(home: Home) -> bool:
    """Whether there is any."""
    return any(True for wall in home.walls for _ in _windows(wall))


def window_place(
    home: Home, walkable: Walkable, room: int, at: Point | None, reach: bool = False
) -> WindowPlace | None:
    """Where to stand before a window of a room, else of any room: as near to it as one gets, then to where the body
    stands; the nearest within arm's reach where it is to be touched. None where nobody gets to one."""
    start = at or walkable.random_point(np.random.default_rng(0), room)
    best: tuple[tuple[bool, int, float], WindowPlace] | None = None
    for elsewhere, rank, place in _places(home, walkable, room, _TO_REACH if reach else _TO_LOOK):
        away = float(np.hypot(place.standing[0] - start[0], place.standing[1] - start[1]))
        order = (elsewhere, 0 if reach else rank, away)
        if (best is None or order < best[0]) and walkable.reachable(start, place.standing):
            best = order, place
    return best[1] if best is not None else None


def _places(
    home: Home, walkable: Walkable, room: int, distances: tuple[float, ...]
) -> Iterator[tuple[bool, int, WindowPlace]]:
    """Free places before all windows: whether in another room, how far from the best distance, and where."""
    for wall in home.walls:
        side = Side.of(wall, home)
        if side is None or side.room is None:
            continue
        for opening in _windows(wall):
            (x0, z0), (x1, z1) = opening.segment
            facing = float(np.arctan2(side.outward[0], side.outward[1]))
            for share in _ALONG:
                middle = (x0 + (0.5 + share) * (x1 - x0), z0 + (0.5 + share) * (z1 - z0))
                for rank, away in enumerate(distances):
                    x, z = np.asarray(middle) - away * side.outward
                    standing = (float(x), float(z))
                    if walkable.is_free(standing) and home.room_at(standing) == side.room:
                        yield side.room != room, rank, WindowPlace(standing, facing, middle, opening)
                        break


def _windows(wall: Wall) -> Iterator[Opening]:
    return (opening for opening in wall.openings if opening.bottom > _SILL)
