"""Procedural rooms and the shipped library."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import shapely

from scene_graphs.checking import RoomCheck, validate
from scene_graphs.furniture import ROOM_TYPES, categories_of
from scene_graphs.generating import generate_library, generate_room
from scene_graphs.layouts import Layout, write_layouts
from scene_graphs.library import COUNT, SEED, built_in_layouts

WORDS = (
    "sofa", "bed", "armchair", "chair", "cabinet", "table", "shelf", "lamp", "closet", "desk", "stool", "loveseat",
    "bookshelf", "dressing table", "coffee table", "tv stand", "dining table", "nightstand", "wardrobe",
)  # fmt: skip


@pytest.mark.parametrize("room_type", ROOM_TYPES)
@pytest.mark.parametrize("seed", [1001, 1002, 1003])
def test_a_generated_room_has_no_problems(room_type: str, seed: int) -> None:
    layout = generate_room(room_type, seed)
    assert validate(layout) == []
    assert layout.room_type == layout.tags[0] == room_type


def test_the_same_seed_gives_the_same_room_and_another_seed_another() -> None:
    assert generate_room("study", 5) == generate_room("study", 5)
    assert generate_room("study", 5) != generate_room("study", 6)
    assert generate_library(5, 7)[:3] == generate_library(3, 7)


@pytest.mark.parametrize("index", [0, 1, 2, 3, 101, 239])
def test_the_shipped_rooms_are_the_ones_the_generator_makes(index: int) -> None:
    kind = ROOM_TYPES[index % len(ROOM_TYPES)]
    assert built_in_layouts()[index] == generate_room(kind, SEED + index // len(ROOM_TYPES))


def test_the_shipped_file_is_written_the_same_again(tmp_path: object) -> None:
    from pathlib import Path

    first, second = Path(str(tmp_path)) / "a.jsonl.gz", Path(str(tmp_path)) / "b.jsonl.gz"
    write_layouts(first, built_in_layouts())
    write_layouts(second, built_in_layouts())
    assert first.read_bytes() == second.read_bytes()


def test_sixty_rooms_of_every_type_are_shipped_under_names_of_their_own() -> None:
    layouts = built_in_layouts()
    assert len(layouts) == COUNT == 240
    assert Counter(layout.room_type for layout in layouts) == dict.fromkeys(ROOM_TYPES, 60)
    assert len({layout.id for layout in layouts}) == COUNT


def test_every_common_word_of_scripts_is_met_in_the_library() -> None:
    there = {placed.category for layout in built_in_layouts() for placed in layout.objects}
    missing = [word for word in WORDS if not categories_of(word) & there]
    assert not missing


def of_type(room_type: str) -> list[Layout]:
    return [layout for layout in built_in_layouts() if layout.room_type == room_type]


def test_bedrooms_hold_a_bed_and_most_a_wardrobe_and_a_nightstand() -> None:
    rooms = [{placed.category for placed in layout.objects} for layout in of_type("bedroom")]
    assert all(categories_of("bed") & room for room in rooms)
    assert np.mean(["wardrobe" in room for room in rooms]) > 0.6
    assert np.mean(["nightstand" in room for room in rooms]) > 0.6


def test_dining_rooms_seat_four_and_studies_have_a_desk_with_a_chair() -> None:
    for layout in of_type("dining_room"):
        assert sum(placed.category == "dining_chair" for placed in layout.objects) >= 4
    for layout in of_type("study"):
        there = {placed.category for placed in layout.objects}
        assert "desk" in there
        assert there & categories_of("chair")


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
