"""What a camera that stands still sees of a home, drawn once, and a body drawn into it frame after frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from motion_backend.rendering.film_picture import Planes, split
from motion_backend.rendering.light_values import Cutting, Drawn, Shading
from motion_backend.rendering.rasterizer import Camera, Real
from motion_backend.rendering.renderer import FILL, STUDIO, Solid, Still, to_linear, to_srgb
from motion_backend.rendering.shadow_map import ShadowMap

SHADES = 8192
"""Steps of linear light that become bytes; finer than a byte's at its darkest."""
LIFTED, DARK = 0.7, 0.10
"""By which share the darkest colours of a body are brighter in a film, and how bright those are whose share is a third
of that: on a screen one would see no face in them."""
NEAR = 0.1
"""Metres before the eye; of a body the faces that are nearer, or behind it, are not drawn."""


@dataclass(frozen=True)
class Backdrop:
    """A still picture of a home, and what is needed to put a body into it."""

    planes: Planes
    """It as a film's picture, with nobody in it; see `film_picture`."""
    camera: Camera
    nearness: Real
    """Of what is nearest, over twice the size; minus infinity for nothing. (2 height, 2 width) float32."""
    maps: tuple[ShadowMap, ShadowMap]
    """What the sun and the sky reach."""
    tiles: Real
    """Its light; see `film_kernel.to_tiles`."""
    bounds: tuple[Real, Real]
    """Where in the maps of the sun and the sky each tile of it lies; see `film_kernel.tile_bounds`."""

    @staticmethod
    def of(solids: Sequence[Solid], camera: Camera, size: tuple[int, int]) -> Backdrop:
        """The picture (width, height, both even) of solids that stay where they are, under a studio's sky."""
        from motion_backend.rendering.film_kernel import IN_SKY, IN_SUN, tile_bounds, to_planes, to_tiles

        still = Still.of(solids, camera, size, ground=None, light=STUDIO)
        planes = np.empty((size[1] * 3 // 2, size[0]), dtype=np.uint8)
        light = np.ascontiguousarray(np.moveaxis(still.lit.color, -1, 0))
        to_planes(light, _bytes_of_light(), split(planes), 0, 0, size[1], size[0])
        tiles = to_tiles(still.lit)
        bounds = (tile_bounds(tiles, IN_SUN), tile_bounds(tiles, IN_SKY))
        return Backdrop(planes, camera, still.nearness.astype(np.float32), still.maps, tiles, bounds)

    @property
    def size(self) -> tuple[int, int]:
        """Pixels across and down."""
        height, width = split(self.planes)[0].shape
        return width, height

    def with_body(self, body: Solid) -> Planes:
        """The picture with a smooth closed body in it."""
        from motion_backend.rendering.film_kernel import TILE, put_body

        sun, sky = cuttings = (_cutting(self.maps[0], body), _cutting(self.maps[1], body))
        planes = self.planes.copy()
        drawn, part = self._drawn(body, cuttings), np.empty((5, TILE, TILE), dtype=np.float32)
        put_body(split(planes), self.tiles, self.bounds, (sun, sky), drawn, _bytes_of_light(), part)
        return planes

    def _drawn(self, body: Solid, cuttings: tuple[Cutting, Cutting]) -> Drawn:
        """Which of its faces is nearest, in the part of the picture it covers, and the light on it."""
        from motion_backend.rendering.depth_buffer import draw_body
        from motion_backend.rendering.film_kernel import body_light, light_planes

        assert body.normals is not None
        camera, (width, height) = self.camera, self.size
        faces = body.faces
        colors = _lifted(to_linear(np.broadcast_to(np.asarray(body.color)[..., :3], (len(faces), 3))))
        viewed = camera.view(np.asarray(body.vertices, dtype=np.float64))
        points = ahead = camera.project(viewed, (2 * width, 2 * height))
        if viewed[:, 2].min() < NEAR:  # the feet of a sleeper whose face is looked at from near
            seen = (viewed[faces, 2] >= NEAR).all(axis=1)
            faces, colors = faces[seen], colors[seen]
            if not len(faces):
                return Drawn(np.zeros((0, 0), dtype=np.int32), np.zeros(2, dtype=np.int64), np.zeros((0, 3)), colors)
            ahead = points[np.unique(faces)]
        first, last = _extent(ahead)
        low = np.clip(np.floor(first / 2), 0, self.size).astype(np.int64)
        high = np.clip(np.ceil(last / 2), 0, self.size).astype(np.int64)
        if (high <= low).any():
            return Drawn(np.zeros((0, 0), dtype=np.int32), low, np.zeros((0, 3)), colors)
        points[:, :2] -= 2 * low
        best = self.nearness[2 * low[1] : 2 * high[1], 2 * low[0] : 2 * high[0]].copy()
        nearest = np.full(best.shape, -1, dtype=np.int32)
        draw_body(points, faces, nearest, best)
        sun, sky = (_with_body(found, cutting) for found, cutting in zip(self.maps, cuttings, strict=True))
        light = np.empty(len(points), dtype=np.float32)
        body_light(body.vertices, body.normals, np.array(camera.eye), sun, sky, FILL, light)
        planes = np.zeros((len(faces), 3))
        light_planes(points, faces, light, planes)
        return Drawn(nearest, low, planes, colors)


def _lifted(colors: Real) -> Real:
    """Linear colours (F, 3) with their dark ones a little brighter."""
    bright = colors.max(axis=1, keepdims=True)
    return np.asarray(colors * (1.0 + LIFTED * np.exp(-bright / DARK)), dtype=np.float32)


def _cutting(found: ShadowMap, body: Solid) -> Cutting:
    """The part of a lamp's map that a body alone covers."""
    from motion_backend.rendering.depth_buffer import draw_body
    from motion_backend.rendering.surface_light import extremes

    points = found.places(np.asarray(body.vertices, dtype=np.float64))
    pixels, margin = found.depth.shape[0], found.margin
    first, last = _extent(points)
    low = np.clip(np.floor(first) - margin, 0, pixels - 1).astype(np.int64)
    high = np.clip(np.ceil(last) + margin, low + 1, pixels).astype(np.int64)
    depth = np.full((high - low)[::-1], -np.inf, dtype=np.float32)
    points[:, :2] -= low
    draw_body(points, body.faces, np.empty(depth.shape, dtype=np.int32), depth)
    return Cutting(low, depth, *extremes(depth, margin), found.dithered_taps)


def _extent(points: Real) -> tuple[Real, Real]:
    """Between which x and y points (V, 3) lie. (2,) each."""
    flat = np.ascontiguousarray(points[:, :2].T)  # Along rows that lie together numpy looks many times as fast.
    return flat.min(axis=1), flat.max(axis=1)


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
