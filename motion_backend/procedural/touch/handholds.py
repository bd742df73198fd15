"""Where hands can lie around a seat: on armrests, on the seat itself, on a table ahead, on the floor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.held_poses import Seat
from motion_backend.rotations import Array
from motion_backend.skeleton import SEATED_REST

Pair = tuple[Array | None, Array | None]
"""Where the left and the right palm lie, (3,) in the world each; None where nothing is there."""
TABLE_REACH = 0.74
"""How far ahead of the pelvis the near edge of a table may be for a leaning sitter (metres at 1.70 m)."""
INSET = 0.01
"""A hand lies at least so far within the edge of a surface (metres)."""
ARMREST, TABLE = (0.08, 0.36), (0.14, 0.58)
"""Heights above the seat that armrests and tables have (metres)."""
ABOUT = (1.2, 1.0, 1.2)
"""Half the box about the pelvis in which things are looked at (metres)."""
LEVEL = 0.05
"""Above and below its seat what a sitter's hands lie on beside it (metres)."""
OVER = 0.1
"""What stands this much higher than that is above the hands (metres)."""
Grid = tuple[float, float, float]
"""From, up to and in steps of (metres)."""
WIDE: Grid = (0.26, 0.16, -0.02)
"""How far to either side of the middle hands lie beside a sitter, the widest first (at 1.70 m)."""
BEHIND, BACKREST, BEHIND_STEP, BEHIND_END = 0.24, 0.07, 0.03, -0.03
"""How far behind the pelvis (at 1.70 m), how far before the backrest, in which steps, and up to where hands lie behind
a sitter (metres)."""
EDGE, MIN_EDGE = 0.07, 0.12
"""How far within the seat's front edge hands lie, and how far before the pelvis that must be for it (metres)."""
ARMREST_AHEAD = (0.24, 0.18, 0.12, 0.06)
"""How far ahead of the pelvis a hand lies on an armrest, the farthest first (metres)."""
ARMREST_ASIDE: Grid = (0.22, 0.44, 0.02)
"""How far to the side armrests are (at 1.70 m)."""
ARMREST_STEPS = 5
"""How many such steps an armrest is wide at the most, from its inner edge."""
TABLE_FROM, TABLE_STEP = 0.20, 0.02
"""How far ahead of the pelvis tables are looked for from, and in which steps (metres)."""
FOREARMS = (0.17, 0.0, -0.17)
"""To the left, where a table must be for two forearms (metres)."""
HALF_DEPTH = 5
"""Steps of half the depth that they need."""
UNEVEN = 0.01
"""A table is level whose heights differ by less (metres)."""


@dataclass(frozen=True)
class Handholds:
    """The surfaces about a sitter that palms can lie on."""

    armrests: Pair = (None, None)
    beside: Pair = (None, None)
    """On the seat, or the floor that is sat on, beside the hips."""
    behind: Pair = (None, None)
    edge: Pair = (None, None)
    """At the seat's front edge, outside the thighs."""
    table: float | None = None
    """How far ahead of the pelvis the edge of a table begins that both forearms fit on."""
    table_top: float = 0.0

    def on_table(self, seat: Seat, inwards: float, apart: float) -> Pair:
        """Both palms on the table, so far from its edge and from each other; none where there is no table."""
        if self.table is None:
            return None, None
        ahead = self.table + inwards
        left, right = (seat.to_world((side * apart / 2, self.table_top, ahead)) for side in (1, -1))
        return left, right


def handholds(seat: Seat, obstacles: Obstacles, scale: float) -> Handholds:
    """What there is about a seat for a body of that size."""
    about = np.array(ABOUT)
    near = obstacles.solid().near(seat.pelvis - about, seat.pelvis + about)
    top = float(seat.pelvis[1]) - SEATED_REST
    level = (top - LEVEL, top + LEVEL)
    rests = (top + ARMREST[0] * scale, top + ARMREST[1] * scale)
    back = -min(BEHIND * scale, max(seat.back - BACKREST, 0.0))
    wide = np.arange(*WIDE) * scale
    behind = [(side, ahead) for ahead in np.arange(back, BEHIND_END, BEHIND_STEP) for side in wide]
    edge = [(side, seat.edge - EDGE) for side in wide] if seat.edge > MIN_EDGE else []
    armrest = [(side, ahead) for ahead in ARMREST_AHEAD for side in np.arange(*ARMREST_ASIDE) * scale]
    table = table_before(seat, near, scale)
    return Handholds(
        armrests=_pair(seat, near, _middles(seat, near, armrest, rests), rests),
        beside=_pair(seat, near, [[(side, 0.0) for side in wide]] * 2, level),
        behind=_pair(seat, near, [behind] * 2, level),
        edge=_pair(seat, near, [edge] * 2, level),
        table=table[0] if table else None,
        table_top=table[1] if table else 0.0,
    )


