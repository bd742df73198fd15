"""A small software renderer: shaded solids, shadows and a floor grid to pictures, in numpy alone.

Frame: Y up, metres. Colours are sRGB, 0 to 1; light is summed in linear space. The nearest fragment of every pixel is
shaded; pixels are looked at in four places, so that edges and see-through solids are smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.rasterizer import Camera, Ints, Real, clip, empty_buffers
from motion_backend.rendering.shadow_map import SKY, SUN, ShadowMap
from motion_backend.rotations import Array

Image = NDArray[np.uint8]

SUN_LIGHT, SKY_LIGHT, BOUNCE_LIGHT, CAMERA_LIGHT = 0.70, 0.45, 0.24, 0.12
GRID = 0.5
"""Metres between the floor's lines."""
HORIZON = np.array([0.90, 0.91, 0.92])
HAZE_START, HAZE_DEPTH = 5.0, 4.0
"""Metres around the target that are clear, and over which all fades behind them."""
SHADOW_OFFSET = 0.02
"""Metres off a surface at which light is looked up, so that it does not shade itself."""
OPEN_SKY = 0.35
"""The share of the sky's light that comes from the sides, and reaches what lies under something."""


@dataclass(frozen=True)
class Solid:
    """Triangles of one colour, or a colour a face."""

    vertices: NDArray[np.floating]
    """(V, 3)."""
    faces: NDArray[np.integer]
    """(F, 3), counter-clockwise seen from outside."""
    color: Sequence[float] | NDArray[np.floating] = (0.75, 0.75, 0.75)
    """(3,) or (F, 3) sRGB; an alpha is not read."""
    normals: NDArray[np.floating] | None = None
    """(V, 3) for smooth shading of a closed shape; flat without."""
    opacity: float = 1.0
    """Quarters show: 0.25, 0.5, 0.75, 1."""
    casts: bool = True
    """Whether it casts a shadow."""


def render(
    solids: Sequence[Solid],
    camera: Camera,
    size: tuple[int, int] = (320, 240),
    ground: float | None = 0.0,
    shadows: bool = True,
) -> Image:
    """The picture, (height, width, 3) uint8 sRGB; `ground` is the height of an endless gridded floor, None for none.

    Without shadows it takes less than half the time.
    """
    seen = Samples.of(solids, camera, size, ground)
    unshaded = np.ones(len(seen.points), dtype=np.float32)
    return seen.picture(shade(seen, *(light(seen) if shadows else (unshaded, unshaded))))


