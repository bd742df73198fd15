"""What `rotations` computes, row by row and compiled: one call, instead of one for every product of components.

Imported at the first call, since numba takes half a second. Arrays are (N, M, components) however they lie in memory;
of several one may have one row for all, in N, in M or in both.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from scene_graphs.jit import filling_rows

Rows = NDArray[np.float64]
TINY = 1e-8
"""Below so many radians an angle's sine is the first terms of its series."""
_of_one, _of_two, _of_three = map(filling_rows, (1, 2, 3))


@_of_two
def compose(a: Rows, b: Rows, found: Rows) -> None:
    """Rotations that apply b, then a."""
    (rows_a, columns_a), (rows_b, columns_b) = a.shape[:2], b.shape[:2]
    for row in range(found.shape[0]):
        i, k = min(row, rows_a - 1), min(row, rows_b - 1)
        for column in range(found.shape[1]):
            j, m = min(column, columns_a - 1), min(column, columns_b - 1)
            ax, ay, az, aw = a[i, j, 0], a[i, j, 1], a[i, j, 2], a[i, j, 3]
            bx, by, bz, bw = b[k, m, 0], b[k, m, 1], b[k, m, 2], b[k, m, 3]
            found[row, column, 0] = aw * bx + ax * bw + ay * bz - az * by
            found[row, column, 1] = aw * by - ax * bz + ay * bw + az * bx
            found[row, column, 2] = aw * bz + ax * by - ay * bx + az * bw
            found[row, column, 3] = aw * bw - ax * bx - ay * by - az * bz


@_of_two
def rotate(a: Rows, b: Rows, found: Rows) -> None:
    """Vectors b turned by a."""
    (rows_a, columns_a), (rows_b, columns_b) = a.shape[:2], b.shape[:2]
    for row in range(found.shape[0]):
        i, k = min(row, rows_a - 1), min(row, rows_b - 1)
        for column in range(found.shape[1]):
            j, m = min(column, columns_a - 1), min(column, columns_b - 1)
            x, y, z, w = a[i, j, 0], a[i, j, 1], a[i, j, 2], a[i, j, 3]
            vx, vy, vz = b[k, m, 0], b[k, m, 1], b[k, m, 2]
            tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
            found[row, column, 0] = vx + w * tx + (y * tz - z * ty)
            found[row, column, 1] = vy + w * ty + (z * tx - x * tz)
            found[row, column, 2] = vz + w * tz + (x * ty - y * tx)


@_of_two
def cross(a: Rows, b: Rows, found: Rows) -> None:
    """Cross products."""
    (rows_a, columns_a), (rows_b, columns_b) = a.shape[:2], b.shape[:2]
    for row in range(found.shape[0]):
        i, k = min(row, rows_a - 1), min(row, rows_b - 1)
        for column in range(found.shape[1]):
            j, m = min(column, columns_a - 1), min(column, columns_b - 1)
            ax, ay, az = a[i, j, 0], a[i, j, 1], a[i, j, 2]
            bx, by, bz = b[k, m, 0], b[k, m, 1], b[k, m, 2]
            found[row, column, 0] = ay * bz - az * by
            found[row, column, 1] = az * bx - ax * bz
            found[row, column, 2] = ax * by - ay * bx


@_of_two
def dot(a: Rows, b: Rows, found: Rows) -> None:
    """Products of vectors, (N, M, 1)."""
    (rows_a, columns_a), (rows_b, columns_b) = a.shape[:2], b.shape[:2]
    for row in range(found.shape[0]):
        i, k = min(row, rows_a - 1), min(row, rows_b - 1)
        for column in range(found.shape[1]):
            j, m = min(column, columns_a - 1), min(column, columns_b - 1)
            found[row, column, 0] = a[i, j, 0] * b[k, m, 0] + a[i, j, 1] * b[k, m, 1] + a[i, j, 2] * b[k, m, 2]


@_of_one
def length(v: Rows, found: Rows) -> None:
    """Lengths of vectors, (N, M, 1)."""
    for row in range(v.shape[0]):
        for column in range(v.shape[1]):
            square = 0.0
            for place in range(v.shape[2]):
                square += v[row, column, place] * v[row, column, place]
            found[row, column, 0] = sqrt(square)


@_of_one
def normalize(v: Rows, found: Rows) -> None:
    """Vectors of unit length; zero stays zero."""
    for row in range(v.shape[0]):
        for column in range(v.shape[1]):
            square = 0.0
            for place in range(v.shape[2]):
                square += v[row, column, place] * v[row, column, place]
            size = max(sqrt(square), 1e-12)
            for place in range(v.shape[2]):
                found[row, column, place] = v[row, column, place] / size


@_of_one
def rotvec_to_quat(v: Rows, found: Rows) -> None:
    """Axis times angle to quaternion."""
    for row in range(v.shape[0]):
        for column in range(v.shape[1]):
            x, y, z = v[row, column, 0], v[row, column, 1], v[row, column, 2]
            angle = sqrt(x * x + y * y + z * z)
            share = sin(0.5 * angle) / angle if angle > TINY else 0.5 - angle * angle / 48
            found[row, column, 0], found[row, column, 1], found[row, column, 2] = x * share, y * share, z * share
            found[row, column, 3] = cos(0.5 * angle)


@_of_one
def quat_to_rotvec(q: Rows, found: Rows) -> None:
    """Quaternion to axis times angle, the shorter way round."""
    for row in range(q.shape[0]):
        for column in range(q.shape[1]):
            x, y, z, w = q[row, column, 0], q[row, column, 1], q[row, column, 2], q[row, column, 3]
            if w < 0:
                x, y, z, w = -x, -y, -z, -w
            sine = sqrt(x * x + y * y + z * z)
            share = 2.0 * atan2(sine, w) / sine if sine > TINY else 2.0
            found[row, column, 0], found[row, column, 1], found[row, column, 2] = x * share, y * share, z * share


@_of_three
def basis_to_quat(x: Rows, y: Rows, z: Rows, found: Rows) -> None:
    """Rotations whose columns these are: of four ways to write them the one that divides by most (Shepperd 1978)."""
    (rows_x, columns_x), (rows_y, columns_y), (rows_z, columns_z) = x.shape[:2], y.shape[:2], z.shape[:2]
    for row in range(found.shape[0]):
        i, k, r = min(row, rows_x - 1), min(row, rows_y - 1), min(row, rows_z - 1)
        for column in range(found.shape[1]):
            j, m, s = min(column, columns_x - 1), min(column, columns_y - 1), min(column, columns_z - 1)
            xx, xy, xz = x[i, j, 0], x[i, j, 1], x[i, j, 2]
            yx, yy, yz = y[k, m, 0], y[k, m, 1], y[k, m, 2]
            zx, zy, zz = z[r, s, 0], z[r, s, 1], z[r, s, 2]
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
            found[row, column, 0], found[row, column, 1] = a / size, b / size
            found[row, column, 2], found[row, column, 3] = c / size, d / size
