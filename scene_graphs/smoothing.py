"""From a path over cells to a path a person would walk: strings pulled tight, corners rounded."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Final

import numpy as np

from scene_graphs.layouts import Array

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

Cost = Callable[[Array, Array], float]
Fits = Callable[[Array], bool]


def smooth_path(raw: Array, cost: Cost, fits: Fits) -> Array:
    """Pull a path of free points tight, round its corners and space its points evenly. (N, 2) -> (M, 2).

    `cost(start, end)` is that of a straight line, infinite if it is not free; `fits(points)` says whether all points
    are free. Both ends stay.
    """
    return space_evenly(round_corners(pull_tight(raw, cost), fits))


def along_line(start: Array, end: Array, spacing: float) -> Array:
    """Points from start to end, ends included, at most `spacing` apart. (N, 2)."""
    count = int(np.ceil(np.hypot(*(end - start)) / spacing)) + 1
    line: Array = start + np.linspace(0.0, 1.0, max(count, 2))[:, None] * (end - start)
    return line


def pull_tight(raw: Array, cost: Cost) -> Array:
    """The corners left when straight lines replace every piece of a path that is not cheaper than they."""
    knots = _thin(raw, cost)
    pieces = [min(cost(start, end), _ENDLESS) for start, end in pairwise(knots)]
    so_far = np.concatenate([[0.0], np.cumsum(pieces)])
    kept = [0]
    while kept[-1] < len(knots) - 1:
        here = kept[-1]
        kept.append(_farthest(knots, so_far, here, cost))
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


def _thin(raw: Array, cost: Cost) -> Array:
    """Every `_KNOT` metres one point of the path, and both ends; all points where it is too tight to leave any out."""
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(raw, axis=0).T))])
    marks = np.unique([0, *np.searchsorted(arc, np.arange(_KNOT, arc[-1], _KNOT)), len(raw) - 1])
    kept = [0]
    for low, high in pairwise(marks):
        kept += [high] if np.isfinite(cost(raw[low], raw[high])) else range(low + 1, high + 1)
    return raw[kept]


def _farthest(knots: Array, so_far: Array, here: int, cost: Cost) -> int:
    """The farthest knot a straight line reaches at no more than the path's own cost; at least the next one."""
    for there in range(len(knots) - 1, here + 1, -1):
        if cost(knots[here], knots[there]) <= _SLACK * (so_far[there] - so_far[here]):
            return there
    return here + 1


def _curve(start: Array, control: Array, end: Array) -> Array:
    """A quadratic Bézier curve. (13, 2)."""
    t = np.linspace(0.0, 1.0, 13)[:, None]
    curve: Array = (1 - t) ** 2 * start + 2 * t * (1 - t) * control + t**2 * end
    return curve
