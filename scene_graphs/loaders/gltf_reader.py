"""The tree of nodes and triangles of a glTF 2.0 scene (Khronos glTF 2.0): names, places, geometry, nothing else.

What a glTF 2.0 file is made of: its JSON, its buffers and the numbers in them, every one checked before it is used.

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

from scene_graphs.errors import FieldPath
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Array
from scene_graphs.loaders.scene_nodes import (
    MAX_DEPTH,
    MAX_NODES,
    MAX_TRIANGLES,
    NOTHING,
    Indices,
    Node,
    Triangles,
    joined,
)
from scene_graphs.loaders.scene_source import parse_json

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
        required = list_of(document, "extensionsRequired", FieldPath(file=name))
        if packed := [word for word in required if isinstance(word, str) and word in _COMPRESSED]:
            raise LayoutError(f"is compressed ({packed[0]})", "export it without compression", at=FieldPath(file=name))
        return cls(document, binary, name)

    @property
    def at(self) -> FieldPath:
        """The document, for errors."""
        return FieldPath(file=self.name)

    def item(self, key: str, number: Any) -> dict[str, Any]:
        """An item of a top list. LayoutError if the number names none."""
        items = list_of(self.json, key, self.at)
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(items):
            raise LayoutError(f"names {key}[{number!r:.20}], of which there are {len(items)}", at=self.at)
        if not isinstance(items[number], dict):
            raise LayoutError("must be an object", at=self.at / key / number)
        found: dict[str, Any] = items[number]
        return found

    def accessor(self, number: Any, type_: str, where: FieldPath) -> NDArray[Any]:
        """The values of an accessor, one element a row."""
        row = self.item("accessors", number)
        if (number, type_) not in self._accessors:
            self._accessors[number, type_] = self._values_of(row, type_, where / "accessors" / number)
        return self._accessors[number, type_]

    def _values_of(self, row: Mapping[str, Any], type_: str, place: FieldPath) -> NDArray[Any]:
        kind = row.get("componentType")
        dtype = _TYPES.get(kind) if isinstance(kind, int) else None
        if dtype is None or row.get("type") != type_:
            raise LayoutError(f"must be of type {type_} with a componentType of glTF 2.0", at=place)
        if row.get("sparse") is not None or row.get("bufferView") is None:
            raise LayoutError("is sparse", "export the scene without sparse accessors", at=place)
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
            raise LayoutError("reaches beyond its buffer; the file is cut off or damaged", at=place)
        self._values += count
        if self._values > 2 * MAX_VALUES:
            raise LayoutError(f"has more than {MAX_TRIANGLES} triangles", "simplify it", at=self.at)
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
                self._buffers[number] = _decoded(uri, self.at / "buffers" / number)
            else:
                raise LayoutError("keeps its geometry in another file", "export it as one .glb", at=self.at)
        return self._buffers[number]


def list_of(row: Mapping[str, Any], key: str, where: FieldPath) -> list[Any]:
    """A list field; an absent one is empty."""
    value = row.get(key) or []
    if not isinstance(value, list):
        raise LayoutError("must be a list", at=where / key)
    return value


def numbers_of(row: Mapping[str, Any], key: str, count: int, where: FieldPath) -> Array:
    """A field of that many finite numbers."""
    value = row[key]
    if not isinstance(value, list) or len(value) != count or not all(_is_number(number) for number in value):
        raise LayoutError(f"must be {count} numbers, got {value!r:.60}", at=where / key)
    return np.array(value, dtype=float)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= MAX_NUMBER


def _chunks(data: bytes, name: str) -> tuple[dict[str, Any], bytes | None]:
    """The JSON and the binary chunk."""
    if data[:4] != _MAGIC:
        return _json(data, name), None
    if len(data) < 20:
        raise LayoutError("is cut off: a .glb has a header of 20 bytes", at=FieldPath(file=name))
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise LayoutError(f"is glTF version {version}", "export it as glTF 2.0", at=FieldPath(file=name))
    if length > len(data):
        raise LayoutError(f"is cut off: it says it has {length} bytes and has {len(data)}", at=FieldPath(file=name))
    found: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", data, place)
        if place + 8 + size > len(data):
            raise LayoutError(f"is cut off: a chunk at byte {place} says it has {size} bytes", at=FieldPath(file=name))
        found.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in found:
        raise LayoutError("has no JSON chunk", "is it a .glb?", at=FieldPath(file=name))
    return _json(found[_JSON], name), found.get(_BIN)


def _json(data: bytes, name: str) -> dict[str, Any]:
    try:
        document = parse_json(data.decode("utf-8-sig"), FieldPath((name,)))
    except ValueError as error:
        raise LayoutError(
            f"is neither a .glb nor a .gltf that holds its own data: {error}", at=FieldPath(file=name)
        ) from error
    if not isinstance(document, dict) or not isinstance(document.get("nodes"), list):
        raise LayoutError("must be a glTF document with nodes", at=FieldPath(file=name))
    return document


def _whole(row: Mapping[str, Any], key: str, where: FieldPath) -> int:
    value = row.get(key, 0)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 40:
        raise LayoutError(f"must be a whole number, got {value!r:.60}", at=where / key)
    return value


def _decoded(uri: str, where: FieldPath) -> bytes:
    try:
        return base64.b64decode(uri.partition(",")[2], validate=True)
    except (binascii.Error, ValueError) as error:
        raise LayoutError(f"is not base64: {error}", at=where) from error


_LIST, _STRIP, _FAN = 4, 5, 6
_LABELS: Final = ("category", "class", "label", "semantic")
"""Keys of a node's extras under which people write what it is."""


