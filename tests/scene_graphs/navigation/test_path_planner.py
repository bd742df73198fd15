"""Paths stay on free floor, keep off furniture where there is space, and end where they should."""

from __future__ import annotations

from itertools import combinations, pairwise

import networkx as nx
import numpy as np
import pytest
import shapely
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Array, Layout, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.navigation.clearance import obstacles
from scene_graphs.navigation.path_planner import CARE, COMFORT, TIGHT, NoPath, Walkable, smooth_path

SQUARE = ((0.0, 0.0), (0.0, 6.0), (6.0, 6.0), (6.0, 0.0))
DIP = 0.004
"""Between two free cells of 5 cm a corner can be nearer than the radius by 3 mm, and a step is straight."""


def furnished(name: str = "a", *objects: Placed) -> Layout:
    bed = Placed("bed", "double_bed", (0.95, 0.0, 1.15), (1.7, 0.9, 2.1))
    table = Placed("table", "dining_table", (3.2, 0.0, 3.4), (1.6, 0.76, 0.95), 0.4)
    chair = Placed("chair", "dining_chair", (3.2, 0.0, 4.4), (0.47, 0.87, 0.54), np.pi)
    rug = Placed("rug", "rug", (3.0, 0.0, 1.5), (2.0, 0.01, 1.5))
    lamp = Placed("lamp", "pendant_lamp", (4.5, 2.0, 1.5), (0.5, 0.5, 0.5))
    return Layout(name, "bedroom", SQUARE, objects=(bed, table, chair, rug, lamp, *objects))


@pytest.fixture(scope="module")
def walkable() -> Walkable:
    return Walkable(home_from_layouts([furnished("a"), furnished("b"), furnished("c")], 4))


@pytest.fixture(scope="module")
def one_room() -> Walkable:
    return Walkable(home_from_layouts([furnished()], 0))


SEEDS = st.integers(0, 10_000)


