"""Quaternions, xyzw, over leading batch dimensions. Names read a_to_b; `compose(a, b)` applies b first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IDENTITY: Array = np.array([0.0, 0.0, 0.0, 1.0])
_CONJUGATE: Array = np.array([-1.0, -1.0, -1.0, 1.0])


def compose(a: Array, b: Array) -> Array:
    """The rotation that applies b, then a. (..., 4)."""
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    return _joined(
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
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return _joined(
        vx + w * tx + (y * tz - z * ty),
        vy + w * ty + (z * tx - x * tz),
        vz + w * tz + (x * ty - y * tx),
    )


def cross(a: Array, b: Array) -> Array:
    """The cross product, broadcasting, to the bit that of numpy, whose own takes four times as long. (..., 3)."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return _joined(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def normalize(v: Array) -> Array:
    """Vectors of unit length along the last axis; a zero vector stays zero."""
    return np.asarray(v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12))


def rotvec_to_quat(v: Array) -> Array:
    """Axis times angle to quaternion. (..., 3) to (..., 4)."""
    v = np.asarray(v, dtype=np.float64)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    half = 0.5 * angle
    scale = np.where(angle > 1e-8, np.sin(half) / np.maximum(angle, 1e-8), 0.5 - angle**2 / 48)
    return np.concatenate([v * scale, np.cos(half)], axis=-1)


def quat_to_rotvec(q: Array) -> Array:
    """Quaternion to axis times angle, the shorter way round. (..., 4) to (..., 3)."""
    q = np.where(q[..., 3:] < 0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    return np.asarray(q[..., :3] * np.where(sine > 1e-8, angle / np.maximum(sine, 1e-8), 2.0))


def yaw_to_quat(yaw: Array | float) -> Array:
    """Turn about +Y, counter-clockwise seen from above. (...) to (..., 4)."""
    half = np.asarray(yaw, dtype=np.float64) / 2
    zero = np.zeros_like(half)
    return np.stack([zero, np.sin(half), zero, np.cos(half)], axis=-1)


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
    """The rotation that takes the axes to three orthonormal vectors (its columns). (..., 3) each to (..., 4)."""
    return matrix_to_quat(np.stack([x, y, z], axis=-1))


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
