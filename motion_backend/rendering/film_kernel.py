"""A moving body put into a still picture: its shadows on what is there, then itself; compiled.

Imported late: see `film_backdrop`. Nothing is checked: whoever calls has checked it. A picture is looked at in tiles,
and only those that a body or its shadow can reach are drawn.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.film_picture import BLACK, GREY, WHITE, Planes
from motion_backend.rendering.light_values import Cutting, Drawn, Lit, Palette, Shading
from motion_backend.rendering.rasterizer import Real
from motion_backend.rendering.shadow_map import SHADOW_BIAS
from motion_backend.rendering.surface_light import share_of
from motion_backend.rotations import Array
from scene_graphs.jit import compiled, filling, inlined

TILE: Final = 16
"""Pixels across and down; even, as colours are halved."""
RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722
"""What each adds to brightness (BT.709)."""
BRIGHT: Final = (WHITE - BLACK) / 255
TO_BLUE, TO_RED = 224 / 255 / 1.8556, 224 / 255 / 1.5748


@compiled
def tile_bounds(places: Real) -> Real:
    """Between which x and y of a lamp's map each tile lies: low x, high x, low y, high y. (rows, columns, 4)."""
    height, width = places.shape[0], places.shape[1]
    bounds = np.empty(((height + TILE - 1) // TILE, (width + TILE - 1) // TILE, 4), dtype=np.float32)
    bounds[..., 0] = bounds[..., 2] = np.inf
    bounds[..., 1] = bounds[..., 3] = -np.inf
    for row in range(height):
        for column in range(width):
            x, y = places[row, column, 0], places[row, column, 1]
            if x > -np.inf:
                tile = bounds[row // TILE, column // TILE]
                tile[0], tile[1] = min(tile[0], x), max(tile[1], x)
                tile[2], tile[3] = min(tile[2], y), max(tile[3], y)
    return bounds


@filling
def body_light(
    vertices: Real, normals: Real, eye: Array, sun: Shading, sky: Shading, light: Palette, out: Real
) -> None:
    """The light on every vertex, in the shadows of the home and of the body itself, into `out` (V,)."""
    for one in range(len(vertices)):
        x, y, z = vertices[one, 0], vertices[one, 1], vertices[one, 2]
        nx, ny, nz = normals[one, 0], normals[one, 1], normals[one, 2]
        ox, oy, oz = x + light.offset * nx, y + light.offset * ny, z + light.offset * nz
        direct = max(nx * sun.direction[0] + ny * sun.direction[1] + nz * sun.direction[2], 0.0)
        if direct > 0:
            direct *= light.sun * share_of(ox, oy, oz, 0, sun, light.bias)
        above = 0.5 + 0.5 * ny
        around = light.open_sky + (1 - light.open_sky) * share_of(ox, oy, oz, 0, sky, light.bias)
        around *= light.sky * above + light.bounce * (1 - above)
        rx, ry, rz = eye[0] - x, eye[1] - y, eye[2] - z
        facing = abs(nx * rx + ny * ry + nz * rz) / np.sqrt(rx * rx + ry * ry + rz * rz)
        out[one] = direct + around + light.camera * facing


@filling
def put_body(
    planes: tuple[Planes, Planes, Planes], lit: Lit, bounds: tuple[Real, Real], cuttings: tuple[Cutting, Cutting],
    drawn: Drawn, table: Real, part: Real,
) -> None:  # fmt: skip
    """Draw a body and its shadows into a picture's planes; `table` has sRGB, 0 to 255, for linear light.

    `part` (TILE, TILE, 3) float32 is written on.
    """
    height, width = lit.color.shape[0], lit.color.shape[1]
    for tile_row in range(bounds[0].shape[0]):
        for tile_column in range(bounds[0].shape[1]):
            top, left = TILE * tile_row, TILE * tile_column
            bottom, right = min(top + TILE, height), min(left + TILE, width)
            sunny = _meets(bounds[0], tile_row, tile_column, cuttings[0])
            open_ = _meets(bounds[1], tile_row, tile_column, cuttings[1])
            near, far = drawn.corner, drawn.nearest.shape
            covered = left < near[0] + far[1] // 2 and right > near[0]
            covered = covered and top < near[1] + far[0] // 2 and bottom > near[1]
            if not (sunny or open_ or covered):
                continue
            for row in range(top, bottom):
                for column in range(left, right):
                    for k in range(3):
                        part[row - top, column - left, k] = lit.color[row, column, k]
            changed = False
            if sunny and _cast(part, lit.by_sun, lit.in_sun, cuttings[0], top, left):
                changed = True
            if open_ and _cast(part, lit.by_sky, lit.in_sky, cuttings[1], top, left):
                changed = True
            if covered and _blend(part, drawn, top, left, bottom, right):
                changed = True
            if changed:
                to_planes(part, table, planes, top, left, bottom, right)


@inlined
def _meets(bounds: Real, row: int, column: int, cutting: Cutting) -> bool:
    """Whether a tile has places in a cutting."""
    height, width = cutting.depth.shape
    left, top = cutting.corner[0], cutting.corner[1]
    across = bounds[row, column, 1] >= left and bounds[row, column, 0] < left + width
    return bool(across and bounds[row, column, 3] >= top and bounds[row, column, 2] < top + height)


@filling
def _cast(part: Real, added: Real, places: Real, cutting: Cutting, top: int, left: int) -> bool:
    """Take away the light of a lamp from a tile wherever a body stands in it; whether there is such a place."""
    height, width = cutting.depth.shape
    found, taps, depth, reach = False, cutting.taps, cutting.depth, cutting.most
    left_of, above = cutting.corner[0], cutting.corner[1]
    for row in range(top, min(top + TILE, places.shape[0])):
        for column in range(left, min(left + TILE, places.shape[1])):
            x, y = places[row, column, 0] - left_of, places[row, column, 1] - above
            if not (0 <= x < width and 0 <= y < height):
                continue
            near, dark = places[row, column, 2] + SHADOW_BIAS, 0
            if reach[int(y), int(x)] < near:
                continue
            for tap in range(len(taps)):
                u, v = taps[tap, 0], taps[tap, 1]
                # Taps are turned by quarters from pixel to pixel, so that edges are dithered and not banded.
                if column & 1:
                    u, v = -v, u
                if row & 1:
                    u, v = -u, -v
                i, j = int(y + v), int(x + u)
                if 0 <= i < height and 0 <= j < width and depth[i, j] >= near:
                    dark += 1
            if dark:
                found = True
                share = dark / len(taps)
                for k in range(3):
                    part[row - top, column - left, k] -= share * added[row, column, k]
    return found


@filling
def _blend(part: Real, drawn: Drawn, top: int, left: int, bottom: int, right: int) -> bool:
    """Draw the faces that are nearest over a tile's linear light; whether there are any.

    A pixel that one face fills is looked at in its middle, all others at their four samples.
    """
    found, corner, nearest = False, drawn.corner, drawn.nearest
    for row in range(max(top, corner[1]), min(bottom, corner[1] + nearest.shape[0] // 2)):
        for column in range(max(left, corner[0]), min(right, corner[0] + nearest.shape[1] // 2)):
            y, x = 2 * (row - corner[1]), 2 * (column - corner[0])
            i, j = row - top, column - left
            face = nearest[y, x]
            if face == nearest[y, x + 1] and face == nearest[y + 1, x] and face == nearest[y + 1, x + 1]:
                if face >= 0:
                    found = True
                    light = _light_at(face, x + 1.0, y + 1.0, drawn.screen, drawn.faces, drawn.light)
                    for k in range(3):
                        part[i, j, k] = light * drawn.colors[face, k]
                continue
            found = True
            red = green = blue = 0.0
            rest = 4
            for sample in range(4):
                face = nearest[y + sample // 2, x + sample % 2]
                if face >= 0:
                    rest -= 1
                    across, down = x + sample % 2 + 0.5, y + sample // 2 + 0.5
                    light = _light_at(face, across, down, drawn.screen, drawn.faces, drawn.light)
                    red += light * drawn.colors[face, 0]
                    green += light * drawn.colors[face, 1]
                    blue += light * drawn.colors[face, 2]
            part[i, j, 0] = (rest * part[i, j, 0] + red) / 4
            part[i, j, 1] = (rest * part[i, j, 1] + green) / 4
            part[i, j, 2] = (rest * part[i, j, 2] + blue) / 4
    return found


@inlined
def _light_at(face: int, x: float, y: float, screen: Real, faces: NDArray[np.integer], light: Real) -> float:
    """The light on a face at a sample, from that on its corners."""
    one, two, three = faces[face, 0], faces[face, 1], faces[face, 2]
    ax, ay = screen[one, 0], screen[one, 1]
    bx, by = screen[two, 0] - ax, screen[two, 1] - ay
    cx, cy = screen[three, 0] - ax, screen[three, 1] - ay
    area = bx * cy - by * cx
    b = ((x - ax) * cy - (y - ay) * cx) / area
    c = (bx * (y - ay) - by * (x - ax)) / area
    return float((1 - b - c) * light[one] + b * light[two] + c * light[three])


@filling
def to_planes(
    part: Real, table: Real, planes: tuple[Planes, Planes, Planes], top: int, left: int, bottom: int, right: int
) -> None:
    """Linear light of a part of a picture, all of its sides even, into planes; see `put_body`."""
    last = len(table) - 1
    bright, blues, reds = planes
    for row in range(top, bottom, 2):
        for column in range(left, right, 2):
            red = green = blue = 0.0
            for sample in range(4):
                i, j = row + sample // 2, column + sample % 2
                r = table[int(min(max(part[i - top, j - left, 0], 0.0), 1.0) * last + 0.5)]
                g = table[int(min(max(part[i - top, j - left, 1], 0.0), 1.0) * last + 0.5)]
                b = table[int(min(max(part[i - top, j - left, 2], 0.0), 1.0) * last + 0.5)]
                bright[i, j] = int(BLACK + 0.5 + BRIGHT * (RED * r + GREEN * g + BLUE * b))
                red, green, blue = red + r / 4, green + g / 4, blue + b / 4
            grey = RED * red + GREEN * green + BLUE * blue
            blues[row // 2, column // 2] = int(GREY + 0.5 + TO_BLUE * (blue - grey))
            reds[row // 2, column // 2] = int(GREY + 0.5 + TO_RED * (red - grey))
