"""Shapes as fields that are negative inside, blended smoothly, and turned into triangles by surface nets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from motion_backend.rotations import Array

Faces = NDArray[np.int64]
Field = Callable[[Array], Array]
"""Points (..., 3) to values (...): negative inside, zero on the surface, roughly metres near it."""


def ellipsoid(center: Sequence[float], half: Sequence[float]) -> Field:
    """An ellipsoid of those half sizes."""
    middle, radii = np.asarray(center, dtype=float), np.asarray(half, dtype=float)
    return lambda p: (np.linalg.norm((p - middle) / radii, axis=-1) - 1.0) * radii.min()


def capsule(start: Sequence[float], end: Sequence[float], radii: tuple[float, float]) -> Field:
    """A round rod that tapers from one radius to the other."""
    a, axis = np.asarray(start, dtype=float), np.subtract(end, start)

    def field(p: Array) -> Array:
        share = np.clip((p - a) @ axis / (axis @ axis), 0.0, 1.0)
        return np.asarray(np.linalg.norm(p - a - share[..., None] * axis, axis=-1) - np.interp(share, (0, 1), radii))

    return field


def tube(axis: int, stations: Sequence[Sequence[float]], power: float = 2.0, rounding: float = 0.01) -> Field:
    """A tube along an axis through rings (position, centre u, centre v, half u, half v), its ends rounded.

    u and v are the other two axes in x, y, z order; power 2 gives ellipses, more gives squarer rings.
    """
    u, v = (k for k in range(3) if k != axis)
    table = np.asarray(stations, dtype=float)
    ring = PchipInterpolator(table[:, 0], table[:, 1:], axis=0)
    low, high = table[0, 0], table[-1, 0]

    def field(p: Array) -> Array:
        along = p[..., axis]
        cu, cv, hu, hv = np.moveaxis(ring(np.clip(along, low, high)), -1, 0)
        across = np.abs((p[..., u] - cu) / hu) ** power + np.abs((p[..., v] - cv) / hv) ** power
        side = (across ** (1.0 / power) - 1.0) * np.minimum(hu, hv)
        return intersection(rounding, lambda _: side, lambda _: np.maximum(along - high, low - along))(p)

    return field


def union(blend: float, *fields: Field) -> Field:
    """All of them, melted together where they come nearer than `blend` metres."""

    def melt(a: Array, b: Array) -> Array:
        overlap = np.maximum(blend - np.abs(a - b), 0.0) / max(blend, 1e-9)
        return np.asarray(np.minimum(a, b) - overlap * overlap * blend / 4.0)

    return lambda p: reduce(melt, (field(p) for field in fields))


def intersection(blend: float, *fields: Field) -> Field:
    """What is inside all of them, its edges rounded by `blend` metres."""
    inside = union(blend, *(_negated(field) for field in fields))
    return _negated(inside)


def difference(blend: float, field: Field, *holes: Field) -> Field:
    """What is inside a shape and in none of the holes."""
    return intersection(blend, field, *(_negated(hole) for hole in holes))


def swollen(field: Field, by: float) -> Field:
    """The shape grown by that many metres, all around."""
    return field if by == 0 else lambda p: field(p) - by


def ring(center: Sequence[float], axis: Sequence[float], radius: float, half: tuple[float, float]) -> Field:
    """A ring around an axis; half sizes of its cross-section away from and along the axis."""
    middle, out = np.asarray(center, dtype=float), np.asarray(axis, dtype=float) / np.linalg.norm(axis)

    def field(p: Array) -> Array:
        along = (p - middle) @ out
        away = np.linalg.norm(p - middle - along[..., None] * out, axis=-1) - radius
        return np.asarray((np.hypot(away / half[0], along / half[1]) - 1.0) * min(half))

    return field


def mirrored(field: Field) -> Field:
    """The shape on the left (+X) side on the right side too; it must not cross the middle."""
    return lambda p: field(np.concatenate([np.abs(p[..., :1]), p[..., 1:]], axis=-1))


def half_space(point: Sequence[float], normal: Sequence[float]) -> Field:
    """Everything behind a plane."""
    out = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    return lambda p: np.asarray((p - np.asarray(point, dtype=float)) @ out)


def _negated(field: Field) -> Field:
    return lambda p: -field(p)


def gradient(field: Field, points: Array) -> Array:
    """Slope of a field by central differences. (N, 3)."""
    step = 1e-4 * np.eye(3)
    return np.stack([(field(points + s) - field(points - s)) / 2e-4 for s in step], axis=-1)


def to_triangles(
    field: Field, low: Sequence[float], high: Sequence[float], cell: Sequence[float]
) -> tuple[Array, Faces]:
    """The surface inside a box as vertices (V, 3) and triangles (F, 3), counter-clockwise seen from outside.

    Surface nets (Gibson 1998): one vertex a grid cell that the surface crosses, then moved onto the surface.
    """
    counts = np.ceil(np.subtract(high, low) / np.asarray(cell)).astype(int) + 1
    index = np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1)
    value = field(np.asarray(low) + index * np.asarray(cell))
    inside = value < 0
    cells = _neighbourhood(inside)
    crossed = cells.any(axis=-1) & ~cells.all(axis=-1)
    number = np.full(crossed.shape, -1)
    number[crossed] = np.arange(np.count_nonzero(crossed))
    faces = np.concatenate([_quads(inside, number, axis) for axis in range(3)])
    vertices = np.asarray(low) + (np.argwhere(crossed) + _crossing_means(value)[crossed]) * np.asarray(cell)
    limit = 0.6 * float(np.max(cell))
    for _ in range(2):
        slope = gradient(field, vertices)
        step = -field(vertices)[:, None] * slope / np.maximum(np.sum(slope**2, axis=-1, keepdims=True), 1e-6)
        length = np.linalg.norm(step, axis=-1, keepdims=True)
        vertices = vertices + step * np.minimum(1.0, limit / np.maximum(length, 1e-12))
    return vertices, faces


def _neighbourhood(inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The eight corners of every cell. (X - 1, Y - 1, Z - 1, 8)."""
    x, y, z = (slice(0, -1), slice(1, None)), (slice(0, -1), slice(1, None)), (slice(0, -1), slice(1, None))
    return np.stack([inside[i, j, k] for i in x for j in y for k in z], axis=-1)


