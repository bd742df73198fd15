"""What is left of walls that are cut, and what a home stands on."""

from __future__ import annotations

import numpy as np
import shapely
from for_each import for_each

from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.meshes.interior_mesh import BASE_HEIGHT, BASE_TOP, STUMP, base_mesh, stump_meshes, wall_meshes


def homes() -> list[Home]:
    rooms = built_in_layouts()
    return [home_from_layouts(rooms[:1], 0), home_from_layouts([rooms[2], rooms[40], rooms[90]], 1)]


@for_each("index", range(2))
def test_every_wall_has_a_stump_that_lies_within_it_and_leaves_its_doorways_open(index: int):
    home = homes()[index]
    walls = [mesh for mesh in wall_meshes(home) if mesh.name.startswith("wall ")]
    stumps = list(stump_meshes(home))
    assert [mesh.name.replace("stump", "wall") for mesh in stumps] == [mesh.name for mesh in walls]
    for wall, stump, whole in zip(walls, stumps, home.walls, strict=True):
        low, high = wall.vertices.min(axis=0), wall.vertices.max(axis=0)
        assert (stump.vertices >= low - 1e-5).all()
        assert (stump.vertices <= high + 1e-5).all()
        assert stump.vertices[:, 1].max() <= STUMP + 1e-6
        for opening in (one for one in whole.openings if one.bottom < 0.01):
            middle = np.mean(np.asarray(opening.segment), axis=0)
            triangles = stump.vertices[stump.faces][:, :, [0, 2]]
            covered = [shapely.Polygon(one).buffer(1e-4).contains(shapely.Point(middle)) for one in triangles]
            assert not any(covered), "nothing stands in a doorway"


@for_each("index", range(2))
def test_a_home_stands_on_a_base_that_reaches_beyond_its_walls_and_touches_no_floor(index: int):
    home = homes()[index]
    base = base_mesh(home)
    assert np.isclose(base.vertices[:, 1].max(), BASE_TOP)
    assert np.isclose(base.vertices[:, 1].min(), -BASE_HEIGHT)
    corners = base.vertices[base.faces]
    top = [one for one in corners if np.ptp(one[:, 1]) < 1e-6 and one[0, 1] > -BASE_HEIGHT / 2]
    plan = shapely.union_all([shapely.Polygon(one[:, [0, 2]]).buffer(1e-4) for one in top])
    for number in range(len(home.rooms)):
        assert plan.contains(shapely.Polygon(home.room_polygon(number)).buffer(0.06))
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 1]
    assert (up > -1e-6).all(), "its top is seen from above"
