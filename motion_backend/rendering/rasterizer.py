"""Cameras: where triangles are in the picture that is taken from there.

Frame: Y up, metres. Pixels count from a picture's top left corner; `nearness` grows towards the eye and is linear
across a triangle in the picture: one over depth, or minus depth in a parallel view.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array

Real = NDArray[np.floating[Any]]
Ints = NDArray[np.int64]
Point3 = tuple[float, float, float]

NEAR = 0.05
"""Metres in front of the eye from which things are seen."""


class Lens(NamedTuple):
    """A camera as compiled code reads it: what is seen at (x, y, depth) lies at eye + (right, up, depth) @ axes."""

    eye: Array
    """(3,)."""
    axes: Array
    """Rows right, up and forward. (3, 3)."""
    middle: Array
    """Pixels to the middle of the picture, across and down. (2,)."""
    scale: float
    """Metres a pixel is wide: at a depth of one metre, or anywhere in a parallel view."""
    parallel: bool
    target: Array
    """(3,)."""


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

    def lens(self, size: tuple[int, int]) -> Lens:
        """The same for pictures (width, height) of that size."""
        parallel = self.span is not None
        across = self.span if self.span is not None else 2.0 * float(np.tan(0.5 * self.fov))
        middle = np.array([0.5 * size[0], 0.5 * size[1]])
        return Lens(np.array(self.eye), self.axes, middle, across / size[1], parallel, np.array(self.target))


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
        corners = [*viewed[f]]
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            if a[2] >= NEAR:
                polygon.append(a)
            if (a[2] < NEAR) != (b[2] < NEAR):
                polygon.append(a + (b - a) * (NEAR - a[2]) / (b[2] - a[2]))
        fan = np.array([[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)])
        pieces.append(fan)
        sources.append(np.full(len(fan), f))
    return np.concatenate(pieces), np.concatenate(sources)


def empty_buffers(size: tuple[int, int]) -> tuple[Ints, Array]:
    """No triangle (-1), infinitely far away, in every pixel: (height, width) each."""
    width, height = size
    return np.full((height, width), -1), np.full((height, width), -np.inf)
