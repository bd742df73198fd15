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
LIGHT, BY_SUN, BY_SKY, IN_SUN, IN_SKY = 0, 3, 6, 9, 12
"""Where in a tile what lies; three numbers each, as in `Lit`."""
OFF_SUN, OFF_SKY = 3, 4
"""The same in the part that is drawn."""
RED, GREEN, BLUE = np.float32(0.2126), np.float32(0.7152), np.float32(0.0722)
"""What each adds to brightness (BT.709)."""
BIAS: Final = np.float32(SHADOW_BIAS)
BRIGHT: Final = np.float32((WHITE - BLACK) / 255)
TO_BLUE, TO_RED = np.float32(224 / 255 / 1.8556), np.float32(224 / 255 / 1.5748)


@compiled
def to_tiles(lit: Lit) -> Real:
    """A still picture's arrays side by side and tile by tile, since a body's way through them is from tile to tile.

    (rows, columns, 15, TILE, TILE): light, what comes from the sun and from the sky, and the place in either's map.
    """
    height, width = lit.color.shape[0], lit.color.shape[1]
    tiles = np.empty(((height + TILE - 1) // TILE, (width + TILE - 1) // TILE, 15, TILE, TILE), dtype=np.float32)
    # The last may reach over the picture's edges, where nothing is.
    tiles[-1], tiles[:, -1] = -np.inf, -np.inf
    for row in range(height):
        for column in range(width):
            tile, i, j = tiles[row // TILE, column // TILE], row % TILE, column % TILE
            for k in range(3):
                tile[LIGHT + k, i, j] = lit.color[row, column, k]
                tile[BY_SUN + k, i, j] = lit.by_sun[row, column, k]
                tile[BY_SKY + k, i, j] = lit.by_sky[row, column, k]
                tile[IN_SUN + k, i, j] = lit.in_sun[row, column, k]
                tile[IN_SKY + k, i, j] = lit.in_sky[row, column, k]
    return tiles


@compiled
def tile_bounds(tiles: Real, lamp: int) -> Real:
    """Between which x and y of a lamp's map each tile lies: low x, high x, low y, high y. (rows, columns, 4)."""
    bounds = np.empty((*tiles.shape[:2], 4), dtype=np.float32)
    bounds[..., 0] = bounds[..., 2] = np.inf
    bounds[..., 1] = bounds[..., 3] = -np.inf
    for row in range(tiles.shape[0]):
        for column in range(tiles.shape[1]):
            edge, xs, ys = bounds[row, column], tiles[row, column, lamp], tiles[row, column, lamp + 1]
            for i in range(TILE):
                for j in range(TILE):
                    if xs[i, j] > -np.inf:
                        edge[0], edge[1] = min(edge[0], xs[i, j]), max(edge[1], xs[i, j])
                        edge[2], edge[3] = min(edge[2], ys[i, j]), max(edge[3], ys[i, j])
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
def light_planes(screen: Real, faces: NDArray[np.integer], light: Real, out: Array) -> None:
    """The light on every face that shows its outside as a plane over samples x and y, out[0] + x out[1] + y out[2].

    Into `out` (F, 3); all else stays.
    """
    for face in range(len(faces)):
        one, two, three = faces[face, 0], faces[face, 1], faces[face, 2]
        x, y, first = screen[one, 0], screen[one, 1], light[one]
        bx, by, cx, cy = screen[two, 0] - x, screen[two, 1] - y, screen[three, 0] - x, screen[three, 1] - y
        area = bx * cy - by * cx
        if area < 0:
            across = ((light[two] - first) * cy - (light[three] - first) * by) / area
            down = ((light[three] - first) * bx - (light[two] - first) * cx) / area
            out[face, 0], out[face, 1], out[face, 2] = first - x * across - y * down, across, down


@filling
def put_body(
    planes: tuple[Planes, Planes, Planes], tiles: Real, bounds: tuple[Real, Real], cuttings: tuple[Cutting, Cutting],
    drawn: Drawn, table: Real, part: Real,
) -> None:  # fmt: skip
    """Draw a body and its shadows into a picture's planes; `table` has sRGB, 0 to 255, for linear light.

    `part` (5, TILE, TILE) float32 is written on: a tile's light, and the shares of the lamps' that the body keeps off.
    """
    height, width = planes[0].shape
    near, far = drawn.corner, drawn.nearest.shape
    for row in range(tiles.shape[0]):
        for column in range(tiles.shape[1]):
            top, left = TILE * row, TILE * column
            bottom, right = min(top + TILE, height), min(left + TILE, width)
            covered = left < near[0] + far[1] // 2 and right > near[0]
            covered = covered and top < near[1] + far[0] // 2 and bottom > near[1]
            if covered and _fills(drawn, top, left, bottom, right):
                _blend(part, drawn, top, left, bottom, right)
                to_planes(part, table, planes, top, left, bottom, right)
                continue
            sunless = _keep_off(part, OFF_SUN, tiles, IN_SUN, row, column, bounds[0], cuttings[0])
            skyless = _keep_off(part, OFF_SKY, tiles, IN_SKY, row, column, bounds[1], cuttings[1])
            if not (sunless or skyless or covered):
                continue
            for k in range(3):
                for i in range(TILE):
                    for j in range(TILE):
                        part[k, i, j] = tiles[row, column, LIGHT + k, i, j]
            if sunless:
                _darken(part, OFF_SUN, tiles, BY_SUN, row, column)
            if skyless:
                _darken(part, OFF_SKY, tiles, BY_SKY, row, column)
            if (covered and _blend(part, drawn, top, left, bottom, right)) or sunless or skyless:
                to_planes(part, table, planes, top, left, bottom, right)


@inlined
def _keep_off(
    part: Real, off: int, tiles: Real, place: int, row: int, column: int, bounds: Real, cutting: Cutting
) -> bool:
    """Which share of a lamp's light a body keeps off every pixel of a tile; whether any of it."""
    height, width = cutting.depth.shape
    left, top = cutting.corner[0], cutting.corner[1]
    found = bounds[row, column, 1] >= left and bounds[row, column, 0] < left + width
    if found and bounds[row, column, 3] >= top and bounds[row, column, 2] < top + height:
        found = False
        for i in range(TILE):
            for j in range(TILE):
                x = tiles[row, column, place, i, j] - np.float32(left)
                y = tiles[row, column, place + 1, i, j] - np.float32(top)
                dark = np.float32(0)
                if 0 <= x < width and 0 <= y < height:
                    dark = _dark(x, y, tiles[row, column, place + 2, i, j] + BIAS, 2 * (i & 1) + (j & 1), cutting)
                part[off, i, j] = dark
                found = found or dark > 0
    else:
        found = False
    return bool(found)


@inlined
def _dark(x: float, y: float, near: float, turn: int, cutting: Cutting) -> np.float32:
    """The share of taps around a place in a cutting that the body is nearer to the lamp at."""
    height, width = cutting.depth.shape
    across, down = np.uint32(x), np.uint32(y)
    dark = np.float32(0)
    # Where all around is nearer than the place, or nothing is, the taps need not be read.
    if cutting.least[down, across] >= near:
        dark = np.float32(1)
    elif cutting.most[down, across] >= near:
        taps = cutting.taps
        for tap in range(taps.shape[1]):
            # What is left of a cutting or above it becomes a large number.
            across, down = np.uint32(np.int32(x + taps[turn, tap, 0])), np.uint32(np.int32(y + taps[turn, tap, 1]))
            if across < width and down < height and cutting.depth[down, across] >= near:
                dark += np.float32(1)
        dark /= np.float32(taps.shape[1])
    return dark


@inlined
def _darken(part: Real, off: int, tiles: Real, lamp: int, row: int, column: int) -> None:
    """Take from a tile's light what is kept off of a lamp's."""
    for k in range(3):
        for i in range(TILE):
            for j in range(TILE):
                part[k, i, j] -= part[off, i, j] * tiles[row, column, lamp + k, i, j]


@inlined
def _fills(drawn: Drawn, top: int, left: int, bottom: int, right: int) -> bool:
    """Whether a body leaves nothing to be seen of a tile."""
    y, x = 2 * (top - drawn.corner[1]), 2 * (left - drawn.corner[0])
    high, wide = 2 * (bottom - top), 2 * (right - left)
    filled = y >= 0 and x >= 0 and y + high <= drawn.nearest.shape[0] and x + wide <= drawn.nearest.shape[1]
    if filled:
        for i in range(y, y + high):
            for j in range(x, x + wide):
                if drawn.nearest[i, j] < 0:
                    filled = False
                    break
            if not filled:
                break
    return bool(filled)


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
                    light = _light_at(face, x + 1.0, y + 1.0, drawn.light)
                    for k in range(3):
                        part[k, i, j] = light * drawn.colors[face, k]
                continue
            found = True
            red = green = blue = 0.0
            rest = 4
            for sample in range(4):
                face = nearest[y + sample // 2, x + sample % 2]
                if face >= 0:
                    rest -= 1
                    across, down = x + sample % 2 + 0.5, y + sample // 2 + 0.5
                    light = _light_at(face, across, down, drawn.light)
                    red += light * drawn.colors[face, 0]
                    green += light * drawn.colors[face, 1]
                    blue += light * drawn.colors[face, 2]
            part[0, i, j] = (rest * part[0, i, j] + red) / 4
            part[1, i, j] = (rest * part[1, i, j] + green) / 4
            part[2, i, j] = (rest * part[2, i, j] + blue) / 4
    return found


@inlined
def _light_at(face: int, x: float, y: float, light: Array) -> float:
    """The light on a face at a sample."""
    return float(light[face, 0] + x * light[face, 1] + y * light[face, 2])


@filling
def to_planes(
    part: Real, table: Real, planes: tuple[Planes, Planes, Planes], top: int, left: int, bottom: int, right: int
) -> None:
    """Linear light of a part of a picture, all of its sides even, into planes; see `put_body`."""
    last, half, none, all_ = np.float32(len(table) - 1), np.float32(0.5), np.float32(0), np.float32(1)
    quarter, black, grey = np.float32(0.25), np.float32(BLACK + 0.5), np.float32(GREY + 0.5)
    bright, blues, reds = planes
    for row in range(top, bottom, 2):
        for column in range(left, right, 2):
            red = green = blue = none
            for sample in range(4):
                i, j = row + sample // 2, column + sample % 2
                r = table[np.uint32(min(max(part[0, i - top, j - left], none), all_) * last + half)]
                g = table[np.uint32(min(max(part[1, i - top, j - left], none), all_) * last + half)]
                b = table[np.uint32(min(max(part[2, i - top, j - left], none), all_) * last + half)]
                bright[i, j] = np.uint8(black + BRIGHT * (RED * r + GREEN * g + BLUE * b))
                red, green, blue = red + r, green + g, blue + b
            level = RED * red + GREEN * green + BLUE * blue
            blues[row // 2, column // 2] = np.uint8(grey + TO_BLUE * quarter * (blue - level))
            reds[row // 2, column // 2] = np.uint8(grey + TO_RED * quarter * (red - level))
