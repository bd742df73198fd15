"""Writes rooms of ours as .glb and .obj, the way modelling programs would, with trimesh: an independent writer."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
import shapely
import trimesh

from scene_graphs.furniture_shapes import parts
from scene_graphs.layout import Layout, Placed

Json = dict[str, Any]


def mesh_of(placed: Placed) -> trimesh.Trimesh:
    """The boxes of a piece's form, in the piece's own frame."""
    boxes = []
    for part in parts(placed.category, placed.size):
        boxes.append(trimesh.creation.box(extents=part.size))
        boxes[-1].apply_translation(part.center)
    whole = trimesh.util.concatenate(boxes)
    assert isinstance(whole, trimesh.Trimesh)
    return whole


def pose_of(placed: Placed) -> np.ndarray:
    """(4, 4)."""
    pose = trimesh.transformations.rotation_matrix(placed.yaw, [0, 1, 0])
    pose[:3, 3] = placed.position
    return pose


def scene_of(layout: Layout, is_baked: bool = False) -> trimesh.Scene:
    """Every object a node by the name "category.id"; baked, the nodes stand still and the points have moved."""
    scene = trimesh.Scene()
    for placed in layout.objects:
        mesh, pose = mesh_of(placed), pose_of(placed)
        if is_baked:
            mesh.apply_transform(pose)
            pose = np.eye(4)
        add(scene, f"{placed.category}.{placed.id}", mesh, pose)
    add(scene, "Floor_01", _floor_of(layout))
    return scene


def add(scene: trimesh.Scene, name: str, mesh: trimesh.Trimesh, pose: Any = None, under: str | None = None) -> None:
    scene.add_geometry(mesh, node_name=name, geom_name=f"g {name}", transform=pose, parent_node_name=under)


def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> trimesh.Trimesh:
    """A box between two corners."""
    return trimesh.creation.box(bounds=[low, high])


def obj_of(scene: trimesh.Scene, z_up: bool = False) -> str:
    """The scene as an .obj: named objects, points where they are, no node turns."""
    lines: list[str] = []
    count = 0
    for name in scene.graph.nodes_geometry:
        pose, geometry = scene.graph[name]
        mesh = scene.geometry[geometry].copy()
        mesh.apply_transform(pose)
        lines.append(f"o {name}")
        for x, y, z in mesh.vertices:
            lines.append(f"v {x} {-z} {y}" if z_up else f"v {x} {y} {z}")
        lines += [f"f {a + 1 + count}//1 {b + 1 + count}//1 {c + 1 + count}//1" for a, b, c in mesh.faces]
        count += len(mesh.vertices)
    return "\n".join(lines)


def glb(document: Json, binary: bytes = b"") -> bytes:
    """A .glb of a document as it is, right or wrong."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        binary += b"\0" * (-len(binary) % 4)
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def small_document() -> tuple[Json, bytes]:
    """One vase of two triangles, with everything a document needs."""
    points = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 1]], dtype="<f4").tobytes()
    corners = np.array([0, 1, 2, 0, 2, 3], dtype="<u2").tobytes()
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "root", "children": [1], "translation": [1, 0, 0]},
            {"name": "Vase", "mesh": 0, "rotation": [0, 0.7071068, 0, 0.7071068], "extras": {"category": "vase"}},
        ],
        "meshes": [{"name": "m", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 60}],
    }, points + corners


def _floor_of(layout: Layout) -> trimesh.Trimesh:
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(layout.floor_polygon)))
    points = np.array([[x, 0.0, z] for piece in pieces for x, z in piece.exterior.coords[:3]])
    return trimesh.Trimesh(points, np.arange(len(points)).reshape(-1, 3), process=False)
