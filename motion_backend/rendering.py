"""A small software renderer: shaded solids, shadows and a floor grid to pictures, in numpy alone.

Frame: Y up, metres. Colours are sRGB, 0 to 1; light is summed in linear space. The nearest fragment of every pixel is
shaded once; pictures are drawn at twice their size and averaged, so that edges and see-through solids are smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion_backend.raster import Array, Camera, Ints, clip, fragments

Image = NDArray[np.uint8]

SUPERSAMPLE = 2
SUN = np.array([0.35, 0.86, 0.37])
SUN_LIGHT, SKY_LIGHT, BOUNCE_LIGHT, CAMERA_LIGHT = 0.72, 0.42, 0.20, 0.10
SHADOW_SIZE, SHADOW_REACH = 640, 3.2
"""Pixels across the shadow maps, and the metres around the target they cover."""
GRID = 0.5
"""Metres between the floor's lines."""
HORIZON = np.array([0.90, 0.91, 0.92])
_TAPS = np.array(
    [[0.0, 0.0], [1.0, 0.2], [-0.9, 0.5], [0.2, -1.0], [-0.3, 0.95], [0.55, -0.5], [-0.6, -0.55], [0.6, 0.7]]
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
    """(V, 3) for smooth shading; flat without."""
    opacity: float = 1.0
    """Quarters show: 0.25, 0.5, 0.75, 1."""
    cut: float = 0.0
    """Parts nearer to the camera than this are left away, as the front wall of a doll's house."""


def render(
    solids: Sequence[Solid], camera: Camera, size: tuple[int, int] = (320, 240), ground: float | None = 0.0
) -> Image:
    """The picture, (height, width, 3) uint8 sRGB; `ground` is the height of an endless gridded floor, None for none."""
    if ground is not None:
        solids = [*solids, _floor(camera, ground)]
    large = (size[0] * SUPERSAMPLE, size[1] * SUPERSAMPLE)
    scene = _Scene.of(solids)
    triangle, nearness = _visible(scene, camera, large)
    color = np.broadcast_to(_to_linear(HORIZON), (large[0] * large[1], 3)).copy()
    hit = np.flatnonzero(triangle >= 0)
    if len(hit):
        x, y = hit % large[0] + 0.5, hit // large[0] + 0.5
        points = camera.unproject(np.asarray(x), np.asarray(y), nearness[hit], large)
        color[hit] = _shade(scene, camera, triangle[hit], points, hit % 2 + 2 * (hit // large[0] % 2))
    color = color.reshape(large[1], large[0], 3)
    steps = range(SUPERSAMPLE)
    mean = sum(color[i::SUPERSAMPLE, j::SUPERSAMPLE] for i in steps for j in steps) / SUPERSAMPLE**2
    return _to_srgb_bytes(np.asarray(mean))


@dataclass(frozen=True)
class _Scene:
    """All triangles of all solids in a row."""

    corners: Array
    """(F, 3, 3)."""
    normals: Array
    """(F, 3, 3), one a corner."""
    color: Array
    """(F, 3) linear."""
    opacity: Array
    cut: Array

    @classmethod
    def of(cls, solids: Sequence[Solid]) -> _Scene:
        corners, normals, colors = [], [], []
        for solid in solids:
            shape = np.asarray(solid.vertices, dtype=np.float64)[solid.faces]
            flat = np.cross(shape[:, 1] - shape[:, 0], shape[:, 2] - shape[:, 0])
            flat = flat / np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-12)
            smooth = None if solid.normals is None else np.asarray(solid.normals, dtype=np.float64)[solid.faces]
            corners.append(shape)
            normals.append(np.repeat(flat[:, None], 3, axis=1) if smooth is None else smooth)
            color = np.asarray(solid.color, dtype=np.float64)[..., :3]
            colors.append(np.broadcast_to(_to_linear(color), (len(shape), 3)))
        counts = [len(c) for c in corners]
        return cls(
            np.concatenate(corners),
            np.concatenate(normals),
            np.concatenate(colors),
            np.repeat([s.opacity for s in solids], counts),
            np.repeat([s.cut for s in solids], counts),
        )


def _floor(camera: Camera, height: float) -> Solid:
    x, _, z = camera.target
    corners = np.array([[x - 9, height, z - 9], [x - 9, height, z + 9], [x + 9, height, z + 9], [x + 9, height, z - 9]])
    # A hair lower than real floors, so that these win where there are some.
    return Solid(corners - [0, 0.004, 0], np.array([[0, 1, 2], [0, 2, 3]]), (0.80, 0.80, 0.79))


def _visible(scene: _Scene, camera: Camera, size: tuple[int, int]) -> tuple[Ints, Array]:
    """For every pixel the nearest triangle (-1 for none) and its nearness."""
    width, height = size
    viewed, source = clip(camera.view(scene.corners), camera)
    pixel, piece, nearness = fragments(camera.project(viewed, size), width, height)
    triangle = source[piece]
    if scene.opacity.min() < 1 or scene.cut.max() > 0:
        order = (pixel % width % 2) * 2 ^ (pixel // width % 2) * 3
        depth = -nearness if camera.span is not None else 1.0 / nearness
        kept = (order < scene.opacity[triangle] * 4 - 0.5) & (depth > scene.cut[triangle])
        pixel, triangle, nearness = pixel[kept], triangle[kept], nearness[kept]
    best = np.full(width * height, -np.inf)
    np.maximum.at(best, pixel, nearness)
    won = nearness == best[pixel]
    nearest = np.full(width * height, -1)
    nearest[pixel[won]] = triangle[won]
    return nearest, best


def _shade(scene: _Scene, camera: Camera, triangle: Ints, points: Array, quarter: Ints) -> Array:
    """Linear colours of surface points; `quarter` says which of a picture's four samples each one is. (N, 3)."""
    normal = _interpolated(scene, triangle, points)
    towards = np.asarray(camera.eye) - points if camera.span is None else np.broadcast_to(-camera.axes[2], points.shape)
    towards = towards / np.sqrt(_dot(towards, towards))[:, None]
    facing = _dot(normal, towards)
    normal = np.where(facing[:, None] < 0, -normal, normal)
    sun, sky = _light(scene, camera, points + 0.02 * normal, quarter)
    direct = np.maximum(normal @ (SUN / np.linalg.norm(SUN)), 0.0) * sun
    up = 0.5 + 0.5 * normal[:, 1]
    light = SUN_LIGHT * direct + sky * (SKY_LIGHT * up + BOUNCE_LIGHT * (1 - up)) + CAMERA_LIGHT * np.abs(facing)
    color = scene.color[triangle] * light[:, None]
    ground = (np.abs(points[:, 1]) < 0.006) & (normal[:, 1] > 0.99)
    color[ground] *= _grid(points[ground], camera)[:, None]
    away = np.hypot(points[:, 0] - camera.target[0], points[:, 2] - camera.target[2])
    haze = np.clip((away - 5.0) / 4.0, 0, 1)[:, None]
    return np.asarray(color * (1 - haze) + _to_linear(HORIZON) * haze)


def _interpolated(scene: _Scene, triangle: Ints, points: Array) -> Array:
    """Unit normals at points of triangles, from the corners' normals. (N, 3)."""
    base, side, other = scene.corners[:, 0], *np.moveaxis(scene.corners[:, 1:] - scene.corners[:, :1], 1, 0)
    across = np.cross(side, other)
    scale = 1.0 / np.maximum(_dot(across, across), 1e-18)[:, None]
    offset = points - base[triangle]
    u = _dot(offset, (np.cross(other, across) * scale)[triangle])[:, None]
    v = _dot(offset, (np.cross(across, side) * scale)[triangle])[:, None]
    n0, n1, n2 = np.moveaxis(scene.normals, 1, 0)
    normal = n0[triangle] + u * (n1 - n0)[triangle] + v * (n2 - n0)[triangle]
    return np.asarray(normal / np.sqrt(np.maximum(_dot(normal, normal), 1e-18))[:, None])


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("nk,nk->n", a, b))


def _light(scene: _Scene, camera: Camera, points: Array, quarter: Ints) -> tuple[Array, Array]:
    """Shares of the sun and of the sky that reach points, from two shadow maps. (N,) each."""
    casting = (scene.opacity >= 1) & (scene.cut <= 0)
    size = (SHADOW_SIZE, SHADOW_SIZE)
    scale = SHADOW_SIZE / (2 * SHADOW_REACH)
    turn = quarter * (np.pi / 8)
    cos, sin = np.cos(turn), np.sin(turn)
    shares = []
    for direction, blur in ((SUN, 0.013), (np.array([0.0, 1.0, 0.0]), 0.10)):
        eye = np.asarray(camera.target) + 6.0 * direction / np.linalg.norm(direction)
        lamp = Camera((float(eye[0]), float(eye[1]), float(eye[2])), camera.target, span=2 * SHADOW_REACH)
        corners = lamp.project(lamp.view(scene.corners[casting]), size)
        pixel, _, nearness = fragments(corners, *size)
        best = np.full(SHADOW_SIZE * SHADOW_SIZE, -np.inf)
        np.maximum.at(best, pixel, nearness)
        x, y, height = np.moveaxis(lamp.project(lamp.view(points), size), -1, 0)
        lit = np.zeros(len(points))
        for u, v in _TAPS * (blur * scale):
            column = (x + u * cos - v * sin).astype(np.int64)
            row = (y + u * sin + v * cos).astype(np.int64)
            beyond = (column < 0) | (row < 0) | (column >= SHADOW_SIZE) | (row >= SHADOW_SIZE)
            at = np.where(beyond, 0, row * SHADOW_SIZE + column)
            lit += beyond | (best[at] < height + 0.02)
        shares.append(lit / len(_TAPS))
    return shares[0], 0.35 + 0.65 * shares[1]


def _grid(points: Array, camera: Camera) -> Array:
    """How dark the floor's lines make it. (N,)."""
    offset = np.abs((points[:, [0, 2]] / GRID + 0.5) % 1.0 - 0.5) * GRID
    ray = points - np.asarray(camera.eye)
    distance = np.sqrt(_dot(ray, ray))
    width = 0.004 + 0.0012 * distance
    return np.asarray(1.0 - 0.22 * np.clip(1.5 - np.minimum(offset[:, 0], offset[:, 1]) / width, 0, 1))


def _to_linear(color: Array) -> Array:
    return np.asarray(np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4))


def _to_srgb_bytes(light: Array) -> Image:
    light = np.clip(light, 0.0, 1.0)
    color = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(color * 255), dtype=np.uint8)
