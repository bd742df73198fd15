"""Where a film leaves a wall away the room goes on: a camera that looks through the gap sees no edge of a home."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from acted import SMALL

from motion_backend.rendering.camera import FOV
from motion_backend.rendering.film_set import FilmSet
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rendering.renderer import nearest_of
from motion_backend.rendering.set_extension import FAR, SetExtension
from motion_backend.rotations import Array
from motion_backend.walls import Side
from scene_graphs.home import Home

SIZE = (96, 54)
YAWS = np.linspace(-np.pi, np.pi, 12, endpoint=False).tolist()
BARE = replace(SMALL, walls=tuple(replace(wall, openings=()) for wall in SMALL.walls))
"""A home without windows and doors, through which one sees what is outside."""


def standing(home: Home) -> Array:
    """A body (1, 22, 3) amidst the first room, as far as a camera cares."""
    x, z = home.room_polygon(0).mean(axis=0)
    return np.tile([x, 0.9, z], (1, 22, 1))


def camera(home: Home, yaw: float) -> Camera:
    x, y, z = standing(home)[0, 0].tolist()
    return orbit((x, y, z), 4.4, yaw, 0.14, FOV)


@pytest.mark.parametrize("yaw", YAWS)
def test_from_wherever_a_camera_looks_there_is_nothing_but_the_room_in_its_picture(yaw: float) -> None:
    shown = FilmSet.of(BARE).seen(camera(BARE, yaw), standing(BARE))
    _, inside = nearest_of(shown, camera(BARE, yaw), SIZE)
    assert (~inside).mean() < 0.005


@pytest.mark.parametrize("yaw", YAWS)
def test_nothing_that_goes_on_stands_before_a_body(yaw: float) -> None:
    sides = [side for wall in BARE.walls if (side := Side.of(wall, BARE)) is not None and side.room == 0]
    eye = np.asarray(camera(BARE, yaw).eye)
    gaps = [side for side in sides if not side.faces(eye[[0, 2]])]
    wide = SetExtension.of(BARE, 0)
    upright = [one for one in wide.beyond(gaps, (0.9, 0.9, 0.9)) if np.ptp(one.vertices[:, 1]) > 1.0]
    here = standing(BARE)[0, 0, [0, 2]]
    for one in upright:
        start, end = np.unique(one.vertices[:, [0, 2]], axis=0)
        assert not Side(start, end, np.zeros(2), 0).crosses(eye[[0, 2]], here[None])
    assert len(upright) == (2 if gaps else 0)


def test_a_floor_goes_on_behind_the_gap_and_nowhere_else() -> None:
    sides = [side for wall in BARE.walls if (side := Side.of(wall, BARE)) is not None and side.room == 0]
    for gap in sides:
        floors = [
            one for one in SetExtension.of(BARE, 0).beyond([gap], (0.9, 0.9, 0.9)) if not np.ptp(one.vertices[:, 1])
        ]
        middles = np.concatenate([one.vertices[one.faces].mean(axis=1)[:, [0, 2]] for one in floors])
        out = (middles - gap.start) @ gap.outward
        assert out.min() > -1.0
        assert out.max() > 0.9 * FAR