@given(SEEDS)
@tries(25)
def test_a_path_joins_its_ends_over_free_floor(walkable: Walkable, seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, goal = (walkable.random_point(rng, int(room)) for room in rng.integers(0, 3, 2))
    path = walkable.path(start, goal)
    assert tuple(path[0]) == start
    assert tuple(path[-1]) == goal
    assert nearest_to(walkable, path) >= walkable.radius - DIP


@given(SEEDS)
@tries(8, least=2)
def test_nothing_of_a_path_through_furnished_rooms_comes_nearer_than_the_radius(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rooms = built_in_layouts()
    home = home_from_layouts([rooms[int(index)] for index in rng.choice(len(rooms), 2, replace=False)], seed)
    walkable = Walkable(home, float(rng.uniform(0.15, 0.25)))
    starts, goals = ([walkable.random_point(rng, room) for _ in range(3)] for room in (0, 1))
    for start, goal in zip(starts, goals, strict=True):
        if walkable.reachable(start, goal):
            assert nearest_to(walkable, walkable.path(start, goal)) >= walkable.radius - 1.2 * DIP


@given(SEEDS)
@tries(10)
def test_no_way_over_the_cells_is_cheaper_than_a_path(
    one_room: Walkable, grid: nx.Graph[tuple[int, int]], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    start, goal = one_room.random_point(rng, 0), one_room.random_point(rng, 0)
    path = one_room.path(start, goal)
    steps = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in pairwise(path)] + [path[-1:]])
    middles, lengths = (steps[1:] + steps[:-1]) / 2, np.hypot(*np.diff(steps, axis=0).T)
    (i, j), (k, m) = (
        ((np.array([start, goal]) - one_room.field.origin) / one_room.field.cell).round().astype(int).tolist()
    )
    cheapest = nx.dijkstra_path_length(grid, (i, j), (k, m))
    assert float(lengths @ price(one_room, one_room.field.at(middles))) <= 1.03 * cheapest + 0.05


def price(walkable: Walkable, clearance: Array) -> Array:
    """What a metre costs, as the module says: more the less clearance there is, most where nothing is to spare."""
    narrow = np.clip((COMFORT - clearance) / (COMFORT - walkable.radius), 0.0, 1.0)
    return 1 + CARE * narrow + TIGHT * (clearance < walkable.radius + 0.71 * walkable.field.cell)


@pytest.fixture(scope="module")
def grid(one_room: Walkable) -> nx.Graph[tuple[int, int]]:
    """Free cells joined to their neighbours by the cost of a step, one by one."""
    distances = one_room.field.distances
    graph: nx.Graph[tuple[int, int]] = nx.Graph()
    prices = price(one_room, distances)
    free = {(int(i), int(j)) for i, j in np.argwhere(distances >= one_room.radius)}
    for i, j in free:
        for other in ((i + 1, j), (i, j + 1), (i + 1, j + 1), (i + 1, j - 1)):
            if other in free:
                length = one_room.field.cell * float(np.hypot(other[0] - i, other[1] - j))
                graph.add_edge((i, j), other, weight=length * (prices[i, j] + prices[other]) / 2)
    return graph


def nearest_to(walkable: Walkable, path: Array) -> float:
    """The least exact distance of a line to furniture and to the edge of the floor."""
    solid = [outline for _, outline in obstacles(walkable.home.objects)]
    edge = shapely.boundary(walkable.home.floor)
    return float(shapely.distance(shapely.LineString(path), [*solid, edge]).min())


@given(SEEDS)
@tries(25)
def test_a_path_has_short_steps_and_no_sharp_turns(walkable: Walkable, seed: int) -> None:
    rng = np.random.default_rng(seed)
    path = walkable.path(walkable.random_point(rng, 0), walkable.random_point(rng, 1))
    steps = np.diff(path, axis=0)
    assert np.hypot(*steps.T).max() < 0.12
    headings = np.arctan2(steps[:, 0], steps[:, 1])
    turns = np.abs((np.diff(headings) + np.pi) % (2 * np.pi) - np.pi)
    assert turns.max() < 1.0


@given(st.floats(-0.5, 6.5), st.floats(-0.5, 6.5))
@tries(60)
def test_clearance_is_the_distance_to_furniture_and_walls(one_room: Walkable, x: float, z: float) -> None:
    floor = shapely.Polygon(SQUARE)
    point = shapely.Point(x, z)
    solid = [outline for _, outline in obstacles(one_room.home.objects)]
    exact = min(point.distance(other) for other in [*solid, floor.exterior]) if floor.contains(point) else 0.0
    assert one_room.clearance((x, z)) == pytest.approx(exact, abs=0.03)


def test_one_walks_over_rugs_and_under_hanging_lamps(one_room: Walkable) -> None:
    assert one_room.is_free((3.0, 1.5))
    assert one_room.is_free((4.5, 1.5))


def test_one_does_not_walk_through_beds_or_between_the_legs_of_a_table(one_room: Walkable) -> None:
    assert not one_room.is_free((1.0, 1.0))
    assert not one_room.is_free((3.2, 3.4))


def test_in_the_open_a_path_is_straight(one_room: Walkable) -> None:
    path = one_room.path((2.6, 0.8), (5.3, 1.9))
    length = np.hypot(*np.diff(path, axis=0).T).sum()
    assert length == pytest.approx(np.hypot(2.7, 1.1), rel=1e-3)


@given(SEEDS)
@tries(3, least=2)
def test_who_gets_there_gets_back_and_who_is_slimmer_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rooms = built_in_layouts()
    home = home_from_layouts([rooms[int(index)] for index in rng.choice(len(rooms), 2, replace=False)], seed)
    slim, usual, stout = (Walkable(home, radius) for radius in (0.15, 0.22, 0.30))
    points = [usual.random_point(rng, room) for room in (0, 1, 0, 1)]
    for start, goal in combinations(points, 2):
        assert usual.reachable(start, goal) == usual.reachable(goal, start)
        assert slim.reachable(start, goal) or not usual.reachable(start, goal)
        assert usual.reachable(start, goal) or not (
            stout.is_free(start) and stout.is_free(goal) and stout.reachable(start, goal)
        )


def test_a_corner_too_tight_to_be_rounded_is_not_cut() -> None:
    raw = np.array([*((0.05 * i, 0.0) for i in range(10)), *((0.45, 0.05 * i) for i in range(1, 9))])
    corridor = shapely.LineString(raw).buffer(1e-6)

    def costs(starts: Array, ends: Array) -> Array:
        lines = shapely.linestrings(np.stack([starts, ends], axis=1))
        return np.where(shapely.contains(corridor, lines), shapely.length(lines), np.inf)

    smooth = smooth_path(raw, costs, lambda points: bool(shapely.intersects_xy(corridor, points).all()))
    assert corridor.contains(shapely.LineString(smooth))
    assert np.array_equal(smooth[[0, -1]], raw[[0, -1]])
    assert np.hypot(*np.diff(smooth, axis=0).T).max() <= 0.1 + 1e-9


def test_paths_keep_off_furniture_where_there_is_space() -> None:
    wall = Placed("wall", "wardrobe", (3.0, 0.0, 3.0), (3.0, 2.0, 1.0))
    walkable = Walkable(home_from_layouts([Layout("a", "study", SQUARE, objects=(wall,))], 0))
    path = walkable.path((1.0, 3.0), (5.0, 3.0))
    beside = path[(path[:, 0] > 1.6) & (path[:, 0] < 4.4)]
    assert min(walkable.clearance((x, z)) for x, z in beside) > walkable.radius + 0.1


def test_a_standing_point_close_to_furniture_is_left_and_reached_straight(one_room: Walkable) -> None:
    start, goal = (1.95, 1.2), (3.2, 4.75)
    assert not one_room.is_free(start)
    path = one_room.path(start, goal)
    assert tuple(path[0]) == start
    assert tuple(path[-1]) == goal
    assert one_room.is_free(tuple(path[1]))
    assert one_room.clearance(tuple(path[len(path) // 2])) >= one_room.radius


def test_nobody_steps_through_a_wall(walkable: Walkable) -> None:
    home = walkable.home
    for wall in home.walls:
        (ax, az), (bx, bz) = wall.segment
        for share in np.linspace(0.1, 0.9, 5):
            beside = np.array([ax + share * (bx - ax), az + share * (bz - az)])
            for index in range(len(home.rooms)):
                inside = beside + 0.05 * (home.room_polygon(index).mean(axis=0) - beside)
                room, free = home.room_at(tuple(inside)), walkable.nearest_free(tuple(inside))
                at_doorway = any(
                    shapely.LineString(d.segment).distance(shapely.Point(inside)) < 0.5 for d in home.doorways
                )
                if room is not None and free is not None and not at_doorway:
                    assert home.room_at(free) == room


def walled_off() -> Home:
    shelf = Placed("shelf", "wardrobe", (3.0, 0.0, 3.0), (6.0, 2.0, 0.5))
    return home_from_layouts([Layout("a", "study", SQUARE, objects=(shelf,))], 0)


def test_where_there_is_no_way_start_and_goal_are_named() -> None:
    walkable = Walkable(walled_off())
    assert not walkable.reachable((3.0, 1.0), (3.0, 5.0))
    with pytest.raises(NoPath, match=r"from \(3.00, 1.00\) to \(3.00, 5.00\)"):
        walkable.path((3.0, 1.0), (3.0, 5.0))


def test_a_goal_off_the_floor_is_named() -> None:
    walkable = Walkable(walled_off())
    with pytest.raises(NoPath, match=r"no walkable floor within 0.6 m of the goal"):
        walkable.path((3.0, 1.0), (30.0, 5.0))
    assert walkable.nearest_free((30.0, 5.0)) is None


@given(SEEDS)
@tries(30)
def test_random_points_are_free_places_of_their_room(walkable: Walkable, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for room in range(3):
        point = walkable.random_point(rng, room)
        assert walkable.home.room_at(point) == room
        assert walkable.clearance(point) >= 0.4


def test_the_same_question_gets_the_same_answer(walkable: Walkable) -> None:
    again = Walkable(walkable.home)
    start, goal = walkable.random_point(np.random.default_rng(1), 0), walkable.random_point(np.random.default_rng(2), 2)
    assert np.array_equal(walkable.path(start, goal), again.path(start, goal))


def test_start_and_goal_may_be_one_place(one_room: Walkable) -> None:
    path = one_room.path((4.5, 1.5), (4.5, 1.5))
    assert np.allclose(path, (4.5, 1.5))
