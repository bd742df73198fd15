"""Scene files that are cut off, too large or no such file are refused with the reason; what is only odd is read."""

from __future__ import annotations

import copy
import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from for_each import for_each
from scans import OBJECTS, RELATIONSHIPS, ROOM, semseg
from scenes_at_hand import glb, small_document
from unity_houses import HOUSE, flat

from scene_graphs.json_fields import LayoutError
from scene_graphs.loaders import Source, gltf_reader, obj_reader, read_scene, virtualhome
from scene_graphs.loaders.gltf_reader import nodes_of_gltf
from scene_graphs.loaders.obj_reader import nodes_of_obj
from scene_graphs.loaders.scene_nodes import Node
from scene_graphs.loaders.threedssg import graph_from_3dssg

Json = dict[str, Any]


def below(node: Node) -> Iterator[Node]:
    """It and all that hangs on it."""
    yield node
    for child in node.children:
        yield from below(child)


def nodes(data: bytes) -> list[Node]:
    return [one for root in nodes_of_gltf(data, "it.glb") for one in below(root)]


def nodes_of_text(text: str) -> list[Node]:
    return [one for root in nodes_of_obj(text, "it.obj") for one in below(root)]


def changed(*changes: tuple[tuple[Any, ...], Any]) -> tuple[Json, bytes]:
    """The small document with something else at some places."""
    document, binary = copy.deepcopy(small_document()[0]), small_document()[1]
    for path, value in changes:
        holder: Any = document
        for key in path[:-1]:
            holder = holder[key]
        holder[path[-1]] = value
    return document, binary


PRIMITIVE = ("meshes", 0, "primitives", 0)


@for_each(
    ("path", "value", "says"),
    [
        (("accessors", 0, "sparse"), {}, "is sparse"),
        (("accessors", 0, "bufferView"), None, "is sparse"),
        (("accessors", 0, "type"), "VEC2", "must be of type VEC3"),
        (("accessors", 0, "componentType"), 7, "must be of type VEC3"),
        (("accessors", 0, "count"), -1, "must be a whole number"),
        (("accessors", 0, "count"), True, "must be a whole number"),
        (("accessors", 0, "count"), 5, "beyond its buffer"),
        (("accessors", 0, "byteOffset"), 4, "beyond its buffer"),
        (("bufferViews", 0, "byteStride"), 4, "beyond its buffer"),
        (("bufferViews", 0, "byteLength"), 47, "beyond its buffer"),
        (("meshes", 0, "primitives"), 5, "must be a list"),
        ((*PRIMITIVE, "attributes"), [], "object with attributes"),
        ((*PRIMITIVE, "indices"), 9, r"names accessors\[9\]"),
        (("accessors", 1, "componentType"), 5122, "without sign"),
        (("accessors", 1, "count"), 6, ""),
    ],
)
def test_geometry_that_is_none_is_refused(path: tuple[Any, ...], value: Any, says: str) -> None:
    data = glb(*changed((path, value)))
    if says:
        with pytest.raises(LayoutError, match=says):
            nodes(data)
    else:
        assert nodes(data)


@for_each(
    ("data", "says"),
    [
        (b"glTF" + struct.pack("<I", 2), "header of 20 bytes"),
        (b"glTF" + struct.pack("<II", 1, 20) + bytes(8), "glTF version 1"),
        (b"glTF" + struct.pack("<II", 2, 99) + bytes(8), "has 99 bytes and has 20"),
        (b"glTF" + struct.pack("<IIII", 2, 20, 5, 0x4E4F534A), "a chunk at byte 12 says it has 5 bytes"),
        (b"glTF" + struct.pack("<IIII", 2, 20, 0, 0x004E4942), "no JSON chunk"),
        (b"not json", "neither a .glb nor a .gltf"),
        (b"[]", "glTF document with nodes"),
        (b'{"nodes": 5}', "glTF document with nodes"),
    ],
)
def test_a_file_that_is_no_gltf_is_refused(data: bytes, says: str) -> None:
    with pytest.raises(LayoutError, match=says):
        nodes(data)


def triangles(data: bytes) -> list[list[list[float]]]:
    """Of the only mesh, in its own frame."""
    (found,) = (node.own for node in nodes(data) if len(node.own.corners))
    rows: list[list[list[float]]] = np.round(found.points[found.corners], 6).tolist()
    return rows


