"""Cameras, and which pixels triangles cover from there: spans of rows, then fragments, all of a scene at once.

Frame: Y up, metres. Pixels count from a picture's top left corner; `nearness` grows towards the eye and is linear
across a triangle in the picture: one over depth, or minus depth in a parallel view.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array

Real = NDArray[np.floating[Any]]
Ints = NDArray[np.int64]
Point3 = tuple[float, float, float]

NEAR = 0.05
"""Metres in front of the eye from which things are seen."""


@dataclass(frozen=True)
class Camera:
    """Where the picture is taken from."""

    eye: Point3
    target: Point3
    fov: float = 0.6
    """Vertical opening in radians."""
    span: float | None = None
    """Height of the picture in metres, for a parallel view; `fov` is then not read."""

    @cached_property
    def axes(self) -> Array:
        """Rows right, up and forward. (3, 3)."""
        forward = np.subtract(self.target, self.eye)
        forward = forward / np.linalg.norm(forward)
        up = np.array([0.0, 0.0, -1.0]) if abs(forward[1]) > 0.999 else np.array([0.0, 1.0, 0.0])
        right = np.cross(forward, up)
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), forward])

    def view(self, points: Real) -> Real:
        """World to camera: right, up, depth. (..., 3), as exact as the points are."""
        axes = self.axes.astype(points.dtype)
        return np.asarray(points @ axes.T - (axes @ np.asarray(self.eye)).astype(points.dtype))

    def project(self, viewed: Real, size: tuple[int, int]) -> Real:
        """From what `view` gives to (x, y, nearness). (..., 3)."""
        width, height = size
        depth = viewed[..., 2]
        if self.span is not None:
            scale, nearness = np.full_like(depth, height / self.span), -depth
        else:
            nearness = 1.0 / depth
            scale = 0.5 * height / np.tan(0.5 * self.fov) * nearness
        across, down = 0.5 * width + viewed[..., 0] * scale, 0.5 * height - viewed[..., 1] * scale
        return np.stack([across, down, nearness], axis=-1, dtype=viewed.dtype)

    def unproject(self, x: Real, y: Real, nearness: Real, size: tuple[int, int]) -> Real:
        """The inverse of `project` and `view` together. (..., 3) in the world."""
        width, height = size
        if self.span is not None:
            depth, scale = -nearness, np.full_like(nearness, self.span / height)
        else:
            depth = 1.0 / nearness
            scale = 2.0 * np.tan(0.5 * self.fov) / height * depth
        viewed = np.stack([(x - 0.5 * width) * scale, (0.5 * height - y) * scale, depth], axis=-1, dtype=x.dtype)
        return np.asarray(viewed @ self.axes.astype(x.dtype) + np.asarray(self.eye, dtype=x.dtype))


def orbit(target: Point3, distance: float, yaw: float, pitch: float, fov: float = 0.6) -> Camera:
    """A camera that far from the target, standing at that yaw around it and looking down by pitch."""
    level = distance * np.cos(pitch)
    offset = (level * np.sin(yaw), distance * np.sin(pitch), level * np.cos(yaw))
    eye = tuple(float(t + o) for t, o in zip(target, offset, strict=True))
    return Camera((eye[0], eye[1], eye[2]), target, fov)


def clip(viewed: Real, camera: Camera) -> tuple[Real, Ints]:
    """Triangles cut off at the near plane, and which one each came from."""
    index = np.arange(len(viewed))
    if camera.span is not None:
        return viewed, index
    behind = (viewed[..., 2] < NEAR).sum(axis=1)
    pieces, sources = [viewed[behind == 0]], [index[behind == 0]]
    for f in np.flatnonzero((behind > 0) & (behind < 3)):
        polygon: list[Real] = []
        for a, b in zip(viewed[f], np.roll(viewed[f], -1, axis=0), strict=True):
            if a[2] >= NEAR:
                polygon.append(a)
            if (a[2] < NEAR) != (b[2] < NEAR):
                polygon.append(a + (b - a) * (NEAR - a[2]) / (b[2] - a[2]))
        fan = np.array([[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)])
        pieces.append(fan)
        sources.append(np.full(len(fan), f))
    return np.concatenate(pieces), np.concatenate(sources)


def fragments(screen: Real, width: int, height: int) -> tuple[Ints, Ints, Real]:
    """Pixel, triangle and nearness of everything every triangle covers. screen: (F, 3, 3) as from `Camera.project`."""
    x, y, near = screen[..., 0], screen[..., 1], screen[..., 2]
    dx, dy = np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y
    area = dx[:, 0] * dy[:, 1] - dy[:, 0] * dx[:, 1]
    sign = np.where(area < 0, -1.0, 1.0)[:, None]
    # Inside means a·x + b·y + c >= 0 for all three edges.
    a, b = -dy * sign, dx * sign
    c = -(a * x + b * y)
    first = np.clip(np.ceil(y.min(axis=1) - 0.5), 0, height).astype(np.int64)
    last = np.clip(np.ceil(y.max(axis=1) - 0.5), 0, height).astype(np.int64)
    outside = (x.max(axis=1) < 0) | (x.min(axis=1) > width) | (np.abs(area) < 1e-9)
    face, row = _spread(np.where(outside, 0, last - first), first)
    middle = row + 0.5
    left, right = np.zeros(len(face)), np.full(len(face), float(width))
    for edge in range(3):
        slope, rest = a[face, edge], b[face, edge] * middle + c[face, edge]
        crossing = -rest / np.where(slope == 0, 1.0, slope)
        left = np.where(slope > 0, np.maximum(left, crossing), left)
        right = np.where(slope < 0, np.minimum(right, crossing), right)
        right = np.where((slope == 0) & (rest < 0), -1.0, right)
    start = np.ceil(left - 0.5).astype(np.int64)
    span, column = _spread(np.maximum(np.ceil(right - 0.5).astype(np.int64) - start, 0), start)
    safe = np.where(np.abs(area) < 1e-9, 1.0, area)
    near1, near2 = near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]
    by_x = (near1 * -dy[:, 2] - near2 * dy[:, 0]) / safe
    by_y = (near2 * dx[:, 0] - near1 * -dx[:, 2]) / safe
    line = near[face, 0] + by_x[face] * (0.5 - x[face, 0]) + by_y[face] * (middle - y[face, 0])
    return row[span] * width + column, face[span], line[span] + by_x[face][span] * column


def _spread(counts: Ints, starts: Ints) -> tuple[Ints, Ints]:
    """Repeat each index as often as counted; beside it a number that runs up from its start."""
    index = np.repeat(np.arange(len(counts)), counts)
    run = np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
    return index, run + starts[index]
