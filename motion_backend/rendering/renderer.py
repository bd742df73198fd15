"""A small software renderer: shaded solids, shadows and a floor grid to pictures, shaded by compiled code.

Frame: Y up, metres. Colours are sRGB, 0 to 1; light is summed in linear space. The nearest fragment of every pixel is
shaded; pixels are looked at in four places, so that edges and see-through solids are smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.light_values import Lit, Palette, Surfaces
from motion_backend.rendering.rasterizer import Camera, Ints, Real, clip, empty_buffers
from motion_backend.rendering.shadow_map import SHADOW_BIAS, SKY, SUN, ShadowMap
from motion_backend.rotations import Array

Image = NDArray[np.uint8]

SUN_LIGHT, SKY_LIGHT, BOUNCE_LIGHT, CAMERA_LIGHT = 0.70, 0.45, 0.24, 0.12
FILL_LIGHT = 0.34
"""What the camera adds to it where a film looks at somebody."""
GRID = 0.5
"""Metres between the floor's lines."""
HORIZON = np.array([0.90, 0.91, 0.92])
STUDIO_HORIZON, STUDIO_ZENITH, STUDIO_RISE = np.array([0.89, 0.89, 0.88]), np.array([0.62, 0.70, 0.78]), 0.42
"""Of films: their sky, and the sine of the angle over the horizon from which it is one colour."""
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
    outside: bool = False
    """Whether a picture that is full of it shows nothing of a home: the ground around it, a wall that is cut."""


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
    return to_srgb_bytes(Still.of(solids, camera, size, ground, shadows).lit.color)


@dataclass(frozen=True)
class Still:
    """What a camera sees of things that stand still, lit."""

    camera: Camera
    nearness: Array
    """Of what is nearest, over twice the size; minus infinity for nothing. (2 height, 2 width)."""
    lit: Lit
    maps: tuple[ShadowMap, ShadowMap]
    """What the sun and the sky reach."""

    @staticmethod
    def of(
        solids: Sequence[Solid],
        camera: Camera,
        size: tuple[int, int],
        ground: float | None = 0.0,
        shadows: bool = True,
        light: Palette | None = None,
    ) -> Still:
        """The picture (width, height), in `PALETTE` unless told; see `render`."""
        from motion_backend.rendering.surface_light import shade_picture

        if ground is not None:
            solids = [*solids, _floor(camera, ground)]
        scene, large = _Scene.of(solids), (2 * size[0], 2 * size[1])
        nearest, nearness = scene.visible(camera, large)
        maps = [
            ShadowMap.of(lamp, scene.casting, camera) if shadows else ShadowMap.empty(lamp, camera)
            for lamp in (SUN, SKY)
        ]
        lit = Lit(*(np.empty((size[1], size[0], 3), dtype=np.float32) for _ in Lit._fields))
        lens, (sun, sky) = camera.lens(large), (found.shading for found in maps)
        shade_picture(
            nearest, nearness, scene.surfaces, lens, sun, sky, light or PALETTE, lit, np.empty(15), np.empty(15)
        )
        return Still(camera, nearness, lit, (maps[0], maps[1]))


def nearest_of(solids: Sequence[Solid], camera: Camera, size: tuple[int, int]) -> tuple[Array, NDArray[np.bool_]]:
    """How near what is nearest is in every pixel, minus infinity for nothing or glass, and whether that is something
    that does not lie outside. (height, width) each."""
    from motion_backend.rendering.depth_buffer import draw

    solid = sorted((one for one in solids if one.opacity >= 1), key=lambda one: one.outside)
    nearest, best = empty_buffers(size)
    corners = [np.asarray(one.vertices, dtype=np.float64)[one.faces] for one in solid]
    viewed, sources = clip(camera.view(np.concatenate([np.zeros((0, 3, 3)), *corners])), camera)
    screen = camera.project(viewed, size)
    closed = np.array([one.normals is not None for one in solid], dtype=bool)
    smooth = np.repeat(closed, [len(one.faces) for one in solid])
    shown = np.flatnonzero(~smooth[sources] | turned_to_us(screen))  # as in `_Scene.visible`
    draw(screen[shown], np.full(len(shown), 4, dtype=np.int64), 0, nearest, best)
    inside = sum(len(one.faces) for one in solid if not one.outside)
    return best, np.append(sources[shown] < inside, False)[nearest]


