"""The box of things seen from above: the upright box around scanned points, and its turn about the vertical."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike

from scene_graphs.layout import Array, Point2, Point3

LESS: Final = 0.9
"""A turned rectangle is taken where it has at most this share of the area of the one along the axes."""
THINNEST: Final = 0.01
"""What was scanned as a plane gets this thickness, in metres."""
MANY: Final = 200
"""Corners of a hull that is made simpler until it has no more: it is turned in every direction."""


class Rectangle(NamedTuple):
    """A rectangle on the floor."""

    middle: Point2
    width: float
    depth: float
    yaw: float
    """Of the width's axis: at 0 the width lies along x, the depth along z."""

    @property
    def long_axis(self) -> tuple[Point2, Point2]:
        """The two ends of the line through the middle along the longer side."""
        along_width = self.width >= self.depth
        half = max(self.width, self.depth) / 2
        way = (np.cos(self.yaw), -np.sin(self.yaw)) if along_width else (np.sin(self.yaw), np.cos(self.yaw))
        (x, z), dx, dz = self.middle, half * float(way[0]), half * float(way[1])
        return (x - dx, z - dz), (x + dx, z + dz)


def rectangle_around(plan: ArrayLike) -> Rectangle:
    """The rectangle of least area around points [x, z], along the axes unless turning it saves area. (N, 2), N >= 1."""
    points = np.asarray(plan, dtype=float).reshape(-1, 2)
    around = shapely.convex_hull(shapely.multipoints(points))
    hull = shapely.get_coordinates(around)
    tolerance = THINNEST / 2
    while len(hull) > MANY:
        hull, tolerance = shapely.get_coordinates(shapely.simplify(around, tolerance)), 4 * tolerance
    steps = np.diff(hull, axis=0)
    angles = np.concatenate([[0.0], np.arctan2(steps[:, 1], steps[:, 0]) % (np.pi / 2)])
    axes = np.stack([np.cos(angles), np.sin(angles)], axis=1)  # (angles, 2)
    along = hull @ axes.T
    across = hull @ np.stack([-axes[:, 1], axes[:, 0]])
    lows, highs = np.stack([along.min(0), across.min(0)]), np.stack([along.max(0), across.max(0)])  # (2, angles)
    areas = np.prod(highs - lows, axis=0)
    best = int(np.argmin(areas))
    if areas[0] * LESS <= areas[best]:
        best = 0
    (u, v), (w, d) = (lows[:, best] + highs[:, best]) / 2, highs[:, best] - lows[:, best]
    cos, sin = axes[best]
    return Rectangle((float(u * cos - v * sin), float(u * sin + v * cos)), float(w), float(d), -float(angles[best]))


class UprightBox(NamedTuple):
    """A box that stands upright, as `Placed` wants it."""

    position: Point3
    """Centre of the bottom face."""
    size: Point3
    yaw: float = 0.0

    @property
    def corners(self) -> Array:
        """The eight corners. (8, 3)."""
        w, h, d = self.size
        local = np.array([[x, y, z] for x in (-w / 2, w / 2) for y in (0.0, h) for z in (-d / 2, d / 2)])
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        turn = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
        corners: Array = local @ turn + np.asarray(self.position)
        return corners


def box_around(points: Array) -> UprightBox:
    """The upright box of least plan area around points [x, y, z], Y up. (N, 3), N >= 1."""
    middle, width, depth, yaw = rectangle_around(points[:, [0, 2]])
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    size = (max(width, THINNEST), max(high - low, THINNEST), max(depth, THINNEST))
    return UprightBox((middle[0], low, middle[1]), size, yaw)
