"""What a camera that stands still sees of a home, drawn once, and a body drawn into it frame after frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from motion_backend.rendering.rasterizer import Camera, Ints, Real, empty_buffers
from motion_backend.rendering.renderer import (
    BOUNCE_LIGHT,
    CAMERA_LIGHT,
    HORIZON,
    OPEN_SKY,
    SHADOW_OFFSET,
    SKY_LIGHT,
    SUN_LIGHT,
    Image,
    Samples,
    Solid,
    light,
    shade,
    to_linear,
    to_srgb_bytes,
    turned_to_us,
)
from motion_backend.rendering.shadow_map import SHADOW_BIAS, SKY, SUN, ShadowMap
from motion_backend.rotations import Array

SHADES = 8192
"""Steps of linear light that become bytes; finer than a byte's at its darkest."""
MARGIN = 3
"""Pixels around a body's shadow that its blurred edge reaches."""


@dataclass(frozen=True)
class _Light:
    """One lamp's part in a still picture."""

    map: ShadowMap
    added: Real
    """What of the picture's linear light comes from it. (height, width, 3)."""
    places: Real
    """Where in its map every pixel's surface is. (height, width, 3)."""


@dataclass(frozen=True)
class _Drawn:
    """A body in the picture."""

    nearest: Ints
    """Its faces where they are nearest, else -1; four samples a pixel. (2 h, 2 w)."""
    corner: Ints
    """The pixel in their upper left, x and y."""
    screen: Real
    """Where all its faces are, in samples. (F, 3, 3)."""