@dataclass(frozen=True)
class _Scene:
    """All triangles of all solids in a row."""

    surfaces: Surfaces
    opacity: Array
    """(F,)."""
    casts: NDArray[np.bool_]
    """(F,)."""

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
        surfaces = Surfaces(
            np.concatenate(corners),
            np.concatenate(normals).astype(np.float32),
            np.concatenate(flats).astype(np.float32),
            np.repeat([s.normals is not None for s in solids], counts),
            # Of rows that lie alike in memory, or all would be compiled once more.
            np.concatenate(colors).astype(np.float32, order="C"),
        )
        return cls(
            surfaces, np.repeat([s.opacity for s in solids], counts), np.repeat([s.casts for s in solids], counts)
        )

    @property
    def casting(self) -> Array:
        """The triangles that cast a shadow. (F', 3, 3)."""
        return self.surfaces.corners[(self.opacity >= 1) & self.casts]

    def visible(self, camera: Camera, size: tuple[int, int]) -> tuple[Ints, Array]:
        """For every pixel the nearest triangle (-1 for none) and its nearness. (height, width) each."""
        from motion_backend.rendering.depth_buffer import draw

        viewed, source = clip(camera.view(self.surfaces.corners), camera)
        screen = camera.project(viewed, size)
        # A smooth solid is closed: its far side is hidden by its near side, or by none when it is see-through.
        shown = np.flatnonzero(~self.surfaces.is_smooth[source] | turned_to_us(screen))
        nearest, best = empty_buffers(size)
        draw(screen[shown], np.round(4 * self.opacity[source[shown]]).astype(np.int64), 0, nearest, best)
        # Triangles that the eye's plane cuts are several pieces; none stays none.
        return np.append(source[shown], -1)[nearest], best


def _floor(camera: Camera, height: float) -> Solid:
    x, _, z = camera.target
    corners = np.array([[x - 9, height, z - 9], [x - 9, height, z + 9], [x + 9, height, z + 9], [x + 9, height, z - 9]])
    # A hair lower than real floors, so that these win where there are some.
    return Solid(corners - [0, 0.004, 0], np.array([[0, 1, 2], [0, 2, 3]]), (0.80, 0.80, 0.79))


def turned_to_us(screen: Real) -> NDArray[np.bool_]:
    """Which triangles on a picture (F, 3, 3) show their outside. (F,)."""
    x, y = screen[..., 0], screen[..., 1]
    return np.asarray((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) < (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0]))


def to_linear(color: Array) -> Array:
    """Of sRGB, 0 to 1."""
    return np.asarray(np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4))


def to_srgb(light: Real) -> Real:
    """Of linear light, 0 to 1."""
    light = np.clip(light, 0.0, 1.0)
    return np.asarray(np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055))


def to_srgb_bytes(light: Real) -> Image:
    """Of linear light, 0 to 1."""
    return np.asarray(np.round(to_srgb(light) * 255), dtype=np.uint8)


PALETTE: Final = Palette(
    SUN_LIGHT, SKY_LIGHT, BOUNCE_LIGHT, CAMERA_LIGHT, OPEN_SKY,
    SHADOW_OFFSET, SHADOW_BIAS, GRID, HAZE_START, HAZE_DEPTH,
    to_linear(HORIZON).astype(np.float32), to_linear(HORIZON).astype(np.float32), 1.0,
)  # fmt: skip
STUDIO: Final = PALETTE._replace(
    grid=0.0, horizon=to_linear(STUDIO_HORIZON).astype(np.float32),
    zenith=to_linear(STUDIO_ZENITH).astype(np.float32), rise=STUDIO_RISE,
)  # fmt: skip
"""No lines on floors, and a sky."""
FILL: Final = PALETTE._replace(camera=FILL_LIGHT)
"""What lights the body of a film: a lamp beside the camera, or a dark face would be a hole in a dark wall."""
