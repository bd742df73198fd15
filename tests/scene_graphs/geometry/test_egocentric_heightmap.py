"""Heightmaps show what stands around a body, turned with it, and nothing that is not there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture_shapes import parts_of
from scene_graphs.geometry.egocentric_heightmap import SIMS, TOKENHSI, UNIHSI, HeightmapSpec, SceneHeights
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Array, Layout, Placed
from scene_graphs.navigation.clearance import MAX_OBSTACLE_HEIGHT

SQUARE = ((-4.0, -4.0), (-4.0, 4.0), (4.0, 4.0), (4.0, -4.0))
ABSOLUTE = HeightmapSpec(21, 0.1, 1.0, "scene", relative=False)
CHEST = Placed("chest", "chest", (0.0, 0.0, 0.0), (0.8, 0.6, 0.5))
CATEGORIES = ("chest", "dining_table", "dining_chair", "double_bed", "l_shaped_sofa", "bookshelf", "floor_lamp", "rug")


def home_of(*objects: Placed) -> Home:
    return home_from_layouts([Layout("room", "study", SQUARE, 2.5, objects=objects)], 0)


def scene_of(*objects: Placed) -> SceneHeights:
    return SceneHeights(home_of(*objects))


@st.composite
def furniture(draw: st.DrawFn) -> Placed:
    x, z = draw(st.floats(-1.5, 1.5)), draw(st.floats(-1.5, 1.5))
    size = (draw(st.floats(0.3, 2.5)), draw(st.floats(0.3, 2.2)), draw(st.floats(0.3, 2.5)))
    yaw, height = draw(st.floats(-4.0, 4.0)), draw(st.sampled_from((0.0, 0.0, 0.7, 2.0)))
    return Placed(f"o{draw(st.integers(0, 10**9))}", draw(st.sampled_from(CATEGORIES)), (x, height, z), size, yaw)


def heights_within(objects: list[Placed], points: Array, margin: float) -> Array:
    """The highest part that a point is in when every part is `margin` wider all round: the oracle. (N, 2) -> (N,)."""
    highest = np.zeros(len(points))
    for placed in objects:
        local = placed.to_local(np.insert(points, 1, 0.0, axis=1))[:, [0, 2]]
        for part in parts_of(placed):
            bottom, top = part.low[1] + placed.position[1], part.high[1] + placed.position[1]
            if part.is_soft or bottom >= MAX_OBSTACLE_HEIGHT:
                continue
            reach = np.array([part.size[0], part.size[2]]) / 2 + margin
            inside = (np.abs(local - np.array([part.center[0], part.center[2]])) <= reach).all(axis=1)
            highest = np.maximum(highest, np.where(inside, top, 0.0))
    return highest


@given(st.lists(furniture(), max_size=4, unique_by=lambda placed: placed.id), st.floats(-4.0, 4.0))
@tries(25)
def test_every_height_is_that_of_a_part_there_to_within_a_cell(objects: list[Placed], yaw: float) -> None:
    scene = scene_of(*objects)
    found = scene.egocentric((0.1, 0.9, -0.2), yaw, replace(ABSOLUTE, shows="furniture")).ravel()
    x, z = ABSOLUTE.offsets
    cos, sin = np.cos(yaw), np.sin(yaw)
    points = np.stack([0.1 + cos * x + sin * z, -0.2 + cos * z - sin * x], axis=-1)
    cell = scene.raster.cell
    assert (found >= heights_within(objects, points, -cell) - 1e-5).all()
    assert (found <= heights_within(objects, points, 1.5 * cell) + 1e-5).all()


@pytest.mark.parametrize("shows", ["scene", "furniture", "target"])
def test_a_box_at_the_origin_has_its_exact_height_at_the_centre_and_none_beyond(shows: Any) -> None:
    spec = replace(ABSOLUTE, shows=shows)
    heights = scene_of(CHEST).egocentric((0.0, 0.9, 0.0), 0.0, spec, "0/chest")
    assert heights[10, 10] == np.float32(0.6)
    x, z = (offsets.reshape(21, 21) for offsets in spec.offsets)
    beyond = (np.abs(x) > 0.45) | (np.abs(z) > 0.3)
    assert not heights[beyond].any()
    assert (heights[(np.abs(x) < 0.35) & (np.abs(z) < 0.2)] == np.float32(0.6)).all()


@given(st.lists(furniture(), max_size=3, unique_by=lambda placed: placed.id), st.integers(0, 3))
@tries(25)
def test_a_quarter_turn_permutes_the_grid(objects: list[Placed], quarters: int) -> None:
    scene = scene_of(*objects)
    i, j = scene.raster.cells_at(np.array(0.3), np.array(0.5))
    x, z = scene.raster.centers()
    place = (float(x[i]), 0.9, float(z[j]))
    before = scene.egocentric(place, quarters * np.pi / 2, ABSOLUTE)
    after = scene.egocentric(place, (quarters + 1) * np.pi / 2, ABSOLUTE)
    assert np.array_equal(after, before.T[::-1])


def test_a_mirrored_room_is_another_and_its_heights_are_mirrored() -> None:
    left = replace(CHEST, position=(0.71, 0.0, 0.33))
    room, mirror = (scene_of(replace(left, position=(sign * 0.71, 0.0, 0.33))) for sign in (1, -1))
    seen, mirrored = (scene.egocentric((0.0, 0.9, 0.0), 0.0, ABSOLUTE) for scene in (room, mirror))
    assert not np.array_equal(seen, mirrored)
    assert np.array_equal(seen, mirrored[::-1])
    assert seen[18, 13] == np.float32(0.6), "what is at the body's left has the greater first index"


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-7, 7)), min_size=1, max_size=6))
@tries(25)
def test_many_bodies_at_once_see_what_each_sees_alone(roots: list[tuple[float, float, float]]) -> None:
    scene = scene_of(CHEST)
    places, yaws = np.array([[x, 0.8, z] for x, z, _ in roots]), np.array([yaw for *_, yaw in roots])
    together = scene.egocentric(places, yaws, TOKENHSI)
    assert together.shape == (len(roots), 25, 25)
    for one, place, yaw in zip(together, places, yaws, strict=True):
        assert np.array_equal(one, scene.egocentric(place, yaw, TOKENHSI))
    assert np.array_equal(scene.egocentric(places[:, None], yaws[:, None])[:, 0], together)


def test_doorways_are_open_and_walls_are_as_high_as_the_highest_room() -> None:
    low, high = (Layout(str(height), "study", SQUARE, height) for height in (2.5, 3.1))
    home = home_from_layouts([low, high], 0)
    scene = SceneHeights(home)
    (start, end) = np.array(home.doorways[0].segment)
    for share, expected in ((0.5, 0.0), (0.1, 0.0), (-0.3, 3.1), (1.3, 3.1)):
        x, z = start + share * (end - start)
        assert scene.egocentric((x, 0.9, z), 0.4, replace(ABSOLUTE, size=1, behind=0.0)) == np.float32(expected)
    assert scene.egocentric((500.0, 0.9, -500.0), 0.0, UNIHSI).min() == np.float32(3.1)
    assert not scene.egocentric((500.0, 0.9, -500.0), 0.0, replace(UNIHSI, shows="furniture")).any()


def test_relative_heights_count_from_the_root() -> None:
    scene = scene_of(CHEST)
    above, floor = (
        scene.egocentric((0.0, 0.7, 0.0), 0.2, replace(ABSOLUTE, relative=is_so)) for is_so in (True, False)
    )
    assert np.allclose(above, floor - 0.7, atol=1e-6)


def test_only_the_target_is_seen_by_a_spec_that_shows_its_target() -> None:
    beside = replace(CHEST, id="beside", position=(1.0, 0.0, 0.0), size=(0.5, 1.2, 0.5))
    scene = scene_of(CHEST, beside)
    spec = replace(ABSOLUTE, shows="target")
    assert scene.egocentric((0.0, 0.9, 0.0), 0.0, spec, "0/chest").max() == np.float32(0.6)
    assert scene.egocentric((0.0, 0.9, 0.0), 0.0, spec, "0/beside").max() == np.float32(1.2)
    with pytest.raises(ValueError, match="name the target"):
        scene.egocentric((0.0, 0.9, 0.0), 0.0, SIMS)
    with pytest.raises(KeyError, match="0/chest, 0/beside"):
        scene.egocentric((0.0, 0.9, 0.0), 0.0, SIMS, "piano")


def test_what_one_sinks_into_and_what_hangs_overhead_has_no_height() -> None:
    rug = Placed("rug", "rug", (0.0, 0.0, 0.0), (2.0, 0.02, 2.0))
    lamp = Placed("lamp", "pendant_lamp", (0.0, 2.0, 0.0), (0.5, 0.5, 0.5))
    assert not scene_of(rug, lamp).egocentric((0.0, 0.9, 0.0), 0.0, ABSOLUTE).any()


def test_a_board_thinner_than_a_cell_is_seen() -> None:
    for yaw in (0.0, 0.7):
        scene = scene_of(Placed("screen", "mirror", (0.013, 0.0, 0.007), (1.0, 1.5, 0.005), yaw))
        wide = HeightmapSpec(101, 0.02, 1.0, "furniture", relative=False)
        seen = scene.egocentric((0.0, 0.9, 0.0), yaw, wide) > 0
        assert seen[30:70].any(axis=1).all()


def test_presets_span_what_their_papers_say() -> None:
    for spec, sides, rear, front in (
        (TOKENHSI, 1.0, -1.0, 1.0),
        (UNIHSI, 0.8, -0.4, 1.2),
        (SIMS, 0.825, -0.825, 0.825),
    ):
        x, z = spec.offsets
        assert [x.min(), x.max(), z.min(), z.max()] == pytest.approx([-sides, sides, rear, front])
        assert len(np.unique(x.round(9))) == len(np.unique(z.round(9))) == spec.size


@for_each("spec", [(0, 0.1, 0.0), (25, 0.0, 0.0), (25, float("nan"), 0.0), (9999, 0.1, 0.0)])
def test_a_grid_without_size_is_refused(spec: tuple[int, float, float]) -> None:
    with pytest.raises(ValueError, match="samples a side"):
        HeightmapSpec(*spec)


def test_places_and_cells_that_are_no_numbers_are_refused() -> None:
    home = home_of(CHEST)
    with pytest.raises(ValueError, match="finite"):
        SceneHeights(home).egocentric((np.nan, 0.0, 0.0), 0.0)
    for cell in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="positive length"):
            SceneHeights(home, cell)
    with pytest.raises(ValueError, match="take a greater cell"):
        SceneHeights(home, 1e-4)
