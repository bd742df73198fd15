"""What light comes from every pixel of a still picture, and how much of it from either lamp; compiled.

Imported late: see `renderer`. Nothing is checked: whoever calls has checked it.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from motion_backend.rendering.light_values import Lit, Palette, Shading, Surfaces
from motion_backend.rendering.rasterizer import Ints, Lens, Real
from motion_backend.rotations import Array
from scene_graphs.jit import compiled, filling, inlined

TURNS: Final = np.arange(4) * np.pi / 8
COS, SIN = np.cos(TURNS), np.sin(TURNS)
"""Of how far each of a pixel's four samples turns the taps of a shadow map."""


@filling
def shade_picture(
    nearest: Ints, nearness: Array, surfaces: Surfaces, lens: Lens, sun: Shading, sky: Shading, light: Palette,
    lit: Lit, found: Array, total: Array,
) -> None:  # fmt: skip
    """Fill `lit` from what is nearest in four samples a pixel, both (2 H, 2 W); see `depth_buffer.draw`.

    A pixel that one triangle fills is looked at in its middle, all others at their four samples. `found` and `total`
    (15,) are written on.
    """
    for row in range(lit.color.shape[0]):
        for column in range(lit.color.shape[1]):
            y, x = 2 * row, 2 * column
            first = nearest[y, x]
            total[:] = 0.0
            if first >= 0 and first == nearest[y, x + 1] and first == nearest[y + 1, x] == nearest[y + 1, x + 1]:
                near = (nearness[y, x] + nearness[y, x + 1] + nearness[y + 1, x] + nearness[y + 1, x + 1]) / 4
                turn = column % 2 + 2 * (row % 2)
                _shade(first, x + 1.0, y + 1.0, near, turn, surfaces, lens, sun, sky, light, total)
            else:
                for sample in range(4):
                    i, j = y + sample // 2, x + sample % 2
                    if nearest[i, j] >= 0:
                        near = nearness[i, j]
                        _shade(nearest[i, j], j + 0.5, i + 0.5, near, sample, surfaces, lens, sun, sky, light, found)
                    else:
                        up = _rise(j + 0.5, i + 0.5, lens, light)
                        for k in range(3):
                            found[k] = light.horizon[k] + up * (light.zenith[k] - light.horizon[k])
                            found[3 + k] = found[6 + k] = 0.0
                            found[9 + k] = found[12 + k] = -np.inf
                    for k in range(15):
                        total[k] += found[k] / 4
            for k in range(3):
                lit.color[row, column, k] = total[k]
                lit.by_sun[row, column, k] = total[3 + k]
                lit.by_sky[row, column, k] = total[6 + k]
                lit.in_sun[row, column, k] = total[9 + k]
                lit.in_sky[row, column, k] = total[12 + k]


@inlined
def _shade(
    face: int, x: float, y: float, near: float, turn: int,
    surfaces: Surfaces, lens: Lens, sun: Shading, sky: Shading, light: Palette, out: Array,
) -> None:  # fmt: skip
    """Light, its two parts, and both places of one sample of one triangle. Into `out` (15,)."""
    depth = -near if lens.parallel else 1.0 / near
    scale = lens.scale if lens.parallel else lens.scale * depth
    right, up = (x - lens.middle[0]) * scale, (lens.middle[1] - y) * scale
    axes, eye = lens.axes, lens.eye
    px = eye[0] + right * axes[0, 0] + up * axes[1, 0] + depth * axes[2, 0]
    py = eye[1] + right * axes[0, 1] + up * axes[1, 1] + depth * axes[2, 1]
    pz = eye[2] + right * axes[0, 2] + up * axes[1, 2] + depth * axes[2, 2]
    nx, ny, nz = surfaces.flat[face, 0], surfaces.flat[face, 1], surfaces.flat[face, 2]
    if surfaces.is_smooth[face]:
        nx, ny, nz = _smooth_normal(face, px, py, pz, surfaces.corners, surfaces.normals)
    rx, ry, rz, distance = -axes[2, 0], -axes[2, 1], -axes[2, 2], 0.0
    if not lens.parallel:
        rx, ry, rz = eye[0] - px, eye[1] - py, eye[2] - pz
        distance = np.sqrt(rx * rx + ry * ry + rz * rz)
        rx, ry, rz = rx / distance, ry / distance, rz / distance
    facing = nx * rx + ny * ry + nz * rz
    if facing < 0:
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    ox, oy, oz = px + light.offset * nx, py + light.offset * ny, pz + light.offset * nz
    direct = light.sun * (nx * sun.direction[0] + ny * sun.direction[1] + nz * sun.direction[2])
    if direct > 0:
        direct *= share_of(ox, oy, oz, turn, sun, light.bias)
    else:
        direct = 0.0
    above = 0.5 + 0.5 * ny
    around = light.sky * above + light.bounce * (1 - above)
    shaded = (1 - light.open_sky) * around
    shaded *= share_of(ox, oy, oz, turn, sky, light.bias)
    lines = 1.0
    if light.grid > 0 and abs(py) < 0.006 and ny > 0.99:
        lines = _grid(px, pz, distance, light.grid)
    away = np.sqrt((px - lens.target[0]) ** 2 + (pz - lens.target[2]) ** 2)
    haze = min(max((away - light.haze_start) / light.haze_depth, 0.0), 1.0)
    for k in range(3):
        color = surfaces.color[face, k] * lines * (1 - haze)
        rest = color * (light.open_sky * around + light.camera * facing)
        out[3 + k], out[6 + k] = color * direct, color * shaded
        out[k] = rest + out[3 + k] + out[6 + k] + haze * light.horizon[k]
        out[9 + k] = _place(px, py, pz, sun.matrix, k)
        out[12 + k] = _place(px, py, pz, sky.matrix, k)