def _pair(seat: Seat, near: Obstacles, places: list[list[tuple[float, float]]], level: tuple[float, float]) -> Pair:
    """The first of the places (to the side, ahead) on either side with a free surface at that level."""
    found: list[Array | None] = []
    for side, wanted in zip((1, -1), places, strict=True):
        points = seat.to_world(np.array([(side * lateral, 0.0, ahead) for lateral, ahead in wanted]).reshape(-1, 3))
        tops = _tops(near, points, level[1] + OVER)
        good = np.flatnonzero((tops >= level[0]) & (tops <= level[1]))
        found.append(np.array([*points[good[0], :1], tops[good[0]], *points[good[0], 2:]]) if len(good) else None)
    return found[0], found[1]


def _middles(
    seat: Seat, near: Obstacles, places: list[tuple[float, float]], level: tuple[float, float]
) -> list[list[tuple[float, float]]]:
    """For either side the middle of the armrest at the farthest of the distances ahead that it reaches."""
    chosen: list[list[tuple[float, float]]] = []
    for side in (1, -1):
        points = seat.to_world([(side * lateral, 0.0, ahead) for lateral, ahead in places])
        tops = _tops(near, points, level[1] + OVER)
        good = (tops >= level[0]) & (tops <= level[1])
        rows = [[place for place, fits in zip(places, good, strict=True) if fits and place[1] == ahead]
                for ahead in dict.fromkeys(ahead for _, ahead in places)]  # fmt: skip
        row = next((row for row in rows if row), [])
        chosen.append([(float(np.mean([lateral for lateral, _ in row[:ARMREST_STEPS]])), row[0][1])] if row else [])
    return chosen


def table_before(seat: Seat, near: Obstacles, scale: float, reach: float = TABLE_REACH) -> tuple[float, float] | None:
    """How far ahead a table's edge is, and its height; a table is level under both forearms."""
    top = float(seat.pelvis[1]) - SEATED_REST
    level = (top + TABLE[0] * scale, top + TABLE[1] * scale)
    deep = 2 * HALF_DEPTH
    ahead = np.arange(TABLE_FROM, reach * scale + (deep + 1) * TABLE_STEP, TABLE_STEP)
    points = seat.to_world([(side, 0.0, a) for a in ahead for side in FOREARMS])
    tops = _tops(near, points, level[1] + OVER).reshape(-1, len(FOREARMS))
    flat = (np.ptp(tops, axis=1) < UNEVEN) & (tops[:, 0] >= level[0]) & (tops[:, 0] <= level[1])
    fits = flat[:-deep] & flat[HALF_DEPTH:-HALF_DEPTH] & flat[deep:]
    if not fits.any():
        return None
    first = int(np.argmax(fits))
    return float(ahead[first]), float(tops[first, 0])


def _tops(near: Obstacles, points: Array, ceiling: float) -> Array:
    """Height of the highest thing at each of N places, of what begins below `ceiling`; the floor is at 0. (N,)."""
    low = near.only(near.centers[:, 1] - near.halves[:, 1] <= ceiling)
    moved = points - low.centers[:, None]
    cos, sin = np.cos(low.yaws)[:, None], np.sin(low.yaws)[:, None]
    across, along = cos * moved[..., 0] - sin * moved[..., 2], sin * moved[..., 0] + cos * moved[..., 2]
    half = low.halves[:, None] - INSET
    on = (np.abs(across) < half[..., 0]) & (np.abs(along) < half[..., 2])
    top = (low.centers[:, 1] + low.halves[:, 1])[:, None]
    return np.asarray(np.where(on, top, 0.0).max(axis=0, initial=0.0))
