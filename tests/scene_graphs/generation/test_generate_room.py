"""Procedural rooms and the shipped library."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import shapely
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.affordances.room_validation import RoomCheck, validate
from scene_graphs.furniture import ROOM_TYPES, affordances, categories_of, class_of
from scene_graphs.generation.generate_room import CHUNK, generate_library, generate_room, generate_rooms, luck_of
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict, write_layouts
from scene_graphs.layout_library import COUNT, SEED, built_in_layouts
from scene_graphs.navigation.path_planner import Walkable

WORDS = (
    "sofa", "bed", "armchair", "chair", "cabinet", "table", "shelf", "lamp", "closet", "desk", "stool", "loveseat",
    "bookshelf", "dressing table", "coffee table", "tv stand", "dining table", "nightstand", "wardrobe",
)  # fmt: skip
KITCHEN = {*("kitchen_counter", "kitchen_cabinet", "kitchen_sink", "stove", "refrigerator", "dishwasher", "microwave")}


@tries(40)
@given(st.sampled_from(ROOM_TYPES), st.integers(0, 1_000_000))
def test_a_generated_room_has_no_problems(room_type: str, seed: int) -> None:
    layout = generate_room(room_type, seed)
    assert validate(layout) == []
    assert layout.room_type == layout.tags[0] == room_type
    assert layout_from_dict(layout_to_dict(layout)) == layout


@pytest.mark.parametrize("step", [23, pytest.param(1, marks=pytest.mark.sweep)])
def test_no_shipped_room_has_a_problem(step: int) -> None:
    found = {layout.id: problems for layout in built_in_layouts()[::step] if (problems := validate(layout))}
    assert found == {}


def test_the_same_seed_gives_the_same_room_and_another_seed_another() -> None:
    assert generate_room("study", 5) == generate_room("study", 5)
    assert generate_room("study", 5) != generate_room("study", 6)
    assert generate_library(5, 7)[:3] == generate_library(3, 7)


@for_each("index", [*range(0, 400, 21), 3, 13, 39, 46, 101, 124, 201, 302, 399])
def test_the_shipped_rooms_are_the_ones_the_generator_makes(index: int) -> None:
    kind = ROOM_TYPES[index % len(ROOM_TYPES)]
    assert built_in_layouts()[index] == generate_room(kind, SEED + index // len(ROOM_TYPES))


def test_the_shipped_file_is_written_the_same_again(tmp_path: object) -> None:
    from pathlib import Path

    first, second = Path(str(tmp_path)) / "a.jsonl.gz", Path(str(tmp_path)) / "b.jsonl.gz"
    write_layouts(first, built_in_layouts())
    write_layouts(second, built_in_layouts())
    assert first.read_bytes() == second.read_bytes()


def test_a_hundred_rooms_of_every_type_are_shipped_under_names_of_their_own() -> None:
    layouts = built_in_layouts()
    assert len(layouts) == COUNT == 400
    assert Counter(layout.room_type for layout in layouts) == dict.fromkeys(ROOM_TYPES, 100)
    assert len({layout.id for layout in layouts}) == COUNT


def test_every_common_word_of_scripts_is_met_in_the_library() -> None:
    there = {placed.category for layout in built_in_layouts() for placed in layout.objects}
    missing = [word for word in WORDS if not categories_of(word) & there]
    assert not missing


def of_type(room_type: str) -> list[Layout]:
    return [layout for layout in built_in_layouts() if layout.room_type == room_type]


def number(layout: Layout) -> int:
    return int(layout.id.rsplit("-", 1)[1])


def test_bedrooms_hold_something_to_sleep_on() -> None:
    for layout in of_type("bedroom"):
        assert any(class_of(placed.category) == "bed" for placed in layout.objects), layout.id


def test_dining_rooms_seat_four_and_studies_have_a_desk_with_a_seat_or_books_with_one() -> None:
    for layout in of_type("dining_room"):
        seats = Counter(placed.category for placed in layout.objects)
        assert seats["dining_chair"] + 2 * seats["bench"] >= 4, layout.id
    for layout in of_type("study"):
        there = {placed.category for placed in layout.objects}
        assert there & {"desk", "bookshelf"}, layout.id
        assert any("sit" in affordances(category) for category in there), layout.id


def test_half_of_the_dining_rooms_hold_a_kitchen_at_which_a_body_can_cook_and_wash_up() -> None:
    kitchens = [room for room in of_type("dining_room") if any(placed.category == "stove" for placed in room.objects)]
    assert len(kitchens) == 50
    for layout in kitchens:
        there = Counter(placed.category for placed in layout.objects)
        once = {name: there[name] for name in ("stove", "refrigerator", "kitchen_cabinet", "kitchen_sink")}
        assert once == dict.fromkeys(once, 1), layout.id
        assert there["kitchen_counter"] == 2, layout.id
    for layout in kitchens[::7]:
        check = RoomCheck(layout)
        for placed in layout.objects:
            if placed.category in KITCHEN:
                touched = next(check.usable(placed, "touch"), None)
                assert touched is not None, (layout.id, placed.id)
                assert 0.85 < touched.point[1] < 1.1, (layout.id, placed.id)


def test_half_of_the_living_rooms_hold_a_lounge_and_a_table_to_dine_at() -> None:
    combined = [
        layout for layout in of_type("living_room") if luck_of("living_room", number(layout)).kind != "living_room"
    ]
    assert len(combined) == 50
    for layout in combined:
        seats = Counter(placed.category for placed in layout.objects)
        assert seats["dining_table"] == 1, layout.id
        assert seats["dining_chair"] + 2 * seats["bench"] >= 2, layout.id
        assert seats["coffee_table"] or any(class_of(category) == "sofa" for category in seats), layout.id
    assert np.mean(["dining_room" in layout.tags for layout in combined]) > 0.9


def test_a_room_that_is_tagged_for_dining_has_a_table_with_four_chairs() -> None:
    for layout in built_in_layouts():
        seats = Counter(placed.category for placed in layout.objects)
        dines = layout.room_type == "dining_room" or (seats["dining_table"] > 0 and seats["dining_chair"] >= 4)
        assert ("dining_room" in layout.tags) == dines, layout.id


def test_some_rooms_of_every_type_are_l_shaped_and_all_corners_are_square() -> None:
    for room_type in ROOM_TYPES:
        assert {len(layout.floor_polygon) for layout in of_type(room_type)} == {4, 6}
    for layout in built_in_layouts():
        steps = np.diff([*layout.floor_polygon, layout.floor_polygon[0]], axis=0)
        assert (np.count_nonzero(steps, axis=1) == 1).all(), layout.id
        assert np.abs(steps).sum(axis=1).min() >= 0.8, layout.id


def test_an_l_shaped_room_joins_others_and_can_be_walked_through() -> None:
    bent = [next(room for room in of_type(kind) if len(room.floor_polygon) == 6) for kind in ("living_room", "bedroom")]
    home = home_from_layouts(bent, seed=3)
    walkable, rng = Walkable(home), np.random.default_rng(0)
    for _ in range(5):
        start, goal = walkable.random_point(rng, 0), walkable.random_point(rng, 1)
        assert len(walkable.path(start, goal)) > 2


def test_most_sofas_are_long_enough_to_lie_on() -> None:
    checks = [RoomCheck(layout) for layout in of_type("living_room")[:20]]
    lyable = [
        any(next(check.usable(placed, "lie"), None) for placed in check.layout.objects if "sofa" in placed.category)
        for check in checks
    ]
    assert np.mean(lyable) > 0.7


def test_pictures_hang_on_a_wall_and_lamps_under_the_ceiling() -> None:
    for layout in built_in_layouts()[::7]:
        outline = shapely.Polygon(layout.floor_polygon).exterior
        for placed in layout.objects:
            if placed.category == "picture":
                assert outline.distance(shapely.Point(placed.position[0], placed.position[2])) < 0.05
            if placed.category in ("ceiling_lamp", "pendant_lamp"):
                assert placed.top == pytest.approx(layout.height, abs=0.01)


def test_another_room_type_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(ValueError, match="bedroom, living_room, dining_room, study"):
        generate_room("cellar", 1)


@pytest.mark.service
def test_several_processes_make_the_same_rooms_in_the_same_order() -> None:
    assert list(generate_rooms(2 * CHUNK + 1, 3, processes=2)) == generate_library(2 * CHUNK + 1, 3)
