"""What a body must not go through: walls are boxes outside the rooms they bound."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from motion_backend.body.scene_collision import WALL, Obstacles
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout

ROOM = Layout("room", "bedroom", ((0.0, 0.0), (0.0, 3.0), (4.0, 3.0), (4.0, 0.0)), height=2.5)


def test_walls_are_ten_centimetres_thick_and_stand_outside_their_room() -> None:
    obstacles = Obstacles.of_home(home_from_layouts([ROOM], 0))
    assert set(obstacles.owners) == {WALL}
    room = shapely.Polygon(ROOM.floor_polygon)
    for center, half, yaw in zip(obstacles.centers, obstacles.halves, obstacles.yaws, strict=True):
        assert 2 * min(half[0], half[2]) == pytest.approx(0.10)
        axes = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        corners = [center[[0, 2]] + x * half[0] * axes[0] + z * half[2] * axes[1]
                   for x, z in ((1, 1), (1, -1), (-1, -1), (-1, 1))]  # fmt: skip
        assert shapely.Polygon(corners).intersection(room).area < 1e-6
    around = np.unique(np.round(obstacles.centers[:, [0, 2]], 3), axis=0)
    assert around[:, 0].min() == pytest.approx(-0.05)
    assert around[:, 0].max() == pytest.approx(4.05)
