"""The two lights of every picture, and maps of what they reach."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from motion_backend.rendering.light_values import Shading
from motion_backend.rendering.rasterizer import Camera, Real, empty_buffers
from motion_backend.rotations import Array

SHADOW_REACH = 3.2
"""Metres around the target that shadows are drawn for."""
SHADOW_BIAS = 0.02
"""Metres towards the light at which it is looked up, so that a surface does not shade itself."""


@dataclass(frozen=True)
class Lamp:
    """A light far away, and the map of what it reaches first."""

    direction: Array
    """Unit vector towards it."""
    pixels: int
    blur: float
    """Metres around a point that its share of light is taken from."""
    taps: Array
    """Where the map is read, in blur radii; each of a pixel's four samples turns them further. (N, 2)."""


SUN = Lamp(
    np.array([0.35, 0.86, 0.37]) / np.linalg.norm([0.35, 0.86, 0.37]),
    640,
    0.013,
    np.array([[0.9, 0.1], [-0.1, 0.9], [-0.9, -0.1], [0.1, -0.9], [0.35, 0.3], [-0.3, -0.35]]),
)
SKY = Lamp(
    np.array([0.0, 1.0, 0.0]),
    288,
    0.10,
    np.array([[0.2, 0.1], [0.9, 0.3], [0.1, 0.95], [-0.75, 0.55], [-0.7, -0.6], [0.35, -0.85]]),
)


@dataclass(frozen=True)
class ShadowMap:
    """What the light of a lamp meets first, around a camera's target."""

    lamp: Lamp
    view: Camera
    """A parallel view from the light."""
    depth: Real
    """The nearness of what it meets in every pixel. (pixels, pixels) float32."""

    @staticmethod
    def of(lamp: Lamp, corners: Array, camera: Camera) -> ShadowMap:
        """Of triangles (F, 3, 3)."""
        from motion_backend.rendering.depth_buffer import draw

        reach = SHADOW_REACH if camera.span is None else max(SHADOW_REACH, 0.8 * camera.span)
        x, y, z = (np.asarray(camera.target) + 6.0 * lamp.direction).tolist()
        view = Camera((x, y, z), camera.target, span=2 * reach)
        nearest, depth = empty_buffers((lamp.pixels, lamp.pixels))
        draw(view.project(view.view(corners), depth.shape), np.full(len(corners), 4), 0, nearest, depth)
        # Nothing casts a shadow on what lies beyond the map: points there read its border.
        depth[[0, -1]] = depth[:, [0, -1]] = -np.inf
        return ShadowMap(lamp, view, depth.astype(np.float32))

    @staticmethod
    def empty(lamp: Lamp, camera: Camera) -> ShadowMap:
        """Of nothing: all is lit."""
        return ShadowMap(lamp, Camera(camera.eye, camera.target, span=1.0), np.full((1, 1), -np.inf, dtype=np.float32))

    @cached_property
    def matrix(self) -> Array:
        """A point p in the map is matrix @ (p, 1): x, y and nearness. (3, 4)."""
        assert self.view.span is not None
        pixels = self.depth.shape[0]
        scale = pixels / self.view.span
        rows = self.view.axes * np.array([[scale], [-scale], [-1.0]])
        return np.column_stack([rows, np.array([pixels / 2, pixels / 2, 0.0]) - rows @ np.array(self.view.eye)])

    def places(self, points: Real) -> Array:
        """Where points (N, 3) are in the map: x, y and nearness. (N, 3)."""
        return np.asarray(points @ self.matrix[:, :3].T + self.matrix[:, 3])

    @cached_property
    def taps(self) -> Real:
        """Where it is read around a place, in pixels. (K, 2)."""
        assert self.view.span is not None
        return (self.lamp.taps * (self.lamp.blur * self.lamp.pixels / self.view.span)).astype(np.float32)

    @cached_property
    def dithered_taps(self) -> Real:
        """The same, turned by quarters for each of four pixels in a square, so that edges are dithered and not banded.
        (4, K, 2)."""
        quarter = np.array([[0, 1], [-1, 0]], dtype=np.float32)
        return np.stack([self.taps, self.taps @ quarter, -self.taps, -self.taps @ quarter])

    @property
    def margin(self) -> int:
        """Pixels around a place that its taps reach."""
        return int(np.ceil(np.hypot(*self.taps.T).max()))

    @cached_property
    def shading(self) -> Shading:
        """The same for compiled code."""
        return self.shading_of(self.depth, self.matrix)

    def shading_of(self, depth: Real, matrix: Array) -> Shading:
        """The same for another map of the lamp: a part of it, with more in it."""
        from motion_backend.rendering.surface_light import extremes

        return Shading(matrix, depth, *extremes(depth, self.margin), self.taps, self.lamp.direction)
