"""3DSSG's scene graphs become furniture graphs, and 3RScan's boxes rooms with Y up."""

from __future__ import annotations

import json
from contextlib import suppress
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from scans import OBJECTS, RELATIONSHIPS, ROOM, Piece, semseg
from spoiling import spoiled

from scene_graphs.furniture import Furniture
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict
from scene_graphs.loaders import Imported, Options, Source, read_scene
from scene_graphs.loaders.threedssg import graph_from_3dssg

Json = dict[str, Any]


def read(row: Any, **options: Any) -> Imported:
    return read_scene(Source.of_bytes("semseg.v2.json", json.dumps(row).encode()), "3dssg", Options(**options))


def only(*pieces: Piece) -> Layout:
    (layout,) = read(semseg(*pieces)).layouts
    return layout


def test_the_graph_joins_furniture_by_place_and_support_only() -> None:
    graph = graph_from_3dssg(OBJECTS, RELATIONSHIPS, "s1")
    table, armchair, first, second = (
        Furniture("coffee_table"),
        Furniture("armchair"),
        Furniture("sofa", 1),
        Furniture("sofa", 2),
    )
    assert set(graph) == {table, armchair, first, second, Furniture("harp")}
    assert {frozenset(edge) for edge in graph.edges} == {frozenset((table, second)), frozenset((second, armchair))}
    assert [graph.nodes[node]["object_id"] for node in (table, armchair, first, second)] == ["2", "3", "6", "10"]
    assert graph.nodes[armchair]["offers"] == {"sit", "touch"}


def test_an_unknown_thing_on_furniture_is_left_out_and_one_on_the_floor_is_not() -> None:
    categories = {node.category for node in graph_from_3dssg(OBJECTS, RELATIONSHIPS, "s1")}
    assert "harp" in categories
    assert "cup" not in categories


def test_ids_may_be_texts_or_numbers_in_either_file() -> None:
    numbers = json.loads(json.dumps(OBJECTS))
    for row in numbers["scans"][0]["objects"]:
        row["id"] = int(row["id"])
    texts = json.loads(json.dumps(RELATIONSHIPS))
    for entry in texts["scans"]:
        entry["relationships"] = [[str(a), str(b), *rest] for a, b, *rest in entry["relationships"]]
    graph = graph_from_3dssg(OBJECTS, RELATIONSHIPS, "s1")
    other = graph_from_3dssg(numbers, texts, "s1")
    assert set(graph) == set(other)
    assert {frozenset(edge) for edge in graph.edges} == {frozenset(edge) for edge in other.edges}


@for_each(
    ("objects", "relationships", "scan", "named"),
    [
        (OBJECTS, RELATIONSHIPS, "s9", "s9"),
        ([], RELATIONSHIPS, "s1", r"objects\.json"),
        (OBJECTS, {"scans": 5}, "s1", r"relationships\.json\.scans"),
        (OBJECTS, {"scans": [{"scan": "s1", "relationships": [[1, 2]]}]}, "s1", r"relationships\[0\]"),
        (OBJECTS, {"scans": [{"scan": "s1", "relationships": [[[], 2, 1, "left"]]}]}, "s1", "subject"),
        ({"scans": [{"scan": "s1", "objects": [{"id": True, "label": "bed"}]}]}, {}, "s1", r"objects\[0\]\.id"),
        ({"scans": [{"scan": "s1", "objects": [{"id": "1"}]}]}, {}, "s1", r"objects\[0\]\.label"),
    ],
)
def test_a_graph_that_cannot_be_read_names_the_place(objects: Any, relationships: Any, scan: str, named: str) -> None:
    with pytest.raises(LayoutError, match=named):
        graph_from_3dssg(objects, relationships, scan)


@given(spoiled(OBJECTS), spoiled(RELATIONSHIPS))
@tries(150)
def test_a_spoiled_graph_is_read_or_refused(objects: Any, relationships: Any) -> None:
    with suppress(LayoutError):
        graph = graph_from_3dssg(objects, relationships, "s1")
        assert all(a != b for a, b in graph.edges)


