"""Where a body can sit, lie and touch."""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.affordances.affordances import Spot, floor_spot, spots
from scene_graphs.furniture import affordances, typical_size
from scene_graphs.layout import Placed, Point3
from scene_graphs.meshes.furniture_mesh import Part, parts

SEATS = ("dining_chair", "office_chair", "dressing_chair", "armchair", "lounge_chair", "lazy_sofa", "stool", "ottoman")
SOFAS = ("multi_seat_sofa", "loveseat_sofa", "l_shaped_sofa", "chaise_longue_sofa")
BEDS = ("double_bed", "single_bed", "kids_bed", "bunk_bed")


def standing(category: str, yaw: float = 0.0, position: Point3 = (0.0, 0.0, 0.0)) -> Placed:
    return Placed("a", category, position, typical_size(category), yaw)


def overlaps(part: Part, low: Point3, high: Point3) -> bool:
    return all(part.low[axis] < high[axis] and low[axis] < part.high[axis] for axis in range(3))


def ahead(spot: Spot, distance: float, yaw: float | None = None) -> tuple[float, float]:
    angle = spot.facing if yaw is None else yaw
    return spot.point[0] + distance * sin(angle), spot.point[2] + distance * cos(angle)


@for_each("category", [*SEATS, *SOFAS, *BEDS])
def test_a_piece_to_sit_on_offers_a_seat(category: str) -> None:
    found = spots(standing(category), "sit")
    assert found
    assert all(0.28 <= spot.point[1] <= 0.68 for spot in found)


@for_each("category", ["dining_chair", "office_chair", "armchair", *SOFAS])
def test_a_seat_faces_away_from_its_backrest(category: str) -> None:
    best = spots(standing(category), "sit")[0]
    assert best.facing == pytest.approx(0.0)
    assert 0.16 - 1e-9 <= best.back < inf


@for_each("category", [*SEATS, *SOFAS, *BEDS])
def test_shins_of_a_sitter_do_not_cut_the_piece(category: str) -> None:
    placed = standing(category)
    for spot in spots(placed, "sit"):
        knee = ahead(spot, 0.4165)
        for side in (-0.09, 0.09):
            x, z = knee[0] + side * cos(spot.facing), knee[1] - side * sin(spot.facing)
            low, high = (x - 0.05, 0.02, z - 0.05), (x + 0.05, spot.point[1] + 0.03, z + 0.05)
            assert not any(overlaps(part, low, high) for part in parts(category, placed.size) if not part.is_soft)


@for_each("category", [*SEATS, *SOFAS, *BEDS])
def test_the_trunk_of_a_sitter_does_not_cut_the_piece(category: str) -> None:
    placed = standing(category)
    for spot in spots(placed, "sit"):
        x, y, z = spot.point
        low, high = (x - 0.12, y + 0.04, z - 0.12), (x + 0.12, y + 0.8, z + 0.12)
        assert not any(overlaps(part, low, high) for part in parts(category, placed.size) if not part.is_soft)


@for_each("category", [*SEATS, *SOFAS, *BEDS])
def test_one_stands_where_the_feet_of_the_sitter_are(category: str) -> None:
    for spot in spots(standing(category), "sit"):
        assert spot.standing == pytest.approx(ahead(spot, 0.42))
        assert spot.approach == pytest.approx(spot.facing)
        assert 0.1 <= spot.edge <= 0.34


@for_each("category", BEDS)
def test_a_bed_is_lain_on_from_both_sides_with_the_head_at_the_headboard(category: str) -> None:
    found = spots(standing(category), "lie")
    assert {round(spot.approach, 4) for spot in found} == {round(pi / 2, 4), round(-pi / 2, 4)}
    assert all(abs(spot.facing) == pytest.approx(pi) for spot in found)
    assert all(spot.back >= 0.8 and spot.side >= 0.9 for spot in found)


def test_a_sofa_is_lain_on_from_the_front_with_the_head_at_either_arm() -> None:
    found = spots(standing("multi_seat_sofa"), "lie")
    assert {round(spot.facing, 4) for spot in found} == {round(pi / 2, 4), round(-pi / 2, 4)}
    assert all(spot.approach == pytest.approx(0.0) for spot in found)
    assert all(spot.back >= 0.85 and spot.side >= 0.95 for spot in found)


def test_a_short_or_narrow_piece_is_not_lain_on() -> None:
    assert spots(Placed("a", "loveseat_sofa", (0, 0, 0), (1.5, 0.8, 0.9)), "lie") == ()
    assert spots(Placed("a", "bench", (0, 0, 0), (1.8, 0.45, 0.35)), "lie") == ()


@pytest.mark.parametrize(
    ("category", "need", "limits"), [("single_bed", "lie", (0.18, 0.80)), ("dining_chair", "sit", (0.28, 0.68))]
)
def test_what_is_too_low_or_too_high_is_neither_sat_nor_lain_on(
    category: str, need: str, limits: tuple[float, float]
) -> None:
    top = spots(standing(category), need)[0].point[1]
    for limit, inwards in zip(limits, (1, -1), strict=True):
        for off, offered in ((0.01, True), (-0.01, False)):
            raised = standing(category, position=(0.0, limit + inwards * off - top, 0.0))
            assert bool(spots(raised, need)) == offered, (limit, off)


def test_a_person_who_lies_down_stands_beside_the_bed() -> None:
    placed = standing("double_bed")
    for spot in spots(placed, "lie"):
        assert abs(spot.standing[0]) > placed.size[0] / 2 + 0.1
        assert abs(spot.standing[1]) < placed.size[2] / 2 - 0.1
    assert spots(placed, "lie")[0].standing[1] == pytest.approx(spots(placed, "lie")[0].point[2])


