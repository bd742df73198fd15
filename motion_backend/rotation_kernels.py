"""What `rotations` computes most, compiled as ufuncs: one call, instead of one for every product of components.

To the bit what the same lines give in numpy. Imported at the first call, since numba takes half a second.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from scene_graphs.jit import compiled_ufunc

Array = NDArray[np.float64]


@compiled_ufunc("(n),(n)->(n)")
def composed(a: Array, b: Array, found: Array) -> None:
    """The rotation that applies b, then a."""
    ax, ay, az, aw = a[0], a[1], a[2], a[3]
    bx, by, bz, bw = b[0], b[1], b[2], b[3]
    found[0] = aw * bx + ax * bw + ay * bz - az * by
    found[1] = aw * by - ax * bz + ay * bw + az * bx
    found[2] = aw * bz + ax * by - ay * bx + az * bw
    found[3] = aw * bw - ax * bx - ay * by - az * bz


@compiled_ufunc("(m),(n)->(n)")
def rotated(q: Array, v: Array, found: Array) -> None:
    """v turned by q."""
    x, y, z, w = q[0], q[1], q[2], q[3]
    vx, vy, vz = v[0], v[1], v[2]
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    found[0] = vx + w * tx + (y * tz - z * ty)
    found[1] = vy + w * ty + (z * tx - x * tz)
    found[2] = vz + w * tz + (x * ty - y * tx)


@compiled_ufunc("(n),(n)->(n)")
def crossed(a: Array, b: Array, found: Array) -> None:
    """The cross product."""
    ax, ay, az = a[0], a[1], a[2]
    bx, by, bz = b[0], b[1], b[2]
    found[0] = ay * bz - az * by
    found[1] = az * bx - ax * bz
    found[2] = ax * by - ay * bx


@compiled_ufunc("(n)->()")
def lengths(v: Array, found: Array) -> None:
    """The length of a vector."""
    square = 0.0
    for component in v:
        square += component * component
    found[0] = sqrt(square)


@compiled_ufunc("(n),(n)->()")
def dotted(a: Array, b: Array, found: Array) -> None:
    """The product of two vectors."""
    found[0] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled_ufunc("(n)->(n)")
def normalized(v: Array, found: Array) -> None:
    """A vector of unit length; zero stays zero."""
    square = 0.0
    for component in v:
        square += component * component
    size = max(sqrt(square), 1e-12)
    for place in range(len(v)):
        found[place] = v[place] / size


@compiled_ufunc("(n),(n),(n),(q)->(q)")
def of_basis(x: Array, y: Array, z: Array, _: Array, found: Array) -> None:
    """The rotation whose columns these are; the fourth argument only says that it has four numbers."""
    xx, xy, xz = x[0], x[1], x[2]
    yx, yy, yz = y[0], y[1], y[2]
    zx, zy, zz = z[0], z[1], z[2]
    trace = xx + yy + zz
    if xx >= yy and xx >= zz and xx >= trace:
        found[0], found[1], found[2], found[3] = 1 - trace + 2 * xx, xy + yx, zx + xz, yz - zy
    elif yy >= zz and yy >= trace:
        found[0], found[1], found[2], found[3] = xy + yx, 1 - trace + 2 * yy, yz + zy, zx - xz
    elif zz >= trace:
        found[0], found[1], found[2], found[3] = zx + xz, yz + zy, 1 - trace + 2 * zz, xy - yx
    else:
        found[0], found[1], found[2], found[3] = yz - zy, zx - xz, xy - yx, 1 + trace
    square = 0.0
    for component in found:
        square += component * component
    size = sqrt(square)
    for place in range(4):
        found[place] /= size
