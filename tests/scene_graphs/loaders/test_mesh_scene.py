"""A plain 3D scene becomes a room: furniture by the names of its nodes, boxes, fronts and shapes from its triangles."""

from __future__ import annotations

import base64
import json
import os
import struct
from contextlib import suppress
from math import pi, remainder, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import trimesh
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from layers import sampled
from scenes_at_hand import add, block, glb, obj_of, pose_of, scene_of, small_document
from spoiling import spoiled

from scene_graphs.affordances.affordances import spots
from scene_graphs.furniture import affordances
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, Placed, layout_from_dict, layout_to_dict
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.loaders import Imported, Options, Source, read_scene
from scene_graphs.loaders.gltf_reader import nodes_of_gltf
from scene_graphs.loaders.obj_reader import MAX_LINES
from scene_graphs.loaders.scene_nodes import Node

MESHES = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "layouts" / "meshes_aws_mit0"
ROOMS = built_in_layouts()[:4]
OBJ_LINES = [
    *("v 0 0 0", "v 1 0 0", "v 1 1 2", "v x", "v nan 0 0", "v 1e30 0 0", "v 1 2", "o vase", "o", "g", "\0"),
    *("f 1 2 3", "f -1 -2 -3", "f 1/1 2//3 9", "f", "f 1 1 1", "f 0 1 2", "usemtl a", "mtllib ../../secret"),
]
FLAT = {"lamp", "vase", "plant", "rug", "table"}
"""Last words of categories that look the same from several sides."""


def read(scene: trimesh.Scene | bytes, name: str = "scene.glb", **options: Any) -> Imported:
    data = scene if isinstance(scene, bytes) else scene.export(file_type="glb")
    return read_scene(Source.of_bytes(name, data), "glb", Options(**options))


def read_obj(text: str, **options: Any) -> Imported:
    return read_scene(Source.of_bytes("scene.obj", text.encode()), "obj", Options(**options))


def assert_same(found: Layout, layout: Layout, fronts: bool = True) -> None:
    assert shapely.Polygon(found.floor_polygon).symmetric_difference(shapely.Polygon(layout.floor_polygon)).area < 0.05
    mine = {placed.id.partition(".")[2]: placed for placed in found.objects}
    assert len(mine) == len(layout.objects)
    for placed in layout.objects:
        ours = mine[placed.id]
        assert ours.category == placed.category
        assert np.allclose(ours.position, placed.position, atol=0.03)
        has_front = placed.category.rpartition("_")[2] not in FLAT
        if fronts or has_front:
            # A box that is hardly turned is taken for one along the axes.
            assert abs(remainder(ours.yaw - placed.yaw, tau)) < (1e-3 if fronts else 0.1)
            assert np.allclose(ours.size, placed.size, atol=0.03 if fronts else 0.15)


@pytest.mark.parametrize("layout", sampled(ROOMS, 2), ids=lambda layout: layout.id)
def test_a_room_written_as_nodes_is_read_as_it_was(layout: Layout) -> None:
    assert_same(read(scene_of(layout)).layouts[0], layout)


@pytest.mark.parametrize("layout", sampled(ROOMS[2:], 2), ids=lambda layout: layout.id)
def test_fronts_are_found_where_turns_are_baked_into_the_points(layout: Layout) -> None:
    result = read(scene_of(layout, is_baked=True))
    assert_same(result.layouts[0], layout, fronts=False)
    assert result.report.guessed["front"] == len(layout.objects)


@pytest.mark.parametrize("z_up", sampled([True, False], 2))
def test_an_obj_with_its_axis_and_unit_named_is_the_same_room(z_up: bool) -> None:
    scene = scene_of(ROOMS[0])
    scene.apply_scale(100.0)
    found = read_obj(obj_of(scene, z_up), up="z" if z_up else "y", unit=0.01)
    assert_same(found.layouts[0], ROOMS[0], fronts=False)


@tries(20)
@given(st.floats(-pi, pi), st.sampled_from(["+z", "+x", "-z", "-x"]))
def test_the_front_is_where_the_option_says_in_the_turned_node(yaw: float, front: str) -> None:
    scene = trimesh.Scene()
    sofa = Placed("a", "multi_seat_sofa", (1.0, 0.0, 2.0), (2.0, 0.8, 0.9), yaw)
    add(scene, "Sofa", block((-1.0, 0.0, -0.4), (1.0, 0.8, 0.4)), pose_of(sofa))
    [placed] = read(scene, front=front).layouts[0].objects
    turn = {"+z": 0.0, "+x": pi / 2, "-z": pi, "-x": -pi / 2}[front]
    assert abs(remainder(placed.yaw - yaw - turn, tau)) < 1e-6
    assert placed.size == pytest.approx((2.0, 0.8, 0.8) if front[1] == "z" else (0.8, 0.8, 2.0))


