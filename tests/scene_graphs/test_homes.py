"""Rooms joined to a home stand apart, meet in doorways, and keep their furniture."""

from __future__ import annotations

import json
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from scene_graphs.clearance import measure_clearance, obstacles
from scene_graphs.homes import Home, HomeError, home_from_dict, home_from_layouts, home_to_dict
from scene_graphs.joining import TIGHT, WALL_GAP
from scene_graphs.layouts import Layout, LayoutError, Opening, Placed


def room(name: str, width: float, depth: float, room_type: str = "bedroom", door: bool = True) -> Layout:
    """A rectangle with a bed in one corner, a wardrobe on the other side and a door in the front wall."""
    outline = ((0.0, 0.0), (0.0, depth), (width, depth), (width, 0.0))
    bed = Placed("bed", "double_bed", (0.9, 0.0, 1.1), (1.6, 0.9, 2.1))
    wardrobe = Placed("wardrobe", "wardrobe", (width - 0.8, 0.0, 0.35), (1.4, 2.0, 0.6))
    lamp = Placed("lamp", "table_lamp", (width - 0.8, 2.0, 0.35), (0.3, 0.4, 0.3), parent="wardrobe")
    doors = (Opening(((width / 2 - 0.45, depth), (width / 2 + 0.45, depth))),) if door else ()
    window = Opening(((width, depth / 2 - 0.5), (width, depth / 2 + 0.5)), 0.9, 2.0)
    return Layout(name, room_type, outline, 2.7, doors, (window,), (bed, wardrobe, lamp), (room_type,))


SIZES = st.tuples(st.floats(3.4, 7.0), st.floats(3.6, 7.0), st.booleans())


@st.composite
def homes(draw: st.DrawFn) -> Home:
    sizes = draw(st.lists(SIZES, min_size=1, max_size=4))
    layouts = [room(f"r{i}", round(w, 2), round(d, 2), door=door) for i, (w, d, door) in enumerate(sizes)]
    return home_from_layouts(layouts, draw(st.integers(0, 99)))


def outlines(home: Home) -> list[shapely.Polygon]:
    return [shapely.Polygon(home.room_polygon(i)) for i in range(len(home.rooms))]


@given(homes())
@settings(max_examples=12, deadline=None)
def test_rooms_keep_the_thickness_of_a_wall_apart(home: Home) -> None:
    for first, second in combinations(outlines(home), 2):
        assert first.distance(second) > 0.8 * WALL_GAP


@given(homes())
@settings(max_examples=12, deadline=None)
def test_all_rooms_can_be_walked_to_from_each_other(home: Home) -> None:
    polygons = outlines(home)
    passages = [shapely.LineString(d.segment).buffer(WALL_GAP / 2 + 0.01, cap_style="flat") for d in home.doorways]
    floor = shapely.union_all([*polygons, *passages])
    walls = [floor.boundary]
    regions = measure_clearance(floor, [outline for _, outline in obstacles(home.objects)], walls)
    spots = [regions.region_at(tuple(np.mean(doorway.segment, axis=0))) for doorway in home.doorways]
    assert len(set(spots)) <= 1
    assert 0 not in spots
    assert len(home.doorways) == len(home.rooms) - 1


@given(homes())
@settings(max_examples=12, deadline=None)
def test_furniture_keeps_off_the_way_through_a_doorway(home: Home) -> None:
    solid = [outline for _, outline in obstacles(home.objects)]
    for doorway in home.doorways:
        start, end = np.array(doorway.segment)
        across = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
        middle = (start + end) / 2
        way = shapely.LineString([middle - 0.5 * across, middle + 0.5 * across])
        assert min(way.distance(outline) for outline in solid) >= TIGHT
        assert min(shapely.LineString(doorway.segment).distance(outline) for outline in solid) > 0.05


@given(homes())
@settings(max_examples=12, deadline=None)
def test_every_doorway_is_cut_through_both_walls(home: Home) -> None:
    for doorway in home.doorways:
        middle = shapely.Point(np.mean(doorway.segment, axis=0))
        cut = [
            opening
            for wall in home.walls
            for opening in wall.openings
            if shapely.LineString(opening.segment).centroid.distance(middle) < WALL_GAP
        ]
        assert len(cut) == 2
        assert {opening.top for opening in cut} == {doorway.top}


