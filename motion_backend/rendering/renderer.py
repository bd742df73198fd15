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

from motion_backend.rendering.rasterizer import Camera, Ints, Real, clip, fragments
from motion_backend.rotations import Array

Image = NDArray[np.uint8]

SUN_LIGHT, SKY_LIGHT, BOUNCE_LIGHT, CAMERA_LIGHT = 0.70, 0.45, 0.24, 0.12
SHADOW_REACH = 3.2
"""Metres around the target that shadows are drawn for."""
GRID = 0.5
"""Metres between the floor's lines."""
HORIZON = np.array([0.90, 0.91, 0.92])
HAZE_START, HAZE_DEPTH = 5.0, 4.0
"""Metres around the target that are clear, and over which all fades behind them."""
SHADOW_OFFSET = 0.02
"""Metres off a surface at which light is looked up, so that it does not shade itself."""


@dataclass(frozen=True)
class _Lamp:
    """A light far away, and the map of what it reaches first."""

    direction: Array
    """Unit vector towards it."""
    pixels: int
    blur: float
    """Metres around a point that its share of light is taken from."""
    taps: Array
    """Where the map is read, in blur radii; each of a pixel's four samples turns them further. (N, 2)."""


_SUN = _Lamp(
    np.array([0.35, 0.86, 0.37]) / np.linalg.norm([0.35, 0.86, 0.37]),
    640,
    0.013,
    np.array([[0.9, 0.1], [-0.1, 0.9], [-0.9, -0.1], [0.1, -0.9], [0.35, 0.3], [-0.3, -0.35]]),
)
_SKY = _Lamp(
    np.array([0.0, 1.0, 0.0]),
    288,
    0.10,
    np.array([[0.2, 0.1], [0.9, 0.3], [0.1, 0.95], [-0.75, 0.55], [-0.7, -0.6], [0.35, -0.85]]),
)


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
    if ground is not None:
        solids = [*solids, _floor(camera, ground)]
    scene = _Scene.of(solids)
    large = (2 * size[0], 2 * size[1])
    triangle, nearness = (_quarters(a, size) for a in _visible(scene, camera, large))
    # A pixel that one triangle fills is shaded once, in its middle; all others at their four samples.
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
    shades = _shade(scene, camera, drawn, points, quarter if shadows else None)
    color = np.tile(_to_linear(HORIZON).astype(np.float32), (size[0] * size[1], 1))
    color[whole] = shades[: len(whole)]
    mixed = np.tile(_to_linear(HORIZON).astype(np.float32), (len(torn), 4, 1))
    mixed[row, sample] = shades[len(whole) :]
    color[torn] = mixed.mean(axis=1)
    return _to_srgb_bytes(color).reshape(size[1], size[0], 3)


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
            colors.append(np.broadcast_to(_to_linear(color), (len(shape), 3)))
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
    viewed, source = clip(camera.view(scene.corners), camera)
    screen = camera.project(viewed, size)
    # A smooth solid is closed: its far side is hidden by its near side, or by none when it is see-through.
    shown = ~scene.is_smooth[source] | _turned_to_us(screen)
    partly = shown & (scene.opacity[source] < 1)
    best = np.full(size[0] * size[1], -np.inf)
    layers = []
    for chosen in (np.flatnonzero(shown & ~partly), np.flatnonzero(partly)):
        pixel, piece, nearness = fragments(screen[chosen], *size)
        triangle = source[chosen][piece]
        if partly[chosen].any():
            kept = _kept(scene, triangle, (pixel % size[0], pixel // size[0]))
            pixel, triangle, nearness = pixel[kept], triangle[kept], nearness[kept]
        np.maximum.at(best, pixel, nearness)
        layers.append((pixel, triangle, nearness))
    nearest = np.full(size[0] * size[1], -1)
    for pixel, triangle, nearness in layers:
        won = np.flatnonzero(nearness == best[pixel])
        nearest[pixel[won]] = triangle[won]
    return nearest, best


def _kept(scene: _Scene, triangle: Ints, place: tuple[Ints, Ints]) -> NDArray[np.bool_]:
    """Which fragments of see-through solids are there: these are holes in a pattern over a pixel's samples."""
    order = (place[0] % 2) * 2 ^ (place[1] % 2) * 3
    return np.asarray(order < scene.opacity[triangle] * 4 - 0.5)


def _turned_to_us(screen: Real) -> NDArray[np.bool_]:
    x, y = screen[..., 0], screen[..., 1]
    return np.asarray((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) < (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0]))


def _shade(scene: _Scene, camera: Camera, triangle: Ints, points: Real, quarter: Ints | None) -> Real:
    """Linear colours of surface points; `quarter` says which of a picture's four samples each one is. (N, 3).

    Without it all light reaches them.
    """
    normal = scene.flat[triangle]
    smooth = np.flatnonzero(scene.is_smooth[triangle])
    normal[smooth] = _interpolated(scene, triangle[smooth], points[smooth])
    if camera.span is None:
        ray = np.asarray(camera.eye, dtype=np.float32) - points
        distance = np.sqrt(_dot(ray, ray))
        facing = _dot(normal, ray) / distance
    else:
        distance = np.zeros(len(points), dtype=np.float32)
        facing = normal @ -camera.axes[2].astype(np.float32)
    normal[facing < 0] *= -1
    sun = sky = np.ones(len(points), dtype=np.float32)
    if quarter is not None:
        sun, sky = _light(scene, camera, points + SHADOW_OFFSET * normal, quarter)
    direct = np.maximum(normal @ _SUN.direction.astype(np.float32), 0.0) * sun
    up = 0.5 + 0.5 * normal[:, 1]
    light = SUN_LIGHT * direct + sky * (SKY_LIGHT * up + BOUNCE_LIGHT * (1 - up)) + CAMERA_LIGHT * np.abs(facing)
    ground = np.flatnonzero((np.abs(points[:, 1]) < 0.006) & (normal[:, 1] > 0.99))
    light[ground] *= _grid(points[ground], distance[ground])
    color = scene.color[triangle] * light[:, None]
    away = np.hypot(points[:, 0] - camera.target[0], points[:, 2] - camera.target[2])
    far = np.flatnonzero(away > HAZE_START)
    haze = np.minimum((away[far, None] - HAZE_START) / HAZE_DEPTH, 1.0)
    color[far] += (_to_linear(HORIZON) - color[far]) * haze
    return np.asarray(color)


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


def _light(scene: _Scene, camera: Camera, points: Real, quarter: Ints) -> tuple[Real, Real]:
    """Shares of the sun and of the sky that reach points. (N,) each."""
    casting = scene.corners[(scene.opacity >= 1) & scene.casts]
    reach = SHADOW_REACH if camera.span is None else max(SHADOW_REACH, 0.8 * camera.span)
    turn = quarter.astype(np.float32) * np.float32(np.pi / 8)
    cos, sin = np.cos(turn), np.sin(turn)
    shares = []
    for lamp in (_SUN, _SKY):
        view, depth = _shadow_map(lamp, casting, camera, reach)
        x, y, height = view.project(view.view(points), (lamp.pixels, lamp.pixels)).T
        lit = np.zeros(len(points), dtype=np.float32)
        for u, v in (lamp.taps * (lamp.blur * lamp.pixels / (2 * reach))).astype(np.float32):
            column = np.clip(x + (u * cos - v * sin), 0, lamp.pixels - 1).astype(np.int32)
            row = np.clip(y + (u * sin + v * cos), 0, lamp.pixels - 1).astype(np.int32)
            lit += depth[row * lamp.pixels + column] < height + 0.02
        shares.append(lit / len(lamp.taps))
    return shares[0], 0.35 + 0.65 * shares[1]


def _shadow_map(lamp: _Lamp, corners: Array, camera: Camera, reach: float) -> tuple[Camera, Real]:
    """A parallel view from the light, and the nearness of what it meets first in every pixel. (pixels ** 2,)."""
    x, y, z = (np.asarray(camera.target) + 6.0 * lamp.direction).tolist()
    view = Camera((x, y, z), camera.target, span=2 * reach)
    size = (lamp.pixels, lamp.pixels)
    pixel, _, nearness = fragments(view.project(view.view(corners), size), *size)
    depth = np.full(size, -np.inf)
    np.maximum.at(depth.reshape(-1), pixel, nearness)
    # Nothing casts a shadow on what lies beyond the map: points there read its border.
    depth[[0, -1]] = depth[:, [0, -1]] = -np.inf
    return view, depth.astype(np.float32).reshape(-1)


def _grid(points: Real, distance: Real) -> Real:
    """How dark the floor's lines make it at points that far from the eye. (N,)."""
    x, z = (np.abs((points[:, k] / GRID + 0.5) % 1.0 - 0.5) * GRID for k in (0, 2))
    width = 0.004 + 0.0012 * distance
    return np.asarray(1.0 - 0.22 * np.clip(1.5 - np.minimum(x, z) / width, 0, 1))


def _to_linear(color: Array) -> Array:
    return np.asarray(np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4))


def _to_srgb_bytes(light: Real) -> Image:
    light = np.clip(light, 0.0, 1.0)
    color = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(color * 255), dtype=np.uint8)