@dataclass(frozen=True)
class Backdrop:
    """A still picture of a home, and what is needed to put a body into it."""

    camera: Camera
    color: Real
    """Linear. (height, width, 3) float32."""
    picture: Image
    """The same in bytes, with nobody in it. (height, width, 3) uint8 sRGB."""
    nearness: Array
    """Over twice the size. (2 height, 2 width)."""
    lights: tuple[_Light, _Light]
    """The sun and the sky."""

    @staticmethod
    def of(solids: Sequence[Solid], camera: Camera, size: tuple[int, int]) -> Backdrop:
        """The picture (width, height) of solids that stay where they are."""
        seen = Samples.of(solids, camera, size)
        sun, sky = light(seen)
        full = shade(seen, sun, sky)
        dark = shade(seen, np.zeros_like(sun), sky), shade(seen, sun, np.full_like(sky, OPEN_SKY))
        casting = seen.scene.corners[(seen.scene.opacity >= 1) & seen.scene.casts]
        nothing = np.zeros(3, dtype=np.float32)
        lights = []
        for lamp, without in zip((SUN, SKY), dark, strict=True):
            found = ShadowMap.of(lamp, casting, camera)
            places = seen.spread(found.places(seen.points), np.full(3, -np.inf))
            lights.append(_Light(found, seen.spread(full - without, nothing), places))
        color = seen.spread(full, to_linear(HORIZON))
        return Backdrop(camera, color, to_srgb_bytes(color), seen.nearness, (lights[0], lights[1]))

    @property
    def size(self) -> tuple[int, int]:
        """Pixels across and down."""
        height, width = self.color.shape[:2]
        return width, height

    def with_body(self, body: Solid) -> Image:
        """The picture with a smooth closed body in it. (height, width, 3) uint8 sRGB."""
        from motion_backend.rendering.film_kernel import blend_body, cast_shadow, to_bytes

        cuttings = [_cutting(one.map, body) for one in self.lights]
        drawn = self._nearest(body)
        touched = self._touched(cuttings, drawn)
        out = self.color[touched].copy()
        for one, (corner, depth) in zip(self.lights, cuttings, strict=True):
            cast_shadow(out, one.added[touched], one.places[touched], corner, depth, one.map.taps, SHADOW_BIAS)
        if drawn is not None:
            colors = to_linear(np.broadcast_to(np.asarray(body.color)[..., :3], (len(body.faces), 3)))
            offset = np.array([touched[1].start, touched[0].start])
            brightness = self._brightness(body, cuttings)[body.faces]
            screen = drawn.screen - 2.0 * np.append(offset, 0)
            blend_body(out, drawn.nearest, drawn.corner - offset, screen, brightness, colors.astype(np.float32))
        picture = self.picture.copy()
        to_bytes(out, _bytes_of_light(), picture[touched])
        return picture

    def _touched(self, cuttings: Sequence[tuple[Ints, Array]], drawn: _Drawn | None) -> tuple[slice, slice]:
        """Rows and columns in which the body or its shadow may be."""
        from motion_backend.rendering.film_kernel import shadow_bounds

        boxes = [shadow_bounds(one.places, *cutting) for one, cutting in zip(self.lights, cuttings, strict=True)]
        if drawn is not None:
            size = np.array(drawn.nearest.shape)[::-1] // 2
            boxes.append(np.concatenate([drawn.corner, drawn.corner + size]))
        left, top = np.min(boxes, axis=0)[:2].tolist()
        right, bottom = np.max(boxes, axis=0)[2:].tolist()
        return slice(min(top, bottom), bottom), slice(min(left, right), right)

    def _nearest(self, body: Solid) -> _Drawn | None:
        """Which of its faces is nearest, in the part of the picture it covers; None where it is not in it."""
        from motion_backend.rendering.depth_buffer import draw

        width, height = self.size
        viewed = self.camera.view(np.asarray(body.vertices, dtype=np.float64))
        if (viewed[:, 2] < 0.1).any():
            return None
        points = self.camera.project(viewed, (2 * width, 2 * height))
        low = np.clip(np.floor(points.min(axis=0)[:2] / 2), 0, self.size).astype(np.int64)
        high = np.clip(np.ceil(points.max(axis=0)[:2] / 2), 0, self.size).astype(np.int64)
        if (high <= low).any():
            return None
        screen = points[body.faces]
        front = np.flatnonzero(turned_to_us(screen))
        best = self.nearness[2 * low[1] : 2 * high[1], 2 * low[0] : 2 * high[0]].copy()
        nearest = np.full(best.shape, -1)
        shifted = screen - np.array([2 * low[0], 2 * low[1], 0])
        draw(shifted[front], np.full(len(front), 4), 0, nearest, best)
        return _Drawn(np.append(front, -1)[nearest], low, screen)

    def _brightness(self, body: Solid, cuttings: Sequence[tuple[Ints, Array]]) -> Real:
        """The light on every vertex, in the shadows of the home and of the body itself. (V,)."""
        from motion_backend.rendering.depth_buffer import light_shares

        vertices, normals = np.asarray(body.vertices), np.asarray(body.normals)
        points = (vertices + SHADOW_OFFSET * normals).astype(np.float32)
        shares = []
        for one, (corner, depth) in zip(self.lights, cuttings, strict=True):
            low, high = corner[::-1], corner[::-1] + depth.shape
            both = np.maximum(depth, one.map.depth[low[0] : high[0], low[1] : high[1]])
            places = one.map.places(points) - np.array([*corner, 0], dtype=np.float32)
            turns = np.zeros(len(points), dtype=np.float32)
            shares.append(light_shares(places.astype(np.float32), turns, one.map.taps, both, SHADOW_BIAS))
        ray = np.asarray(self.camera.eye) - vertices
        facing = np.abs(np.einsum("vk,vk->v", normals, ray)) / np.linalg.norm(ray, axis=1)
        up = 0.5 + 0.5 * normals[:, 1]
        sky = (OPEN_SKY + (1 - OPEN_SKY) * shares[1]) * (SKY_LIGHT * up + BOUNCE_LIGHT * (1 - up))
        direct = np.maximum(normals @ SUN.direction.astype(np.float32), 0.0) * shares[0]
        return np.asarray(SUN_LIGHT * direct + sky + CAMERA_LIGHT * facing, dtype=np.float32)


def _cutting(found: ShadowMap, body: Solid) -> tuple[Ints, Array]:
    """The part of a lamp's map that a body alone covers, and its upper left pixel."""
    from motion_backend.rendering.depth_buffer import draw

    points = found.places(np.asarray(body.vertices, dtype=np.float64))
    pixels = found.depth.shape[0]
    low = np.clip(np.floor(points.min(axis=0)[:2]) - MARGIN, 0, pixels - 1).astype(np.int64)
    high = np.clip(np.ceil(points.max(axis=0)[:2]) + MARGIN, low + 1, pixels).astype(np.int64)
    nearest, depth = empty_buffers((int(high[0] - low[0]), int(high[1] - low[1])))
    screen = points[body.faces] - np.array([*low, 0])
    draw(screen, np.full(len(screen), 4), 0, nearest, depth)
    return low, depth


@cache
def _bytes_of_light() -> Image:
    return to_srgb_bytes(np.linspace(0, 1, SHADES))
