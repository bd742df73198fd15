"""Quaternions, xyzw, over leading batch dimensions. Names read a_to_b; `compose(a, b)` applies b first."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
X = TypeVar("X", float, Array)
"""A component of one rotation or vector, or of many."""
IDENTITY: Array = np.array([0.0, 0.0, 0.0, 1.0])
_CONJUGATE: Array = np.array([-1.0, -1.0, -1.0, 1.0])


def compose(a: Array, b: Array) -> Array:
    """The rotation that applies b, then a. (..., 4)."""
    if _lone(a, b):
        return _alone(_composed(*a.ravel().tolist(), *b.ravel().tolist()), a, b)
    return _joined(*_composed(*_components(a), *_components(b)))


def _composed(ax: X, ay: X, az: X, aw: X, bx: X, by: X, bz: X, bw: X) -> tuple[X, X, X, X]:
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(q: Array) -> Array:
    """The rotation that undoes q. (..., 4)."""
    return np.asarray(q * _CONJUGATE)


def rotate(q: Array, v: Array) -> Array:
    """Vectors v turned by q, broadcasting. (..., 3)."""
    if _lone(q, v):
        return _alone(_rotated(*q.ravel().tolist(), *v.ravel().tolist()), q, v)
    return _joined(*_rotated(*_components(q), *_components(v)))


def _rotated(x: X, y: X, z: X, w: X, vx: X, vy: X, vz: X) -> tuple[X, X, X]:
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + (y * tz - z * ty),
        vy + w * ty + (z * tx - x * tz),
        vz + w * tz + (x * ty - y * tx),
    )


def cross(a: Array, b: Array) -> Array:
    """The cross product, broadcasting, to the bit that of numpy, whose own takes four times as long. (..., 3)."""
    if _lone(a, b):
        return _alone(_crossed(*a.ravel().tolist(), *b.ravel().tolist()), a, b)
    return _joined(*_crossed(*_components(a), *_components(b)))


def _crossed(ax: X, ay: X, az: X, bx: X, by: X, bz: X) -> tuple[X, X, X]:
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def dot(a: Array, b: Array) -> Array:
    """The products of vectors, broadcasting, the last axis kept. (..., 3) to (..., 1)."""
    ax, ay, az = _components(a)
    bx, by, bz = _components(b)
    return np.asarray(ax * bx + ay * by + az * bz)[..., None]


def length(v: Array) -> Array:
    """The lengths of vectors, the last axis kept; np.linalg.norm takes twice as long. (..., N) to (..., 1)."""
    first, *rest = _components(v)
    square = first * first
    for component in rest:
        square = square + component * component
    return np.asarray(np.sqrt(square))[..., None]


def normalize(v: Array) -> Array:
    """Vectors of unit length along the last axis; a zero vector stays zero."""
    return np.asarray(v / np.maximum(length(v), 1e-12))


def rotvec_to_quat(v: Array) -> Array:
    """Axis times angle to quaternion. (..., 3) to (..., 4)."""
    v = np.asarray(v, dtype=np.float64)
    found = np.empty((*v.shape[:-1], 4))
    angle = length(v)
    half = 0.5 * angle
    np.multiply(v, _sine_share(angle, half), out=found[..., :3])
    found[..., 3:] = np.cos(half)
    return found


def axis_to_quat(axis: str, angle: Array) -> Array:
    """Turns about "x", "y" or "z", to the bit as `rotvec_to_quat` has them. (...) to (..., 4)."""
    size = np.abs(angle)
    half = 0.5 * size
    found = np.zeros((*size.shape, 4))
    found[..., "xyz".index(axis)] = angle * _sine_share(size, half)
    found[..., 3] = np.cos(half)
    return found


def _sine_share(angle: Array, half: Array) -> Array:
    return np.where(angle > 1e-8, np.sin(half) / np.maximum(angle, 1e-8), 0.5 - angle**2 / 48)


def quat_to_rotvec(q: Array) -> Array:
    """Quaternion to axis times angle, the shorter way round. (..., 4) to (..., 3)."""
    q = np.where(q[..., 3:] < 0, -q, q)
    sine = length(q[..., :3])
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    return np.asarray(q[..., :3] * np.where(sine > 1e-8, angle / np.maximum(sine, 1e-8), 2.0))


def yaw_to_quat(yaw: Array | float) -> Array:
    """Turn about +Y, counter-clockwise seen from above. (...) to (..., 4)."""
    half = np.asarray(yaw, dtype=np.float64) / 2
    found = np.zeros((*np.shape(half), 4))
    found[..., 1], found[..., 3] = np.sin(half), np.cos(half)
    return found


def matrix_to_quat(m: Array) -> Array:
    """Rotation matrices to quaternions. (..., 3, 3) to (..., 4)."""
    from scipy.spatial.transform import Rotation

    flat = Rotation.from_matrix(m.reshape(-1, 3, 3)).as_quat()
    return np.asarray(flat.reshape((*m.shape[:-2], 4)))


def quat_to_matrix(q: Array) -> Array:
    """Quaternions to rotation matrices. (..., 4) to (..., 3, 3)."""
    q = np.asarray(q, dtype=np.float64)
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    entries = _joined(
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    )  # fmt: skip
    return entries.reshape((*q.shape[:-1], 3, 3))


def basis_to_quat(x: Array, y: Array, z: Array) -> Array:
    """The rotation that takes the axes to three orthonormal vectors (its columns). (..., 3) each to (..., 4).

    Of the four ways to write it the one that divides by most (Shepperd 1978).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = _components(x), _components(y), _components(z)
    trace = xx + yy + zz
    most = np.argmax(_joined(xx, yy, zz, trace), axis=-1)
    ways = np.empty((*most.shape, 4, 4))
    for way, component in enumerate((xx, yy, zz)):
        ways[..., way, way] = 1 - trace + 2 * component
    ways[..., 0, 1] = ways[..., 1, 0] = xy + yx
    ways[..., 1, 2] = ways[..., 2, 1] = yz + zy
    ways[..., 2, 0] = ways[..., 0, 2] = zx + xz
    ways[..., 3, 0] = ways[..., 0, 3] = yz - zy
    ways[..., 3, 1] = ways[..., 1, 3] = zx - xz
    ways[..., 3, 2] = ways[..., 2, 3] = xy - yx
    ways[..., 3, 3] = 1 + trace
    found = np.take_along_axis(ways, most[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(found / length(found))


def slerp(a: Array, b: Array, t: Array | float) -> Array:
    """The way from a to b at share t, the shorter arc, broadcasting. (..., 4)."""
    delta = quat_to_rotvec(compose(inverse(a), b))
    share = np.asarray(t, dtype=np.float64)[..., None]
    return compose(a, rotvec_to_quat(delta * share))


def continuous(q: Array) -> Array:
    """The same rotations with signs chosen so that neighbours in time stay in one hemisphere. (T, ..., 4)."""
    flips = np.sum(q[1:] * q[:-1], axis=-1) < 0
    sign = np.where(np.cumsum(flips, axis=0) % 2 == 1, -1.0, 1.0)
    out = q.copy()
    out[1:] *= sign[..., None]
    return out


def wrap(angle: Array | float) -> Array:
    """Angles brought into (-pi, pi]."""
    return np.asarray(np.pi - np.mod(np.pi - np.asarray(angle, dtype=np.float64), 2 * np.pi))


def _joined(*components: Array) -> Array:
    """Components of one shape side by side along a new last axis; np.stack takes longer for the few of a vector."""
    first = components[0]
    found = np.empty((*first.shape, len(components)), first.dtype)
    for place, component in enumerate(components):
        found[..., place] = component
    return found


def _components(v: Array) -> list[Array]:
    return [v[..., place] for place in range(v.shape[-1])]


def _lone(a: Array, b: Array) -> bool:
    """Whether two arrays hold one rotation or vector each: plain numbers then take a fifth of the time."""
    return a.size == a.shape[-1] and b.size == b.shape[-1] and a.dtype.char == "d" == b.dtype.char


def _alone(values: tuple[float, ...], a: Array, b: Array) -> Array:
    """The one result of two arrays of one rotation or vector each, in the shape that they broadcast to."""
    return np.array(values).reshape((*max(a.shape[:-1], b.shape[:-1], key=len), len(values)))
