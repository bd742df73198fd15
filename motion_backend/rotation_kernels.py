"""What `rotations` computes most, row by row and compiled: one call, instead of one for every product of components.

To the bit what the same lines give in numpy. Imported at the first call, since numba takes half a second. Rows are
(N, components), or (1, components) for one that is the same for all.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from scene_graphs.jit import compiled

Rows = NDArray[np.float64]


@compiled
def compose(a: Rows, b: Rows, found: Rows) -> None:
    """Rotations that apply b, then a."""
    many_a, many_b = len(a) > 1, len(b) > 1
    for row in range(len(found)):
        i, j = row if many_a else 0, row if many_b else 0
        ax, ay, az, aw = a[i, 0], a[i, 1], a[i, 2], a[i, 3]
        bx, by, bz, bw = b[j, 0], b[j, 1], b[j, 2], b[j, 3]
        found[row, 0] = aw * bx + ax * bw + ay * bz - az * by
        found[row, 1] = aw * by - ax * bz + ay * bw + az * bx
        found[row, 2] = aw * bz + ax * by - ay * bx + az * bw
        found[row, 3] = aw * bw - ax * bx - ay * by - az * bz


@compiled
def rotate(q: Rows, v: Rows, found: Rows) -> None:
    """Vectors v turned by q."""
    many_q, many_v = len(q) > 1, len(v) > 1
    for row in range(len(found)):
        i, j = row if many_q else 0, row if many_v else 0
        x, y, z, w = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        vx, vy, vz = v[j, 0], v[j, 1], v[j, 2]
        tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
        found[row, 0] = vx + w * tx + (y * tz - z * ty)
        found[row, 1] = vy + w * ty + (z * tx - x * tz)
        found[row, 2] = vz + w * tz + (x * ty - y * tx)


@compiled
def cross(a: Rows, b: Rows, found: Rows) -> None:
    """Cross products."""
    many_a, many_b = len(a) > 1, len(b) > 1
    for row in range(len(found)):
        i, j = row if many_a else 0, row if many_b else 0
        ax, ay, az = a[i, 0], a[i, 1], a[i, 2]
        bx, by, bz = b[j, 0], b[j, 1], b[j, 2]
        found[row, 0] = ay * bz - az * by
        found[row, 1] = az * bx - ax * bz
        found[row, 2] = ax * by - ay * bx


@compiled
def dot(a: Rows, b: Rows, found: Rows) -> None:
    """Products of vectors, (N, 1)."""
    many_a, many_b = len(a) > 1, len(b) > 1
    for row in range(len(found)):
        i, j = row if many_a else 0, row if many_b else 0
        found[row, 0] = a[i, 0] * b[j, 0] + a[i, 1] * b[j, 1] + a[i, 2] * b[j, 2]


@compiled
def length(v: Rows, found: Rows) -> None:
    """Lengths of vectors, (N, 1)."""
    for row in range(len(v)):
        square = 0.0
        for place in range(v.shape[1]):
            square += v[row, place] * v[row, place]
        found[row, 0] = sqrt(square)


@compiled
def normalize(v: Rows, found: Rows) -> None:
    """Vectors of unit length; zero stays zero."""
    for row in range(len(v)):
        square = 0.0
        for place in range(v.shape[1]):
            square += v[row, place] * v[row, place]
        size = max(sqrt(square), 1e-12)
        for place in range(v.shape[1]):
            found[row, place] = v[row, place] / size


@compiled
def basis_to_quat(x: Rows, y: Rows, z: Rows, found: Rows) -> None:
    """Rotations whose columns these are: of four ways to write them the one that divides by most (Shepperd 1978)."""
    for row in range(len(found)):
        xx, xy, xz = x[row, 0], x[row, 1], x[row, 2]
        yx, yy, yz = y[row, 0], y[row, 1], y[row, 2]
        zx, zy, zz = z[row, 0], z[row, 1], z[row, 2]
        trace = xx + yy + zz
        if xx >= yy and xx >= zz and xx >= trace:
            a, b, c, d = 1 - trace + 2 * xx, xy + yx, zx + xz, yz - zy
        elif yy >= zz and yy >= trace:
            a, b, c, d = xy + yx, 1 - trace + 2 * yy, yz + zy, zx - xz
        elif zz >= trace:
            a, b, c, d = zx + xz, yz + zy, 1 - trace + 2 * zz, xy - yx
        else:
            a, b, c, d = yz - zy, zx - xz, xy - yx, 1 + trace
        size = sqrt(a * a + b * b + c * c + d * d)
        found[row, 0], found[row, 1], found[row, 2], found[row, 3] = a / size, b / size, c / size, d / size
