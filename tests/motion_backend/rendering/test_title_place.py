"""A film's title stands beside the body, wherever that is, and above the told words."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend.rendering.film_shots import FilmShot
from motion_backend.rendering.rasterizer import orbit
from motion_backend.rendering.title_place import PLACES, Place, title_place
from motion_backend.rotations import Array

SIZE = (1280, 720)
WORDS = (90, 480)
CAMERA = orbit((0.0, 1.0, 0.0), 4.0, 0.0, 0.1)


def standing(across: float, up: float = 0.0) -> Array:
    """A body as a column of joints that far to the right in the picture and up, metres. (20, 22, 3)."""
    column = np.stack([np.full(22, across), np.linspace(0.1, 1.7, 22) + up, np.zeros(22)], axis=1)
    return np.tile(column, (20, 1, 1))


def joints_under(joints: Array) -> int:
    """How many joints the title lies on in the place that is chosen, until it goes."""
    shot = FilmShot(0, len(joints), CAMERA, ())
    place, clear = title_place(WORDS, SIZE, [shot], joints)
    left, top, right, bottom = place.box(WORDS, SIZE)
    x, y, _ = np.moveaxis(CAMERA.project(CAMERA.view(joints[:clear]), SIZE), -1, 0)
    return int(np.count_nonzero((x > left) & (x < right) & (y > top) & (y < bottom)))


@pytest.mark.parametrize("across", [-1.6, -1.0, -0.5, 0.0, 0.5, 1.0, 1.6])
@pytest.mark.parametrize("up", [-0.6, 0.0, 0.4])
def test_no_title_lies_on_a_body(across: float, up: float) -> None:
    assert joints_under(standing(across, up)) == 0


def test_who_walks_through_the_picture_is_not_under_it_either() -> None:
    walk = np.concatenate([standing(across)[:1] for across in np.linspace(-1.5, 0.2, 60)])
    assert joints_under(walk) == 0


def test_only_pictures_with_the_title_count() -> None:
    late = FilmShot(20, 60, CAMERA, ())
    first = FilmShot(0, 20, orbit((50.0, 1.0, 0.0), 4.0, 0.0, 0.1), ())
    assert title_place(WORDS, SIZE, [first, late], standing(-1.2)) == (PLACES[0], 20)


def test_a_title_goes_when_somebody_comes_to_wherever_it_is() -> None:
    crowd = np.concatenate([standing(across)[:1] for across in [*np.linspace(1.7, -1.7, 60)]])
    _, clear = title_place(WORDS, SIZE, [FilmShot(0, 60, CAMERA, ())], crowd)
    assert 20 < clear < 60, "who crosses the whole picture comes everywhere"


@pytest.mark.parametrize("place", PLACES)
def test_every_place_is_in_the_picture_and_above_the_told_words(place: Place) -> None:
    left, top, right, bottom = place.box(WORDS, SIZE)
    assert 0 <= left < right <= SIZE[0]
    assert 0 <= top < bottom <= 0.8 * SIZE[1]
