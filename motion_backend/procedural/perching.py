"""Where on a seat one sits for what hands are to lie on: beside an armrest, or in front, within reach of a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from motion_backend.obstacles import Obstacles
from motion_backend.procedural.handholds import TABLE_REACH, handholds, table_before
from motion_backend.procedural.sit_styles import sit_style
from motion_backend.procedural.stances import Seat
from scene_graphs.surfaces import Spot

AT_TABLE = frozenset({"table", "desk"})
"""Arms of a way of sitting that lie on a table."""
MIN_EDGE = 0.12
"""Thighs rest on so much of a seat at least (metres)."""
AT_EASE = 0.45
"""Distance of a table's edge from the pelvis to which nobody draws nearer (metres)."""
ABOUT = 1.4
"""A table in reach is within this distance of the pelvis (metres)."""


def seat_for(found: Sequence[Spot], emotion: str, caption: str, obstacles: Obstacles) -> Spot:
    """The first of the sit spots, and the place on it, where the most hands have what they are to lie on.

    Chairs stand so far from their tables that a body can get between: at a table one sits on the front of the seat.
    """
    arms = sit_style(emotion, caption).arms
    if AT_TABLE & set(arms):
        return next((near for spot in found if (near := _drawn_up(spot, obstacles))), found[0])
    if "armrest" not in arms:
        return found[0]
    # The first of those that are as good as any.
    return max(found, key=lambda spot: _armrests(spot, obstacles))


def _drawn_up(spot: Spot, obstacles: Obstacles) -> Spot | None:
    """The same seat sat on so far to the front that the table before it is near; None where no table is in reach."""
    seat, forward = Seat.of(spot), max(spot.edge - MIN_EDGE, 0.0)
    near = obstacles.near(seat.pelvis - ABOUT, seat.pelvis + ABOUT)
    table = table_before(seat, near, 1.0, TABLE_REACH + forward)
    if table is None:
        return None
    moved = float(np.clip(table[0] - AT_EASE, 0.0, forward))
    x, y, z = spot.point
    x, z = x + moved * np.sin(spot.facing), z + moved * np.cos(spot.facing)
    place = replace(spot, point=(float(x), y, float(z)), edge=spot.edge - moved, back=spot.back + moved)
    return place if table_before(Seat.of(place), near, 1.0) is not None else None


def _armrests(spot: Spot, obstacles: Obstacles) -> int:
    return sum(rest is not None for rest in handholds(Seat.of(spot), obstacles, 1.0).armrests)
