"""Quaternions, xyzw, over leading batch dimensions. Names read a_to_b; `compose(a, b)` applies b first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IDENTITY: Array = np.array([0.0, 0.0, 0.0, 1.0])
_CONJUGATE: Array = np.array([-1.0, -1.0, -1.0, 1.0])


@cache
def _compiled() -> ModuleType:
    """Imported when something is first turned: numba takes half a second, and many commands turn nothing."""
    from motion_backend import rotation_kernels

    return rotation_kernels


def _filled(kernel: Callable[..., None], columns: tuple[int, ...], size: int, *arrays: Array) -> Array:
    """What a kernel makes of arrays that are broadcast but for their last axes, of so many `columns`. (..., size).

    Raises ValueError for others: a kernel does not look where an array ends.
    """
    if tuple(array.shape[-1] for array in arrays) != columns:
        raise ValueError(f"the last axes are {[array.shape for array in arrays]}, not {columns}")
    lead = arrays[0].shape[:-1]
    if len(arrays) == 2 and (other := arrays[1].shape[:-1]) != lead:
        both = np.broadcast_shapes(lead, other)
        # One row for all needs no copies of it.
        arrays = tuple(
            array if array.size == array.shape[-1] else np.broadcast_to(array, (*both, array.shape[-1]))
            for array in arrays
        )
        lead = both
    rows = [np.ascontiguousarray(array, dtype=np.float64).reshape(-1, array.shape[-1]) for array in arrays]
    found = np.empty((*lead, size))
    kernel(*rows, found.reshape(-1, size))
    return found


def compose(a: Array, b: Array) -> Array:
    """The rotation that applies b, then a, broadcasting. (..., 4)."""
    return _filled(_compiled().compose, (4, 4), 4, a, b)


def inverse(q: Array) -> Array:
    """The rotation that undoes q. (..., 4)."""
    return np.asarray(q * _CONJUGATE)


def rotate(q: Array, v: Array) -> Array:
    """Vectors v turned by q, broadcasting. (..., 3)."""
    return _filled(_compiled().rotate, (4, 3), 3, q, v)


def cross(a: Array, b: Array) -> Array:
    """The cross product, broadcasting. (..., 3)."""
    return _filled(_compiled().cross, (3, 3), 3, a, b)


def dot(a: Array, b: Array) -> Array:
    """The products of vectors, broadcasting, the last axis kept. (..., 3) to (..., 1)."""
    return _filled(_compiled().dot, (3, 3), 1, a, b)


def length(v: Array) -> Array:
    """The lengths of vectors, the last axis kept. (..., N) to (..., 1)."""
    return _filled(_compiled().length, v.shape[-1:], 1, v)


def normalize(v: Array) -> Array:
    """Vectors of unit length along the last axis; a zero vector stays zero."""
    return _filled(_compiled().normalize, v.shape[-1:], v.shape[-1], v)


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
    entries = [
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return np.stack(entries, axis=-1).reshape((*q.shape[:-1], 3, 3))


def basis_to_quat(x: Array, y: Array, z: Array) -> Array:
    """The rotation that takes the axes to three orthonormal vectors (its columns). (..., 3) each to (..., 4)."""
    return _filled(_compiled().basis_to_quat, (3, 3, 3), 4, *np.broadcast_arrays(x, y, z))


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