def test_pieces_have_the_shape_of_their_mesh_and_can_be_sat_on() -> None:
    layout = read(scene_of(ROOMS[0])).layouts[0]
    for placed in layout.objects:
        if "sit" in affordances(placed.category):
            assert placed.shape
            assert spots(placed, "sit")


def test_a_mesh_finer_than_any_grid_has_its_shape_too() -> None:
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.25)
    scene = trimesh.Scene()
    add(scene, "Ottoman", ball)
    [placed] = read(scene).layouts[0].objects
    assert placed.size == pytest.approx((0.5, 0.5, 0.5), abs=1e-3)
    assert placed.shape


def test_a_piece_is_all_that_hangs_under_its_node_but_other_pieces() -> None:
    scene = trimesh.Scene()
    add(scene, "TV_Stand", block((0, 0, 0), (1.6, 0.1, 0.4)))
    add(scene, "Drawer_1", block((0, 0.1, 0), (0.8, 0.5, 0.4)), under="TV_Stand")
    add(scene, "Cube.003", block((0.8, 0.1, 0), (1.6, 0.5, 0.4)), under="TV_Stand")
    add(scene, "Vase", block((0.2, 0.5, 0.1), (0.3, 0.8, 0.2)), under="TV_Stand")
    stand, vase = read(scene).layouts[0].objects
    assert stand.category == "tv_stand"
    assert stand.size[1] == pytest.approx(0.5)
    assert (vase.category, vase.parent) == ("vase", stand.id)


def test_a_node_over_several_pieces_of_its_kind_is_a_group() -> None:
    scene = trimesh.Scene()
    scene.graph.update(frame_to="Chairs", frame_from="world", matrix=np.eye(4))
    for index in range(3):
        add(scene, f"Chair.{index}", block((index, 0, 0), (index + 0.5, 0.9, 0.5)), under="Chairs")
    assert [placed.category for placed in read(scene).layouts[0].objects] == ["dining_chair"] * 3
    scene = trimesh.Scene()
    scene.graph.update(frame_to="Sofa", frame_from="world", matrix=np.eye(4))
    for index in range(3):
        add(scene, f"Sofa_{index}", block((index, 0, 0), (index + 1, 0.9, 0.9)), under="Sofa")
    [sofa] = read(scene).layouts[0].objects
    assert sofa.size[0] == pytest.approx(3.0)


def test_parts_that_have_one_name_are_parts_each() -> None:
    document, points = small_document()
    same = {"mesh": 0, "name": "Drawer"}
    document |= {"nodes": [{"name": "Dresser", "children": [1, 2]}, same, same]}
    [dresser] = read(glb(document, points)).layouts[0].objects
    assert dresser.category == "dresser"


def test_a_plain_block_is_used_as_what_it_is_called() -> None:
    scene = trimesh.Scene()
    add(scene, "Sofa", block((0, 0, 0), (2, 0.8, 0.9)))
    [sofa] = read(scene).layouts[0].objects
    assert not sofa.shape
    assert spots(sofa, "sit")


def test_a_table_that_is_one_block_gets_legs_and_the_report_says_so() -> None:
    scene = trimesh.Scene()
    add(scene, "Table", block((0, 0, 0), (1.6, 0.75, 0.9)))
    add(scene, "Wardrobe", block((3, 0, 0), (4, 2.0, 0.6)))
    boxed = read(scene)
    assert not boxed.layouts[0].objects[0].shape
    (told,) = [line for line in boxed.report.lines() if "one solid block" in line]
    assert told.startswith("estimated 1: legs of a table")
    for x in (0.0, 1.5):
        add(scene, f"Leg{x}", block((x, -0.7, 0), (x + 0.1, 0, 0.9)), under="Table")
    built = read(scene)
    assert built.layouts[0].objects[0].shape
    assert not [line for line in built.report.lines() if "one solid block" in line]


def test_a_label_says_more_than_a_name() -> None:
    document, binary = small_document()
    document["nodes"][1] |= {"name": "Mesh_0815", "extras": {"category": "Wardrobe"}}
    assert read(glb(document, binary)).layouts[0].objects[0].category == "wardrobe"


