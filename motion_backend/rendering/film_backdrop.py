"""What a camera that stands still sees of a home, drawn once, and a body drawn into it frame after frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from motion_backend.rendering.film_picture import Planes, split
from motion_backend.rendering.light_values import Cutting, Drawn, Shading
from motion_backend.rendering.rasterizer import Camera, Real, empty_buffers
from motion_backend.rendering.renderer import PALETTE, Solid, Still, to_linear, to_srgb
from motion_backend.rendering.shadow_map import ShadowMap

SHADES = 8192
"""Steps of linear light that become bytes; finer than a byte's at its darkest."""
NEAR = 0.1
"""Metres before the eye where a body is too near to be drawn."""


@dataclass(frozen=True)
class Backdrop:
    """A still picture of a home, and what is needed to put a body into it."""

    still: Still
    planes: Planes
    """The same as a film's picture, with nobody in it; see `film_picture`."""
    bounds: tuple[Real, Real]
    """Where in the maps of the sun and the sky each tile of it lies; see `film_kernel.tile_bounds`."""

    @staticmethod
    def of(solids: Sequence[Solid], camera: Camera, size: tuple[int, int]) -> Backdrop:
        """The picture (width, height, both even) of solids that stay where they are."""
        from motion_backend.rendering.film_kernel import tile_bounds, to_planes

        still = Still.of(solids, camera, size)
        planes = np.empty((size[1] * 3 // 2, size[0]), dtype=np.uint8)
        to_planes(still.lit.color, _bytes_of_light(), split(planes), 0, 0, size[1], size[0])
        return Backdrop(still, planes, (tile_bounds(still.lit.in_sun), tile_bounds(still.lit.in_sky)))

    @property
    def size(self) -> tuple[int, int]:
        """Pixels across and down."""
        height, width = self.still.lit.color.shape[:2]
        return width, height

    def with_body(self, body: Solid) -> Planes:
        """The picture with a smooth closed body in it."""
        from motion_backend.rendering.film_kernel import TILE, put_body

        sun, sky = cuttings = (_cutting(self.still.maps[0], body), _cutting(self.still.maps[1], body))
        planes = self.planes.copy()
        drawn, part = self._drawn(body, cuttings), np.empty((TILE, TILE, 3), dtype=np.float32)
        put_body(split(planes), self.still.lit, self.bounds, (sun, sky), drawn, _bytes_of_light(), part)
        return planes

    def _drawn(self, body: Solid, cuttings: tuple[Cutting, Cutting]) -> Drawn:
        """Which of its faces is nearest, in the part of the picture it covers, and the light on it."""
        from motion_backend.rendering.depth_buffer import draw_body
        from motion_backend.rendering.film_kernel import body_light

        assert body.normals is not None
        camera, (width, height) = self.still.camera, self.size
        faces = body.faces
        colors = to_linear(np.broadcast_to(np.asarray(body.color)[..., :3], (len(faces), 3))).astype(np.float32)
        viewed = camera.view(np.asarray(body.vertices, dtype=np.float64))
        points = camera.project(viewed, (2 * width, 2 * height))
        low = np.clip(np.floor(points.min(axis=0)[:2] / 2), 0, self.size).astype(np.int64)
        high = np.clip(np.ceil(points.max(axis=0)[:2] / 2), 0, self.size).astype(np.int64)
        if viewed[:, 2].min() < NEAR or (high <= low).any():
            nothing = np.zeros((0, 0), dtype=np.int64)
            return Drawn(nothing, low, points, faces, np.zeros(len(points), dtype=np.float32), colors)
        points[:, :2] -= 2 * low
        best = self.still.nearness[2 * low[1] : 2 * high[1], 2 * low[0] : 2 * high[0]].copy()
        nearest = np.full(best.shape, -1)
        draw_body(points, faces, nearest, best)
        sun, sky = (_with_body(found, cutting) for found, cutting in zip(self.still.maps, cuttings, strict=True))
        light = np.empty(len(points), dtype=np.float32)
        body_light(body.vertices, body.normals, np.array(camera.eye), sun, sky, PALETTE, light)
        return Drawn(nearest, low, points, faces, light, colors)


def _cutting(found: ShadowMap, body: Solid) -> Cutting:
    """The part of a lamp's map that a body alone covers."""
    from motion_backend.rendering.depth_buffer import draw_body
    from motion_backend.rendering.surface_light import extremes

    points = found.places(np.asarray(body.vertices, dtype=np.float64))
    pixels, margin = found.depth.shape[0], found.margin
    low = np.clip(np.floor(points.min(axis=0)[:2]) - margin, 0, pixels - 1).astype(np.int64)
    high = np.clip(np.ceil(points.max(axis=0)[:2]) + margin, low + 1, pixels).astype(np.int64)
    nearest, depth = empty_buffers((int(high[0] - low[0]), int(high[1] - low[1])))
    points[:, :2] -= low
    draw_body(points, body.faces, nearest, depth)
    return Cutting(low, depth, extremes(depth, margin)[0], found.taps)


def _with_body(found: ShadowMap, cutting: Cutting) -> Shading:
    """The same part of the map with the home and the body in it."""
    low, high = cutting.corner[::-1], cutting.corner[::-1] + cutting.depth.shape
    both = np.maximum(cutting.depth, found.depth[low[0] : high[0], low[1] : high[1]])
    matrix = found.matrix.copy()
    matrix[:2, 3] -= cutting.corner
    return found.shading_of(both, matrix)


@cache
def _bytes_of_light() -> Real:
    return (255 * to_srgb(np.linspace(0, 1, SHADES))).astype(np.float32)
