"""What somebody stands before and looks at, and what it is that they do depends on: the window looked out of, the door
waited at, the mirror combed at. It is in the picture with them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.rendering.camera import Front
from motion_backend.rendering.film_entrance import SILL
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home
    from scene_graphs.layout import Placed

FROM_WINDOW, FROM_DOOR = 2.3, 1.3
"""Metres from a window at most at which one stands who looks out of it, and from a door or a mirror who is at it."""
BESIDE: Final = 0.4
"""Metres that one may stand beside it."""
TOWARDS: Final = 0.8
"""The cosine from which on head and window are in line."""
STANDS: Final = 0.5
"""The share of frames in which somebody stands there, from which on it is what they do."""
WIDE: Final = 0.8
"""Metres of a wide window that are shown, to either side of who looks."""
UPRIGHT: Final = 0.8
"""The share of a standing pelvis's height above which somebody stands."""
MIRRORS: Final = frozenset({"mirror"})
"""Furniture that one stands before."""


class Kind(StrEnum):
    """What it is."""

    WINDOW = "window"
    DOOR = "door"
    MIRROR = "mirror"


@dataclass(frozen=True)
class _Upright:
    """A rectangle that stands: an opening of a wall, the front of a mirror."""

    side: Side
    segment: Array
    """Its ends on the floor [x, z]. (2, 2)."""
    bottom: float
    top: float
    kind: Kind


@dataclass(frozen=True)
class Counterpart:
    """A window, door or mirror that somebody stands before."""

    corners: Array
    """Of what is shown of it. (4, 3)."""
    side: Side
    """Its wall as its room sees it, or the front of a mirror."""
    kind: Kind

    @property
    def front(self) -> Front:
        """It as something that is seen from the room."""
        return Front(self.corners.mean(axis=0), -np.insert(self.side.outward, 1, 0.0))

    @staticmethod
    def of(home: Home, motion: Motion, joints: Array, turns: Array) -> Counterpart | None:
        """The nearest before which a body stands with its head turned to it in many of some frames of a motion, whose
        joints are (T, 22, 3) in the world and their rotations `turns` (T, 22, 4)."""
        ahead = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))[:, [0, 2]]
        upright = joints[:, 0, 1] > UPRIGHT * motion.skeleton.standing_height
        found: list[tuple[float, Counterpart]] = []
        for one in chain(_openings(home), _mirrors(home, joints[:, 0].mean(axis=0))):
            start, end = one.segment
            long = max(float(np.linalg.norm(end - start)), 1e-6)
            here = joints[:, 0][:, [0, 2]] - start
            along, away = here @ (end - start) / long, -here @ one.side.outward
            near = (away > 0) & (away < (FROM_WINDOW if one.kind is Kind.WINDOW else FROM_DOOR))
            before = near & (along > -BESIDE) & (along < long + BESIDE)
            there = before & upright & (ahead @ one.side.outward > TOWARDS)
            if there.mean() < STANDS:
                continue
            at = float(np.clip(along[there].mean(), 0.0, long))
            ends = [start + (end - start) * share / long for share in (max(at - WIDE, 0.0), min(at + WIDE, long))]
            corners = np.array([(x, y, z) for x, z in ends for y in (one.bottom, one.top)])
            found.append((float(away[there].mean()), Counterpart(corners, one.side, one.kind)))
        return min(found, key=lambda two: two[0])[1] if found else None


def _openings(home: Home) -> Iterator[_Upright]:
    """Windows and doors of a home."""
    for wall in home.walls:
        side = Side.of(wall, home)
        if side is None:
            continue
        for one in wall.openings:
            segment = np.asarray(one.segment, dtype=np.float64)
            yield _Upright(side, segment, one.bottom, one.top, Kind.WINDOW if one.bottom > SILL else Kind.DOOR)


def _mirrors(home: Home, place: Array) -> Iterator[_Upright]:
    """Mirrors as a body at a place (3,) is before them."""
    return (_front_of(one, home, place) for one in home.objects if one.category in MIRRORS)


def _front_of(placed: Placed, home: Home, place: Array) -> _Upright:
    """The long side of a piece that looks at a place (3,)."""
    wide, _, deep = (length / 2 for length in placed.size)
    toward = 1.0 if placed.to_local(place)[2] > 0 else -1.0
    one, other, middle = (
        np.asarray(placed.to_world(np.array([x, 0.0, toward * deep])))[[0, 2]] for x in (-wide, wide, 0.0)
    )
    outward = np.asarray(placed.position)[[0, 2]] - middle
    outward /= max(float(np.linalg.norm(outward)), 1e-9)
    room = home.room_at((float(middle[0]), float(middle[1])))
    return _Upright(
        Side(one, other, outward, room), np.array([one, other]), placed.position[1], placed.top, Kind.MIRROR
    )
