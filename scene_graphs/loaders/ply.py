"""The vertices of a PLY file, ascii or binary; nothing else of it is read."""

from __future__ import annotations

from typing import Final

import numpy as np

from scene_graphs.fields import MAX_COORDINATE, LayoutError
from scene_graphs.layouts import Array
from scene_graphs.loaders.source import Source

MAX_VERTICES: Final = 10_000_000
MAX_WORDS: Final = 5_000_000
"""Numbers of the vertices of an ascii file, colours and all."""
_MAX_HEADER_LENGTH: Final = 1 << 16
_END: Final = b"end_header"
_ORDERS: Final = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_TYPES: Final = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}


def read_ply_vertices(source: Source) -> Array:
    """The points x, y, z in the file's own frame and unit. (N, 3).

    LayoutError if it is no PLY, its vertices do not come first, it is cut off, or a point is not within `MAX_COORDINATE`.
    """
    data = source.read()
    order, count, columns, start = _header(data, source.name)
    dtype = np.dtype([(name, order + kind) for name, kind in columns])
    if order or not count:
        if len(data) - start < count * dtype.itemsize:
            raise LayoutError(f"{source.name} is cut off: its header promises {count} vertices")
        rows = np.frombuffer(data, dtype, count, start)
        with np.errstate(invalid="ignore"):  # a NaN that signals; it is refused below
            points = np.stack([rows[axis].astype(float) for axis in "xyz"], axis=-1)
    else:
        points = _ascii_points(data[start:], count, [name for name, _ in columns], source.name)
    # A NaN is within no bound.
    if not (np.abs(points) <= MAX_COORDINATE).all():
        raise LayoutError(
            f"{source.name} has vertices that are not within {MAX_COORDINATE:g} m of its origin; is it metres?"
        )
    return points


def _header(data: bytes, name: str) -> tuple[str, int, list[tuple[str, str]], int]:
    """Byte order ("" for ascii), number of vertices, their columns, and where the data starts."""
    end = data.find(_END, 0, _MAX_HEADER_LENGTH)
    line_end = data.find(b"\n", end)
    if not data.startswith(b"ply") or end < 0 or line_end < 0:
        raise LayoutError(f"{name} is not a PLY file: it has no header from ply to end_header")
    lines = [line.split() for line in data[:end].decode("latin-1").splitlines()]
    formats = [line[1] for line in lines if line[:1] == ["format"] and len(line) > 1]
    elements = [number for number, line in enumerate(lines) if line[:1] == ["element"]]
    if not formats or formats[0] not in _ORDERS:
        raise LayoutError(f"{name}: its format must be one of {', '.join(_ORDERS)}")
    if not elements or len(lines[elements[0]]) != 3 or lines[elements[0]][1] != "vertex":
        raise LayoutError(f"{name}: its first element must be the vertices")
    stop = elements[1] if len(elements) > 1 else len(lines)
    columns: list[tuple[str, str]] = []
    for line in lines[elements[0] + 1 : stop]:
        if line[:1] == ["property"]:
            if len(line) != 3 or line[1] not in _TYPES or line[2] in dict(columns):
                raise LayoutError(f"{name}: a vertex has properties of plain types only, got {' '.join(line)!r:.60}")
            columns.append((line[2], _TYPES[line[1]]))
    if not {"x", "y", "z"} <= dict(columns).keys():
        raise LayoutError(f"{name}: a vertex must have x, y and z")
    told = lines[elements[0]][2]
    if not (told.isascii() and told.isdigit() and len(told) < 12 and int(told) <= MAX_VERTICES):
        raise LayoutError(f"{name} must have at most {MAX_VERTICES} vertices, got {told!r:.20}")
    return _ORDERS[formats[0]], int(told), columns, line_end + 1


def _ascii_points(body: bytes, count: int, names: list[str], name: str) -> Array:
    if count * len(names) > MAX_WORDS:
        raise LayoutError(f"{name} has more than {MAX_WORDS} numbers as text; save it as binary")
    words = body.split(maxsplit=count * len(names))[: count * len(names)]
    if len(words) < count * len(names):
        raise LayoutError(f"{name} is cut off: its header promises {count} vertices")
    columns = [words[names.index(axis) :: len(names)] for axis in "xyz"]
    try:
        return np.stack([np.fromiter(map(float, column), float, count) for column in columns], axis=-1)
    except ValueError as error:
        raise LayoutError(f"{name} has a vertex that is not numbers: {error}") from error
