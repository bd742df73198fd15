"""Ways through a home: where on its floor a walking body can stand, and smooth short paths that keep off furniture.

From a path over cells to a path a person would walk: strings pulled tight, corners rounded.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from scene_graphs.errors import UserError
from scene_graphs.home import Home
from scene_graphs.layout import Array, Point2
from scene_graphs.navigation.clearance import BODY_RADIUS, edges_of, measure_clearance, obstacles, rectangles_of

SPACING: Final = 0.1
"""Between the points of a finished path, in metres."""
_KNOT: Final = 0.15
"""Between the points of a raw path that may become corners."""
_SLACK: Final = 1.02
"""A straight line replaces a piece of path if it costs no more than this many times as much."""
_ENDLESS: Final = 1e6
"""Cost of a piece of path that only just does not fit, so that sums stay finite."""
_TURN: Final = 0.45
"""A corner is rounded from this far before it, in metres, space permitting."""

_TOGETHER: Final = 64
"""Straight lines that are tried in one go."""

Costs = Callable[[Array, Array], Array]
Fits = Callable[[Array], bool]


def smooth_path(raw: Array, costs: Costs, fits: Fits) -> Array:
    """Pull a path of free points tight, round its corners and space its points evenly. (N, 2) -> (M, 2).

    `costs(starts, ends)` are those of straight lines, infinite where they are not free. (K, 2), (K, 2) -> (K,).
    `fits(points)` says whether all points are free. Both ends stay.
    """
    rounded = round_corners(pull_tight(raw, costs), fits)
    even = space_evenly(rounded)
    if fits((even[1:] + even[:-1]) / 2):
        return even
    # Even steps would cut a corner that is too tight to be rounded: there every corner stays.
    pieces = [space_evenly(np.stack(piece))[:-1] for piece in pairwise(rounded)]
    return np.concatenate([*pieces, rounded[-1:]])


def along_lines(starts: Array, ends: Array, spacing: float) -> tuple[Array, NDArray[np.int64]]:
    """Points at most `spacing` apart along lines, both ends of each included, and where each line begins in them.

    (K, 2), (K, 2) -> (N, 2), (K,).
    """
    ways = ends - starts
    counts = np.maximum(np.ceil(np.hypot(*ways.T) / spacing).astype(np.int64) + 1, 2)
    first = np.cumsum(counts) - counts
    line = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(line)) - first[line]) / (counts - 1)[line]
    points: Array = starts[line] + share[:, None] * ways[line]
    return points, first


def pull_tight(raw: Array, costs: Costs) -> Array:
    """The corners left when straight lines replace every piece of a path that is not cheaper than they."""
    knots = _thin(raw, costs)
    so_far = np.concatenate([[0.0], np.cumsum(np.minimum(costs(knots[:-1], knots[1:]), _ENDLESS))])
    kept = [0]
    while kept[-1] < len(knots) - 1:
        kept.append(_farthest(knots, so_far, kept[-1], costs))
    return knots[kept]


def round_corners(corners: Array, fits: Fits) -> Array:
    """Replace every corner by a curve that touches both its sides, as wide as the space allows."""
    pieces = [corners[:1]]
    for before, corner, after in zip(corners[:-2], corners[1:-1], corners[2:], strict=True):
        to_before, to_after = before - corner, after - corner
        lengths = np.hypot(*to_before), np.hypot(*to_after)
        cut = min(_TURN, lengths[0] / 2, lengths[1] / 2)
        curve = corner[None, :]
        while cut > 0.05:
            wider = _curve(corner + to_before / lengths[0] * cut, corner, corner + to_after / lengths[1] * cut)
            if fits(wider):
                curve = wider
                break
            cut /= 2
        pieces.append(curve)
    return np.concatenate([*pieces, corners[-1:]])


def space_evenly(points: Array, spacing: float = SPACING) -> Array:
    """The same line with equal steps of about `spacing`, ends kept. (N, 2) -> (M, 2)."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    keep = np.concatenate([[True], lengths > 1e-9])
    if keep.sum() < 2:
        return points[[0, -1]]
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    count = max(int(np.ceil(arc[-1] / spacing)) + 1, 2)
    at = np.linspace(0.0, arc[-1], count)
    even: Array = np.stack([np.interp(at, arc[keep], points[keep, axis]) for axis in (0, 1)], axis=-1)
    even[-1] = points[-1]
    return even


