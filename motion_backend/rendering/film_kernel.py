"""A moving body put into a still picture: its shadows on what is there, then itself; compiled.

Imported late: see `film_backdrop`. Nothing is checked: whoever calls has checked it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.rasterizer import Ints, Real
from motion_backend.rotations import Array
from scene_graphs.jit import compiled

Bytes = NDArray[np.uint8]


@compiled
def shadow_bounds(places: Real, corner: Ints, depth: Array) -> Ints:
    """The least box of pixels (left, top, right, bottom) that lie in a cutting of a lamp's map; see `cast_shadow`."""
    height, width = depth.shape
    rows, columns = places.shape[0], places.shape[1]
    left, top, right, bottom = columns, rows, 0, 0
    for row in range(rows):
        for column in range(columns):
            x, y = places[row, column, 0] - corner[0], places[row, column, 1] - corner[1]
            if 0 <= x < width and 0 <= y < height:
                left, right = min(left, column), max(right, column + 1)
                top, bottom = min(top, row), row + 1
    return np.array([left, top, right, bottom])


@compiled
def cast_shadow(out: Real, added: Real, places: Real, corner: Ints, depth: Array, taps: Real, bias: float) -> None:
    """Take away the light of a lamp wherever a body stands in it.

    `out` (H, W, 3) is linear light, `added` (H, W, 3) what of it comes from the lamp, `places` (H, W, 3) where in the
    lamp's map each pixel is. `depth` (h, w) is a cutting of that map with the body alone in it, its upper left pixel
    `corner`, `taps` (K, 2) are in pixels.
    """
    height, width = depth.shape
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            x, y = places[row, column, 0] - corner[0], places[row, column, 1] - corner[1]
            if not (0 <= x < width and 0 <= y < height):
                continue
            near, dark = places[row, column, 2] + bias, 0
            for u, v in taps:
                # Taps are turned by quarters from pixel to pixel, so that edges are dithered and not banded.
                if column & 1:
                    u, v = -v, u
                if row & 1:
                    u, v = -u, -v
                i, j = int(y + v), int(x + u)
                if 0 <= i < height and 0 <= j < width and depth[i, j] >= near:
                    dark += 1
            share = dark / len(taps)
            for k in range(3):
                out[row, column, k] -= share * added[row, column, k]


@compiled
def blend_body(out: Real, nearest: Ints, corner: Ints, screen: Real, brightness: Real, colors: Real) -> None:
    """Draw the faces that are nearest over linear light `out` (H, W, 3), four samples a pixel.

    `nearest` (2 h, 2 w) has a face's number, or -1 where none is nearest; its upper left sample is that of the pixel
    `corner`. `screen` (F, 3, 3) is where faces are in samples, `brightness` (F, 3) the light on their corners, `colors`
    (F, 3) linear.
    """
    for row in range(nearest.shape[0] // 2):
        for column in range(nearest.shape[1] // 2):
            red = green = blue = 0.0
            covered = 0
            for sample in range(4):
                i, j = 2 * row + sample // 2, 2 * column + sample % 2
                face = nearest[i, j]
                if face < 0:
                    continue
                covered += 1
                x, y = 2 * corner[0] + j + 0.5, 2 * corner[1] + i + 0.5
                ax, ay = screen[face, 0, 0], screen[face, 0, 1]
                bx, by = screen[face, 1, 0] - ax, screen[face, 1, 1] - ay
                cx, cy = screen[face, 2, 0] - ax, screen[face, 2, 1] - ay
                area = bx * cy - by * cx
                b = ((x - ax) * cy - (y - ay) * cx) / area
                c = (bx * (y - ay) - by * (x - ax)) / area
                light = (1 - b - c) * brightness[face, 0] + b * brightness[face, 1] + c * brightness[face, 2]
                red += light * colors[face, 0]
                green += light * colors[face, 1]
                blue += light * colors[face, 2]
            if covered:
                pixel = out[corner[1] + row, corner[0] + column]
                left = (4 - covered) / 4
                pixel[0] = left * pixel[0] + red / 4
                pixel[1] = left * pixel[1] + green / 4
                pixel[2] = left * pixel[2] + blue / 4


@compiled
def to_bytes(light: Real, table: Bytes, out: Bytes) -> None:
    """Linear light (H, W, 3) by a table of sRGB bytes."""
    last = len(table) - 1
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            for k in range(3):
                out[row, column, k] = table[int(min(max(light[row, column, k], 0.0), 1.0) * last + 0.5)]
