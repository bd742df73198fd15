"""What is wrong with a room, and how far things are from each other."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import shapely
from for_each import for_each

from scene_graphs.affordances.room_validation import RoomCheck, solids_overlap, validate
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.navigation.clearance import edges_of, measure_clearance, obstacles, rectangles_of
from scene_graphs.plots.floor_plan import draw_layout

DOOR = Opening(((-0.45, -2.0), (0.45, -2.0)))
BED = Placed("bed", "double_bed", (0.0, 0.0, 1.0), (1.6, 0.9, 2.0), pi)
EMPTY = Layout("room", "bedroom", ((-2, -2), (-2, 2), (2, 2), (2, -2)), doors=(DOOR,))


def room(*objects: Placed) -> Layout:
    return replace(EMPTY, objects=objects)


def test_a_room_with_a_bed_against_the_wall_is_sound() -> None:
    assert validate(room(BED)) == []
    assert validate(EMPTY) == []


def test_what_stands_outside_the_walls_is_named() -> None:
    assert "bed stands outside the walls" in validate(room(replace(BED, position=(0.0, 0.0, 1.5))))


def test_two_things_in_one_place_are_named() -> None:
    wardrobe = Placed("wardrobe", "wardrobe", (0.5, 0.0, 1.0), (1.0, 2.0, 0.6))
    assert "bed and wardrobe overlap" in validate(room(BED, wardrobe))


def test_a_chair_may_be_pushed_under_a_table_but_not_into_it() -> None:
    table = Placed("t", "dining_table", (0.0, 0.0, 0.0), (1.6, 0.76, 0.9))
    stool = Placed("s", "stool", (0.0, 0.0, 0.3), (0.4, 0.45, 0.4))
    assert not solids_overlap(table, stool)
    assert solids_overlap(table, replace(stool, category="cabinet", size=(0.4, 1.2, 0.4)))


def test_a_blocked_door_is_named() -> None:
    chest = Placed("chest", "chest", (0.0, 0.0, -1.6), (1.0, 0.5, 0.5))
    assert "door 0 is blocked by chest" in validate(room(chest))


def test_what_nobody_can_get_to_is_named() -> None:
    wall = Placed("wall", "cabinet", (0.0, 0.0, -0.6), (3.9, 1.5, 0.3))
    problems = validate(room(BED, wall))
    assert "nobody can get to bed to lie on it" in problems
    assert not any("cabinet" in problem for problem in problems)


def test_usable_spots_are_a_part_of_the_possible_ones() -> None:
    beside_wall = replace(BED, position=(-1.17, 0.0, 0.97))
    check = RoomCheck(room(beside_wall))
    approaches = {round(spot.approach, 2) for spot in check.usable(beside_wall, "lie")}
    assert len(approaches) == 1


def test_what_lies_on_a_seat_is_in_nobodys_way_to_it_but_what_stands_before_it_is() -> None:
    sofa = Placed("sofa", "loveseat_sofa", (0.0, 0.0, 1.0), (1.6, 0.85, 0.9), pi)
    laptop = Placed("laptop", "laptop", (0.0, 0.43, 0.7), (1.4, 0.05, 0.3), 0.0, "sofa")
    box = Placed("box", "box", (0.0, 0.0, 0.2), (1.4, 0.5, 0.5))
    assert ("sofa", "sit") not in RoomCheck(room(sofa, laptop)).unreachable()
    assert ("sofa", "sit") in RoomCheck(room(sofa, box)).unreachable()


def test_a_room_is_entered_by_another_door_where_the_first_is_blocked() -> None:
    shelf = Placed("shelf", "cabinet", (0.0, 0.0, -1.7), (1.6, 1.5, 0.4))
    other = Opening(((2.0, 0.5), (2.0, 1.4)))
    two_doors = replace(room(BED, shelf), doors=(DOOR, other))
    assert ("bed", "lie") in RoomCheck(room(BED, shelf)).unreachable()
    assert ("bed", "lie") not in RoomCheck(two_doors).unreachable()
    assert "door 0 is blocked by shelf" in validate(two_doors)


def test_clearance_is_the_distance_to_the_nearest_thing() -> None:
    floor = shapely.box(0, 0, 4, 4)
    clearance = measure_clearance(floor, rectangles_of([shapely.box(1.9, 1.9, 2.1, 2.1)]), edges_of(floor))
    points = np.array([[1.0, 2.0], [2.0, 2.0], [0.3, 1.5], [9.0, 9.0]])
    assert np.allclose(clearance.at(points), [0.9, 0.0, 0.3, 0.0], atol=0.03)


def test_a_rug_and_a_hanging_lamp_are_in_nobodys_way_but_a_table_is() -> None:
    rug = Placed("rug", "rug", (0, 0, 0), (2.0, 0.012, 1.5))
    lamp = Placed("lamp", "pendant_lamp", (0, 1.85, 0), (0.5, 0.8, 0.5))
    table = Placed("table", "dining_table", (0, 0, 0), (1.6, 0.76, 0.9))
    assert {placed.id for placed, _ in obstacles([rug, lamp, table])} == {"table"}


def test_drawings_of_rooms_and_homes_are_written(tmp_path: Path) -> None:
    layout = built_in_layouts()[0]
    check = RoomCheck(layout)
    found = [spot for placed in layout.objects for spot in list(check.usable(placed, "touch"))[:1]]
    edge = (layout.objects[0].id, layout.objects[1].id)
    figure = draw_layout(layout, tmp_path / "room.png", spots=found, route=[[0, 0], [1, 0], [1, 1]], edges=[edge])
    assert (tmp_path / "room.png").stat().st_size > 10_000
    assert figure.axes[0].yaxis_inverted(), "z must run down the page, or the room is mirrored"
    draw_layout(home_from_layouts(built_in_layouts()[:2], 0), tmp_path / "home.svg")
    assert (tmp_path / "home.svg").read_text().lstrip().startswith("<?xml")


def test_a_drawing_goes_into_axes_that_are_given() -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    first, second = figure.subplots(1, 2)
    assert draw_layout(built_in_layouts()[1], ax=second) is figure
    assert not first.lines
    assert second.get_title().startswith("living-room-0000")


@for_each("index", range(0, 240, 40))
def test_shipped_rooms_have_no_problems(index: int) -> None:
    assert validate(built_in_layouts()[index]) == []