def test_walls_enclose_the_floor_and_doors_open_them() -> None:
    scene = trimesh.Scene()
    add(scene, "Wall_North", block((0, 0, -0.1), (5, 2.6, 0)))
    add(scene, "Wall_South_1", block((0, 0, 4), (2, 2.6, 4.1)))
    add(scene, "Wall_South_2", block((3, 0, 4), (5, 2.6, 4.1)))
    add(scene, "Wall_West", block((-0.1, 0, 0), (0, 2.6, 4)))
    add(scene, "Wall_East", block((5, 0, 0), (5.1, 2.6, 4)))
    add(scene, "Door", block((2, 0, 4), (3, 2.0, 4.1)))
    add(scene, "Bed", block((0, 0, 1), (2, 0.5, 3)))
    add(scene, "Gizmo", block((4, 0, 1), (4.1, 0.1, 1.1)))
    result = read(scene)
    [layout] = result.layouts
    assert shapely.Polygon(layout.floor_polygon).symmetric_difference(shapely.box(0, 0, 5, 4)).area < 0.1
    assert layout.room_type == "bedroom"
    assert layout.height == pytest.approx(2.6)
    [door] = layout.doors
    assert np.allclose(sorted(door.segment), [(2, 4), (3, 4)], atol=0.06)
    assert result.report.examples["its name is no furniture we know; name or label its node"] == ["Gizmo"]


def test_a_scene_stands_on_its_floor_wherever_that_is() -> None:
    scene = scene_of(ROOMS[0])
    scene.apply_translation([3.0, -7.5, 2.0])
    layout = read(scene).layouts[0]
    assert min(placed.position[1] for placed in layout.objects) == pytest.approx(0.0, abs=1e-3)


@tries(25)
@given(st.data())
def test_points_are_those_another_library_reads(data: st.DataObject) -> None:
    numbers = st.floats(-3, 3, width=32)
    scene = trimesh.Scene()
    above = None
    for index in range(data.draw(st.integers(1, 4))):
        mesh = trimesh.creation.box(extents=data.draw(st.tuples(*[st.floats(0.125, 2, width=32)] * 3)))
        pose = trimesh.transformations.quaternion_matrix(data.draw(st.tuples(*[st.floats(0.125, 1, width=32)] * 4)))
        pose[:3, :3] *= data.draw(st.floats(0.25, 2, width=32))
        pose[:3, 3] = data.draw(st.tuples(numbers, numbers, numbers))
        add(scene, f"n{index}", mesh, pose, above)
        above = data.draw(st.sampled_from([None, f"n{index}"]))
    content = scene.export(file_type="glb")
    theirs = trimesh.load_scene(trimesh.util.wrap_as_stream(content), file_type="glb")
    mine = {node.name: node for top in nodes_of_gltf(content, "scene.glb") for node in _all(top)}
    for name in theirs.graph.nodes_geometry:
        pose, geometry = theirs.graph[name]
        mesh = theirs.geometry[geometry].copy()
        mesh.apply_transform(pose)
        triangles = mine[name].own.points[mine[name].own.corners]
        assert np.allclose(triangles, mesh.vertices[mesh.faces], atol=1e-5)


def _all(node: Node) -> list[Node]:
    return [node, *(below for child in node.children for below in _all(child))]


@for_each(
    ("change", "message"),
    [
        ({"nodes": [{"children": [0]}]}, "two parents or is its own"),
        ({"nodes": [{"children": [1, 1]}, {"mesh": 0}]}, "two parents or is its own"),
        ({"nodes": [{"children": [n + 1]} for n in range(300)] + [{}]}, "deeper than 100"),
        ({"nodes": [{}] * 30_000}, "more than 20000 nodes"),
        ({"nodes": [{"mesh": 7}]}, r"names meshes\[7\]"),
        ({"nodes": [{"mesh": 0, "rotation": [0, 0, 0, 0]}]}, "must be a quaternion"),
        ({"nodes": [{"mesh": 0, "matrix": [1e300] * 16}]}, "must be 16 numbers"),
        ({"nodes": [{"mesh": 0, "scale": [1e6] * 3, "children": [1]}, {"scale": [1e6] * 3}]}, "beyond any room"),
        ({"buffers": [{"byteLength": 60, "uri": "../../etc/passwd"}]}, "geometry in another file"),
        ({"buffers": [{"byteLength": 60, "uri": "data:x;base64,####"}]}, "not base64"),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "export it without compression"),
        ({"bufferViews": [{"buffer": 0, "byteLength": 1 << 35}] * 2}, "beyond its buffer"),
    ],
)
def test_a_hostile_document_is_refused_with_the_reason(change: dict[str, Any], message: str) -> None:
    document, binary = small_document()
    if message == "beyond its buffer":
        document["accessors"][0]["count"] = 1 << 30
    with pytest.raises(LayoutError, match=message):
        read(glb(document | change, binary))


def test_points_that_are_no_numbers_and_corners_that_are_not_there_are_refused() -> None:
    document, binary = small_document()
    with pytest.raises(LayoutError, match="no numbers"):
        read(glb(document, struct.pack("<f", float("nan")) + binary[4:]))
    with pytest.raises(LayoutError, match="no numbers"):
        read(glb(document, bytes.fromhex("0100a07f") + binary[4:]))  # a NaN that signals
    with pytest.raises(LayoutError, match="name point 65535 of 4"):
        read(glb(document, binary[:48] + b"\xff\xff" + binary[50:]))


