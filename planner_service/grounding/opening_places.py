"""Windows and outer doors of a home: where one stands to look out of one, where a hand goes that opens it, and where
somebody stands who has just come in.

Scripts name neither, since these are no furniture: what the theme says, or a caption, tells that one is meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from motion_backend.motion import Skill
from motion_backend.walls import Side
from scene_graphs.affordances.affordances import Spot
from scene_graphs.home import HANDLE_HEIGHT, Home, Wall
from scene_graphs.layout import Opening, wrap
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
Kind = Literal["window", "door"]
"""Its name is the object id of what is touched there as well."""
LACKS: Final[dict[Kind, str]] = {
    "window": "no window that can be got to: it is done without one",
    "door": "no door to the outside that can be got to: it is done without one",
}
"""What is noted where there is none."""
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
_OF_A_HOUSE: Final = r"(?:(?:the|a|an|his|her|their|my|its|front|back|outer|heavy|street|kitchen|bedroom|room) )*"
_OPENS: Final = re.compile(
    r"\b(?:open|clos|shut|slam|bang|lock|unlock|bolt|unbolt|latch|unlatch|answer|push|pull|kick|yank|throw|fling|swing"
    rf"|get|knock|check|tr(?:y|ies|ied))\w*\s(?:\w+ly\s)?(?:(?:at|on|against|behind) )?{_OF_A_HOUSE}"
    r"(?:doors?|doorbell|bell|doorknob|door handle)\b(?! of)"
    r"|\banswer\w* (?:the|a) knock\b"
    r"|\blet(?:s|ting)? (?:(?:the|a|his|her|their|my) )?"
    r"(?:cat|dog|guests?|friends?|him|her|them|visitors?) (?:in|out)\b",
    re.IGNORECASE,
)
_TO_THE_DOOR: Final = re.compile(
    rf"\b(?:to|at|by|near|behind|towards?|for) {_OF_A_HOUSE}(?:door|doorway|entrance)(?!\w| of)", re.IGNORECASE
)
_COMES_IN: Final = re.compile(
    r"\b(?:com|came|get|got|arriv|return|walk|step|storm|burst|stumbl|stagger|rush|hurr|bound|trudg|stomp|sneak|slip)\w*"
    r"\b(?:(?!\b(?:and|then|to)\b)[^,;.])*?\b(?:home|in|inside|indoors|through the (?:front )?door|from (?:work|school)"
    r"|from (?:the|a|his|her|their) (?:\w+ )?(?:shift|office|shop|funeral|party|school|hospital|walk|run|trip|date))\b"
    r"|^(?:\w+ )?(?:gets|got|is|was) (?:back|home)\b|\benters? (?:the )?(?:house|home|flat|apartment|room)\b",
    re.IGNORECASE,
)
_NOT_IN: Final = re.compile(
    r"\b(?:in|inside) (?:the|a|an|his|her|their|my|bed|circles?|front|silence|despair|pain)\b", re.IGNORECASE
)
"""Where one is, or how, and not that one comes in."""
_SILL: Final = 0.3
"""An opening that begins higher than this is a window, and no door (metres)."""
_HANDLE: Final = 0.04
"""From the plane of the wall to the handle of its door, into the room (metres)."""
_ENTERED: Final = (0.7, 0.9, 0.55, 1.2)
"""How far before the door one stands who has just come in (metres)."""
_TO_LOOK: Final = (0.45, 0.6, 0.8, 1.0, 1.25, 1.5, 1.8, 2.1)
_TO_REACH: Final = (0.45, 0.5, 0.55, 0.6)
"""How far from the wall one stands, the best first (metres)."""
_ALONG: Final = (0.0, -0.25, 0.25)
"""Where before a window: shares of its width from its middle."""
_HAND: Final = {"high": 1.78, "medium": 1.25, "low": 1.0}
"""Where on it a hand goes, at least so far from its edges (metres at 1.70 m):"""
_EDGE: Final = 0.1


def opening_of(skill: Skill, said: str) -> Kind | None:
    """Which opening the words of a keyframe, its caption or the theme's, ask for: to stand at it, or to touch it."""
    if skill is Skill.TOUCH:
        return "window" if _HANDLES.search(said) else "door" if _OPENS.search(said) else None
    if skill is Skill.LOCO:
        return "window" if _LOOKS.search(said) else "door" if _TO_THE_DOOR.search(said) else None
    return None


