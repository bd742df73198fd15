"""Occupancy grids hold what is solid around a body and its goal, in the order LINGO reads it."""

from __future__ import annotations

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture_shapes import parts_of
from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.geometry.occupancy_grid import LINGO, TRUMANS, VoxelSpec, occupancy, occupancy_pair
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Array, Layout, Placed
from scene_graphs.navigation.clearance import MAX_OBSTACLE_HEIGHT

SQUARE = ((-4.0, -4.0), (-4.0, 4.0), (4.0, 4.0), (4.0, -4.0))
TABLE = Placed("table", "dining_table", (0.0, 0.0, 0.0), (1.8, 0.75, 1.6))
CATEGORIES = ("chest", "dining_table", "dining_chair", "double_bed", "bookshelf", "desk", "office_chair", "plant")
COARSE = VoxelSpec(12)


def scene_of(*objects: Placed) -> SceneHeights:
    return SceneHeights(home_from_layouts([Layout("room", "study", SQUARE, objects=objects)], 0))


def points_of(spec: VoxelSpec, place: tuple[float, float], yaw: float) -> Array:
    """The points of a grid in the home's frame, written out loop by loop as the paper gives them. (y, x, z, 3)."""
    line, levels = np.linspace(-spec.reach, spec.reach, spec.size), np.linspace(spec.low, spec.high, spec.size)
    left, ahead = np.array([np.cos(yaw), -np.sin(yaw)]), np.array([np.sin(yaw), np.cos(yaw)])
    rows = [[[[*(place + x * left + z * ahead), y] for z in line] for x in line] for y in levels]
    return np.array(rows)[..., [0, 2, 1]]


def in_parts(objects: list[Placed], points: Array, margin: float) -> np.ndarray:
    """Whether points lie in a solid part that is wider by `margin` at its sides: the oracle. (..., 3) -> (...)."""
    found = np.zeros(points.shape[:-1], dtype=bool)
    for placed in objects:
        local = placed.to_local(points)
        for part in parts_of(placed):
            if not part.is_soft and part.low[1] + placed.position[1] < MAX_OBSTACLE_HEIGHT:
                reach = np.array(part.size) / 2 + np.array([margin, np.sign(margin) * 1e-9, margin])
                found |= (np.abs(local - np.array(part.center)) <= reach).all(axis=-1)
    return found


@st.composite
def furniture(draw: st.DrawFn) -> Placed:
    x, z = draw(st.floats(-1.0, 1.0)), draw(st.floats(-1.0, 1.0))
    size = (draw(st.floats(0.3, 2.0)), draw(st.floats(0.3, 2.0)), draw(st.floats(0.3, 2.0)))
    yaw, height = draw(st.floats(-4.0, 4.0)), draw(st.sampled_from((0.0, 0.0, 0.6)))
    return Placed(f"o{draw(st.integers(0, 10**9))}", draw(st.sampled_from(CATEGORIES)), (x, height, z), size, yaw)


@given(st.lists(furniture(), max_size=3, unique_by=lambda placed: placed.id), st.floats(-4.0, 4.0))
@tries(25)
def test_a_point_is_occupied_where_a_part_is_to_within_a_cell(objects: list[Placed], yaw: float) -> None:
    scene = scene_of(*objects)
    found, points = occupancy(scene, (0.2, -0.3), yaw, COARSE), points_of(COARSE, (0.2, -0.3), yaw)
    cell = scene.raster.cell
    assert (found >= in_parts(objects, points, -cell)).all()
    assert (found <= in_parts(objects, points, 1.5 * cell)).all()


def test_a_table_is_hollow() -> None:
    solid = occupancy(scene_of(TABLE), (0.0, 0.0), 0.3)
    levels = np.linspace(0.1, 1.2, 32)
    top = (levels > 0.72) & (levels < 0.75)
    assert top.any()
    assert solid[top].all()
    assert not solid[(levels < 0.55) | (levels > 0.76)].any()


def test_levels_come_first_then_left_then_ahead() -> None:
    ahead_left = Placed("chest", "chest", (0.4, 0.0, 0.1), (0.2, 0.5, 0.2))
    solid = occupancy(scene_of(ahead_left), (0.0, 0.0), 0.0)
    levels, line = np.linspace(0.1, 1.2, 32), np.linspace(-0.6, 0.6, 32)
    y, x, z = (axis.mean() for axis in np.nonzero(solid))
    assert solid[:8].any()
    assert not solid[levels > 0.52].any()
    assert line[round(x)] == pytest.approx(0.4, abs=0.05)
    assert line[round(z)] == pytest.approx(0.1, abs=0.05)
    assert y < 8
    turned = occupancy(scene_of(ahead_left), (0.0, 0.0), np.pi / 2)
    _, x, z = (axis.mean() for axis in np.nonzero(turned))
    assert line[round(z)] == pytest.approx(0.4, abs=0.05), "one who faces +X has it ahead"
    assert line[round(x)] == pytest.approx(-0.1, abs=0.05)


def test_outside_is_occupied_and_a_doorway_is_not() -> None:
    home = home_from_layouts([Layout(name, "study", SQUARE) for name in "ab"], 0)
    scene = SceneHeights(home)
    start, end = np.array(home.doorways[0].segment)
    middle = (start + end) / 2
    along = (end - start) / np.hypot(*(end - start))
    yaw = float(np.arctan2(along[1], -along[0]))
    solid = occupancy(scene, (float(middle[0]), float(middle[1])), yaw)
    assert not solid[:, 8:24, :].any()
    assert solid[:, 0].any(axis=-1).all()
    assert occupancy(scene, (90.0, 90.0), 0.0).all()
    assert not occupancy(scene, (0.0, 0.0), 0.0).any()


def test_the_second_grid_lies_at_the_goal_or_a_step_towards_it() -> None:
    scene = scene_of(TABLE)
    here, goal, yaw = (-2.0, 0.0), (1.0, 4.0), 0.7
    first, second = occupancy_pair(scene, here, yaw, goal)
    assert np.array_equal(first, occupancy(scene, here, yaw))
    assert np.array_equal(second, occupancy(scene, goal, yaw))
    _, ahead = occupancy_pair(scene, here, yaw, goal, walking=True)
    assert np.array_equal(ahead, occupancy(scene, (-2.0 + 0.48, 0.64), yaw))
    for alone in (occupancy_pair(scene, here, yaw), occupancy_pair(scene, here, yaw, here, walking=True)):
        assert np.array_equal(alone[0], alone[1])


def test_presets_are_those_of_the_papers() -> None:
    for spec, low in ((LINGO, 0.1), (TRUMANS, 0.0)):
        heights, x, z = spec.offsets
        assert (len(heights), len(x), len(z)) == (32, 1024, 1024)
        assert (heights[0], heights[-1]) == (low, 1.2)
        assert (x.min(), x.max(), z.min(), z.max()) == (-0.6, 0.6, -0.6, 0.6)


def test_bad_places_and_boxes_are_refused() -> None:
    scene = scene_of()
    with pytest.raises(ValueError, match="finite"):
        occupancy(scene, (0.0, float("inf")), 0.0)
    with pytest.raises(ValueError, match="finite"):
        occupancy_pair(scene, (0.0, 0.0), 0.0, (float("nan"), 0.0), walking=True)
    for spec in ({"size": 1}, {"size": 1000}, {"reach": 0.0}, {"low": 1.3}, {"high": float("nan")}):
        with pytest.raises(ValueError, match="low below high"):
            VoxelSpec(**spec)