def test_one_mesh_drawn_a_thousand_times_is_refused_before_it_fills_the_memory() -> None:
    corners = np.zeros((50_000, 3), dtype="<u4")
    document, _ = small_document()
    document["nodes"] = [{"name": "chair", "mesh": 0} for _ in range(1_000)]
    document["scenes"] = [{"nodes": list(range(1_000))}]
    document["accessors"][1] |= {"componentType": 5125, "count": corners.size}
    document["bufferViews"][1]["byteLength"] = corners.nbytes
    with pytest.raises(LayoutError, match="more than 2000000 triangles"):
        read(glb(document, small_document()[1][:48] + corners.tobytes()))


def test_a_gltf_that_holds_its_own_data_is_read_too() -> None:
    document, binary = small_document()
    document["buffers"] = [{"uri": "data:application/octet-stream;base64," + base64.b64encode(binary).decode()}]
    assert read(json.dumps(document).encode()).layouts == read(glb(*small_document())).layouts


@tries(150)
@given(spoiled(small_document()[0]))
def test_whatever_a_document_says_it_is_read_or_refused(document: Any) -> None:
    with suppress(LayoutError):
        for layout in read(glb(document, small_document()[1])).layouts:
            assert layout_from_dict(layout_to_dict(layout)) == layout


@tries(100)
@given(st.data())
def test_a_file_that_is_cut_off_or_has_flipped_bytes_is_read_or_refused(data: st.DataObject) -> None:
    content = bytearray(glb(*small_document()))
    length = data.draw(st.integers(0, len(content)))
    for _ in range(data.draw(st.integers(0, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    with suppress(LayoutError):
        read(bytes(content[:length]))


@tries(100)
@given(st.lists(st.sampled_from(OBJ_LINES), max_size=12))
def test_whatever_an_obj_says_it_is_read_or_refused(lines: list[str]) -> None:
    with suppress(LayoutError):
        read_obj("\n".join(lines))


@for_each(
    ("text", "message"),
    [
        ("o sofa\nv 1 2", "line 2: v must be followed by three numbers"),
        ("v 0 0 0\nf 1 2 3", "line 2: there is no point '2' of 1"),
        ("v 0 0 nan", "line 1: a point beyond any room"),
        ("v 0 1e7 0\nv 0 -1.1e7 0", "line 2: a point beyond any room"),
        ("f " + "1 " * 20_000, "more than 10000 corners"),
        ("hello", "has no faces"),
    ],
)
def test_a_bad_line_of_an_obj_is_named(text: str, message: str) -> None:
    with pytest.raises(LayoutError, match=message):
        read_obj(text)


@pytest.mark.sweep
def test_a_text_of_millions_of_lines_is_refused() -> None:
    with pytest.raises(LayoutError, match="lines; simplify it"):
        read_obj("\n" * (MAX_LINES + 1))


def test_options_that_name_no_axis_are_refused() -> None:
    scene = scene_of(ROOMS[0])
    for options in ({"up": "x"}, {"front": "up"}, {"unit": 0.0}, {"unit": float("nan")}):
        with pytest.raises(LayoutError, match="must be"):
            read(scene, **options)


def test_a_scene_in_centimetres_says_so() -> None:
    scene = scene_of(ROOMS[0])
    scene.apply_scale(100.0)
    with pytest.raises(LayoutError, match=r"larger than 30 m"):
        read(scene)


@pytest.mark.sweep
@pytest.mark.skipif(not MESHES.is_dir(), reason="SIMS_TEST_DATA holds no layouts/meshes_aws_mit0")
def test_real_furniture_is_read_with_its_size_and_its_seat() -> None:
    pieces = json.loads((MESHES / "manifest.json").read_text())["meshes"]
    for piece in pieces:
        document = _named((MESHES / piece["file"]).read_bytes(), piece["category"])
        layout = read(document).layouts[0]
        [placed] = layout.objects
        assert np.allclose(placed.size, piece["size"], atol=2e-3)
        heights = [region["height"] for region in piece.get("flat_regions", []) if region["sit"] or region["lie"]]
        if heights:
            use = (
                "sit"
                if "sit" in affordances(placed.category) and any(r["sit"] for r in piece["flat_regions"])
                else "lie"
            )
            found = [spot.point[1] for spot in spots(placed, use)]
            assert found
            assert min(abs(height - y) for y in found for height in heights) < 0.03


def _named(data: bytes, name: str) -> bytes:
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    document["nodes"][0]["extras"] = {"category": name}
    return glb(document, data[28 + length :])
