"""numpy's .npy and .npz files, read without numpy's own reader: every claimed size is checked against the bytes there.

numpy's reader makes room for whatever a header claims, and fails on damaged ones with whatever lies nearest.
"""

from __future__ import annotations

import ast
import io
import math
import struct
import zipfile
import zlib
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.mocap.clip import ClipError

MAX_UNPACKED_BYTES: Final = 256 << 20
"""Bytes of all arrays of an archive."""
_MAGIC: Final = b"\x93NUMPY"
_MAX_HEADER_LENGTH: Final = 10_000
_PLAIN: Final = frozenset("biufUS")
"""Kinds of numbers and texts."""


class Header(NamedTuple):
    """What an .npy file says before its data."""

    descr: Any
    fortran: bool
    shape: tuple[int, ...]
    start: int
    """Where the data begin."""


def npy_header(data: bytes) -> Header:
    """The header of an .npy file. ClipError if there is none."""
    if data[:6] != _MAGIC or len(data) < 12:
        raise ClipError("not an .npy file: its first bytes are not numpy's")
    long = data[6] > 1
    size = int(struct.unpack_from("<I" if long else "<H", data, 8)[0])
    start = (12 if long else 10) + size
    if size > _MAX_HEADER_LENGTH or start > len(data):
        raise ClipError("its header is cut off or longer than any")
    try:
        header = ast.literal_eval(data[start - size : start].decode("latin-1").strip())
        shape = header["shape"]
        if not isinstance(shape, tuple) or not all(type(length) is int and 0 <= length < 1 << 40 for length in shape):
            raise ClipError(f"its shape is {str(shape)[:60]}")
        return Header(header["descr"], bool(header["fortran_order"]), shape, start)
    except (ValueError, SyntaxError, KeyError, TypeError, RecursionError, MemoryError) as error:
        if isinstance(error, ClipError):
            raise
        raise ClipError("its header is not that of an .npy file") from error


def npz_names(data: bytes) -> list[str]:
    """Names of an archive's arrays. ClipError if it is none or would unpack to too much."""
    return [info.filename.removesuffix(".npy") for info in _entries(data)]


def npz_arrays(data: bytes) -> dict[str, NDArray[Any]]:
    """The arrays of an archive that are numbers or texts; what only Python could unpickle is left out."""
    found = {}
    entries = _entries(data)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for info in entries:
                array = _npy_array(archive.read(info))
                if array is not None:
                    found[info.filename.removesuffix(".npy")] = array
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, RuntimeError, ValueError, struct.error) as error:
        if isinstance(error, ClipError):
            raise
        raise ClipError(f"the archive is damaged: {error}") from error
    return found


def _entries(data: bytes) -> list[zipfile.ZipInfo]:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, ValueError, struct.error, OverflowError, NotImplementedError) as error:
        raise ClipError(f"not an .npz archive: {error}") from error
    if sum(info.file_size for info in entries) > MAX_UNPACKED_BYTES:
        raise ClipError(f"the archive unpacks to more than {MAX_UNPACKED_BYTES >> 20} MB")
    if any(info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) for info in entries):
        raise ClipError("the archive is packed in a way that numpy does not")
    return entries


def _npy_array(data: bytes) -> NDArray[Any] | None:
    """The array of an .npy file; None where it holds objects."""
    header = npy_header(data)
    try:
        dtype = np.dtype(header.descr)
    except (TypeError, ValueError, SyntaxError) as error:
        raise ClipError(f"an array is of type {str(header.descr)[:60]}, which is none") from error
    if dtype.kind not in _PLAIN:
        return None
    count = math.prod(header.shape)
    if count * dtype.itemsize != len(data) - header.start:
        raise ClipError(
            f"an array of shape {header.shape} has {len(data) - header.start} bytes", "is the file cut off?"
        )
    if dtype.itemsize == 0:
        return np.zeros(header.shape, dtype)
    values = np.frombuffer(data, dtype, count, header.start)
    return values.reshape(header.shape, order="F" if header.fortran else "C")