def test_a_scan_with_boxes_becomes_a_room_with_y_up() -> None:
    imported = read(semseg(*ROOM))
    (layout,) = imported.layouts
    assert (layout.id, layout.room_type, layout.tags) == ("3rscan/s1", "bedroom", ("bedroom", "study"))
    assert layout.area == pytest.approx(12.0, abs=0.05)
    by_category = {placed.category: placed for placed in layout.objects}
    assert set(by_category) == {"single_bed", "pillow", "desk", "office_chair", "mug"}
    bed, desk, chair = by_category["single_bed"], by_category["desk"], by_category["office_chair"]
    assert np.allclose(bed.position, (1.0, 0.0, -2.4), atol=0.03)
    assert np.allclose(bed.size, (1.0, 0.6, 2.0), atol=0.03)
    assert np.allclose(bed.front, (1.0, 0.0), atol=1e-6)
    assert np.allclose(desk.size, (1.2, 0.75, 0.6), atol=0.03)
    assert desk.position[1] == 0.0
    assert np.allclose(desk.front, (0.0, 1.0), atol=1e-6)
    assert np.allclose(chair.front, (0.0, -1.0), atol=1e-6)
    assert by_category["mug"].parent == desk.id
    assert by_category["pillow"].parent == bed.id
    assert imported.report.guessed["front"] == 5
    assert imported.report.dropped["it is part of the building, not furniture"] == 1
    assert (len(layout.doors), len(layout.windows)) == (1, 1)
    assert layout_from_dict(layout_to_dict(layout)) == layout


@given(st.floats(-pi, pi), st.floats(0.5, 1.0))
@tries(50)
def test_a_turned_box_keeps_its_plan(heading: float, depth: float) -> None:
    piece = Piece("wardrobe", (2.0, 1.5, 1.0), (1.6, depth, 2.0), heading)
    placed = only(piece).objects[0]
    corners = {tuple(np.round((x, -y), 6) + 0.0) for x, y, _ in piece.points(2)}
    away = np.linalg.norm(np.array(sorted(corners))[:, None] - placed.footprint[None], axis=2)
    assert away.min(axis=1).max() < 1e-5
    assert np.allclose(placed.size, (1.6, 2.0, depth))


def test_heights_count_from_the_floor_wherever_the_scan_has_it() -> None:
    lifted = [piece._replace(middle=(*piece.middle[:2], piece.middle[2] - 1.4)) for piece in ROOM]
    first, second = only(*ROOM), only(*lifted)
    for a, b in zip(first.objects, second.objects, strict=True):
        assert np.allclose(a.position, b.position)
        assert np.allclose(a.size, b.size)


def test_a_scan_without_floor_stands_on_its_lowest_things() -> None:
    imported = read(semseg(*[piece for piece in ROOM if piece.label not in ("floor", "wall", "door", "window")]))
    assert min(placed.position[1] for placed in imported.layouts[0].objects) == 0.0
    assert imported.report.guessed["floor"] == 1


def test_scans_lie_in_folders_beside_the_labels(tmp_path: Path) -> None:
    (tmp_path / "objects.json").write_text(json.dumps(OBJECTS))
    for source in (tmp_path, tmp_path / "objects.json"):
        with pytest.raises(LayoutError, match=r"semseg\.v2\.json.*graph_from_3dssg"):
            read_scene(source, "3dssg")
    for name in ("s1", "s2"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "semseg.v2.json").write_text(json.dumps(semseg(*ROOM)))
    assert [layout.id for layout in read_scene(tmp_path, "3dssg").layouts] == ["3rscan/s1", "3rscan/s2"]
    assert [layout.id for layout in read_scene(tmp_path, "3dssg", Options(scan="s2")).layouts] == ["3rscan/s2"]
    assert [layout.id for layout in read_scene(tmp_path / "s2", "3dssg").layouts] == ["3rscan/s2"]
    assert read_scene(tmp_path / "s2" / "semseg.v2.json", "3dssg").layouts[0].id == "3rscan/s1"


def test_a_folder_without_anything_says_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(LayoutError, match=r"semseg\.v2\.json"):
        read_scene(tmp_path, "3dssg")


def test_a_room_type_can_be_given() -> None:
    assert read(semseg(*ROOM), room_type="Office").layouts[0].room_type == "study"


@given(spoiled(semseg(*ROOM)))
@tries(150)
def test_a_spoiled_scan_is_refused_or_reported(row: Any) -> None:
    with suppress(LayoutError):
        for layout in read(row).layouts:
            assert layout_from_dict(layout_to_dict(layout)) == layout


@pytest.mark.sweep
@pytest.mark.parametrize("count", [1_500, 6_000])
def test_a_huge_scan_is_read_or_refused(count: int) -> None:
    row = semseg(*ROOM)
    row["segGroups"] = (row["segGroups"] * (count // len(ROOM) + 1))[:count]
    with suppress(LayoutError):
        assert len(read(row).layouts[0].objects) <= 500