def _crossing_means(value: Array) -> Array:
    """Where the surface crosses a cell's edges, on average, from its low corner. (X - 1, Y - 1, Z - 1, 3)."""
    shape = tuple(n - 1 for n in value.shape)
    total, count = np.zeros((*shape, 3)), np.zeros(shape)
    for axis in range(3):
        u, v = (k for k in range(3) if k != axis)
        for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
            window = [slice(0, -1)] * 3
            window[u], window[v] = slice(i, value.shape[u] - 1 + i), slice(j, value.shape[v] - 1 + j)
            start = value[tuple(window)]
            window[axis] = slice(1, None)
            end = value[tuple(window)]
            crosses = (start < 0) != (end < 0)
            share = np.where(crosses, start / np.where(crosses, start - end, 1.0), 0.0)
            total[..., axis] += share
            total[..., u] += i * crosses
            total[..., v] += j * crosses
            count += crosses
    return np.asarray(total / np.maximum(count, 1)[..., None])


def _quads(inside: NDArray[np.bool_], number: NDArray[np.int64], axis: int) -> Faces:
    """Two triangles for every grid edge along an axis that crosses the surface: its four cells' vertices."""
    first = np.moveaxis(inside, axis, 0)
    cells = np.moveaxis(number, axis, 0)
    crossing = np.argwhere(first[:-1, 1:-1, 1:-1] != first[1:, 1:-1, 1:-1])
    a, b, c = crossing.T
    ring = np.stack([cells[a, b, c], cells[a, b + 1, c], cells[a, b + 1, c + 1], cells[a, b, c + 1]], axis=-1)
    outward = first[a, b + 1, c + 1]
    # Moving an axis to the front keeps the hand of x and z, and turns that of y.
    flipped = outward == (axis == 1)
    ring[flipped] = ring[flipped][:, ::-1]
    return np.concatenate([ring[:, [0, 1, 2]], ring[:, [0, 2, 3]]])