def _thin(raw: Array, costs: Costs) -> Array:
    """Every `_KNOT` metres one point of the path, and both ends; all points where it is too tight to leave any out."""
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(raw, axis=0).T))])
    marks = np.unique([0, *np.searchsorted(arc, np.arange(_KNOT, arc[-1], _KNOT)), len(raw) - 1])
    straight = np.isfinite(costs(raw[marks[:-1]], raw[marks[1:]]))
    kept = [0]
    for low, high, is_free in zip(marks[:-1], marks[1:], straight, strict=True):
        kept += [high] if is_free else range(low + 1, high + 1)
    return raw[kept]


def _farthest(knots: Array, so_far: Array, here: int, costs: Costs) -> int:
    """The farthest knot a straight line reaches at no more than the path's own cost; at least the next one."""
    for last in range(len(knots) - 1, here + 1, -_TOGETHER):
        there = np.arange(last, max(last - _TOGETHER, here + 1), -1)
        cheap = costs(np.broadcast_to(knots[here], (len(there), 2)), knots[there]) <= _SLACK * (
            so_far[there] - so_far[here]
        )
        if cheap.any():
            return int(there[cheap.argmax()])
    return here + 1


def _curve(start: Array, control: Array, end: Array) -> Array:
    """A quadratic Bézier curve. (13, 2)."""
    t = np.linspace(0.0, 1.0, 13)[:, None]
    curve: Array = (1 - t) ** 2 * start + 2 * t * (1 - t) * control + t**2 * end
    return curve


COMFORT: Final = 0.45
"""Beyond this clearance more room is worth no detour, in metres."""
CARE: Final = 2.0
"""How many times longer than its length a step counts, beyond itself, where the body only just fits."""
TIGHT: Final = 3.0
"""The same for a step with less than 0.7 of a cell to spare."""
WITHIN: Final = 0.6
"""How far from walkable floor a start or goal may be, in metres."""
OUTSIDE: Final = 2.0
"""The same of a place outside an outer door (metres)."""
_STEPS: Final = ((1, 0), (0, 1), (1, 1), (1, -1))
_SHARES: Final = np.arange(1, 8) / 8
"""Of a line, where one looks first whether it is free at all."""

Cells = NDArray[np.int64]


class NoPath(UserError):  # noqa: N818
    """There is no way to walk from a start to a goal: names both and why."""


