"""Drawing chairs up to the tables they belong to."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.affordances.affordances import spots
from scene_graphs.affordances.chairs_at_tables import BELONGS, FROM_TABLE, drawn_up
from scene_graphs.affordances.room_validation import RoomCheck, validate
from scene_graphs.affordances.usable_furniture import pulled
from scene_graphs.layout import Layout, Opening, Placed

DOOR = Opening(((-0.45, -2.5), (0.45, -2.5)))
EMPTY = Layout("room", "dining_room", ((-2.5, -2.5), (-2.5, 2.5), (2.5, 2.5), (2.5, -2.5)), doors=(DOOR,))
TABLE = Placed("table", "dining_table", (0.0, 0.0, 0.6), (1.6, 0.76, 0.9))
CHAIR = Placed("chair", "dining_chair", (0.0, 0.0, -1.0), (0.47, 0.87, 0.54), 0.0)
"""Faces the table, a long step away from it."""


def room(*objects: Placed) -> Layout:
    return replace(EMPTY, objects=objects)


def gap(chair: Placed, table: Placed = TABLE) -> float:
    """How far before the front of a seat, straight ahead, the edge of the table is: by marching there."""
    x, _, z = chair.position
    for step in np.arange(0.0, 3.0, 0.005):
        ahead = chair.size[2] / 2 + step
        local = table.to_local((x + ahead * sin(chair.yaw), 0.0, z + ahead * cos(chair.yaw)))
        if (np.abs(local[[0, 2]]) <= np.array([table.size[0], table.size[2]]) / 2).all():
            return float(step)
    return np.inf


@given(
    away=st.floats(1.3, 1.9), aside=st.floats(-0.6, 0.6), turned=st.floats(-pi, pi), of_table=st.sampled_from([0.0, pi])
)
@tries(12)
def test_a_chair_comes_square_before_the_table_within_reach_and_can_be_sat_on(
    away: float, aside: float, turned: float, of_table: float
) -> None:
    layout = room(replace(TABLE, yaw=of_table), replace(CHAIR, position=(aside, 0.0, 0.6 - away), yaw=turned))
    move = drawn_up(layout, "chair")
    assert move is not None
    after = pulled(layout, move)
    chair = after.object("chair")
    assert min(FROM_TABLE) - 0.01 <= gap(chair) <= max(FROM_TABLE) + 0.01
    assert any(map(RoomCheck(after).is_usable, spots(chair, "sit")))
    assert set(validate(after)) <= set(validate(layout))
    assert drawn_up(after, "chair") is None, "it stands there then"


@for_each("category", ["armchair", "multi_seat_sofa", "double_bed"])
def test_heavy_seats_stay_where_they_are(category: str) -> None:
    assert drawn_up(room(TABLE, replace(CHAIR, category=category)), "chair") is None


@pytest.mark.parametrize(
    "table",
    [
        replace(TABLE, position=(0.0, 0.0, 0.45 - 1.0 + BELONGS + 0.02)), replace(TABLE, size=(1.6, 0.42, 0.9)),
        replace(TABLE, category="cabinet"), replace(TABLE, position=(0.0, 0.6, 0.6)),
    ],
    ids=["too far", "too low", "no table", "on a wall"],
)  # fmt: skip
def test_a_chair_without_a_table_to_sit_at_stays(table: Placed) -> None:
    assert drawn_up(room(table, CHAIR), "chair") is None


def test_a_chair_goes_to_its_own_side_of_the_table_and_not_before_a_door() -> None:
    behind = replace(CHAIR, position=(0.0, 0.0, 2.15), yaw=pi)
    move = drawn_up(room(replace(TABLE, position=(0.0, 0.0, 0.2)), behind), "chair")
    assert move is not None
    assert move.end[2] > 0.2
    near_door = room(replace(TABLE, position=(0.0, 0.0, -1.2)), replace(CHAIR, position=(0.0, 0.0, 0.3), yaw=pi))
    move = drawn_up(near_door, "chair")
    assert move is not None
    assert not RoomCheck(pulled(near_door, move)).blocked_doors()


def test_a_table_with_no_room_before_it_leaves_the_chair_where_it_is() -> None:
    places = [(0.9 * x, 0.6 + 1.05 * z) for x in (-2, -1, 0, 1, 2) for z in (-1, 1)] + [(-1.35, 0.6), (1.35, 0.6)]
    around = [Placed(f"box{number}", "cabinet", (x, 0.0, z), (0.9, 1.2, 1.0)) for number, (x, z) in enumerate(places)]
    layout = room(TABLE, replace(CHAIR, position=(0.0, 0.0, -1.2)), *around)
    assert drawn_up(layout, "chair") is None
