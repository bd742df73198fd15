"""Rooms joined to a home stand apart, meet in doorways, and keep their furniture."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.doorways import TIGHT, WALL_GAP
from scene_graphs.home import Home, HomeError, home_from_dict, home_from_layouts, home_to_dict, random_home
from scene_graphs.layout import Layout, LayoutError, Opening, Placed, read_layouts
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.navigation.clearance import obstacles
from scene_graphs.navigation.path_planner import Walkable

ROOMS = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "layouts" / "rooms"


def room(name: str, width: float, depth: float, room_type: str = "bedroom", door: bool = True) -> Layout:
    """A rectangle with a bed in one corner, a wardrobe on the other side and a door in the front wall."""
    outline = ((0.0, 0.0), (0.0, depth), (width, depth), (width, 0.0))
    bed = Placed("bed", "double_bed", (0.9, 0.0, 1.1), (1.6, 0.9, 2.1))
    wardrobe = Placed("wardrobe", "wardrobe", (width - 0.8, 0.0, 0.35), (1.4, 2.0, 0.6))
    lamp = Placed("lamp", "table_lamp", (width - 0.8, 2.0, 0.35), (0.3, 0.4, 0.3), parent="wardrobe")
    doors = (Opening(((width / 2 - 0.45, depth), (width / 2 + 0.45, depth))),) if door else ()
    window = Opening(((width, 0.3 * depth - 0.5), (width, 0.3 * depth + 0.5)), 0.9, 2.0)
    return Layout(name, room_type, outline, 2.7, doors, (window,), (bed, wardrobe, lamp), (room_type,))


def with_a_corner_cut(layout: Layout, slant: float) -> Layout:
    """The same room as an L, whose inner wall may run aslant."""
    (_, (_, depth), (width, _), _) = layout.floor_polygon
    inner = ((0.75 * width, depth), (0.75 * width - slant, 0.6 * depth), (width, 0.6 * depth))
    return replace(layout, floor_polygon=((0.0, 0.0), (0.0, depth), *inner, (width, 0.0)))


SIZES = st.tuples(st.floats(3.4, 7.0), st.floats(3.6, 7.0), st.booleans(), st.sampled_from((None, 0.0, 0.3)))


@st.composite
def homes(draw: st.DrawFn) -> Home:
    layouts = []
    for index, (width, depth, door, slant) in enumerate(draw(st.lists(SIZES, min_size=1, max_size=4))):
        layout = room(f"r{index}", round(width, 2), round(depth, 2), door=door)
        layouts.append(layout if slant is None else with_a_corner_cut(layout, slant))
    return home_from_layouts(layouts, draw(st.integers(0, 99)))


def outlines(home: Home) -> list[shapely.Polygon]:
    return [shapely.Polygon(home.room_polygon(i)) for i in range(len(home.rooms))]


@given(homes())
@tries(10, least=2)
def test_rooms_keep_the_thickness_of_a_wall_apart(home: Home) -> None:
    for first, second in combinations(outlines(home), 2):
        assert first.distance(second) > 0.8 * WALL_GAP


@given(homes())
@tries(10, least=2)
def test_all_rooms_can_be_walked_to_from_each_other(home: Home) -> None:
    walkable = Walkable(home)
    inside = [walkable.random_point(np.random.default_rng(0), index) for index in range(len(home.rooms))]
    assert all(walkable.reachable(inside[0], point) for point in inside)
    assert len(home.doorways) == len(home.rooms) - 1


@given(homes())
@tries(10, least=2)
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
@tries(10, least=2)
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
@tries(10, least=2)
def test_openings_lie_on_their_wall_and_lead_outside_or_through_a_doorway(home: Home) -> None:
    for wall in home.walls:
        line = shapely.LineString(wall.segment)
        for opening in wall.openings:
            assert line.distance(shapely.LineString(opening.segment)) < 1e-6


@given(homes())
@tries(10, least=2)
def test_furniture_moves_with_its_room(home: Home) -> None:
    for placed in home.objects:
        index, name = placed.id.split("/")
        original = home.rooms[int(index)].layout.object(name)
        assert home.object(placed.id) == placed
        assert home.room_at((placed.position[0], placed.position[2])) == int(index)
        assert np.allclose(home.rooms[int(index)].pose.to_home(original.footprint), placed.footprint)
        assert placed.parent is None or placed.parent == f"{index}/wardrobe"


@given(homes())
@tries(10, least=2)
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


def test_a_room_whose_floor_cannot_be_walked_to_is_refused() -> None:
    """A slot just as wide as a body: wide enough on the cells of the room alone, not on those of the home."""
    shelves = [((3.0, 0.90225), (0.3, 1.8045)), ((3.0, 3.12275), (0.3, 1.7545))]
    lining = [((5.5, 0.15), (4.6, 0.3)), ((5.5, 3.85), (4.6, 0.3)), ((7.85, 2.0), (0.3, 3.2))]
    lining += [((1.5, 3.85), (2.6, 0.3)), ((0.15, 2.0), (0.3, 3.2))]
    pieces = [
        Placed(f"w{i}", "wardrobe", (x, 0.0, z), (width, 2.0, depth))
        for i, ((x, z), (width, depth)) in enumerate([*shelves, *lining])
    ]
    cut = Layout("cut", "study", ((0.0, 0.0), (0.0, 4.0), (8.0, 4.0), (8.0, 0.0)), objects=tuple(pieces))
    with pytest.raises(HomeError, match="cannot be walked to"):
        home_from_layouts([cut, room("a", 4.0, 4.0)], 0)


def test_a_room_that_fits_nowhere_beside_the_others_is_named() -> None:
    def niche(name: str) -> Layout:
        """Walls with furniture all along but at the bottom of a slot that no other room gets its door into."""
        corners = ((0.0, 0.0), (0.0, 6.0), (2.4, 6.0), (2.4, 3.0), (3.6, 3.0), (3.6, 6.0), (6.0, 6.0), (6.0, 0.0))
        walls = [((1.2, 5.8), 2.2, 0.0), ((4.8, 5.8), 2.2, 0.0), ((3.0, 0.2), 5.8, 0.0)]
        walls += [((0.2, 3.0), 5.0, np.pi / 2), ((5.8, 3.0), 5.0, np.pi / 2)]
        walls += [((2.2, 4.6), 2.6, np.pi / 2), ((3.8, 4.6), 2.6, np.pi / 2)]
        shelves = [
            Placed(f"w{i}", "wardrobe", (x, 0.0, z), (length, 2.0, 0.3), yaw)
            for i, ((x, z), length, yaw) in enumerate(walls)
        ]
        return Layout(name, "study", corners, objects=tuple(shelves))

    with pytest.raises(HomeError, match="room 'second' fits nowhere beside 'first'"):
        home_from_layouts([niche("first"), niche("second")], 0)


TYPES = ("bedroom", "living_room", "dining_room", "study")


@given(st.lists(st.sampled_from(TYPES), min_size=1, max_size=4), st.integers(0, 10_000))
@tries(6)
def test_a_random_home_has_a_room_of_each_asked_type(room_types: list[str], seed: int) -> None:
    home = random_home(built_in_layouts(), room_types, seed)
    for one, room_type in zip(home.rooms, room_types, strict=True):
        assert room_type in one.layout.tags
    assert len({one.layout.id for one in home.rooms}) == len(room_types)
    assert random_home(built_in_layouts(), room_types, seed) == home


def test_seeds_make_different_homes() -> None:
    drawn = {random_home(built_in_layouts(), TYPES[:1], seed).rooms[0].layout.id for seed in range(6)}
    assert len(drawn) > 2


def test_a_type_there_is_no_room_of_is_named() -> None:
    with pytest.raises(HomeError, match="no room of type 'bedroom' left"):
        random_home([room("only", 4.0, 4.0)], ["bedroom", "bedroom"], 0)
    with pytest.raises(HomeError, match="1 to 4 rooms, got 0"):
        random_home(built_in_layouts(), [], 0)


@pytest.mark.skipif(not ROOMS.is_dir(), reason="SIMS_TEST_DATA holds no layouts/rooms")
@pytest.mark.parametrize(
    "source", ["tdw", *(pytest.param(name, marks=pytest.mark.sweep) for name in ("procthor", "virtualhome"))]
)
def test_other_peoples_rooms_make_homes_one_can_walk_through(source: str) -> None:
    layouts = read_layouts(ROOMS / f"{source}_rooms.jsonl.gz")
    for seed in range(2):
        room_types = [
            str(name) for name in np.random.default_rng(seed).choice(["bedroom", "living_room", "kitchen"], 4)
        ]
        home = random_home(layouts, room_types, seed)
        walkable = Walkable(home)
        inside = [walkable.random_point(np.random.default_rng(seed), index) for index in range(4)]
        for first, second in combinations(range(4), 2):
            assert outlines(home)[first].distance(outlines(home)[second]) > 0.8 * WALL_GAP
            assert len(walkable.path(inside[first], inside[second])) > 1


def test_a_home_has_one_to_four_rooms() -> None:
    with pytest.raises(HomeError, match="1 to 4 rooms, got 0"):
        home_from_layouts([], 0)


@for_each(
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