def comes_in(said: str) -> bool:
    """Whether somebody comes in from outside, by the theme's words."""
    return bool(_COMES_IN.search(_NOT_IN.sub("", said)))


@dataclass(frozen=True)
class OpeningPlace:
    """Where one stands before a window or a door."""

    kind: Kind
    standing: Point
    """[x, z] of the pelvis."""
    facing: float
    """Yaw straight out of it."""
    middle: Point
    """[x, z] of what is straight ahead: the wall, or the handle of the door."""
    opening: Opening

    @property
    def inward(self) -> float:
        """Yaw of who has come in by it."""
        return wrap(self.facing + np.pi)

    def spot(self, height: str, scale: float) -> Spot:
        """Where a hand goes: on a door to its handle, on a window to a height (low, medium or high) of a body of
        `scale` times 1.70 m."""
        low, high = self.opening.bottom + _EDGE, self.opening.top - _EDGE
        y = HANDLE_HEIGHT if self.kind == "door" else float(np.clip(_HAND[height] * scale, low, max(low, high)))
        inward = (-float(np.sin(self.facing)), 0.0, -float(np.cos(self.facing)))
        proud = _HANDLE if self.kind == "door" else 0.0
        point = (self.middle[0] + proud * inward[0], y, self.middle[1] + proud * inward[2])
        at = "medium" if self.kind == "door" else height
        return Spot("touch", self.kind, point, inward, self.facing, self.standing, self.facing, height=at)


def has_opening(home: Home, kind: Kind) -> bool:
    """Whether there is any window, or any door to the outside."""
    return any(True for wall in home.walls for _ in _openings(home, wall, kind))


def opening_place(
    home: Home, walkable: Walkable, kind: Kind, room: int, at: Point | None, reach: bool = False
) -> OpeningPlace | None:
    """Where to stand before a window or door of a room, else of any room: as near to it as one gets, then to where the
    body stands; the nearest within arm's reach where it is to be touched. None where nobody gets to one."""
    start = at or walkable.random_point(np.random.default_rng(0), room)
    best: tuple[tuple[bool, int, float], OpeningPlace] | None = None
    for elsewhere, rank, place in _places(home, walkable, kind, room, _TO_REACH if reach else _TO_LOOK):
        away = float(np.hypot(place.standing[0] - start[0], place.standing[1] - start[1]))
        order = (elsewhere, 0 if reach else rank, away)
        if (best is None or order < best[0]) and walkable.reachable(start, place.standing):
            best = order, place
    return best[1] if best is not None else None


def entry(home: Home, walkable: Walkable, room: int) -> tuple[float, float, float] | None:
    """Where somebody stands and looks, [x, z, yaw], who has just come into a room by its outer door, else into any."""
    found = min(_places(home, walkable, "door", room, _ENTERED), key=lambda one: one[:2], default=None)
    return (*found[2].standing, found[2].inward) if found is not None else None


def _places(
    home: Home, walkable: Walkable, kind: Kind, room: int, distances: tuple[float, ...]
) -> Iterator[tuple[bool, int, OpeningPlace]]:
    """Free places before all windows or doors: whether in another room, how far from the best distance, and where."""
    for wall in home.walls:
        side = Side.of(wall, home)
        if side is None or side.room is None:
            continue
        for opening in _openings(home, wall, kind):
            (x0, z0), (x1, z1) = opening.segment
            facing = float(np.arctan2(side.outward[0], side.outward[1]))
            middles = [(x0 + (0.5 + share) * (x1 - x0), z0 + (0.5 + share) * (z1 - z0)) for share in _ALONG]
            for middle in [wall.handle(opening)] if kind == "door" else middles:
                for rank, away in enumerate(distances):
                    x, z = np.asarray(middle) - away * side.outward
                    standing = (float(x), float(z))
                    if walkable.is_free(standing) and home.room_at(standing) == side.room:
                        yield side.room != room, rank, OpeningPlace(kind, standing, facing, middle, opening)
                        break


def _openings(home: Home, wall: Wall, kind: Kind) -> Iterator[Opening]:
    """The windows of a wall, or its doors that lead out of the home."""
    for opening in wall.openings:
        if (opening.bottom > _SILL) == (kind == "window") and not (kind == "door" and home.leads_on(opening)):
            yield opening
