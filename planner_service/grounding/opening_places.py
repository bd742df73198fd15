"""Windows and outer doors of a home: where one stands to look out of one, where a hand goes that opens it, and where
somebody stands who has just come in.

Scripts name neither, since these are no furniture: what the theme says, or a caption, tells that one is meant.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend.procedural.touch.hand_contacts import KNOCKED
from motion_backend.walls import Side
from planner_service.themes.opening_words import Kind
from scene_graphs.affordances.affordances import Spot
from scene_graphs.boxes import Part
from scene_graphs.home import HANDLE_HEIGHT, SILL, Home, Wall
from scene_graphs.layout import Opening, Placed, wrap
from scene_graphs.meshes.interior_mesh import CURTAIN_ABOVE, CURTAIN_BELOW, CURTAIN_OUT, LEAF_OUT, THICKNESS
from scene_graphs.meshes.moving_parts import CURTAINS, HALL_HEIGHT, ROOM_DOOR
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
LACKS: Final[dict[Kind, str]] = {
    "window": "no window that can be got to: it is done without one",
    "door": "no door to the outside that can be got to: it is done without one",
}
"""What is noted where there is none."""
_HANDLE: Final = 0.04
"""From the plane of the wall to the handle of its door, into the room (metres)."""
_ENTERED: Final = (0.7, 0.9, 0.55, 1.2)
"""How far before the door one stands who has just come in (metres)."""
_TO_LOOK: Final = (0.45, 0.6, 0.8, 1.0, 1.25, 1.5, 1.8, 2.1)
_PASSED: Final = (0.95, 0.3)
"""How far outside of the door one is who has gone out by it, the best first (metres)."""
_TO_REACH: Final = (0.45, 0.5, 0.55, 0.6)
"""How far from the wall one stands, the best first (metres)."""
_ALONG: Final = (0.0, -0.25, 0.25)
"""Where before a window: shares of its width from its middle."""
_HAND: Final = {"high": 1.78, "medium": 1.25, "low": 1.0}
"""Where on it a hand goes, at least so far from its edges (metres at 1.70 m):"""
_EDGE: Final = 0.1


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

    def outside(self, walkable: Walkable) -> Point | None:
        """[x, z] of who has gone out by it; None where there is no way."""
        x, z = np.mean(np.asarray(self.opening.segment), axis=0)
        for away in _PASSED:
            place = float(x + away * np.sin(self.facing)), float(z + away * np.cos(self.facing))
            if walkable.reachable(self.standing, place):
                return place
        return None

    @property
    def inward(self) -> float:
        """Yaw of who has come in by it."""
        return wrap(self.facing + np.pi)

    def spot(self, height: str, scale: float, knocked: bool = False) -> Spot:
        """Where a hand goes: on a door to its handle, or over it where it is `knocked` on, on a window to a height
        (low, medium or high) of a body of `scale` times 1.70 m."""
        low, high = self.opening.bottom + _EDGE, self.opening.top - _EDGE
        y = float(np.clip((KNOCKED if knocked else _HAND[height]) * scale, low, max(low, high)))
        y = HANDLE_HEIGHT if self.kind == "door" and not knocked else y
        inward = (-float(np.sin(self.facing)), 0.0, -float(np.cos(self.facing)))
        proud = _HANDLE if self.kind == "door" and not knocked else 0.0
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


def entry(home: Home, walkable: Walkable, room: int) -> OpeningPlace | None:
    """Where somebody stands who has just come into a room by its outer door, else into any."""
    found = min(_places(home, walkable, "door", room, _ENTERED), key=lambda one: one[:2], default=None)
    return found[2] if found is not None else None


def opening_piece(home: Home, is_door: bool, at: Point) -> Placed | None:
    """The leaf of the door to the outside, or the curtains of the window, that is nearest to [x, z], as a piece that
    faces into the room; None where there is none."""
    found = [
        (wall, side, opening)
        for wall in home.walls if (side := Side.of(wall, home)) is not None and side.room is not None
        for opening in _openings(home, wall, "door" if is_door else "window")
    ]  # fmt: skip
    if not found:
        return None
    wall, side, opening = min(found, key=lambda one: float(np.hypot(*np.subtract(np.mean(one[2].segment, axis=0), at))))
    (x, z), width = np.mean(opening.segment, axis=0), float(np.hypot(*np.subtract(*opening.segment)))
    yaw = float(np.arctan2(-side.outward[0], -side.outward[1]))
    name = f"{side.room}/{home.walls.index(wall)}.{wall.openings.index(opening)}"
    tall = min(opening.top, wall.height - 0.02)
    if not is_door:
        low, top = opening.bottom - CURTAIN_BELOW, tall + CURTAIN_ABOVE
        return Placed(f"{name} curtains", CURTAINS, (x, low, z), (width, top - low, CURTAIN_OUT), yaw)
    door = Placed(f"{name} door", ROOM_DOOR, (x, 0.0, z), (width, tall, 2 * LEAF_OUT[1]), yaw)
    handle_x, handle_z = wall.handle(opening)
    grip = float(door.to_local((handle_x, 0.0, handle_z))[0])
    leaf = Part("panel", (-width / 2, 0.005, -LEAF_OUT[1]), (width / 2, tall, -LEAF_OUT[0]))
    begin, end = (grip - 0.065, HANDLE_HEIGHT - 0.015), (grip + 0.065, HANDLE_HEIGHT + 0.015)
    handle = Part("pole", (*begin, -LEAF_OUT[0]), (*end, _HANDLE + 0.005))
    _, deep, aside = home.hall(opening)
    hall = Part("panel", (-width / 2 - aside, 0.0, -deep), (width / 2 + aside, HALL_HEIGHT, -THICKNESS))
    return replace(door, size=(width + 2 * aside, HALL_HEIGHT, 2 * deep), shape=(leaf, handle, hall))


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
        if (opening.bottom > SILL) == (kind == "window") and not (kind == "door" and home.leads_on(opening)):
            yield opening
