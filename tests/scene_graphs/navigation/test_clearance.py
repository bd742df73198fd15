"""Where a body of one radius can stand."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import shapely
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.layout import Placed
from scene_graphs.navigation.clearance import Rectangles, find_footing, measure_clearance

FLOOR = shapely.Polygon([(0, 0), (0, 4), (4, 4), (4, 2), (2, 2), (2, 0)])
within = st.floats(-1.0, 5.0)


def outline(x: float, z: float, width: float, depth: float, yaw: float) -> np.ndarray:
    return Placed("box", "box", (x, 0, z), (width, 1.0, depth), yaw).footprint


@given(within, within, st.floats(0.05, 2.0), st.floats(0.05, 2.0), st.floats(-pi, pi), within, within)
def test_the_distance_to_a_rectangle_is_that_of_geometry(
    x: float, z: float, width: float, depth: float, yaw: float, px: float, pz: float
) -> None:
    corners = outline(x, z, width, depth, yaw)
    exact = shapely.Polygon(corners).distance(shapely.Point(px, pz))
    assert Rectangles.of(corners[None]).distances(np.array([px, pz]))[0] == pytest.approx(exact, abs=1e-9)


@given(within, within)
def test_the_distance_to_walls_is_that_of_geometry(px: float, pz: float) -> None:
    walls = Rectangles.of_walls(shapely.get_coordinates(FLOOR.exterior)[:-1])
    expected = FLOOR.exterior.distance(shapely.Point(px, pz))
    assert walls.distances(np.array([px, pz])).min() == pytest.approx(expected, abs=1e-9)


@tries(40)
@given(within, within, st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(-pi, pi), st.floats(0.05, 0.4))
def test_a_cell_is_free_where_clearance_is_enough(
    x: float, z: float, width: float, depth: float, yaw: float, radius: float
) -> None:
    corners = outline(x, z, width, depth, yaw)
    footing = find_footing(FLOOR, Rectangles.of(corners[None]), radius, 0.1)
    centers = [np.arange(0.05, 4, 0.1)] * 2
    points = shapely.points(*np.meshgrid(*centers, indexing="ij"))
    away = np.minimum(shapely.distance(shapely.Polygon(corners), points), shapely.distance(FLOOR.exterior, points))
    exact = np.where(shapely.contains(FLOOR, points), away, 0.0)
    sure = np.abs(exact - radius) > 1e-6
    assert (footing.free == (exact >= radius))[sure].all()


def test_a_wall_of_things_parts_the_floor_in_two() -> None:
    wall = outline(2.0, 3.0, 0.1, 2.0, 0.0)
    footing = find_footing(FLOOR, Rectangles.of(wall[None]), 0.22)
    left, right = footing.region_at((1.0, 3.0)), footing.region_at((3.0, 3.0))
    assert left
    assert right
    assert left != right
    assert footing.region_at((2.0, 3.0)) == footing.region_at((3.0, 1.0)) == footing.region_at((-9.0, 1.0)) == 0


@pytest.mark.parametrize("count", [3, 200])
def test_clearance_is_the_distance_to_the_nearest_of_few_or_many_obstacles(count: int) -> None:
    rng = np.random.default_rng(count)
    centers, turns = rng.uniform(-9, 9, (count, 2)), rng.uniform(0, pi, count)
    outlines = [
        Placed("", "stool", (x, 0.0, z), (0.3, 0.4, 0.2), turn).footprint
        for (x, z), turn in zip(centers, turns, strict=True)
    ]
    floor = shapely.box(-10, -10, 10, 10)
    edges = shapely.get_coordinates(floor.exterior)
    walls = Rectangles.of(np.stack([edges[:-1], edges[1:], edges[1:], edges[:-1]], axis=1))
    found = measure_clearance(floor, Rectangles.of(np.stack(outlines)), walls, cell=0.2)
    i, j = np.indices(found.distances.shape).reshape(2, -1)
    cells = shapely.points(found.origin[0] + 0.2 * i, found.origin[1] + 0.2 * j)
    obstacles = [floor.exterior, *(shapely.Polygon(outline) for outline in outlines)]
    exact = shapely.distance(shapely.union_all(obstacles), cells)
    assert np.allclose(found.distances[i, j], exact, atol=1e-9)