def nodes_of_gltf(data: bytes, name: str) -> list[Node]:
    """The top nodes of the scene in a .glb, or in a .gltf that holds its own data; points in glTF's frame and unit.

    LayoutError, naming the file and the place in it, for whatever is not so.
    """
    return _Scene(Document.of(data, name)).tops()


@dataclass
class _Scene:
    """One scene being read."""

    document: Document
    _meshes: dict[int, Triangles] = field(default_factory=dict)
    _seen: set[int] = field(default_factory=set)
    _parts: int = 0
    _triangles: int = 0

    def tops(self) -> list[Node]:
        """The nodes of the scene, with all below them."""
        document = self.document
        nodes = list_of(document.json, "nodes", document.at)
        if len(nodes) > MAX_NODES:
            raise LayoutError(f"has more than {MAX_NODES} nodes", "join what belongs together", at=document.at)
        if document.json.get("scenes"):
            scene = document.item("scenes", document.json.get("scene", 0))
            return [self._node(number, np.eye(4), 0) for number in list_of(scene, "nodes", document.at / "scene")]
        below = {
            child
            for node in nodes
            if isinstance(node, dict) and isinstance(node.get("children"), list)
            for child in node["children"]
            if isinstance(child, int)
        }
        return [self._node(number, np.eye(4), 0) for number in range(len(nodes)) if number not in below]

    def _node(self, number: Any, above: Array, depth: int) -> Node:
        row = self.document.item("nodes", number)
        where = self.document.at / "nodes" / number
        if number in self._seen:
            raise LayoutError("has two parents or is its own", "the nodes must be a tree", at=where)
        if depth > MAX_DEPTH:
            raise LayoutError(f"lies deeper than {MAX_DEPTH} nodes within nodes", at=where)
        self._seen.add(number)
        matrix = above @ _matrix(row, where)
        if not np.abs(matrix).max() <= MAX_NUMBER:
            raise LayoutError("is scaled or moved beyond any room", at=where)
        own = NOTHING if row.get("mesh") is None else self._placed(row["mesh"], matrix)
        children = tuple(self._node(child, matrix, depth + 1) for child in list_of(row, "children", where))
        return Node(self._name(row, number), _axes(matrix), own, children, _label(row.get("extras")))

    def _name(self, row: Mapping[str, Any], number: int) -> str:
        """The node's name, else its mesh's."""
        mesh = {} if row.get("mesh") is None else self.document.item("meshes", row["mesh"])
        return next((n for n in (row.get("name"), mesh.get("name")) if isinstance(n, str) and n), f"node {number}")

    def _placed(self, number: Any, matrix: Array) -> Triangles:
        """A mesh in the scene's frame; a mirroring node turns its triangles inside out, which nobody minds."""
        mesh = self._mesh(number)
        self._count(len(mesh.corners))
        return Triangles(mesh.points @ matrix[:3, :3].T + matrix[:3, 3], mesh.corners)

    def _mesh(self, number: Any) -> Triangles:
        row = self.document.item("meshes", number)
        if number not in self._meshes:
            where = self.document.at / "meshes" / number
            parts = list_of(row, "primitives", where)
            self._parts += len(parts)
            if self._parts > MAX_NODES:
                raise LayoutError(f"has more than {MAX_NODES} primitives", "join what belongs together", at=where)
            self._meshes[number] = joined(
                [self._primitive(part, where / "primitives" / index) for index, part in enumerate(parts)]
            )
        return self._meshes[number]

    def _primitive(self, row: Any, where: FieldPath) -> Triangles:
        if not isinstance(row, dict) or not isinstance(row.get("attributes"), dict):
            raise LayoutError("must be an object with attributes", at=where)
        mode = row.get("mode", _LIST)
        if mode not in (_LIST, _STRIP, _FAN) or "POSITION" not in row["attributes"]:
            return NOTHING
        points = self.document.accessor(row["attributes"]["POSITION"], "VEC3", where)
        if row.get("indices") is None:
            order = np.arange(len(points))
        else:
            indices = self.document.accessor(row["indices"], "SCALAR", where)
            if indices.dtype.kind != "u":
                raise LayoutError("must be whole numbers without sign", at=where / "indices")
            order = indices[:, 0].astype(np.int64)
        if len(order) and order.max() >= len(points):
            raise LayoutError(f"name point {order.max()} of {len(points)}", at=where / "indices")
        corners = _triples(order, mode)
        self._count(len(corners))
        # Many meshes may share one long list of points; each takes along only its own.
        used, corners = np.unique(corners, return_inverse=True)
        with np.errstate(invalid="ignore"):  # a NaN that signals; it is refused below
            own = points[used].astype(float)
        if not (np.abs(own) <= MAX_NUMBER).all():
            raise LayoutError("has points that are no numbers or lie beyond any room", at=where)
        return Triangles(own, corners.reshape(-1, 3))

    def _count(self, triangles: int) -> None:
        self._triangles += triangles
        if self._triangles > 2 * MAX_TRIANGLES:
            raise LayoutError(f"has more than {MAX_TRIANGLES} triangles", "simplify it", at=self.document.at)


