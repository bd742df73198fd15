"""The tree of nodes and triangles of a glTF 2.0 scene (Khronos glTF 2.0): names, places, geometry, nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from scene_graphs.fields import LayoutError
from scene_graphs.loaders.gltf_document import MAX_NUMBER, Document, list_of, numbers_of
from scene_graphs.loaders.scene_tree import (
    MAX_DEPTH,
    MAX_NODES,
    MAX_TRIANGLES,
    NOTHING,
    Indices,
    Node,
    Triangles,
    joined,
)
from scene_graphs.placed import Array

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
        document, name = self.document, self.document.name
        nodes = list_of(document.json, "nodes", name)
        if len(nodes) > MAX_NODES:
            raise LayoutError(f"{name} has more than {MAX_NODES} nodes; join what belongs together")
        if document.json.get("scenes"):
            scene = document.item("scenes", document.json.get("scene", 0))
            return [self._node(number, np.eye(4), 0) for number in list_of(scene, "nodes", f"{name} scene")]
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
        where = f"{self.document.name} nodes[{number}]"
        if number in self._seen:
            raise LayoutError(f"{where} has two parents or is its own; the nodes must be a tree")
        if depth > MAX_DEPTH:
            raise LayoutError(f"{where} lies deeper than {MAX_DEPTH} nodes within nodes")
        self._seen.add(number)
        matrix = above @ _matrix(row, where)
        if not np.abs(matrix).max() <= MAX_NUMBER:
            raise LayoutError(f"{where} is scaled or moved beyond any room")
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
            where = f"{self.document.name} meshes[{number}]"
            parts = list_of(row, "primitives", where)
            self._parts += len(parts)
            if self._parts > MAX_NODES:
                raise LayoutError(f"{where}: more than {MAX_NODES} primitives; join what belongs together")
            self._meshes[number] = joined(
                [self._primitive(part, f"{where}.primitives[{index}]") for index, part in enumerate(parts)]
            )
        return self._meshes[number]

    def _primitive(self, row: Any, where: str) -> Triangles:
        if not isinstance(row, dict) or not isinstance(row.get("attributes"), dict):
            raise LayoutError(f"{where} must be an object with attributes")
        mode = row.get("mode", _LIST)
        if mode not in (_LIST, _STRIP, _FAN) or "POSITION" not in row["attributes"]:
            return NOTHING
        points = self.document.accessor(row["attributes"]["POSITION"], "VEC3", where)
        if row.get("indices") is None:
            order = np.arange(len(points))
        else:
            indices = self.document.accessor(row["indices"], "SCALAR", where)
            if indices.dtype.kind != "u":
                raise LayoutError(f"{where}.indices must be whole numbers without sign")
            order = indices[:, 0].astype(np.int64)
        if len(order) and order.max() >= len(points):
            raise LayoutError(f"{where}.indices name point {order.max()} of {len(points)}")
        corners = _triples(order, mode)
        self._count(len(corners))
        # Many meshes may share one long list of points; each takes along only its own.
        used, corners = np.unique(corners, return_inverse=True)
        with np.errstate(invalid="ignore"):  # a NaN that signals; it is refused below
            own = points[used].astype(float)
        if not (np.abs(own) <= MAX_NUMBER).all():
            raise LayoutError(f"{where} has points that are no numbers or lie beyond any room")
        return Triangles(own, corners.reshape(-1, 3))

    def _count(self, triangles: int) -> None:
        self._triangles += triangles
        if self._triangles > 2 * MAX_TRIANGLES:
            raise LayoutError(f"{self.document.name} has more than {MAX_TRIANGLES} triangles; simplify it")


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


def _matrix(row: Mapping[str, Any], where: str) -> Array:
    """A node's own matrix, or the one of its translation, rotation (xyzw) and scale. (4, 4)."""
    if row.get("matrix") is not None:
        return numbers_of(row, "matrix", 16, where).reshape(4, 4).T
    matrix = np.eye(4)
    if row.get("rotation") is not None:
        turn = numbers_of(row, "rotation", 4, where)
        length = float(np.linalg.norm(turn))
        if length < 1e-6:
            raise LayoutError(f"{where}.rotation must be a quaternion [x, y, z, w]")
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