def test_strips_and_fans_are_triangles_and_points_without_order_come_three_by_three() -> None:
    point = np.round(np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 1]], dtype=float), 6)
    in_order = ((*PRIMITIVE, "indices"), None)
    as_written = triangles(glb(*small_document()))
    by_mode = {mode: triangles(glb(*changed(in_order, ((*PRIMITIVE, "mode"), mode)))) for mode in (4, 5, 6)}
    assert [len(by_mode[mode]) for mode in (4, 5, 6)] == [1, 2, 2]
    assert by_mode[6] == as_written, "a fan is what the order says"
    sides = [np.linalg.norm(np.diff(by_mode[5][1][k : k + 2], axis=0)) for k in (0, 1)]
    assert sides == pytest.approx([np.linalg.norm(point[2] - point[1]), np.linalg.norm(point[3] - point[2])])
    lines = glb(*changed(((*PRIMITIVE, "mode"), 1)))
    assert not any(len(node.own.corners) for node in nodes(lines))


def test_a_mesh_of_nothing_is_nothing() -> None:
    data = glb(*changed((("accessors", 1, "count"), 0)))
    assert not any(len(node.own.corners) for node in nodes(data))


def test_too_much_geometry_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    data = glb(*small_document())
    monkeypatch.setattr(gltf_reader, "MAX_TRIANGLES", 1)
    with pytest.raises(LayoutError, match="more than 1 triangles"):
        nodes(glb(*changed((("nodes", 0), {"children": [1], "mesh": 0}))))
    monkeypatch.undo()
    monkeypatch.setattr(gltf_reader, "MAX_NODES", 0)
    with pytest.raises(LayoutError, match="more than 0"):
        nodes(data)


OBJ = """
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
f 1 2 3
o chair 1
g seat
f 1 2 3 4
g back
f -1 -2 -3
o table
f 1/1 2//1 3/1/1
"""


def test_an_obj_keeps_objects_and_their_groups_apart() -> None:
    found = [
        (root.name, len(root.own.corners), [(group.name, len(group.own.corners)) for group in root.children])
        for root in nodes_of_obj(OBJ, "it.obj")
    ]
    assert found == [("", 1, []), ("chair 1", 0, [("seat", 2), ("back", 1)]), ("table", 1, [])]


@for_each(
    ("line", "says"),
    [
        ("v 1 2", "three numbers"),
        ("v 1 2 x", "three numbers"),
        ("v 1e7 0 0", ""),
        ("v 1.1e7 0 0", "beyond any room"),
        ("f 1 2 x", "numbers of points"),
        ("f 1 2 5", "no point '5' of 4"),
        ("f 1 2 0", "no point '0' of 4"),
        ("f 1 2 -5", "no point '-5' of 4"),
        ("f 1 2", ""),
    ],
)
def test_a_line_that_an_obj_cannot_have_is_named(line: str, says: str) -> None:
    text = f"{OBJ}{line}\n"
    if says:
        with pytest.raises(LayoutError, match=rf"it\.obj line 14: .*{says}"):
            nodes_of_text(text)
    else:
        assert nodes_of_text(text)


@for_each(
    ("limit", "value", "says"),
    [
        ("MAX_LINES", 5, "more than 5 lines"),
        ("MAX_TRIANGLES", 4, "more than 4 tri"),
        ("MAX_NODES", 3, "more than 3 gr"),
    ],
)
def test_an_obj_that_is_too_large_is_refused(
    limit: str, value: int, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(obj_reader, limit, value)
        with pytest.raises(LayoutError, match=says):
            nodes_of_text(OBJ)
        patch.setattr(obj_reader, limit, {"MAX_LINES": 13}.get(limit, value + 1))
        assert nodes_of_text(OBJ)


def test_houses_and_scans_that_lie_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def read(row: Any, kind: str) -> Any:
        return read_scene(Source.of_bytes("it.json", json.dumps(row).encode()), kind)

    for key, value, says in (
        ("floorPolygon", [{"x": 0, "y": 0, "z": 0}] * 2, "list of 3"),
        ("floorPolygon", 5, "list of 3"),
    ):
        with pytest.raises(LayoutError, match=says):
            read({**HOUSE, "rooms": [{**HOUSE["rooms"][0], key: value}]}, "procthor")
    with pytest.raises(LayoutError, match=r"3DSSG's objects\.json|scans or segGroups"):
        read({"rooms": []}, "3dssg")
    assert read(semseg(*ROOM), "3dssg").layouts
    with pytest.raises(LayoutError, match="at most"):
        graph_from_3dssg(OBJECTS, {"scans": [{"scan": "s1", "relationships": 5}]}, "s1")
    assert len(graph_from_3dssg(OBJECTS, RELATIONSHIPS, "s1")) == 5
    with pytest.raises(LayoutError, match="format must be one of"):
        read({}, "fbx")
    monkeypatch.setattr(virtualhome, "MAX_ROOMS_PER_FLAT", 2)
    assert len(read(flat(), "virtualhome").layouts) == 2
    monkeypatch.setattr(virtualhome, "MAX_ROOMS_PER_FLAT", 1)
    with pytest.raises(LayoutError, match="more than 1 rooms"):
        read(flat(), "virtualhome")