def test_where_one_side_of_a_bed_is_taken_one_sits_down_farther_along_it_and_lies_in_the_same_place() -> None:
    lying = spots(standing("double_bed"), "lie")
    for approach in {spot.approach for spot in lying}:
        same_side = [spot for spot in lying if spot.approach == approach]
        assert len({spot.standing for spot in same_side}) == len(same_side) >= 3
        assert len({spot.point for spot in same_side}) == 1


def test_each_wing_of_a_corner_sofa_is_sat_on_away_from_its_own_back() -> None:
    shape = (
        Part("seat", (-0.9, 0.25, -0.9), (-0.3, 0.43, 1.2)),
        Part("seat", (-0.3, 0.25, -0.9), (1.2, 0.43, -0.3)),
        Part("back", (-1.2, 0.0, -1.2), (1.2, 0.9, -0.9)),
        Part("back", (-1.2, 0.0, -0.9), (-0.9, 0.9, 1.2)),
        Part("arm", (1.05, 0.0, -0.9), (1.2, 0.6, -0.3)),
    )
    found = spots(Placed("a", "l_shaped_sofa", (0, 0, 0), (2.4, 0.9, 2.4), shape=shape), "sit")
    wings = {(round(spot.facing / (pi / 2)), spot.point[0] > -0.3) for spot in found}
    assert {(1, False), (0, True)} <= wings
    assert all(spot.back == pytest.approx(0.27) for spot in found if spot.facing > 0.1)


@pytest.mark.parametrize("category", ["wardrobe", "bookshelf", "cabinet"])
def test_tall_storage_is_touched_low_medium_and_high_from_the_front(category: str) -> None:
    front = [spot for spot in spots(standing(category), "touch") if abs(abs(spot.facing) - pi) < 1e-6]
    assert {"low", "medium", "high"} == {spot.height for spot in front}
    assert front[0].height == "medium"


@for_each(
    ("category", "heights"),
    [
        ("double_bed", {"low", "medium"}),
        ("coffee_table", {"low"}),
        ("dining_table", {"medium"}),
        ("nightstand", {"low"}),
    ],
)
def test_a_height_that_a_piece_lacks_is_not_offered(category: str, heights: set[str]) -> None:
    assert {spot.height for spot in spots(standing(category), "touch")} == heights


@for_each("category", ["wardrobe", "desk", "double_bed", "multi_seat_sofa", "floor_lamp", "tv_stand", "stool"])
def test_who_touches_stands_clear_of_the_piece_and_within_reach(category: str) -> None:
    placed = standing(category)
    found = spots(placed, "touch")
    assert found
    for spot in found:
        away = hypot(spot.standing[0] - spot.point[0], spot.standing[1] - spot.point[2])
        assert (0.37 if spot.height == "medium" else 0.4) <= away <= 0.52
        assert np.allclose([spot.standing[0], spot.standing[1]], ahead(spot, -away), atol=1e-9)
        for part in parts(category, placed.size):
            gap = [abs(spot.standing[i] - part.center[a]) - part.size[a] / 2 for i, a in ((0, 0), (1, 2))]
            assert hypot(*(max(g, 0.0) for g in gap)) >= 0.22 - 1e-9 or part.is_soft


def test_a_chair_is_touched_on_its_back_from_behind() -> None:
    chair = standing("dining_chair")
    behind = [spot for spot in spots(chair, "touch") if spot.standing[1] < -chair.size[2] / 2]
    assert {spot.height for spot in behind} >= {"medium"}


@for_each("category", ["wardrobe", "dining_table", "armchair", "table_lamp"])
def test_a_touched_point_lies_on_a_part(category: str) -> None:
    placed = standing(category)
    for spot in spots(placed, "touch"):
        inward = np.subtract(spot.point, np.multiply(spot.normal, 1e-4))
        assert any(
            all(part.low[axis] - 1e-9 <= inward[axis] <= part.high[axis] + 1e-9 for axis in range(3))
            for part in parts(category, placed.size)
        )


@tries(25)
@given(st.sampled_from([*SEATS, *SOFAS, *BEDS, "wardrobe"]), st.floats(-3, 3), st.floats(-4, 4), st.floats(-4, 4))
def test_spots_turn_and_move_with_their_piece(category: str, yaw: float, x: float, z: float) -> None:
    moved = standing(category, yaw, (x, 0.0, z))
    for affordance in affordances(category):
        for here, there in zip(spots(standing(category), affordance), spots(moved, affordance), strict=True):
            assert np.allclose(moved.to_world(here.point), there.point)
            assert np.allclose(moved.to_world((here.standing[0], 0.0, here.standing[1]))[[0, 2]], there.standing)
            assert cos(here.facing + yaw - there.facing) == pytest.approx(1.0)
            assert (here.edge, here.back, here.side, here.height) == (there.edge, there.back, there.side, there.height)


def test_the_floor_is_sat_and_lain_on_anywhere() -> None:
    seat = floor_spot("sit", (1.0, 2.0), 0.0)
    assert (seat.object_id, seat.point) == ("floor", (1.0, 0.0, 2.0))
    assert seat.standing[1] > 2.0
    assert floor_spot("lie", (1.0, 2.0), 0.0).standing[1] < 2.0


def test_an_unknown_affordance_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(ValueError, match="sit, lie, touch"):
        spots(standing("stool"), "climb")
    with pytest.raises(ValueError, match="sit and lie"):
        floor_spot("touch", (0.0, 0.0), 0.0)
