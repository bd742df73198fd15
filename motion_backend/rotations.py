"""Quaternions, xyzw, over leading batch dimensions. Names read a_to_b; `compose(a, b)` applies b first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IDENTITY: Array = np.array([0.0, 0.0, 0.0, 1.0])
_CONJUGATE: Array = np.array([-1.0, -1.0, -1.0, 1.0])
_FLOAT: Final = np.dtype(np.float64)
_RAISED: Final[dict[int, Any]] = {1: (None, None), 2: None}
"""What makes three axes of so many, and (below) so many of three."""
_LOWERED: Final[dict[int, Any]] = {1: (0, 0), 2: 0}


@cache
def _compiled() -> ModuleType:
    """Imported when something is first turned: numba takes half a second, and many commands turn nothing."""
    from motion_backend import rotation_kernels

    return rotation_kernels


def _one(kernel: Callable[..., None], wide: int, size: int, array: Array) -> Array:
    """`_filled` for one array: rows of floats, as most are, take no longer than they must."""
    shape = array.shape
    if len(shape) != 2 or shape[1] != wide or array.dtype is not _FLOAT:
        return _filled(kernel, (wide,), size, array)
    found = np.empty((shape[0], size))
    kernel(array[None], found[None])
    return found


def _two(kernel: Callable[..., None], wide: int, other: int, size: int, a: Array, b: Array) -> Array:
    """The same for two."""
    shape, beside = a.shape, b.shape
    if len(shape) != 2 or (wide, shape[0], other) != (shape[1], *beside) or not a.dtype is b.dtype is _FLOAT:
        return _filled(kernel, (wide, other), size, a, b)
    found = np.empty((shape[0], size))
    kernel(a[None], b[None], found[None])
    return found


def _filled(kernel: Callable[..., None], columns: tuple[int, ...], size: int, *arrays: Array) -> Array:
    """What a kernel makes of arrays of so many `columns` each, broadcast but for these. (..., size).

    Raises ValueError for others: a kernel does not look where an array ends.
    """
    rows, axes, number, each = [], 0, 1, 1
    for array, wide in zip(arrays, columns, strict=True):
        shape = array.shape
        if shape[-1] != wide:
            raise ValueError(f"the last axes are {[array.shape for array in arrays]}, not {columns}")
        if len(shape) > 3:
            return _flat(kernel, columns, size, *arrays)
        raised = array if len(shape) == 3 else array[_RAISED[len(shape)]]
        rows.append(raised if array.dtype is _FLOAT else raised.astype(np.float64))
        many, more, _ = raised.shape
        if (many != number and 1 not in (many, number)) or (more != each and 1 not in (more, each)):
            raise ValueError(f"{[array.shape for array in arrays]} can not be broadcast together")
        axes, number, each = max(axes, len(shape)), many if number == 1 else number, more if each == 1 else each
    found = np.empty((number, each, size))
    kernel(*rows, found)
    return found if axes == 3 else np.asarray(found[_LOWERED[axes]])


def _flat(kernel: Callable[..., None], columns: tuple[int, ...], size: int, *arrays: Array) -> Array:
    """The same for arrays of more axes than a kernel takes."""
    lead = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    rows = [np.broadcast_to(array, (*lead, array.shape[-1])).reshape(-1, array.shape[-1]) for array in arrays]
    return _filled(kernel, columns, size, *rows).reshape((*lead, size))


def compose(a: Array, b: Array) -> Array:
    """The rotation that applies b, then a, broadcasting. (..., 4)."""
    return _two(_compiled().compose, 4, 4, 4, a, b)


def inverse(q: Array) -> Array:
    """The rotation that undoes q. (..., 4)."""
    return np.asarray(q * _CONJUGATE)


def rotate(q: Array, v: Array) -> Array:
    """Vectors v turned by q, broadcasting. (..., 3)."""
    return _two(_compiled().rotate, 4, 3, 3, q, v)


def cross(a: Array, b: Array) -> Array:
    """The cross product, broadcasting. (..., 3)."""
    return _two(_compiled().cross, 3, 3, 3, a, b)


def dot(a: Array, b: Array) -> Array:
    """The products of vectors, broadcasting, the last axis kept. (..., 3) to (..., 1)."""
    return _two(_compiled().dot, 3, 3, 1, a, b)


def length(v: Array) -> Array:
    """The lengths of vectors, the last axis kept. (..., N) to (..., 1)."""
    return _one(_compiled().length, v.shape[-1], 1, v)


def normalize(v: Array) -> Array:
    """Vectors of unit length along the last axis; a zero vector stays zero."""
    return _one(_compiled().normalize, v.shape[-1], v.shape[-1], v)


def rotvec_to_quat(v: Array) -> Array:
    """Axis times angle to quaternion. (..., 3) to (..., 4)."""
    return _one(_compiled().rotvec_to_quat, 3, 4, np.asarray(v))


def axis_to_quat(axis: str, angle: Array) -> Array:
    """Turns about "x", "y" or "z", to the bit as `rotvec_to_quat` has them. (...) to (..., 4)."""
    v = np.zeros((*np.shape(angle), 3))
    v[..., "xyz".index(axis)] = angle
    return rotvec_to_quat(v)


def quat_to_rotvec(q: Array) -> Array:
    """Quaternion to axis times angle, the shorter way round. (..., 4) to (..., 3)."""
    return _one(_compiled().quat_to_rotvec, 4, 3, q)


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
    return _filled(_compiled().basis_to_quat, (3, 3, 3), 4, x, y, z)


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
