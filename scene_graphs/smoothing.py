"""From a path over cells to a path a person would walk: strings pulled tight, corners rounded."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

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