def _label(extras: Any) -> str | None:
    words = [extras.get(key) for key in _LABELS] if isinstance(extras, dict) else []
    return next((word for word in words if isinstance(word, str) and word.strip()), None)


def _triples(order: Indices, mode: int) -> Indices:
    """Corners of triangles from the order of points in a list, strip or fan. (M, 3)."""
    if mode == _LIST:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    if len(order) < 3:
        return NOTHING.corners
    first = order[:-2] if mode == _STRIP else np.broadcast_to(order[0], (len(order) - 2,))
    return np.stack([first, order[1:-1], order[2:]], axis=1)


def _matrix(row: Mapping[str, Any], where: FieldPath) -> Array:
    """A node's own matrix, or the one of its translation, rotation (xyzw) and scale. (4, 4)."""
    if row.get("matrix") is not None:
        return numbers_of(row, "matrix", 16, where).reshape(4, 4).T
    matrix = np.eye(4)
    if row.get("rotation") is not None:
        turn = numbers_of(row, "rotation", 4, where)
        length = float(np.linalg.norm(turn))
        if length < 1e-6:
            raise LayoutError("must be a quaternion [x, y, z, w]", at=where / "rotation")
        matrix[:3, :3] = _turn_from_quaternion(turn / length)
    if row.get("scale") is not None:
        matrix[:3, :3] *= numbers_of(row, "scale", 3, where)
    if row.get("translation") is not None:
        matrix[:3, 3] = numbers_of(row, "translation", 3, where)
    return matrix


def _turn_from_quaternion(quaternion: Array) -> Array:
    """Rotation matrix of a unit quaternion x, y, z, w. (3, 3)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _axes(matrix: Array) -> Array:
    """Where a node's own axes point, of length 1; an axis scaled to nothing stays nothing. (3, 3)."""
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    axes: Array = matrix[:3, :3] / np.where(lengths > 1e-12, lengths, 1.0)
    return axes
