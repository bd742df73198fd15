"""Meshes and the few shapes everything is drawn with: bevelled blocks, turned profiles, blades, flat polygons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from scene_graphs.layout import Array, Point2, Point3

Faces = NDArray[np.int32]
Color = tuple[float, float, float, float]
Shape = tuple[Array, Faces]
"""Vertices (V, 3) and triangles (F, 3), counter-clockwise seen from outside."""


@dataclass(frozen=True)
class Mesh:
    """Triangles of one look, in the frame of whoever asked for them (metres, Y up)."""

    name: str
    vertices: NDArray[np.float32]
    """(V, 3)."""
    faces: Faces
    """(F, 3), counter-clockwise seen from outside."""
    color: Color
    """Red, green, blue, alpha; 0 to 1, sRGB."""
    roughness: float = 0.8


def block(low: Point3, high: Point3, bevel: float = 0.0) -> Shape:
    """A box between two corners; with a bevel its edges are cut off that far (at most 45 % of the thinnest side)."""
    center, half = np.add(low, high) / 2, np.subtract(high, low) / 2
    cut = min(bevel, 0.9 * float(half.min()))
    if cut < 1e-3:
        signs, faces = _box_template()
        return center + signs * half, faces
    signs, inset, faces = _bevel_template()
    return center + signs * (half - cut * inset), faces


def turned(profile: Sequence[Point2], center: Point2 = (0.0, 0.0), segments: int = 12, squash: float = 1.0) -> Shape:
    """A profile of (radius, y) points from bottom to top turned about a vertical axis; closed where the radius is 0.

    `squash` scales z, for elliptic things.
    """
    angle = np.arange(segments) * 2 * np.pi / segments
    rings = [
        np.stack([r * np.sin(angle), np.full(segments, y), squash * r * np.cos(angle)], axis=1) for r, y in profile
    ]
    vertices = np.concatenate(rings) + np.array([center[0], 0.0, center[1]])
    here, following = np.arange(segments), (np.arange(segments) + 1) % segments
    faces = []
    for level in range(len(profile) - 1):
        a, b = level * segments, (level + 1) * segments
        if profile[level][0] > 0:
            faces.append(np.stack([a + here, a + following, b + following], axis=1))
        if profile[level + 1][0] > 0:
            faces.append(np.stack([a + here, b + following, b + here], axis=1))
    return vertices, np.concatenate(faces).astype(np.int32)


def cylinder(low: Point3, high: Point3, segments: int = 12, taper: float = 1.0) -> Shape:
    """The upright cylinder (or cone stump: `taper` is the upper radius over the lower) inscribed in a box."""
    radius, squash = (high[0] - low[0]) / 2, (high[2] - low[2]) / max(high[0] - low[0], 1e-9)
    bottom, top = radius * min(1.0, 1 / taper), radius * min(1.0, taper)
    profile = [(0.0, low[1]), (bottom, low[1]), (top, high[1]), (0.0, high[1])]
    return turned(profile, ((low[0] + high[0]) / 2, (low[2] + high[2]) / 2), segments, squash)


def blade(root: Array, tip: Array, width: float, thickness: float = 0.006) -> Shape:
    """A leaf: a long flat double pyramid from root to tip, widest in the middle, sagging a little."""
    along = tip - root
    across = np.cross(along, (0.0, 1.0, 0.0))
    across = width / 2 * across / max(float(np.linalg.norm(across)), 1e-9)
    middle = root + 0.55 * along + np.array([0.0, 0.12 * float(np.linalg.norm(along)), 0.0])
    up = np.array([0.0, thickness, 0.0])
    vertices = np.stack([root, middle + across, middle + up, middle - across, middle - up, tip])
    faces = [(0, 1, 2), (0, 2, 3), (5, 2, 1), (5, 3, 2), (0, 4, 1), (0, 3, 4), (5, 1, 4), (5, 4, 3)]
    return vertices, np.array(faces, dtype=np.int32)


def flat(corners: Sequence[Point2] | Array, height: float = 0.0) -> Shape:
    """A simple polygon of [x, z] corners lying at a height, seen from above; cut into triangles by clipping ears."""
    points = np.asarray(corners, dtype=float)
    if _twice_area(points) > 0:
        points = points[::-1]
    vertices = np.stack([points[:, 0], np.full(len(points), height), points[:, 1]], axis=1)
    return vertices, np.array(_ears(points), dtype=np.int32).reshape(-1, 3)


def merge(shapes: Sequence[Shape]) -> Shape:
    """Several shapes as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in shapes[:-1])])
    faces = [faces + start for (_, faces), start in zip(shapes, starts, strict=True)]
    return np.concatenate([vertices for vertices, _ in shapes]), np.concatenate(faces).astype(np.int32)


@lru_cache(maxsize=1)
def _box_template() -> tuple[Array, Faces]:
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return signs, _outward(signs, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


@lru_cache(maxsize=1)
def _bevel_template() -> tuple[Array, Array, Faces]:
    """Signs (24, 3), which axes the bevel insets (24, 3), and faces: three vertices at each corner, one a side."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    keys = [(corner, axis) for corner in corners for axis in range(3)]
    index = {key: number for number, key in enumerate(keys)}
    signs = np.array([corner for corner, _ in keys], dtype=float)
    inset = np.array([[float(axis != other) for other in range(3)] for _, axis in keys])
    faces = [tuple(index[corner, axis] for axis in range(3)) for corner in corners]
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            ring = [index[_corner(axis, sign, one, p, two, q), axis] for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            faces += [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
            for other in (-1, 1):
                a, b = (_corner(axis, side, one, sign, two, other) for side in (-1, 1))
                faces += [(index[a, one], index[b, one], index[b, two]), (index[a, one], index[b, two], index[a, two])]
    return signs, inset, _outward(signs * (1 - 0.2 * inset), faces)


def _corner(i: int, a: int, j: int, b: int, k: int, c: int) -> tuple[int, int, int]:
    values = {i: a, j: b, k: c}
    return (values[0], values[1], values[2])


def _outward(vertices: Array, faces: Sequence[Sequence[int]]) -> Faces:
    """Turn every triangle of a convex shape about the origin so that it faces out."""
    turned_faces = []
    for a, b, c in faces:
        normal = np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
        turned_faces.append((a, b, c) if normal @ (vertices[a] + vertices[b] + vertices[c]) > 0 else (a, c, b))
    return np.array(turned_faces, dtype=np.int32)


def _ears(points: Array) -> list[tuple[int, int, int]]:
    """Triangles of a polygon that runs counter-clockwise seen from above (negative area in [x, z])."""
    left, faces = list(range(len(points))), []
    while len(left) > 3:
        for spot in range(len(left)):
            a, b, c = left[spot - 1], left[spot], left[(spot + 1) % len(left)]
            if _turn(points[a], points[b], points[c]) < 0 and not any(
                _is_within(points[p], points[a], points[b], points[c]) for p in left if p not in (a, b, c)
            ):
                faces.append((a, b, c))
                del left[spot]
                break
        else:
            break
    return [*faces, (left[0], left[1], left[2])]


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _is_within(p: Array, a: Array, b: Array, c: Array) -> bool:
    return all(_turn(*pair, p) <= 0 for pair in ((a, b), (b, c), (c, a)))


def _twice_area(points: Array) -> float:
    following = np.roll(points, -1, axis=0)
    return float((points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]).sum())
