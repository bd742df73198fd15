"""Where one way leads on into the next: a corner that is cut, or a turn about in an arc, as far as there is room.

Numbers are in data/gait/way_junction.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import smooth
from motion_backend.procedural.walk.root_path import SPACING, resample
from motion_backend.rotations import Array
from scene_graphs.data_tables import read_table, table

Fits = Callable[[Array], bool]
"""Whether a body can be at all of these points. (N, 2) as [x, z]."""
JOINS = 2.0
"""A way is joined from aside over so much more than it is off, at least: shorter, it would bend more than an arc."""


@table
class JunctionTable:
    """data/gait/way_junction.toml."""

    onward_min_m: float
    """A shorter way is walked by itself."""
    onward_max_m: float
    """So much of the next way is looked at."""
    arrives_m: float
    """Of a way that is known by its direction alone: its last piece."""
    beyond_m: float
    """So far past the place where the ways join a walk goes over into the next,"""
    feet_change_steps: tuple[float, float]
    """or so much of a step sooner or later, at most: both feet are down once in that."""
    arc_from_rad: float
    """A turn of less cuts the corner, one of more goes round in an arc."""
    cuts_m: tuple[float, ...]
    """How far from it a corner is cut, the widest that has room."""
    radii_m: tuple[float, ...]
    """Of the arc, likewise."""
    passes_m: float
    """From where the first way ends the joined one passes no farther."""
    wide_m: tuple[float, ...]
    """Where one way goes over into the next an arc may be as wide as this."""
    before_ratios: tuple[float, ...]
    """Of its radius, that the arc begins before the place: the first that has room."""
    other_way_rad: float
    """An arc may go round the other way where that is no more."""
    back_m: float
    """Over which the way that leads on is joined."""
    round_from_rad: float
    """Who sets out turned by more than this comes round in an arc."""


def junction_table() -> JunctionTable:
    """How one way leads on into the next."""
    rows: JunctionTable = read_table("motion_backend", "gait/way_junction.toml", JunctionTable)
    return rows


@dataclass(frozen=True)
class ThroughWay:
    """Two ways as one."""

    points: Array
    """(N, 2) [x, z], about `SPACING` apart."""
    cut_m: float
    """Length along it at which the first walk is over."""


def through_way(path: Array, onward: Array, fits: Fits) -> ThroughWay | None:
    """Two ways (N, 2), (M, 2) joined where the first ends and the second begins; None where there is no room."""
    row = junction_table()
    first, second = resample(path), resample(onward)
    second = second[: max(int(row.onward_max_m / SPACING), 2)]
    if min(len(first), len(second)) * SPACING < row.onward_min_m:
        return None
    arrives, leaves = _direction(first[::-1], row) * -1.0, _direction(second, row)
    turn = float(rotations.wrap(np.arctan2(*leaves) - np.arctan2(*arrives)))
    sharp = abs(turn) >= row.arc_from_rad
    for joined in _arcs(first, second, arrives, turn) if sharp else (_cut(first, second, size) for size in row.cuts_m):
        if joined is None or not fits(joined):
            continue
        points = resample(joined)
        away = np.linalg.norm(points - first[-1], axis=1)
        near = int(np.argmin(away))
        if away[near] <= row.passes_m:
            cut = min(near * SPACING + row.beyond_m, SPACING * (len(points) - 1) - row.onward_min_m / 2)
            return ThroughWay(points, cut)
    return None


def _arcs(first: Array, second: Array, arrives: Array, turn: float) -> Iterator[Array | None]:
    """All arcs that join two ways, the widest first: round the shorter way or the other, sooner or later begun."""
    row = junction_table()
    other = turn - np.sign(turn) * 2 * np.pi
    turns = [turn, other] if abs(other) <= row.other_way_rad else [turn]
    for radius, about, before, back in product(row.wide_m + row.radii_m, turns, row.before_ratios, (row.back_m, 0.0)):
        yield _arc(first, second, arrives, about, radius, back, before * radius)


def _direction(points: Array, row: JunctionTable) -> Array:
    """Unit vector of where a way leads at its beginning. (2,)."""
    far = points[min(int(row.arrives_m / SPACING), len(points) - 1)]
    return rotations.normalize(far - points[0])


def _cut(first: Array, second: Array, size: float) -> Array | None:
    """A curve from so far before the corner to so far after it, in place of the corner."""
    steps = int(size / SPACING)
    if steps >= min(len(first), len(second)):
        return None
    share = np.linspace(0.0, 1.0, 2 * steps + 1)[:, None]
    start, corner, end = first[-1 - steps], second[0], second[steps]
    curve = (1 - share) ** 2 * start + 2 * share * (1 - share) * corner + share**2 * end
    return np.concatenate([first[: -1 - steps], curve, second[steps + 1 :]])


def _arc(
    first: Array, second: Array, arrives: Array, turn: float, radius: float, back_m: float, before_m: float = 0.0
) -> Array | None:
    """An arc of that radius from the first way's direction, so far before its end, round to the second's, which is
    joined little by little, over `back_m` at least, and ends where it did; None where too little of it is left."""
    before = min(int(before_m / SPACING), len(first) - 1)
    start, side = first[-1 - before], np.sign(turn) * np.array([arrives[1], -arrives[0]])
    angle = np.linspace(0.0, abs(turn), max(int(abs(turn) * radius / SPACING), 2))[:, None]
    curve = start + radius * (np.sin(angle) * arrives + (1 - np.cos(angle)) * side)
    nearest = int(np.argmin(np.linalg.norm(second - curve[-1], axis=1)))
    rest = second[nearest:]
    left, off = SPACING * (len(rest) - 1), curve[-1] - rest[0]
    least = JOINS * float(np.linalg.norm(off))
    if left < least:
        return None
    away = smooth(SPACING * np.arange(len(rest)) / min(max(back_m, least, SPACING), left))[:, None]
    return np.concatenate([first[: -1 - before], curve, (rest + (1 - away) * off)[1:]])


def way_from(path: Array, yaw: float, fits: Fits) -> Array:
    """A way (N, 2) for a body that faces `yaw`: it sets out ahead and comes round in an arc; as it was without room."""
    row, points = junction_table(), resample(path)
    if len(points) * SPACING < row.onward_min_m:
        return path
    ahead = np.array([np.sin(yaw), np.cos(yaw)])
    turn = float(rotations.wrap(np.arctan2(*_direction(points, row)) - yaw))
    if abs(turn) < row.round_from_rad:
        return path
    for radius in row.radii_m:
        curved = _arc(points[:1], points, ahead, turn, radius, row.back_m)
        if curved is not None and len(points) * SPACING > 2 * radius and fits(curved):
            return curved
    return path
