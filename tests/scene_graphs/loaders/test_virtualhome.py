"""A VirtualHome flat becomes rooms: floors from tiles, fronts from what stands around, and junk is refused."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from math import pi, remainder, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from spoiling import spoiled
from unity_houses import edge, flat, node

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict, read_layouts
from scene_graphs.loaders import Imported, Source, read_scene

DATA = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "layouts"
FLAT = DATA / "extra" / "virtualhome_TestScene2_graph.json.gz"
HANGING = {"ceiling_lamp", "coffee_maker", "coffee_pot", "toaster", "computer", "mouse", "radio"}
"""Things without a front that anybody could tell."""


def read(graph: Any) -> Imported:
    return read_scene(Source.of_bytes("flat.json", json.dumps(graph).encode()), "virtualhome")


def test_a_room_is_the_union_of_its_tiles_mirrored_into_our_frame() -> None:
    bedroom, living_room = read(flat()).layouts
    assert (bedroom.id, bedroom.room_type, living_room.room_type) == ("flat/1", "bedroom", "living_room")
    assert shapely.Polygon(bedroom.floor_polygon).symmetric_difference(shapely.box(-5, 0, 0, 2.5)).area < 0.01
    assert bedroom.height == 2.5


def test_a_door_frame_opens_the_wall_of_both_rooms() -> None:
    for layout in read(flat()).layouts:
        [door] = layout.doors
        assert np.allclose(sorted(door.segment), [(0.0, 0.785), (0.0, 1.715)], atol=1e-3)
        assert door.top == pytest.approx(2.06)


def test_furniture_has_its_box_its_height_and_a_front_that_was_guessed() -> None:
    result = read(flat())
    bedroom = result.layouts[0]
    bed, pillow, wardrobe = (bedroom.object(name) for name in ("10", "11", "12"))
    assert bed.category == "double_bed"
    assert bed.size == pytest.approx((1.4, 0.65, 2.0))
    # The pillow lies at Unity's +x, ours is -x: the foot looks the other way.
    assert np.allclose(bed.front, (1.0, 0.0))
    assert pillow.parent == "10"
    assert wardrobe.category == "wardrobe"
    assert np.allclose(wardrobe.front, (0.0, 1.0))
    assert bedroom.object("13").size[1] > 0
    assert result.report.guessed["front"] == 5
    assert result.report.dropped["a small thing to pick up, or nobody's furniture"] == 1


def test_a_turned_chair_has_a_footprint_though_its_stored_size_is_none() -> None:
    graph = flat()
    chair = node(30, "chair", "Furniture", (2.0, 0.5, 1.0), (0.0, 1.0, 0.87), "PRE_FUR_CPU_chair_03_05")
    graph["nodes"].append(chair)
    graph["edges"].append(edge(30, "INSIDE", 1))
    placed = read(graph).layouts[0].object("30")
    assert (placed.category, placed.size[0], placed.size[2]) == ("office_chair", 0.62, 0.62)


def test_a_program_holds_its_graph_as_init_graph() -> None:
    assert read({"init_graph": flat(), "final_graph": {}}).layouts == read(flat()).layouts


def test_a_room_without_tiles_has_its_own_box_for_a_floor() -> None:
    graph = flat()
    graph["nodes"] = [row for row in graph["nodes"] if row["category"] != "Floor"]
    result = read(graph)
    assert result.report.guessed["floor"] == 2
    assert result.layouts[0].area == pytest.approx(16.5, abs=0.01)


def test_what_is_no_graph_is_refused() -> None:
    no_graphs: tuple[Any, ...] = ({"rooms": []}, [1], "graph", None)
    for junk in no_graphs:
        with pytest.raises(LayoutError, match="nodes and edges"):
            read(junk)


def test_things_on_each_other_in_a_circle_do_no_harm() -> None:
    graph = flat()
    graph["edges"] += [edge(10, "ON", 11), edge(11, "ON", 11), edge(12, "INSIDE", 12), edge(1, "INSIDE", 1)]
    assert len(read(graph).layouts) == 2


@pytest.mark.sweep
def test_a_hundred_thousand_nodes_are_refused_in_bounded_time() -> None:
    graph = flat()
    graph["nodes"] += [node(n, "chair", "Furniture", (1, 0, 1), (0.5, 1, 0.5)) for n in range(100, 100_000)]
    with pytest.raises(LayoutError, match="at most 20000"):
        read(graph)


@tries(150)
@given(spoiled(flat()))
def test_whatever_a_graph_says_it_is_read_or_refused(graph: Any) -> None:
    with suppress(LayoutError):
        for layout in read(graph).layouts:
            assert layout_from_dict(layout_to_dict(layout)) == layout


@tries(40)
@given(st.integers(0, len(json.dumps(flat())) - 1))
def test_a_file_that_is_cut_off_is_refused(length: int) -> None:
    with pytest.raises(LayoutError):
        read_scene(Source.of_bytes("flat.json", json.dumps(flat())[:length].encode()), "virtualhome")


@pytest.mark.skipif(not FLAT.is_file(), reason="SIMS_TEST_DATA holds no layouts/extra")
def test_an_original_flat_agrees_with_its_rooms_as_others_converted_them() -> None:
    rooms = {layout.id.rsplit("/")[-1]: layout for layout in read_scene(FLAT, "virtualhome").layouts}
    converted = [
        layout
        for layout in read_layouts(DATA / "rooms" / "virtualhome_rooms.jsonl.gz")
        if layout.id.startswith("virtualhome/TestScene2/")
    ]
    fronts = []
    for theirs in converted:
        ours = rooms[theirs.id.rsplit("/")[-1]]
        assert (ours.room_type, set(ours.tags)) == (theirs.room_type, set(theirs.tags))
        assert _outline(ours).symmetric_difference(_outline(theirs)).area < 0.02
        assert (len(ours.doors), len(ours.windows)) == (len(theirs.doors), len(theirs.windows))
        mine = {placed.id: placed for placed in ours.objects}
        for placed in theirs.objects:
            found = mine[placed.id]
            assert found.category == placed.category
            assert np.allclose(
                [found.position[axis] for axis in (0, 2)], [placed.position[axis] for axis in (0, 2)], atol=1e-3
            )
            assert abs(found.position[1] - placed.position[1]) < 0.13
            assert np.allclose(sorted(found.size), sorted(placed.size), atol=3e-3)
            if placed.category not in HANGING:
                fronts.append(abs(remainder(found.yaw - placed.yaw, tau)) < pi / 4)
    assert len(converted) == 4
    assert np.mean(fronts) > 0.95


def _outline(layout: Layout) -> shapely.Polygon:
    return shapely.Polygon(layout.floor_polygon)
