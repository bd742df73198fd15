"""Drawings: what is asked for is in them, and the same room gives the same picture."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.colors import to_rgb

from scene_graphs.affordances.room_validation import RoomCheck
from scene_graphs.furniture import AFFORDANCES, display_name
from scene_graphs.graph.furniture_graph import graph_from_layout, graph_from_uses
from scene_graphs.layout import Layout, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.plots.floor_plan import EDGE_COLOR, GROUP_COLORS, ROUTE_COLOR, SPOT_COLORS, draw_layout
from scene_graphs.plots.match_plot import LEVEL_COLORS, MISSING_COLOR, draw_match
from scene_graphs.retrieval.home_retrieval import retrieve_home
from scene_graphs.retrieval.layout_index import LayoutIndex

ROOM = next(layout for layout in built_in_layouts() if layout.room_type == "bedroom")


@cache
def index() -> LayoutIndex:
    return LayoutIndex(built_in_layouts()[:40])


@cache
def best_spots(layout: Layout) -> list:
    check = RoomCheck(layout)
    found = (next(check.usable(placed, verb), None) for placed in layout.objects for verb in AFFORDANCES)
    return [spot for spot in found if spot is not None]


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_the_same_room_gives_the_same_bytes(tmp_path: Path, ending: str) -> None:
    first, second = tmp_path / f"a.{ending}", tmp_path / f"b.{ending}"
    for path in (first, second):
        draw_layout(ROOM, path, spots=best_spots(ROOM), route=[[0, 0], [1, 1]])
    assert first.read_bytes() == second.read_bytes()


def test_an_svg_holds_names_relations_spots_and_the_path_that_were_asked_for(tmp_path: Path) -> None:
    graph = graph_from_layout(ROOM)
    edges = [(graph.nodes[a]["object_id"], graph.nodes[b]["object_id"]) for a, b in graph.edges]
    bare, full = tmp_path / "bare.svg", tmp_path / "full.svg"
    draw_layout(ROOM, bare)
    draw_layout(ROOM, full, spots=best_spots(ROOM), edges=edges, route=[[0, 0], [1, 1]])
    texts = {"".join(element.itertext()).strip() for element in ET.parse(full).iter() if element.tag.endswith("text")}
    beds = [placed for placed in ROOM.objects if "bed" in placed.category]
    assert beds
    assert all(display_name(bed.category) in texts for bed in beds)
    for color in (EDGE_COLOR, ROUTE_COLOR, SPOT_COLORS["lie"], SPOT_COLORS["touch"]):
        assert color in full.read_text()
        assert color not in bare.read_text()
    assert full.read_text().count(EDGE_COLOR) > len(edges)


def test_no_name_covers_another_however_much_lies_on_a_table() -> None:
    things = [Placed(f"thing_{k}", "mouse", (0.1 * k, 0.8, 0.05 * (k % 3)), (0.1, 0.05, 0.1)) for k in range(12)]
    table = Placed("table", "dining_table", (0.5, 0.0, 0.0), (1.6, 0.8, 0.9))
    room = Layout("full", "dining_room", ((-2, -2), (-2, 2), (3, 2), (3, -2)), objects=(table, *things))
    figure = draw_layout(room)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    assert figure.axes[0].texts[0].get_text() == "dining table"
    assert 3 <= len(boxes) <= len(room.objects)
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


def test_the_floor_between_the_wings_of_a_corner_sofa_stays_free_and_its_name_is_on_it() -> None:
    sofa = Placed("sofa", "l_shaped_sofa", (0.0, 0.0, 0.0), (3.8, 0.85, 3.2))
    room = Layout("corner", "living_room", ((-3, -3), (-3, 3), (3, 3), (3, -3)), objects=(sofa,))
    ax = draw_layout(room).axes[0]
    (name,) = ax.texts
    filled = [patch for patch in ax.patches if patch.get_facecolor()[:3] == to_rgb(GROUP_COLORS["sit"])]
    assert filled
    outlines = [shapely.Polygon(np.asarray(patch.get_path().vertices)) for patch in filled]
    area = sum(outline.area for outline in outlines)
    assert area < 0.8 * 3.8 * 3.2
    assert any(outline.covers(shapely.Point(name.get_position())) for outline in outlines)


def test_a_match_shows_how_near_each_piece_is_and_what_is_missing(tmp_path: Path) -> None:
    query = graph_from_uses([("bed", 1), ("wardrobe", 1), ("stove", 1)], [["lie"], ["touch"], ["touch"]])
    match = index().search(query, 1, "bedroom")[0]
    assert [node.category for node in match.missing] == ["stove"]
    path = tmp_path / "match.svg"
    draw_match(query, [index().layout(match.layout_id)], match, path, ["stove: nothing of its group"])
    text = path.read_text()
    assert "stove: nothing of its group" in text
    assert "what is asked for" in text
    for _, _, level in match.mapping:
        assert LEVEL_COLORS[level] in text
    assert MISSING_COLOR in text


def test_a_home_of_two_rooms_is_drawn_beside_its_query(tmp_path: Path) -> None:
    query = graph_from_uses([("bed", 1), ("nightstand", 1), ("sofa", 1), ("dining_table", 1)])
    match = retrieve_home(index(), query, 2)[0]
    assert len(match.layout_ids) == 2
    layouts = [index().layout(name) for name in match.layout_ids]
    figure = draw_match(query, layouts, match, tmp_path / "home.svg")
    assert len(figure.axes) == 3
    assert all(name in (tmp_path / "home.svg").read_text() for name in match.layout_ids)
    with pytest.raises(ValueError, match="more rooms"):
        draw_match(query, layouts[:1], match)
