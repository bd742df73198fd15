"""Which furniture of a room can be used, and why not the rest."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import pi

from scene_graphs.affordances.usable_furniture import count_uses, uses
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.layout_library import built_in_layouts

DOOR = Opening(((-0.45, -2.5), (0.45, -2.5)))
EMPTY = Layout("room", "dining_room", ((-2.5, -2.5), (-2.5, 2.5), (2.5, 2.5), (2.5, -2.5)), doors=(DOOR,))
TABLE = Placed("table", "dining_table", (0.0, 0.0, 0.0), (1.6, 0.76, 0.9))
UNDER = Placed("under", "dining_chair", (0.0, 0.0, 0.5), (0.47, 0.87, 0.54), pi)
FREE = replace(UNDER, id="free", position=(-1.5, 0.0, 1.5))
TALL = Placed("tall", "barstool", (1.5, 0.0, 1.5), (0.4, 0.9, 0.4))
SOFA = Placed("sofa", "multi_seat_sofa", (0.0, 0.0, 2.0), (2.2, 0.85, 0.95))
"""It faces the wall."""
LAMP = Placed("lamp", "floor_lamp", (2.0, 0.0, -2.0), (0.4, 1.6, 0.4))


def test_every_seat_is_told_with_what_can_be_done_with_it_or_why_not() -> None:
    told = {(use.object_id, use.affordance): use for use in uses(replace(EMPTY, objects=(TABLE, UNDER, FREE, TALL)))}
    assert {name: use.verdict for (name, _), use in told.items()} == {
        "under": "pulled out",
        "free": "as placed",
        "tall": "no surface",
    }


def test_what_is_in_the_way_is_named() -> None:
    told = {use.affordance: use for use in uses(replace(EMPTY, objects=(SOFA,)))}
    assert {(use.verdict, use.hindrance) for use in told.values()} == {("no room", "wall")}
    before = replace(
        EMPTY, objects=(replace(SOFA, yaw=pi), replace(TABLE, position=(0.0, 0.0, 1.05), size=(3, 0.7, 0.9)))
    )
    assert {(use.verdict, use.hindrance) for use in uses(before)} == {("no room", "surface")}
    shut_in = [Placed(f"wall{x}", "cabinet", (x, 0.0, 0.3), (1.0, 1.8, 0.4)) for x in (-2, -1, 0, 1, 2)]
    closed = replace(EMPTY, objects=(replace(SOFA, yaw=pi), *shut_in))
    assert {(use.verdict, use.hindrance) for use in uses(closed)} == {("no way", "")}


def test_seats_and_beds_of_our_rooms_are_used_as_placed() -> None:
    counts = count_uses(built_in_layouts()[::20])
    assert sum(counts.values(), Counter()).keys() == {"as placed"}
    assert {"sit", "lie"} == {affordance for _, affordance in counts}


def test_things_that_are_neither_sat_nor_lain_on_are_not_told() -> None:
    assert list(uses(replace(EMPTY, objects=(TABLE, LAMP)))) == []
