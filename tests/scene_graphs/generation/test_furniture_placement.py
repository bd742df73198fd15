"""Rectangles, empty rooms and the furnishing of them."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.affordances.room_validation import solids_overlap
from scene_graphs.generation import furniture_groups
from scene_graphs.generation.furniture_placement import Arrangement, Group, Item
from scene_graphs.generation.room_shell import MIN_WING_WIDTH, Rectangle, Shell, build_shell, rectangle
from scene_graphs.layout import Placed

places = st.tuples(st.floats(-2, 2), st.floats(-2, 2))
rectangles = st.builds(rectangle, places, st.floats(0.1, 3), st.floats(0.1, 3), st.floats(-pi, pi))
shells = st.builds(
    lambda seed, area, bent: build_shell(np.random.default_rng(seed), area, bent),
    st.integers(0, 10_000),
    st.floats(8, 50),
    st.booleans(),
)


def polygon(piece: Rectangle) -> shapely.Polygon:
    return shapely.Polygon(piece.corners)


@given(rectangles, rectangles)
def test_two_rectangles_meet_if_and_only_if_their_polygons_share_floor(a: Rectangle, b: Rectangle) -> None:
    shared = polygon(a).intersection(polygon(b)).area
    if shared > 1e-6:
        assert a.meets(b)
    if polygon(a).distance(polygon(b)) > 1e-6:
        assert not a.meets(b)
    assert a.meets(b) == b.meets(a)


@given(rectangles, rectangles, st.floats(0.01, 1))
def test_what_is_nearer_than_a_gap_is_never_let_through(a: Rectangle, b: Rectangle, gap: float) -> None:
    if polygon(a).distance(polygon(b)) < gap - 1e-6:
        assert a.meets(b, gap)


@given(shells, rectangles)
def test_a_room_holds_what_lies_inside_its_outline(shell: Shell, piece: Rectangle) -> None:
    room = shapely.Polygon(shell.outline)
    if room.contains(polygon(piece)):
        assert shell.holds(piece)
    if polygon(piece).difference(room.buffer(0.01, join_style="mitre")).area > 1e-6:
        assert not shell.holds(piece)


@given(shells)
def test_walls_face_into_the_room_and_run_from_corner_to_corner(shell: Shell) -> None:
    room = shapely.Polygon(shell.outline)
    assert not room.exterior.is_ccw
    for index, side in enumerate(shell.sides):
        assert room.contains(shapely.Point(side.at(0.0, 0.1)))
        assert side.at(side.length / 2, 0.0) == pytest.approx(shell.outline[index])
        assert room.buffer(1e-6).covers(shapely.LineString([side.at(0.0, 0.0), side.at(0.0, side.reach)]))
        assert not room.buffer(-1e-6).contains(shapely.Point(side.at(0.0, side.reach + 0.1)))
        for sign, closed in zip((-1, 1), side.corners, strict=True):
            assert room.contains(shapely.Point(side.at(sign * (side.length / 2 + 0.1), 0.1))) != closed
    for opening in (*shell.door_openings(), *shell.window_openings()):
        assert room.exterior.distance(shapely.LineString(opening.segment)) < 2e-3
    assert shell.doors


@given(shells)
def test_no_wing_of_a_room_is_too_narrow(shell: Shell) -> None:
    for cell in shell.outside:
        for wall, cut in ((shell.floor.half_width, cell.half_width), (shell.floor.half_depth, cell.half_depth)):
            assert 2 * (wall - cut) >= MIN_WING_WIDTH - 1e-6


kitchens = st.tuples(st.integers(0, 10_000), st.booleans(), st.booleans(), st.booleans())


@given(kitchens)
def test_a_kitchen_stands_in_level_lines_that_one_can_stand_before(kitchen: tuple[int, bool, bool, bool]) -> None:
    seed, goes_round, microwave, dishwasher = kitchen
    group = furniture_groups.kitchen(np.random.default_rng(seed), -1, goes_round, microwave, dishwasher)
    standing = [item for item in group.items if item.stands]
    covered = [rectangle((item.x, item.z), item.size[0], item.size[2], item.yaw) for item in standing]
    clear = shapely.union_all([shapely.box(x0, z0, x1, z1) for x0, x1, z0, z1 in group.clear])
    assert len({item.size[1] for item in standing if item.size[1] < 1.0}) == 1
    assert {item.yaw for item in standing} == ({0.0, pi / 2} if goes_round else {0.0})
    for number, (item, piece) in enumerate(zip(standing, covered, strict=True)):
        assert not any(piece.meets(other) for other in covered[:number])
        assert polygon(piece).intersection(clear).area < 1e-6
        # The far end of the counter in a corner is stood at, of all others the middle.
        along = item.size[0] / 2 - 0.3 if item is standing[0] and goes_round else 0.0
        before = polygon(rectangle(piece.at(along, piece.half_depth + 0.45), 0.4, 0.7, item.yaw))
        assert clear.buffer(1e-6).covers(before)


@given(kitchens)
def test_what_is_on_a_counter_of_a_kitchen_lies_within_its_top(kitchen: tuple[int, bool, bool, bool]) -> None:
    seed, *details = kitchen
    items = furniture_groups.kitchen(np.random.default_rng(seed), 1, *details).items
    laid = [item for item in items if item.on is not None]
    assert [item.category for item in laid] == ["kitchen_sink", *["microwave"] * details[1]]
    for item in laid:
        below = items[item.on or 0]
        top, piece = (rectangle((one.x, one.z), one.size[0], one.size[2], one.yaw) for one in (below, item))
        assert (below.category, below.size[1], below.yaw) == ("kitchen_counter", item.y, item.yaw)
        assert polygon(top).covers(polygon(piece))


@given(kitchens)
def test_a_kitchen_at_the_other_end_of_a_wall_is_its_mirror_image(kitchen: tuple[int, bool, bool, bool]) -> None:
    seed, *details = kitchen
    left, right = (furniture_groups.kitchen(np.random.default_rng(seed), end, *details) for end in (-1, 1))
    assert left.span == pytest.approx((-right.span[1], -right.span[0]))
    assert [(item.category, -item.x, item.z, -item.yaw) for item in left.items] == [
        (item.category, item.x, item.z, item.yaw) for item in right.items
    ]


@given(st.integers(0, 10_000), st.sampled_from([2, 3, 4, 5, 6]))
def test_chairs_at_a_table_stand_apart(seed: int, seats: int) -> None:
    items = furniture_groups.dining(np.random.default_rng(seed), seats).items
    placed = [
        Placed(str(i), item.category, (item.x, item.y, item.z), item.size, item.yaw) for i, item in enumerate(items)
    ]
    assert sum(item.category == "dining_chair" for item in items) == seats
    assert not any(solids_overlap(a, b) for i, a in enumerate(placed[:-1]) for b in placed[i + 1 : -1])


@given(st.integers(0, 10_000))
def test_seats_beside_a_table_stand_at_both_its_ends_and_face_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    group = furniture_groups.lounge(rng, 5.0, "loveseat_sofa", ("armchair", "armchair"), has_table=True)
    assert group is not None
    items = group.items
    table = next(item for item in items if item.category == "coffee_table")
    seats = [item for item in items if item.category == "armchair"]
    assert sorted(np.sign(seat.x - table.x) for seat in seats) == [-1.0, 1.0]
    for seat in seats:
        assert np.sin(seat.yaw) * (table.x - seat.x) > 0


def test_nothing_is_put_on_something_nor_before_a_door() -> None:
    shell = Shell(((-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)), 2.6, doors=((0, 0.0),))
    room = Arrangement(shell, np.random.default_rng(0))
    box = Group((Item("cabinet", 0.0, 0.5, (1.0, 1.0, 1.0)),))
    door = shell.sides[0]
    assert not room.try_at(box, door.at(0.0, 0.0), door.yaw)
    assert room.try_at(box, (0.0, -0.5), 0.0)
    assert not room.try_at(box, (0.9, -0.5), 0.0)
    assert room.try_at(box, (0.0, 0.6), 0.0)
    assert not room.try_at(box, (0.0, 1.6), 0.0)
    assert [placed.id for placed in room.placed] == ["cabinet_1", "cabinet_2"]


@pytest.mark.parametrize("sides", [(-1, 1), (1,)])
def test_a_bed_is_clear_along_its_free_sides_and_one_can_walk_round_its_foot(sides: tuple[int, ...]) -> None:
    group = furniture_groups.bed(np.random.default_rng(0), "double_bed", sides, 1, lamps=True)
    placed, *others = group.items
    width, _, length = placed.size
    assert len(group.clear) == len(sides)
    for side, (near, far, start, end) in zip(sides, group.clear, strict=True):
        assert sorted((side * near, side * far)) == pytest.approx([width / 2, width / 2 + 0.75])
        assert end > length
        assert 0.0 < start < length / 2
    assert [item.category for item in others] == ["nightstand", "table_lamp"]
    assert others[0].x == pytest.approx(sides[0] * (width / 2 + 0.06 + others[0].size[0] / 2))
