"""Pulling chairs out from where a table, or anything, blocks them."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from scene_graphs.affordances.affordances import spots
from scene_graphs.affordances.room_validation import RoomCheck, validate
from scene_graphs.affordances.usable_furniture import BACK, can_be_pulled, pulled, pulled_out
from scene_graphs.layout import Layout, Opening, Placed

DOOR = Opening(((-0.45, -2.5), (0.45, -2.5)))
EMPTY = Layout("room", "dining_room", ((-2.5, -2.5), (-2.5, 2.5), (2.5, 2.5), (2.5, -2.5)), doors=(DOOR,))
TABLE = Placed("table", "dining_table", (0.0, 0.0, 0.0), (1.6, 0.76, 0.9))
CHAIR = Placed("chair", "dining_chair", (0.0, 0.0, 0.5), (0.47, 0.87, 0.54), pi)
"""Pushed under the table, with free floor behind it."""
WALLED = replace(EMPTY, floor_polygon=((-2.5, -2.5), (-2.5, 0.8), (2.5, 0.8), (2.5, -2.5)))
"""The wall is right behind the chair."""


def room(*objects: Placed, empty: Layout = EMPTY) -> Layout:
    return replace(empty, objects=objects)


def test_a_chair_pushed_under_a_table_comes_straight_back_by_the_least_distance() -> None:
    layout = room(TABLE, CHAIR)
    pull = pulled_out(layout, "chair")
    assert pull is not None
    assert pull.end_yaw == pull.start_yaw == CHAIR.yaw
    assert pull.end[0] == pytest.approx(0.0, abs=1e-9)
    assert pull.end[2] - CHAIR.position[2] == pytest.approx(pull.distance)
    for distance in BACK[pull.distance - 1e-6 > BACK]:
        nearer = replace(CHAIR, position=(0.0, 0.0, 0.5 + float(distance)))
        assert not any(map(RoomCheck(room(TABLE, nearer)).is_usable, spots(nearer, "sit")))


def test_a_chair_with_the_wall_behind_it_is_taken_out_aside() -> None:
    pull = pulled_out(room(TABLE, CHAIR, empty=WALLED), "chair")
    assert pull is not None
    assert abs(pull.end[0]) > 0.5
    assert validate(pulled(room(TABLE, CHAIR, empty=WALLED), pull)) == []


def test_what_can_be_sat_on_stays_where_it_is() -> None:
    assert pulled_out(room(TABLE, replace(CHAIR, position=(0.0, 0.0, 1.5))), "chair") is None


@for_each("category", ["armchair", "bench", "multi_seat_sofa", "double_bed", "dining_table"])
def test_heavy_furniture_is_not_pulled_out(category: str) -> None:
    blocked = replace(CHAIR, category=category, size=(1.0, 0.8, 0.8), position=(0.0, 0.0, 0.9))
    assert not can_be_pulled(blocked)
    assert pulled_out(room(TABLE, blocked), "chair") is None


@pytest.mark.sweep
def test_a_chair_in_a_room_full_of_things_stays() -> None:
    around = [
        Placed(f"{x}/{z}", "cabinet", (x, 0.0, z), (0.95, 1.8, 0.95)) for x in (-2, -1, 0, 1, 2) for z in (1.5, -1)
    ]
    assert pulled_out(room(TABLE, CHAIR, *around), "chair") is None


def test_a_door_is_not_blocked_by_a_chair_pulled_out() -> None:
    table = replace(TABLE, position=(0.0, 0.0, -0.5))
    chair = replace(CHAIR, position=(0.0, 0.0, -1.1), yaw=0.0)
    layout = room(table, chair)
    pull = pulled_out(layout, "chair")
    assert pull is not None
    assert not RoomCheck(pulled(layout, pull)).blocked_doors()


def test_what_lies_on_a_chair_comes_with_it() -> None:
    book = Placed("book", "book", (0.1, 0.45, 0.55), (0.2, 0.03, 0.15), 0.3, "chair")
    layout = room(TABLE, CHAIR, book)
    pull = pulled_out(layout, "chair")
    assert pull is not None
    after = pulled(layout, pull)
    before = CHAIR.to_local(book.position)
    assert after.object("chair").to_local(after.object("book").position) == pytest.approx(before)
    assert after.object("table") == TABLE


def test_an_unknown_object_is_refused_by_name() -> None:
    with pytest.raises(KeyError, match="no object 'sofa'"):
        pulled_out(room(TABLE, CHAIR), "sofa")


def test_a_pull_beside_another_chair_makes_the_seat_usable_and_nothing_worse() -> None:
    check_pull([(0.5, 0.6, pi)], -0.2)


@pytest.mark.sweep
@tries(5, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(st.tuples(st.floats(-2.2, 2.2), st.floats(-2.2, 2.2), st.floats(-pi, pi)), min_size=1, max_size=2),
    st.floats(-0.4, 0.4),
)
def test_a_pull_makes_the_seat_usable_and_nothing_worse(chairs: list[tuple[float, float, float]], shift: float) -> None:
    check_pull(chairs, shift, maybe=True)


def check_pull(chairs: list[tuple[float, float, float]], shift: float, maybe: bool = False) -> None:
    """Whether a chair that is blocked, by others too, is pulled out as it should; maybe it is not pulled out at all."""
    others = [replace(CHAIR, id=f"c{i}", position=(x, 0.0, z), yaw=yaw) for i, (x, z, yaw) in enumerate(chairs)]
    layout = room(TABLE, replace(CHAIR, position=(shift, 0.0, 0.5)), *others)
    pull = pulled_out(layout, "chair")
    if pull is None:
        assert maybe
        return
    before, after = RoomCheck(layout), RoomCheck(pulled(layout, pull))
    assert any(map(after.is_usable, spots(after.layout.object("chair"), "sit")))
    assert set(after.unreachable()) < set(before.unreachable())
    assert set(after.problems()) <= set(before.problems())
    assert np.hypot(pull.end[0] - shift, pull.end[2] - 0.5) == pytest.approx(pull.distance)
    assert pulled_out(layout, "chair") == pull