class Walkable:
    """The walkable floor of a home for a body of one radius, and the ways over it. Everything is [x, z] in metres.

    Points that stand a little too near to furniture (where one sits down, where one reaches a shelf) may be a start or
    a goal: the body leaves and reaches them in a straight line.
    """

    def __init__(self, home: Home, radius: float = BODY_RADIUS, cell: float = 0.05) -> None:
        self.home = home
        self.radius = radius
        shapely.prepare(home.floor)
        blocked = rectangles_of([outline for _, outline in obstacles(home.objects)])
        self.field = measure_clearance(home.floor, blocked, edges_of(home.floor), cell)
        self._free = self.field.distances >= radius
        self._cells: Cells = np.argwhere(self._free)
        self._numbers = np.full(self._free.shape, -1, dtype=np.int64)
        self._numbers[self._free] = np.arange(len(self._cells))

    def clearance(self, point: Point2) -> float:
        """Distance to the nearest furniture or wall; 0 inside one or off the floor."""
        return float(self.field.at(np.asarray(point, dtype=float)))

    def is_free(self, point: Point2) -> bool:
        """Whether the body can stand there without touching anything."""
        return self.clearance(point) >= self.radius

    def nearest_free(self, point: Point2, within: float = WITHIN) -> Point2 | None:
        """The point itself if it is free, else the nearest walkable place a straight step away, else None."""
        if self.is_free(point):
            return point
        number = self._enter(point, within)
        return None if number is None else self._center(number)

    def reachable(self, start: Point2, goal: Point2) -> bool:
        """Whether there is a way from start to goal."""
        first, last = self._enter(start, self._within(start)), self._enter(goal, self._within(goal))
        return first is not None and last is not None and bool(self._regions[first] == self._regions[last])

    def sees(self, start: Point2, goal: Point2) -> bool:
        """Whether no wall is between two points of the floor; furniture does not count."""
        line, _ = along_lines(np.asarray(start, dtype=float)[None], np.asarray(goal, dtype=float)[None], 0.02)
        return self._on_floor(line)

    def straight(self, starts: Array, ends: Array) -> Array:
        """Lengths of the straight lines from places (N, 2) to others (M, 2), 0 where the body does not fit. (N, M)."""
        first, last = np.repeat(starts, len(ends), axis=0), np.tile(ends, (len(starts), 1))
        fits = np.isfinite(self._costs(first, last))
        lengths: Array = (np.hypot(*(last - first).T) * fits).reshape(len(starts), len(ends))
        return lengths

    def path(self, start: Point2, goal: Point2) -> Array:
        """A smooth way from start to goal, at most about 0.1 m between points, ends included. (N, 2).

        All of it keeps the radius from furniture and walls: between two cells where the body fits it may come nearer to
        a corner, by less than cell² / (4 radius), 3 mm. It is shortest for a cost in which a step counts more the less
        clearance there is (`CARE`, `COMFORT`).
        NoPath if start or goal is farther than `WITHIN` from walkable floor, or nothing leads from one to the other.
        """
        first, last = self._entry("start", start, goal), self._entry("goal", start, goal)
        if self._regions[first] != self._regions[last]:
            raise NoPath(f"no way from {_name(start)} to {_name(goal)}: furniture or walls separate them")
        inner = self._shortest(first, last)
        inner[0] = start if self.is_free(start) else inner[0]
        inner[-1] = goal if self.is_free(goal) else inner[-1]
        smooth = smooth_path(inner, self._costs, lambda points: bool((self.field.at(points) >= self.radius).all()))
        ends = ([] if self.is_free(start) else [start], [] if self.is_free(goal) else [goal])
        return np.concatenate([np.reshape(ends[0], (-1, 2)), smooth, np.reshape(ends[1], (-1, 2))])

    def random_point(self, rng: np.random.Generator, room: int) -> Point2:
        """A place in the room with generous clearance, connected to the rest of the home where possible.

        NoPath if no floor of that room is walkable; IndexError if there is no such room.
        """
        outline = shapely.Polygon(self.home.room_polygon(room))
        centers = self._centers
        inside = np.flatnonzero(shapely.contains_xy(outline, centers[:, 0], centers[:, 1]))
        if not len(inside):
            name = self.home.rooms[room].layout.id
            raise NoPath(f"room {room} ({name!r}) has no walkable floor: too small or too full", "take another")
        main = np.bincount(self._regions).argmax()
        candidates = connected if len(connected := inside[self._regions[inside] == main]) else inside
        clear = self.field.distances[tuple(self._cells[candidates].T)]
        roomy = candidates[clear >= min(0.5, float(np.quantile(clear, 0.8)))]
        return self._center(int(rng.choice(roomy)))

    def free_points(self, rng: np.random.Generator, room: int, count: int, spare: float = 0.0) -> Array:
        """Places of a room where a body has `spare` metres more than it needs, drawn by chance. (at most count, 2)."""
        centers = self._centers[self.field.distances[self._free] >= self.radius + spare]
        inside = shapely.contains_xy(shapely.Polygon(self.home.room_polygon(room)), centers[:, 0], centers[:, 1])
        found: Array = rng.permutation(centers[inside])[:count]
        return found

    @cached_property
    def _centers(self) -> Array:
        """Centres of the free cells. (free cells, 2)."""
        centers: Array = np.asarray(self.field.origin) + self._cells * self.field.cell
        return centers

    @cached_property
    def _graph(self) -> sparse.csr_array:
        """Free cells joined to their free neighbours, by the cost of the step."""
        count = len(self._cells)
        weights = self._weights(self.field.distances[self._free])
        starts, ends, costs = [], [], []
        for di, dj in _STEPS:
            moved = self._cells + np.array([di, dj])
            valid = (moved >= 0).all(axis=1) & (moved < self._free.shape).all(axis=1)
            other = np.full(count, -1)
            other[valid] = self._numbers[tuple(moved[valid].T)]
            here = np.flatnonzero(other >= 0)
            starts.append(here)
            ends.append(other[here])
            costs.append(np.hypot(di, dj) * self.field.cell * (weights[here] + weights[other[here]]) / 2)
        edges = (np.concatenate(costs), (np.concatenate(starts), np.concatenate(ends)))
        upper = sparse.coo_array(edges, shape=(count, count)).tocsr()
        return sparse.csr_array(upper + upper.T)

    @cached_property
    def _regions(self) -> NDArray[np.int32]:
        """The connected region of every free cell. (free cells,)."""
        return np.asarray(csgraph.connected_components(self._graph, directed=False)[1], dtype=np.int32)

    def _weights(self, clearance: Array) -> Array:
        """What a metre counts at that clearance: 1 with room to spare, 1 + CARE where the body only just fits."""
        tight = (COMFORT - clearance) / max(COMFORT - self.radius, 1e-6)
        touching = clearance < self.radius + 0.71 * self.field.cell
        weights: Array = 1.0 + CARE * np.clip(tight, 0.0, 1.0) + TIGHT * touching
        return weights

    def _costs(self, starts: Array, ends: Array) -> Array:
        """Costs of walking straight from starts to ends; infinite where the body does not fit. (K, 2) twice -> (K,)."""
        costs = np.full(len(starts), np.inf)
        few = starts[:, None] + _SHARES[:, None] * (ends - starts)[:, None]
        open_lines = np.flatnonzero((self.field.at(few) >= self.radius).all(axis=1))
        if len(open_lines):
            starts, ends = starts[open_lines], ends[open_lines]
            points, first = along_lines(starts, ends, self.field.cell)
            clearance = self.field.at(points)
            fits = np.minimum.reduceat(clearance, first) >= self.radius
            means = np.add.reduceat(self._weights(clearance), first) / np.diff([*first, len(points)])
            costs[open_lines[fits]] = (np.hypot(*(ends - starts).T) * means)[fits]
        return costs

    def _shortest(self, first: int, last: int) -> Array:
        """Centres of the cells on the cheapest way between two free cells. (N, 2)."""
        _, before = csgraph.dijkstra(self._graph, indices=np.array([last]), return_predecessors=True)
        numbers = [first]
        while numbers[-1] != last:
            numbers.append(int(before[0, numbers[-1]]))
        return self._centers[numbers]

    def _center(self, number: int) -> Point2:
        x, z = self._centers[number]
        return float(x), float(z)

    def _entry(self, which: str, start: Point2, goal: Point2) -> int:
        point = start if which == "start" else goal
        number = self._enter(point, self._within(point))
        if number is None:
            raise NoPath(
                f"no way from {_name(start)} to {_name(goal)}: no walkable floor within {WITHIN} m of the {which}",
                "move the furniture there or take another place",
            )
        return number

    def _within(self, point: Point2) -> float:
        """How far from walkable floor a start or goal may be: outside a door there is none, and one goes straight."""
        off = self.clearance(point) <= 0.0 and not self._on_floor(np.asarray(point, dtype=float)[None])
        return OUTSIDE if off and bool(shapely.intersects_xy(self.home.thresholds, *point)) else WITHIN

    def _enter(self, point: Point2, within: float) -> int | None:
        """The free cell where a body at the point joins the walkable floor, or None.

        Of the cells near by it takes one whose straight line to the point crosses least furniture, then the nearest;
        a line never leaves the floor, so nobody steps through a wall.
        """
        if not len(self._cells):
            return None
        here = np.asarray(point, dtype=float)
        away = np.hypot(*(self._centers - here).T)
        near = np.flatnonzero(away <= within)
        near = near[np.argsort(away[near], kind="stable")[:200]]
        if self.is_free(point):
            near = near[:4]
        best: tuple[float, int] | None = None
        for number in near:
            if best is not None and away[number] >= best[0]:
                break
            line, _ = along_lines(here[None], self._centers[number][None], 0.02)
            if not self._on_ways(line):
                continue
            blocked = float((self.field.at(line) <= 0.0).mean())
            cost = float(away[number]) * (1.0 + 10.0 * blocked)
            if best is None or cost < best[0]:
                best = (cost, int(number))
        return None if best is None else best[1]

    def _on_floor(self, line: Array) -> bool:
        return bool(shapely.intersects_xy(self.home.floor, line[:, 0], line[:, 1]).all())

    def _on_ways(self, line: Array) -> bool:
        """Whether a line is on the floor, or leaves it by an outer door."""
        if self._on_floor(line):
            return True
        return bool(shapely.intersects_xy(self._ways, line[:, 0], line[:, 1]).all())

    @cached_property
    def _ways(self) -> shapely.Geometry:
        return shapely.union(self.home.floor, self.home.thresholds)


def _name(point: Point2) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
