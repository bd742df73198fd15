"""What a glTF 2.0 file is made of: its JSON, its buffers and the numbers in them, every one checked before it is used.

Written here and not taken from a library because what people send is not to be trusted: nothing outside the file is
opened, no image is decoded, and time and memory are bounded by the size of the file.
"""

from __future__ import annotations

import base64
import binascii
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.fields import LayoutError
from scene_graphs.loaders.scene_tree import MAX_TRIANGLES
from scene_graphs.loaders.source import parse_json
from scene_graphs.placed import Array

MAX_NUMBER: Final = 1e7
"""No number of a matrix or a point is larger."""
MAX_VALUES: Final = 3 * MAX_TRIANGLES
"""Points, and corners of triangles, that are read from one file."""
_MAGIC, _JSON, _BIN = b"glTF", 0x4E4F534A, 0x004E4942
_TYPES: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS: Final = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
_COMPRESSED: Final = frozenset({"KHR_draco_mesh_compression", "EXT_meshopt_compression"})


@dataclass
class Document:
    """One document; every accessor is read once."""

    json: Mapping[str, Any]
    binary: bytes | None
    name: str
    """Of the file, for errors."""
    _buffers: dict[int, bytes] = field(default_factory=dict)
    _accessors: dict[tuple[int, str], NDArray[Any]] = field(default_factory=dict)
    _values: int = 0

    @classmethod
    def of(cls, data: bytes, name: str) -> Document:
        """A .glb, or a .gltf that holds its own data. LayoutError if it is neither, cut off or compressed."""
        document, binary = _chunks(data, name)
        required = list_of(document, "extensionsRequired", name)
        if packed := [word for word in required if isinstance(word, str) and word in _COMPRESSED]:
            raise LayoutError(f"{name} is compressed ({packed[0]}); export it without compression")
        return cls(document, binary, name)

    def item(self, key: str, number: Any) -> dict[str, Any]:
        """An item of a top list. LayoutError if the number names none."""
        items = list_of(self.json, key, self.name)
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(items):
            raise LayoutError(f"{self.name} names {key}[{number!r:.20}], of which there are {len(items)}")
        if not isinstance(items[number], dict):
            raise LayoutError(f"{self.name} {key}[{number}] must be an object")
        found: dict[str, Any] = items[number]
        return found

    def accessor(self, number: Any, type_: str, where: str) -> NDArray[Any]:
        """The values of an accessor, one element a row."""
        row = self.item("accessors", number)
        if (number, type_) not in self._accessors:
            self._accessors[number, type_] = self._values_of(row, type_, f"{where}: accessors[{number}]")
        return self._accessors[number, type_]

    def _values_of(self, row: Mapping[str, Any], type_: str, place: str) -> NDArray[Any]:
        kind = row.get("componentType")
        dtype = _TYPES.get(kind) if isinstance(kind, int) else None
        if dtype is None or row.get("type") != type_:
            raise LayoutError(f"{place} must be of type {type_} with a componentType of glTF 2.0")
        if row.get("sparse") is not None or row.get("bufferView") is None:
            raise LayoutError(f"{place} is sparse; export the scene without sparse accessors")
        view = self.item("bufferViews", row["bufferView"])
        data = self._buffer(view.get("buffer"))
        width, item = _WIDTHS[type_], np.dtype(dtype).itemsize
        count, offset = _whole(row, "count", place), _whole(view, "byteOffset", place)
        start, end = offset + _whole(row, "byteOffset", place), offset + _whole(view, "byteLength", place)
        stride = _whole(view, "byteStride", place) or width * item
        last = start + stride * (count - 1) + width * item
        if count == 0:
            return np.zeros((0, width), dtype)
        if stride < width * item or last > min(end, len(data)):
            raise LayoutError(f"{place} reaches beyond its buffer; the file is cut off or damaged")
        self._values += count
        if self._values > 2 * MAX_VALUES:
            raise LayoutError(f"{self.name} has more than {MAX_TRIANGLES} triangles; simplify it")
        values = np.ndarray((count, width), dtype, data, start, (stride, item))
        if row.get("normalized") is True and values.dtype.kind in "iu":
            return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return values

    def _buffer(self, number: Any) -> bytes:
        row = self.item("buffers", number)
        if number not in self._buffers:
            uri = row.get("uri")
            if uri is None and number == 0 and self.binary is not None:
                self._buffers[number] = self.binary
            elif isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri[:200]:
                self._buffers[number] = _decoded(uri, f"{self.name} buffers[{number}]")
            else:
                raise LayoutError(f"{self.name} keeps its geometry in another file; export it as one .glb")
        return self._buffers[number]


def list_of(row: Mapping[str, Any], key: str, where: str) -> list[Any]:
    """A list field; an absent one is empty."""
    value = row.get(key) or []
    if not isinstance(value, list):
        raise LayoutError(f"{where}: {key} must be a list")
    return value


def numbers_of(row: Mapping[str, Any], key: str, count: int, where: str) -> Array:
    """A field of that many finite numbers."""
    value = row[key]
    if not isinstance(value, list) or len(value) != count or not all(_is_number(number) for number in value):
        raise LayoutError(f"{where}.{key} must be {count} numbers, got {value!r:.60}")
    return np.array(value, dtype=float)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= MAX_NUMBER


def _chunks(data: bytes, name: str) -> tuple[dict[str, Any], bytes | None]:
    """The JSON and the binary chunk."""
    if data[:4] != _MAGIC:
        return _json(data, name), None
    if len(data) < 20:
        raise LayoutError(f"{name} is cut off: a .glb has a header of 20 bytes")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise LayoutError(f"{name} is glTF version {version}; export it as glTF 2.0")
    if length > len(data):
        raise LayoutError(f"{name} is cut off: it says it has {length} bytes and has {len(data)}")
    found: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", data, place)
        if place + 8 + size > len(data):
            raise LayoutError(f"{name} is cut off: a chunk at byte {place} says it has {size} bytes")
        found.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in found:
        raise LayoutError(f"{name} has no JSON chunk; is it a .glb?")
    return _json(found[_JSON], name), found.get(_BIN)


def _json(data: bytes, name: str) -> dict[str, Any]:
    try:
        document = parse_json(data.decode("utf-8-sig"), name)
    except ValueError as error:
        raise LayoutError(f"{name} is neither a .glb nor a .gltf that holds its own data: {error}") from error
    if not isinstance(document, dict) or not isinstance(document.get("nodes"), list):
        raise LayoutError(f"{name} must be a glTF document with nodes")
    return document


def _whole(row: Mapping[str, Any], key: str, where: str) -> int:
    value = row.get(key, 0)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 40:
        raise LayoutError(f"{where}: {key} must be a whole number, got {value!r:.60}")
    return value


def _decoded(uri: str, where: str) -> bytes:
    try:
        return base64.b64decode(uri.partition(",")[2], validate=True)
    except (binascii.Error, ValueError) as error:
        raise LayoutError(f"{where} is not base64: {error}") from error