@inlined
def _rise(x: float, y: float, lens: Lens, light: Palette) -> float:
    """How far from the horizon to where the sky is quite another colour one looks in a sample, 0 to 1."""
    axes, rise = lens.axes, lens.axes[2, 1]
    if not lens.parallel:
        right, up = (x - lens.middle[0]) * lens.scale, (lens.middle[1] - y) * lens.scale
        rise = (rise + right * axes[0, 1] + up * axes[1, 1]) / np.sqrt(1.0 + right * right + up * up)
    return float(min(max(rise / light.rise, 0.0), 1.0))


@inlined
def _smooth_normal(
    face: int, x: float, y: float, z: float, corners: Array, normals: Real
) -> tuple[float, float, float]:
    """The unit normal at a point of a triangle, from those of its corners."""
    ax, ay, az = corners[face, 0, 0], corners[face, 0, 1], corners[face, 0, 2]
    sx, sy, sz = corners[face, 1, 0] - ax, corners[face, 1, 1] - ay, corners[face, 1, 2] - az
    ox, oy, oz = corners[face, 2, 0] - ax, corners[face, 2, 1] - ay, corners[face, 2, 2] - az
    gx, gy, gz = x - ax, y - ay, z - az
    a, b, c = sx * sx + sy * sy + sz * sz, sx * ox + sy * oy + sz * oz, ox * ox + oy * oy + oz * oz
    d, e = gx * sx + gy * sy + gz * sz, gx * ox + gy * oy + gz * oz
    area = max(a * c - b * b, 1e-18)
    u, v = (c * d - b * e) / area, (a * e - b * d) / area
    w = 1 - u - v
    nx = w * normals[face, 0, 0] + u * normals[face, 1, 0] + v * normals[face, 2, 0]
    ny = w * normals[face, 0, 1] + u * normals[face, 1, 1] + v * normals[face, 2, 1]
    nz = w * normals[face, 0, 2] + u * normals[face, 1, 2] + v * normals[face, 2, 2]
    length = np.sqrt(max(nx * nx + ny * ny + nz * nz, 1e-18))
    return nx / length, ny / length, nz / length


@inlined
def share_of(x: float, y: float, z: float, turn: int, lamp: Shading, bias: float) -> float:
    """The share of a lamp's light that reaches a point: of the taps around it, turned, those that nothing shades."""
    height, width = lamp.depth.shape
    across, down = _place(x, y, z, lamp.matrix, 0), _place(x, y, z, lamp.matrix, 1)
    near = _place(x, y, z, lamp.matrix, 2) + bias
    column, row = min(max(int(across), 0), width - 1), min(max(int(down), 0), height - 1)
    share = 1.0
    # Where nothing around is nearer to the lamp than the point, or all is, the taps need not be read.
    if lamp.least[row, column] >= near:
        share = 0.0
    elif lamp.most[row, column] >= near:
        cos, sin = COS[turn], SIN[turn]
        lit = 0
        for tap in range(lamp.taps.shape[0]):
            u, v = lamp.taps[tap, 0], lamp.taps[tap, 1]
            column = min(max(int(across + (u * cos - v * sin)), 0), width - 1)
            row = min(max(int(down + (u * sin + v * cos)), 0), height - 1)
            lit += lamp.depth[row, column] < near
        share = lit / lamp.taps.shape[0]
    return share


@inlined
def _place(x: float, y: float, z: float, matrix: Array, row: int) -> float:
    """One of a point's three numbers in a lamp's map."""
    return float(matrix[row, 0] * x + matrix[row, 1] * y + matrix[row, 2] * z + matrix[row, 3])


@inlined
def _grid(x: float, z: float, distance: float, step: float) -> float:
    """How dark the floor's lines make it at a point that far from the eye."""
    across = abs((x / step + 0.5) % 1.0 - 0.5) * step
    along = abs((z / step + 0.5) % 1.0 - 0.5) * step
    width = 0.004 + 0.0012 * distance
    return 1.0 - 0.22 * min(max(1.5 - min(across, along) / width, 0.0), 1.0)


@compiled
def extremes(depth: Real, margin: int) -> tuple[Real, Real]:
    """The greatest and the least value of a map within so many pixels, across and down, of every one."""
    height, width = depth.shape
    over, under = np.empty_like(depth), np.empty_like(depth)
    most, least = np.empty_like(depth), np.empty_like(depth)
    for row in range(height):
        for column in range(width):
            high, low = -np.inf, np.inf
            for j in range(max(column - margin, 0), min(column + margin + 1, width)):
                high, low = max(high, depth[row, j]), min(low, depth[row, j])
            over[row, column], under[row, column] = high, low
    for row in range(height):
        for column in range(width):
            high, low = -np.inf, np.inf
            for i in range(max(row - margin, 0), min(row + margin + 1, height)):
                high, low = max(high, over[i, column]), min(low, under[i, column])
            most[row, column], least[row, column] = high, low
    return most, least
