"""Rooms and their files."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture_shapes import parts_of
from scene_graphs.layout import (
    Layout,
    LayoutError,
    Placed,
    layout_from_dict,
    layout_to_dict,
    read_layouts,
    write_layouts,
)

ROW: dict[str, Any] = {
    "id": "demo",
    "room_type": "bedroom",
    "floor_polygon": [[-2, -2], [-2, 2], [2, 2], [2, -2]],
    "doors": [{"segment": [[-2, 0], [-2, 0.9]]}],
    "objects": [
        {"id": "a", "category": "Couch", "pos": [0, 0, 1], "size": [2.1, 0.85, 0.95], "yaw": 3.1416},
        {"id": "b", "category": "lamp", "position": [0, 0.4, 1], "size": [0.2, 0.3, 0.2], "parent": "a"},
    ],
}
numbers = st.floats(-50, 50)


def changed(**fields: Any) -> dict[str, Any]:
    return {**ROW, **fields}


@tries(30)
@given(numbers, numbers, numbers, st.floats(-3.1, 3.1), st.tuples(numbers, numbers, numbers))
def test_to_local_undoes_to_world(x: float, y: float, z: float, yaw: float, point: tuple[float, float, float]) -> None:
    placed = Placed("a", "desk", (x, y, z), (1.0, 1.0, 1.0), yaw)
    assert np.allclose(placed.to_local(placed.to_world(point)), point, atol=1e-9)


def test_yaw_turns_the_front_from_z_to_x() -> None:
    placed = Placed("a", "desk", (0, 0, 0), (1.0, 1.0, 1.0), np.pi / 2)
    assert np.allclose(placed.to_world((0, 0, 1)), (1, 0, 0))
    assert np.allclose(placed.front, (1, 0))


def test_a_row_is_read_with_pos_for_position_and_canonical_categories() -> None:
    layout = layout_from_dict(ROW)
    assert layout.objects[0].position == (0.0, 0.0, 1.0)
    assert layout.objects[0].category == "sofa"
    assert layout.tags == ("bedroom",)
    assert (layout.doors[0].bottom, layout.doors[0].top) == (0.0, 2.1)


def test_writing_a_row_and_reading_it_is_the_identity() -> None:
    layout = layout_from_dict(ROW)
    assert layout_from_dict(json.loads(json.dumps(layout_to_dict(layout)))) == layout


SHAPE = [["seat", [-1.0, 0.2, -0.3], [1.0, 0.43, 0.47]], ["back", [-1.0, 0.2, -0.47], [1.0, 0.85, -0.3]]]


def shaped(shape: Any) -> dict[str, Any]:
    return changed(objects=[{**ROW["objects"][0], "shape": shape}])


def test_a_measured_shape_is_written_and_read_to_the_last_bit_and_left_out_where_there_is_none() -> None:
    layout = layout_from_dict(shaped(SHAPE))
    row = layout_to_dict(layout)
    assert row["objects"][0]["shape"] == SHAPE
    assert layout_from_dict(json.loads(json.dumps(row))) == layout
    assert parts_of(layout.objects[0]) == layout.objects[0].shape
    assert "shape" not in layout_to_dict(layout_from_dict(ROW))["objects"][0]


@for_each(
    ("shape", "message"),
    [
        ("box", "shape must be a list of at most 64"),
        (SHAPE * 33, "shape must be a list of at most 64"),
        ([["throne", *SHAPE[0][1:]]], r"shape\[0\] must be \[role, low, high\] with a role of arm, back"),
        ([[["seat"], *SHAPE[0][1:]]], r"shape\[0\] must be \[role"),
        ([["seat", [0, 0, 0]]], r"shape\[0\] must be \[role"),
        ([["seat", [0, 0], [1, 1, 1]]], r"shape\[0\] must be three numbers"),
        ([["seat", [0, 0, 0], [0.1, float("nan"), 0.1]]], r"shape\[0\] must be a number"),
        ([["seat", [0, 0, 0], [0.1, 1.2, 0.1]]], r"shape\[0\] must lie in its piece's box"),
        ([["seat", [0, 0.2, 0], [0.1, 0.1, 0.1]]], r"shape\[0\] must lie in its piece's box"),
    ],
)
def test_a_shape_that_is_none_is_refused_with_its_place(shape: Any, message: str) -> None:
    with pytest.raises(LayoutError, match=rf"layout.objects\[0\].{message}"):
        layout_from_dict(shaped(shape))


def test_an_outline_may_come_closed_and_closed_again() -> None:
    corners = ROW["floor_polygon"]
    closed = layout_from_dict(changed(floor_polygon=[*corners, corners[0], corners[0]]))
    assert closed == layout_from_dict(changed(floor_polygon=corners))


def test_an_outline_is_counter_clockwise_seen_from_above_whatever_its_order() -> None:
    backwards = layout_from_dict(changed(floor_polygon=ROW["floor_polygon"][::-1]))
    points = np.array(backwards.floor_polygon)
    following = np.roll(points, -1, axis=0)
    assert (points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]).sum() < 0


@for_each(
    ("fields", "message"),
    [
        ({"id": ""}, "layout.id must be a text"),
        ({"floor_polygon": [[0, 0], [1, 1]]}, "floor_polygon must be a list of 3"),
        ({"floor_polygon": [[0, 0], [2, 2], [2, 0], [0, 2]]}, "floor_polygon must be a simple polygon"),
        ({"floor_polygon": [[0, 0], [0, 2], [2, "x"]]}, r"floor_polygon\[2\] must be a number"),
        ({"height": float("nan")}, "height must be a number"),
        ({"height": True}, "height must be a number"),
        ({"doors": [{"segment": [[0, 0]]}]}, r"doors\[0\].segment must be two"),
        ({"windows": [{"segment": [[0, 0], [1, 0]], "bottom": 2, "top": 1}]}, r"windows\[0\].top must be above"),
        ({"objects": [{"id": "a", "category": "bed", "size": [1, 1, 1]}]}, r"objects\[0\].position must be three"),
        (
            {"objects": [{"id": "a", "category": "bed", "position": [0, 0, 0], "size": [1, 0, 1]}]},
            "size must lie between",
        ),
        ({"objects": [ROW["objects"][0], ROW["objects"][0]]}, r"objects\[1\].id 'a' occurs twice"),
        ({"objects": [{**ROW["objects"][0], "parent": "z"}]}, "parent 'z' is no other object's id"),
        ({"objects": [ROW["objects"][0]] * 501}, "at most 500"),
        ({"objects": ["sofa"]}, r"objects\[0\] must be an object, got str"),
    ],
)
def test_a_bad_field_is_named_with_what_would_be_right(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(LayoutError, match=message):
        layout_from_dict(changed(**fields))


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


@tries(60)
@given(st.sampled_from(sorted(ROW)), json_values)
def test_whatever_a_field_holds_it_is_read_or_refused_by_name(field: str, value: Any) -> None:
    try:
        read: Layout | str = layout_from_dict(changed(**{field: value}))
    except LayoutError as error:
        read = str(error)
    assert isinstance(read, Layout) or field in read


@pytest.mark.parametrize("name", ["rooms.json", "rooms.jsonl", "rooms.json.gz", "rooms.jsonl.gz"])
def test_files_of_every_kind_are_read_as_they_were_written(tmp_path: Path, name: str) -> None:
    layouts = [layout_from_dict(ROW), layout_from_dict(changed(id="other"))]
    write_layouts(tmp_path / name, layouts)
    assert read_layouts(tmp_path / name) == layouts


def test_a_single_room_is_a_file_too(tmp_path: Path) -> None:
    (tmp_path / "room.json").write_text(json.dumps(ROW))
    assert [layout.id for layout in read_layouts(tmp_path / "room.json")] == ["demo"]


def test_errors_in_files_name_the_file_and_the_line(tmp_path: Path) -> None:
    file = tmp_path / "rooms.jsonl"
    file.write_text(json.dumps(ROW) + "\n" + json.dumps(changed(id="b", height=0)) + "\n")
    with pytest.raises(LayoutError, match=r"rooms.jsonl line 2.height"):
        read_layouts(file)
    file.write_text(json.dumps(ROW) + "\n" + json.dumps(ROW) + "\n")
    with pytest.raises(LayoutError, match=r"line 2.id 'demo' occurs twice"):
        read_layouts(file)
    file.write_text("{")
    with pytest.raises(LayoutError, match="line 1 is not JSON"):
        read_layouts(file)
    with pytest.raises(LayoutError, match=r"read from .json"):
        read_layouts(tmp_path / "rooms.csv")
    with pytest.raises(LayoutError, match="cannot be read"):
        read_layouts(tmp_path / "absent.json")
    (tmp_path / "broken.json.gz").write_bytes(gzip.compress(b"[]")[:-6])
    with pytest.raises(LayoutError, match="cannot be read"):
        read_layouts(tmp_path / "broken.json.gz")


def test_an_object_is_found_by_its_id_or_the_ids_are_listed() -> None:
    layout = layout_from_dict(ROW)
    assert layout.object("b").parent == "a"
    with pytest.raises(KeyError, match="it has a, b"):
        layout.object("c")
