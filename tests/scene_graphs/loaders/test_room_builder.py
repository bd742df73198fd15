"""Rooms are filled piece by piece, and no piece, floor or thing on a plan spoils the others or takes for ever."""

from __future__ import annotations

import time

import numpy as np
import pytest
import shapely
from for_each import for_each

from scene_graphs.boxes import Part
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import MAX_OBJECTS
from scene_graphs.loaders.floor_polygon import MAX_CORNERED, floor_from_triangles, united
from scene_graphs.loaders.plan_boxes import rectangle_around
from scene_graphs.loaders.room_builder import Intake, RoomIntake
from scene_graphs.loaders.scene_source import Options

FLOOR = [(-3.0, -3.0), (-3.0, 3.0), (3.0, 3.0), (3.0, -3.0)]
HUGE = Part("seat", (-9.0, 0.0, -9.0), (9.0, 0.5, 9.0))


def room_of(intake: Intake) -> RoomIntake:
    return intake.room("a", "bedroom", FLOOR, source="user")


def test_an_object_that_is_not_valid_loses_itself_and_what_stands_on_it() -> None:
    intake = Intake()
    room = room_of(intake)
    room.add("bed", "double_bed", (0, 0, 0), (1.6, 0.6, 2))
    room.add("odd", "desk", (2, 0, 2), (1, 0.7, 0.5), shape=(HUGE,))
    room.add("lamp", "table_lamp", (2, 0.7, 2), (0.2, 0.4, 0.2), parent="odd")
    layout = room.finish()
    assert layout is not None
    assert [placed.id for placed in layout.objects] == ["bed"]
    assert intake.report.rooms == 1
    assert "odd" in intake.report.examples["it is no valid object"][0]
    assert intake.report.examples["what it stands on was dropped"] == ["lamp"]


@for_each("size", [(0, 1, 1), (-1, 1, 1), (float("nan"), 1, 1), (1e400, 1, 1), (10**400, 1, 1), (31, 1, 1)])
def test_sizes_that_are_none_are_dropped_with_the_reason(size: tuple[float, ...]) -> None:
    intake = Intake()
    room = room_of(intake)
    assert room.add("bed", "double_bed", (0, 0, 0), size) is None
    assert intake.report.dropped.total() == 1
    assert "size" in next(iter(intake.report.dropped)) or "larger" in next(iter(intake.report.dropped))
    assert room.finish() is None


@pytest.mark.sweep
def test_of_very_many_objects_a_bounded_number_is_looked_at_and_all_are_counted() -> None:
    intake = Intake()
    room = room_of(intake)
    for number in range(100_000):
        room.add(f"{number}", "cup", (number % 59 / 10 - 2.9, 0, number // 59 % 59 / 10 - 2.9), (0.01, 0.01, 0.01))
    assert len(room.objects) == 2 * MAX_OBJECTS
    room.finish()
    assert intake.report.kept.total() + intake.report.dropped.total() >= 100_000 - MAX_OBJECTS


def test_a_file_of_more_rooms_than_may_be_is_refused() -> None:
    intake = Intake(Options(most_rooms=3))
    intake.count_rooms(3, "houses.jsonl")
    with pytest.raises(LayoutError, match=r"houses\.jsonl holds more than 3 rooms.*scan"):
        intake.count_rooms(1, "houses.jsonl")


def test_a_round_thing_of_any_size_has_its_rectangle() -> None:
    turn = np.linspace(0, 2 * np.pi, 5_000, endpoint=False)
    for radius in (0.4, 30.0, 1e6, 1e12):
        found = rectangle_around(radius * np.stack([np.cos(turn), np.sin(turn)], axis=1))
        assert found.width == pytest.approx(2 * radius, rel=0.05)


def test_floors_are_united_as_another_way_unites_them() -> None:
    rng = np.random.default_rng(0)
    for count in (0, 1, 2, 3, 50):
        corners = rng.uniform(0, 4, (count, 3, 2))
        polygons = np.asarray(shapely.polygons(corners) if count else [], dtype=object)
        assert shapely.symmetric_difference(united(polygons), shapely.union_all(polygons)).area < 1e-9


def test_triangles_that_are_points_take_nothing_from_the_floor() -> None:
    floor = np.array([[[0, 0], [0, 3], [4, 3]], [[0, 0], [4, 3], [4, 0]]], dtype=float)
    points = np.zeros((3, 3, 2))
    found = floor_from_triangles(np.concatenate([points, floor]))
    assert found is not None
    assert shapely.Polygon(found).area == pytest.approx(12, rel=1e-3)
    assert floor_from_triangles(points) is None


def test_a_floor_of_crossing_slivers_is_their_hull_at_once() -> None:
    at = np.linspace(0, 10, MAX_CORNERED * 2)
    zero, ten = np.zeros_like(at), np.full_like(at, 10.0)
    across = np.stack([np.stack([zero, at], 1), np.stack([ten, at], 1), np.stack([ten, at + 1e-4], 1)], axis=1)
    start = time.process_time()
    floor = floor_from_triangles(np.concatenate([across, across[..., ::-1]]))
    assert time.process_time() - start < 20
    assert floor is not None
    assert shapely.Polygon(floor).area == pytest.approx(100, rel=0.01)


def test_what_is_left_out_of_a_room_is_counted_with_its_reason_and_all_else_is_kept() -> None:
    intake = Intake()
    room = room_of(intake)
    room.add("bed", "double_bed", (0, 0, 0), (1.6, 0.6, 2))
    room.door(((-3.0, -1.0), (-3.0, 0.0)), 0.0, 2.0)
    room.door(((0.0, 0.0), (1.0, 0.0)), 0.0, 2.0)
    room.window(((-1.0, 3.0), (1.0, 3.0)), 1.0, 2.0)
    room.window(((-1.0, 3.0), (1.0, 3.0)), 2.0, 1.0)
    layout = room.finish()
    assert layout is not None
    assert len(layout.doors) == len(layout.windows) == 1
    assert intake.report.dropped["a door that is not in a wall of the room"] == 1
    assert intake.report.dropped["a window that is not in a wall of the room"] == 1
    assert (layout.windows[0].bottom, layout.windows[0].top) == (1.0, 2.0)
