"""Meshes of furniture and homes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import catalogue, typical_size
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.meshes.furniture_mesh import Mesh, furniture_meshes, home_meshes
from scene_graphs.meshes.mesh_primitives import block, cylinder, flat, turned


def assert_sound(mesh: Mesh) -> None:
    assert mesh.vertices.dtype == np.float32
    assert mesh.faces.dtype == np.int32
    assert np.isfinite(mesh.vertices).all()
    assert 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices)
    assert len(mesh.color) == 4
    assert all(0 <= value <= 1 for value in mesh.color)


@tries(25)
@given(st.tuples(*[st.floats(0.05, 2.0)] * 3), st.floats(0.0, 0.5))
def test_a_bevelled_block_is_closed_faces_out_and_keeps_its_extent(
    size: tuple[float, float, float], bevel: float
) -> None:
    shape = trimesh.Trimesh(*block((0.0, 0.0, 0.0), size, bevel), process=False)
    joined = trimesh.Trimesh(*block((0.0, 0.0, 0.0), size, bevel), process=True)
    assert joined.is_watertight
    assert 0 < shape.volume <= np.prod(size) * (1 + 1e-9)
    assert np.allclose(shape.extents, size)


@pytest.mark.parametrize("taper", [0.6, 1.0, 1.4])
def test_turned_shapes_are_closed_and_face_out(taper: float) -> None:
    shape = trimesh.Trimesh(*cylinder((0.0, 0.0, 0.0), (1.0, 2.0, 1.0), 16, taper))
    assert shape.is_watertight
    assert shape.volume > 0
    assert trimesh.Trimesh(*turned([(0.0, 0.0), (0.3, 0.0), (0.1, 0.5), (0.0, 0.6)])).volume > 0


def test_a_floor_of_any_winding_covers_its_polygon_and_faces_up() -> None:
    corners = [(0.0, 0.0), (0.0, 2.0), (1.0, 2.0), (1.0, 1.0), (3.0, 1.0), (3.0, 0.0)]
    for polygon in (corners, corners[::-1]):
        shape = trimesh.Trimesh(*flat(polygon))
        assert shape.area == pytest.approx(4.0)
        assert np.allclose(shape.face_normals, (0, 1, 0))


@for_each("category", [*sorted(catalogue().categories), "aquarium"])
def test_every_category_is_drawn_within_a_centimetre_or_two_of_its_box(category: str) -> None:
    size = typical_size(category)
    meshes = furniture_meshes(Placed("a", category, (0.0, 0.0, 0.0), size))
    assert meshes
    for mesh in meshes:
        assert_sound(mesh)
        assert (mesh.vertices.min(axis=0) >= np.array([-size[0] / 2, 0.0, -size[2] / 2]) - 0.03).all()
        assert (mesh.vertices.max(axis=0) <= np.array([size[0] / 2, size[1], size[2] / 2]) + 0.03).all()


def test_furniture_is_drawn_where_it_stands_and_turned_as_it_stands() -> None:
    size = typical_size("desk")
    here = furniture_meshes(Placed("a", "desk", (0.0, 0.0, 0.0), size))
    moved = Placed("a", "desk", (2.0, 0.0, -1.0), size, 0.7)
    for at_home, away in zip(here, furniture_meshes(moved), strict=True):
        assert np.allclose(moved.to_world(at_home.vertices.astype(float)), away.vertices, atol=1e-5)


def test_chairs_of_a_set_match_in_colour() -> None:
    size = typical_size("dining_chair")
    first, second = (furniture_meshes(Placed(name, "dining_chair", (0, 0, 0), size)) for name in ("a", "b"))
    assert [mesh.color for mesh in first] == [mesh.color for mesh in second]


def test_a_home_of_four_rooms_is_small_named_and_always_the_same() -> None:
    layouts = built_in_layouts()[:4]
    home = home_from_layouts(layouts, seed=0)
    meshes = home_meshes(home)
    for mesh in meshes:
        assert_sound(mesh)
    size = sum(mesh.vertices.nbytes + mesh.faces.size * 2 for mesh in meshes)
    assert size < 600_000
    starts = {mesh.name.split()[0] for mesh in meshes if "/" not in mesh.name}
    assert starts == {"floor", "wall", "door", "window"}
    again = home_meshes(home_from_layouts(layouts, seed=0))
    assert all((a.vertices == b.vertices).all() and a.name == b.name for a, b in zip(meshes, again, strict=True))


def test_floors_lie_in_their_rooms_and_walls_stand_outside_them() -> None:
    home = home_from_layouts(built_in_layouts()[4:5], seed=0)
    outline = home.room_polygon(0)
    low, high = outline.min(axis=0), outline.max(axis=0)
    for mesh in home_meshes(home):
        plan = mesh.vertices[:, [0, 2]]
        if mesh.name.startswith("floor"):
            assert (plan >= low - 1e-4).all()
            assert (plan <= high + 1e-4).all()
        if mesh.name.split(":")[0] in {f"wall {number}" for number in range(4)}:
            inside = ((plan > low + 1e-3) & (plan < high - 1e-3)).all(axis=1)
            assert not inside.any()


def test_every_mesh_faces_out_as_a_whole() -> None:
    home = home_from_layouts(built_in_layouts()[:1], seed=0)
    for mesh in home_meshes(home):
        if mesh.name.startswith("floor"):
            continue
        assert trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume > 0, mesh.name


@pytest.mark.parametrize("span", [(0.0, 1.0), (3.0, 4.0), (0.1, 3.9)])
def test_curtains_of_a_window_in_a_corner_stay_within_its_wall(span: tuple[float, float]) -> None:
    window = Opening(((span[0], 0.0), (span[1], 0.0)), 0.9, 2.0)
    room = Layout("corner", "study", ((0, 0), (0, 4), (4, 4), (4, 0)), windows=(window,))
    hung = [mesh for mesh in home_meshes(home_from_layouts([room], 0)) if mesh.name.startswith("window")]
    along = np.concatenate([mesh.vertices[:, 0] for mesh in hung if "curtain" in mesh.name or "rod" in mesh.name])
    assert along.min() >= -1e-6
    assert along.max() <= 4 + 1e-6
    assert along.max() - along.min() >= span[1] - span[0]
