"""The renderer draws what is nearest, where the camera says, and lights it from above."""

from __future__ import annotations

from dataclasses import replace
from time import process_time

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.rendering.depth_buffer import draw
from motion_backend.rendering.rasterizer import Camera, clip, empty_buffers, orbit
from motion_backend.rendering.renderer import Solid, render

RED, GREEN = (0.8, 0.1, 0.1), (0.1, 0.7, 0.1)
FRONT = Camera((0.0, 0.5, 5.0), (0.0, 0.5, 0.0), span=2.0)


def square(z: float, half: float = 0.5, y: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[-half, y - half, z], [half, y - half, z], [half, y + half, z], [-half, y + half, z]])
    return corners, np.array([[0, 1, 2], [0, 2, 3]])


def box(size: float = 1.0) -> Solid:
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0, 1) for z in (-0.5, 0.5)]) * size
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [1, 5, 7, 3], [0, 2, 6, 4]]
    return Solid(corners, np.array([[a, b, c] for a, b, c, _ in sides] + [[a, c, d] for a, _, c, d in sides]), RED)


def is_red(pixel: np.ndarray) -> bool:
    return int(pixel[0]) > 2 * int(pixel[1])


@given(st.lists(st.floats(-5, 45), min_size=6, max_size=6))
@tries(60)
def test_a_triangle_covers_exactly_the_pixel_centres_inside_it(numbers):
    corners = np.array(numbers).reshape(3, 2)
    screen = np.concatenate([corners, np.ones((3, 1))], axis=1)[None]
    nearest, best = empty_buffers((40, 40))
    draw(screen, np.array([4]), 7, nearest, best)
    (ax, ay), (bx, by), (cx, cy) = corners
    y, x = np.mgrid[:40, :40] + 0.5
    edges = [
        (bx - ax) * (y - ay) - (by - ay) * (x - ax),
        (cx - bx) * (y - by) - (cy - by) * (x - bx),
        (ax - cx) * (y - cy) - (ay - cy) * (x - cx),
    ]
    inside = np.all(np.array(edges) > 1e-6, axis=0) | np.all(np.array(edges) < -1e-6, axis=0)
    touching = np.all(np.array(edges) > -1e-6, axis=0) | np.all(np.array(edges) < 1e-6, axis=0)
    covered = nearest.ravel() == 7
    assert ((best.ravel() == 1.0) == covered).all()
    assert not (inside.ravel() & ~covered).any()
    assert not (covered & ~touching.ravel()).any()


@given(st.floats(0.0, 6.28), st.floats(-0.3, 1.4), st.floats(1.0, 8.0))
@tries(40)
def test_unprojecting_undoes_projecting(yaw, pitch, distance):
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.4, 0.4, (20, 3)) + np.array([0, 1, 0])
    for camera in (orbit((0, 1, 0), distance, yaw, pitch), Camera((3, 4, 2), (0, 1, 0), span=3.0)):
        x, y, near = np.moveaxis(camera.project(camera.view(points), (64, 48)), -1, 0)
        np.testing.assert_allclose(camera.unproject(x, y, near, (64, 48)), points, atol=1e-9)


def test_the_nearer_square_hides_the_farther_one():
    picture = render([Solid(*square(0.0), GREEN), Solid(*square(1.0, 0.25), RED)], FRONT, (40, 40), ground=None)
    assert is_red(picture[20, 20])
    assert not is_red(picture[12, 20])


def test_half_opacity_lets_half_of_what_is_behind_through():
    veiled = render([Solid(*square(0.0), GREEN), Solid(*square(1.0), RED, opacity=0.5)], FRONT, (40, 40), ground=None)
    assert int(veiled[20, 20, 0]) > 60
    assert int(veiled[20, 20, 1]) > 60


def test_a_floor_that_runs_behind_the_camera_is_cut_and_not_turned_inside_out():
    camera = Camera((0.0, 1.0, 0.0), (0.0, 0.9, 1.0))
    picture = render([], camera, (40, 40)).astype(int)
    sky, floor = picture[2, 20], picture[37, 20]
    assert sky.sum() > floor.sum()
    corners = np.array([[[-1.0, 0, -1], [1, 0, -1], [0, 0, 3]]])
    pieces, source = clip(corners, Camera((0, 0, 0), (0, 0, 1)))
    assert pieces[..., 2].min() > 0
    assert set(source.tolist()) == {0}


def test_the_floor_is_darker_under_a_thing():
    camera = Camera((0.0, 2.0, 6.0), (0.0, 0.0, 0.0))
    floating = Solid(box().vertices + np.array([0, 0.6, 0]), box().faces, RED)
    lit = replace(floating, casts=False)
    bare, shaded, unshaded = (render(solids, camera, (80, 60)).astype(int) for solids in ([], [floating], [lit]))
    assert shaded[32, 40].sum() < bare[32, 40].sum() - 35
    np.testing.assert_array_equal(unshaded[32, 40], bare[32, 40])


def test_a_top_is_lighter_than_a_side():
    picture = render([box()], orbit((0, 0.5, 0), 4.0, 3.6, 0.7), (80, 80)).astype(int)
    reds = picture[(picture[..., 0] > 2 * picture[..., 1])]
    assert reds[:, 0].max() > 1.4 * reds[:, 0].min()


@pytest.mark.parametrize("yaw", [0.0, 1.0, 2.5])
def test_pictures_repeat_exactly(yaw: float):
    camera = orbit((0, 0.5, 0), 4.0, yaw, 0.3)
    np.testing.assert_array_equal(render([box()], camera, (60, 40)), render([box()], camera, (60, 40)))


def test_a_picture_is_quick():
    render([box()], FRONT, (32, 24))
    start = process_time()
    render([box()], orbit((0, 0.5, 0), 4.0, 0.5, 0.3), (320, 240))
    assert process_time() - start < 1.0
