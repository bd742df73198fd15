"""Who comes in by an outer door is seen with it in the first shot."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from upright_body import walking

from motion_backend.rendering.film_entrance import BEFORE, Entrance
from motion_backend.rendering.film_shots import film_shots
from motion_backend.scene import scene_of
from planner_service.grounding.opening_places import entry
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout_library import built_in_layouts

SIZE = (160, 90)


@cache
def homes() -> tuple[tuple[Home, tuple[float, float, float]], ...]:
    """Some homes with where one stands who has just come in."""
    rooms = [layout for layout in built_in_layouts() if layout.room_type == "living_room"][:3]
    made = [home_from_layouts([room], seed=0) for room in rooms]
    found = [(home, entry(home, scene_of(home).walkable, 0)) for home in made]
    return tuple((home, (*at.standing, at.inward)) for home, at in found if at is not None)


@pytest.mark.parametrize("metres", [0.0, 1.0])
def test_the_first_shot_shows_the_door_from_within_and_the_body(metres: float):
    assert len(homes()) >= 2
    for home, at in homes():
        motion = walking(at, metres)
        entrance = Entrance.of(home, motion)
        assert entrance is not None
        camera = next(film_shots(home, motion, [0], SIZE[0] / SIZE[1])).camera
        assert entrance.side.faces(np.asarray(camera.eye)[[0, 2]]), "a door is not seen from behind its wall"
        for points in (entrance.corners, motion.joint_positions()[::20].reshape(-1, 3).astype(np.float64)):
            x, y, _ = np.moveaxis(camera.project(camera.view(points), SIZE), -1, 0)
            assert ((x >= 0) & (x <= SIZE[0]) & (y >= 0) & (y <= SIZE[1])).all()


def test_who_goes_to_a_door_or_begins_far_from_it_has_not_come_in():
    for home, (x, z, yaw) in homes():
        assert Entrance.of(home, walking((x, z, yaw + np.pi), 0.0)) is None, "it is before the body"
        far = (x + 2 * BEFORE * np.sin(yaw), z + 2 * BEFORE * np.cos(yaw), yaw)
        assert Entrance.of(home, walking(far, 0.0)) is None


def test_a_window_is_no_entrance_and_a_wall_without_openings_has_none():
    for home, at in homes():
        for bottom in (0.9, None):
            walls = tuple(
                replace(wall, openings=tuple(replace(o, bottom=bottom, top=bottom + 1.0) for o in wall.openings))
                if bottom is not None
                else replace(wall, openings=())
                for wall in home.walls
            )
            assert Entrance.of(replace(home, walls=walls), walking(at, 0.0)) is None