@dataclass(frozen=True)
class Samples:
    """What a camera sees, point by point: a pixel that one triangle fills in its middle, all others at four samples."""

    scene: _Scene
    camera: Camera
    size: tuple[int, int]
    points: Real
    """(N, 3) float32 on surfaces: those of `whole`, then those of `torn`."""
    triangle: Ints
    """Which one each lies on. (N,)."""
    quarter: Ints
    """Which of a picture's four samples each is taken as. (N,)."""
    whole: Ints
    torn: Ints
    """Pixels."""
    place: tuple[Ints, Ints]
    """Where in `torn`, and in its four samples, each point of the second kind belongs."""
    nearness: Array
    """Of what is nearest, over twice the size; minus infinity for nothing. (2 height, 2 width)."""

    @staticmethod
    def of(solids: Sequence[Solid], camera: Camera, size: tuple[int, int], ground: float | None = 0.0) -> Samples:
        """What is nearest; `ground` is the height of an endless floor, None for none."""
        if ground is not None:
            solids = [*solids, _floor(camera, ground)]
        scene = _Scene.of(solids)
        large = (2 * size[0], 2 * size[1])
        visible = _visible(scene, camera, large)
        triangle, nearness = (_quarters(a, size) for a in visible)
        whole = np.flatnonzero((triangle[:, 0] >= 0) & (triangle == triangle[:, :1]).all(axis=1))
        torn = np.setdiff1d(np.flatnonzero(triangle.max(axis=1) >= 0), whole, assume_unique=True)
        row, sample = np.nonzero(triangle[torn] >= 0)
        pixel = np.concatenate([whole, torn[row]])
        x = 2 * (pixel % size[0]) + np.concatenate([np.full(len(whole), 1.0), sample % 2 + 0.5])
        y = 2 * (pixel // size[0]) + np.concatenate([np.full(len(whole), 1.0), sample // 2 + 0.5])
        near = np.concatenate([nearness[whole].mean(axis=1), nearness[torn][row, sample]])
        points = camera.unproject(x.astype(np.float32), y.astype(np.float32), near.astype(np.float32), large)
        drawn = np.concatenate([triangle[whole, 0], triangle[torn][row, sample]])
        quarter = np.concatenate([whole % 2 + 2 * (whole // size[0] % 2), sample])
        depth = visible[1].reshape(large[::-1])
        return Samples(scene, camera, size, points, drawn, quarter, whole, torn, (row, sample), depth)

    def spread(self, values: Real, empty: Real) -> Real:
        """Values of points (N, K) as values of pixels (height, width, K); `empty` (K,) where there is nothing."""
        pixels = np.tile(np.asarray(empty, dtype=np.float32), (self.size[0] * self.size[1], 1))
        pixels[self.whole] = values[: len(self.whole)]
        mixed = np.tile(np.asarray(empty, dtype=np.float32), (len(self.torn), 4, 1))
        mixed[self.place] = values[len(self.whole) :]
        pixels[self.torn] = mixed.mean(axis=1)
        return pixels.reshape(self.size[1], self.size[0], -1)

    def picture(self, colors: Real) -> Image:
        """Linear colours of points (N, 3) as a picture."""
        return to_srgb_bytes(self.spread(colors, to_linear(HORIZON)))


def _quarters(samples: NDArray[Any], size: tuple[int, int]) -> NDArray[Any]:
    """A double-size picture's values as four a pixel. (H * W, 4)."""
    width, height = size
    return samples.reshape(height, 2, width, 2).transpose(0, 2, 1, 3).reshape(-1, 4)


@dataclass(frozen=True)
class _Scene:
    """All triangles of all solids in a row."""

    corners: Array
    """(F, 3, 3)."""
    normals: Array
    """(F, 3, 3) float32, one a corner; zero where flat."""
    flat: Array
    """(F, 3) float32."""
    is_smooth: NDArray[np.bool_]
    """(F,)."""
    color: Array
    """(F, 3) float32, linear."""
    opacity: Array
    casts: NDArray[np.bool_]

    @classmethod
    def of(cls, solids: Sequence[Solid]) -> _Scene:
        corners = [np.asarray(s.vertices, dtype=np.float64)[s.faces] for s in solids]
        counts = [len(c) for c in corners]
        flats, normals, colors = [], [], []
        for solid, shape in zip(solids, corners, strict=True):
            flat = np.cross(shape[:, 1] - shape[:, 0], shape[:, 2] - shape[:, 0])
            flats.append(flat / np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-12))
            normals.append(np.zeros_like(shape) if solid.normals is None else np.asarray(solid.normals)[solid.faces])
            color = np.asarray(solid.color, dtype=np.float64)[..., :3]
            colors.append(np.broadcast_to(to_linear(color), (len(shape), 3)))
        return cls(
            np.concatenate(corners),
            np.concatenate(normals).astype(np.float32),
            np.concatenate(flats).astype(np.float32),
            np.repeat([s.normals is not None for s in solids], counts),
            np.concatenate(colors).astype(np.float32),
            np.repeat([s.opacity for s in solids], counts),
            np.repeat([s.casts for s in solids], counts),
        )


def _floor(camera: Camera, height: float) -> Solid:
    x, _, z = camera.target
    corners = np.array([[x - 9, height, z - 9], [x - 9, height, z + 9], [x + 9, height, z + 9], [x + 9, height, z - 9]])
    # A hair lower than real floors, so that these win where there are some.
    return Solid(corners - [0, 0.004, 0], np.array([[0, 1, 2], [0, 2, 3]]), (0.80, 0.80, 0.79))


def _visible(scene: _Scene, camera: Camera, size: tuple[int, int]) -> tuple[Ints, Array]:
    """For every pixel the nearest triangle (-1 for none) and its nearness."""
    from motion_backend.rendering.depth_buffer import draw

    viewed, source = clip(camera.view(scene.corners), camera)
    screen = camera.project(viewed, size)
    # A smooth solid is closed: its far side is hidden by its near side, or by none when it is see-through.
    shown = np.flatnonzero(~scene.is_smooth[source] | turned_to_us(screen))
    nearest, best = empty_buffers(size)
    draw(screen[shown], np.round(4 * scene.opacity[source[shown]]).astype(np.int64), 0, nearest, best)
    # Triangles that the eye's plane cuts are several pieces; none stays none.
    return np.append(source[shown], -1)[nearest].reshape(-1), best.reshape(-1)


def turned_to_us(screen: Real) -> NDArray[np.bool_]:
    """Which triangles on a picture (F, 3, 3) show their outside. (F,)."""
    x, y = screen[..., 0], screen[..., 1]
    return np.asarray((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) < (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0]))


def shade(seen: Samples, sun: Real, sky: Real) -> Real:
    """Linear colours of what is seen, of whose two lights these shares (N,) reach each point. (N, 3)."""
    scene, camera, triangle, points = seen.scene, seen.camera, seen.triangle, seen.points
    normal, distance, facing = _surface(seen)
    direct = np.maximum(normal @ SUN.direction.astype(np.float32), 0.0) * sun
    up = 0.5 + 0.5 * normal[:, 1]
    bright = SUN_LIGHT * direct + sky * (SKY_LIGHT * up + BOUNCE_LIGHT * (1 - up)) + CAMERA_LIGHT * facing
    ground = np.flatnonzero((np.abs(points[:, 1]) < 0.006) & (normal[:, 1] > 0.99))
    bright[ground] *= _grid(points[ground], distance[ground])
    color = scene.color[triangle] * bright[:, None]
    away = np.hypot(points[:, 0] - camera.target[0], points[:, 2] - camera.target[2])
    far = np.flatnonzero(away > HAZE_START)
    haze = np.minimum((away[far, None] - HAZE_START) / HAZE_DEPTH, 1.0)
    color[far] += (to_linear(HORIZON) - color[far]) * haze
    return np.asarray(color)


def _surface(seen: Samples) -> tuple[Real, Real, Real]:
    """Normals towards the eye (N, 3), how far from it (N,) and the cosine of the angle to it (N,)."""
    normal = seen.scene.flat[seen.triangle]
    smooth = np.flatnonzero(seen.scene.is_smooth[seen.triangle])
    normal[smooth] = _interpolated(seen.scene, seen.triangle[smooth], seen.points[smooth])
    if seen.camera.span is None:
        ray = np.asarray(seen.camera.eye, dtype=np.float32) - seen.points
        distance = np.sqrt(_dot(ray, ray))
        facing = _dot(normal, ray) / distance
    else:
        distance = np.zeros(len(seen.points), dtype=np.float32)
        facing = normal @ -seen.camera.axes[2].astype(np.float32)
    normal[facing < 0] *= -1
    return normal, distance, np.abs(facing)


def _interpolated(scene: _Scene, triangle: Ints, points: Real) -> Real:
    """Unit normals at points of triangles, from the corners' normals. (N, 3) float32."""
    corners, normals = scene.corners[triangle], scene.normals[triangle]
    side, other, offset = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    a, b, c = _dot(side, side), _dot(side, other), _dot(other, other)
    d, e = _dot(offset, side), _dot(offset, other)
    area = np.maximum(a * c - b * b, 1e-18)
    u, v = ((c * d - b * e) / area)[:, None], ((a * e - b * d) / area)[:, None]
    normal = (1 - u - v) * normals[:, 0] + u * normals[:, 1] + v * normals[:, 2]
    return np.asarray(normal / np.sqrt(np.maximum(_dot(normal, normal), 1e-18))[:, None], dtype=np.float32)


def _dot(a: Real, b: Real) -> Real:
    return np.asarray(np.einsum("nk,nk->n", a, b))


def light(seen: Samples) -> tuple[Real, Real]:
    """Shares of the sun and of the sky that reach points. (N,) each."""
    normal = _surface(seen)[0]
    points = seen.points + SHADOW_OFFSET * normal
    casting = seen.scene.corners[(seen.scene.opacity >= 1) & seen.scene.casts]
    sun, sky = (ShadowMap.of(lamp, casting, seen.camera).shares(points, seen.quarter) for lamp in (SUN, SKY))
    return sun, OPEN_SKY + (1 - OPEN_SKY) * sky


def _grid(points: Real, distance: Real) -> Real:
    """How dark the floor's lines make it at points that far from the eye. (N,)."""
    x, z = (np.abs((points[:, k] / GRID + 0.5) % 1.0 - 0.5) * GRID for k in (0, 2))
    width = 0.004 + 0.0012 * distance
    return np.asarray(1.0 - 0.22 * np.clip(1.5 - np.minimum(x, z) / width, 0, 1))


def to_linear(color: Array) -> Array:
    """Of sRGB, 0 to 1."""
    return np.asarray(np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4))


def to_srgb_bytes(light: Real) -> Image:
    """Of linear light, 0 to 1."""
    light = np.clip(light, 0.0, 1.0)
    color = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(color * 255), dtype=np.uint8)