@given(homes())
@settings(max_examples=12, deadline=None)
def test_openings_lie_on_their_wall_and_lead_outside_or_through_a_doorway(home: Home) -> None:
    for wall in home.walls:
        line = shapely.LineString(wall.segment)
        for opening in wall.openings:
            assert line.distance(shapely.LineString(opening.segment)) < 1e-6


@given(homes())
@settings(max_examples=12, deadline=None)
def test_furniture_moves_with_its_room(home: Home) -> None:
    for placed in home.objects:
        index, name = placed.id.split("/")
        original = home.rooms[int(index)].layout.object(name)
        assert home.object(placed.id) == placed
        assert home.room_at((placed.position[0], placed.position[2])) == int(index)
        assert np.allclose(home.rooms[int(index)].pose.to_home(original.footprint), placed.footprint)
        assert placed.parent is None or placed.parent == f"{index}/wardrobe"


@given(homes())
@settings(max_examples=12, deadline=None)
def test_a_home_survives_its_json_exactly(home: Home) -> None:
    assert home_from_dict(json.loads(json.dumps(home_to_dict(home)))) == home


def test_the_seed_decides_the_home() -> None:
    layouts = [room(f"r{i}", 4.0 + i, 4.0) for i in range(3)]
    assert home_from_layouts(layouts, 1) == home_from_layouts(layouts, 1)
    assert len({home_from_layouts(layouts, seed).rooms[1].offset for seed in range(8)}) > 1


def test_one_room_keeps_its_frame() -> None:
    home = home_from_layouts([room("r", 4.0, 4.0)], 3)
    assert home.rooms[0].offset == (0.0, 0.0, 0.0)
    assert not home.doorways
    assert [placed.position for placed in home.objects] == [placed.position for placed in home.rooms[0].layout.objects]


def test_doors_that_are_there_are_used_first() -> None:
    layouts = [room("a", 4.0, 4.0), room("b", 4.0, 4.0)]
    widths = [np.hypot(*np.diff(home_from_layouts(layouts, seed).doorways[0].segment, axis=0)[0]) for seed in range(6)]
    assert widths == pytest.approx([0.9] * 6)


def test_a_room_that_is_no_rectangle_joins_too() -> None:
    corner = ((0.0, 0.0), (0.0, 6.0), (3.0, 6.0), (3.0, 3.0), (6.0, 3.0), (6.0, 0.0))
    home = home_from_layouts([Layout("l", "study", corner), room("b", 4.0, 4.0)], 0)
    assert len(home.doorways) == 1


def test_a_point_in_a_doorway_belongs_to_a_room_and_one_in_the_wall_to_none() -> None:
    home = home_from_layouts([room("a", 4.0, 4.0), room("b", 4.0, 4.0)], 0)
    start, end = np.array(home.doorways[0].segment)
    assert home.room_at(tuple((start + end) / 2)) in (0, 1)
    assert home.room_at(tuple(start + 1.3 * (end - start))) is None


def test_a_room_without_a_free_wall_says_so() -> None:
    blocks = tuple(
        Placed(f"w{i}", "wardrobe", (x, 0.0, z), (w, 2.0, d))
        for i, (x, z, w, d) in enumerate([(2, 0.3, 4, 0.6), (2, 3.7, 4, 0.6), (0.3, 2, 0.6, 4), (3.7, 2, 0.6, 4)])
    )
    full = Layout("full", "study", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=blocks)
    with pytest.raises(HomeError, match="room 'full' has no stretch of wall"):
        home_from_layouts([room("a", 4.0, 4.0), full], 0)


def test_a_home_has_one_to_four_rooms() -> None:
    with pytest.raises(HomeError, match="1 to 4 rooms, got 0"):
        home_from_layouts([], 0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rooms": []}, "home.rooms must hold"),
        ({"rooms": [{"layout": 3}]}, r"home.rooms\[0\].layout must be an object"),
        ({"walls": [{"segment": [[0, 0]], "height": 2}]}, r"home.walls\[0\].segment must be two"),
        ({"doorways": [{"segment": [[0, 0], [1, "x"]]}]}, r"home.doorways\[0\].segment\[1\]"),
    ],
)
def test_a_bad_home_names_the_field(change: dict[str, object], message: str) -> None:
    row = home_to_dict(home_from_layouts([room("a", 4.0, 4.0)], 0)) | change
    with pytest.raises(LayoutError, match=message):
        home_from_dict(row)


def test_an_unknown_object_names_the_ones_there_are() -> None:
    with pytest.raises(KeyError, match="0/bed"):
        home_from_layouts([room("a", 4.0, 4.0)], 0).object("0/piano")
