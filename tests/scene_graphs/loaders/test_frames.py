"""Unity's left-handed frame becomes ours and not its mirror image."""

from __future__ import annotations

from math import cos, radians, remainder, sin, tau

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.loaders.frames import box_from_unity, point_from_unity, yaw_from_unity

degrees = st.floats(-720, 720)
places = st.tuples(*[st.floats(-20, 20)] * 3)
sizes = st.tuples(*[st.floats(0.1, 3)] * 3)


def unity_euler(turns: tuple[float, float, float]) -> np.ndarray:
    """Unity's own words: about z, then x, then y; each turn is clockwise seen along the axis, in left-handed axes."""
    x, y, z = (radians(turn) for turn in turns)
    about_z = np.array([[cos(z), -sin(z), 0], [sin(z), cos(z), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, cos(x), -sin(x)], [0, sin(x), cos(x)]])
    about_y = np.array([[cos(y), 0, sin(y)], [0, 1, 0], [-sin(y), 0, cos(y)]])
    return about_y @ about_x @ about_z


@given(places, places, degrees)
def test_what_is_to_the_right_of_a_thing_stays_to_its_right(
    here: tuple[float, float, float], there: tuple[float, float, float], turn: float
) -> None:
    yaw = radians(turn)
    offset = np.subtract(there, here)[[0, 2]]
    # Unity: clockwise, front (sin, cos), right (cos, -sin) in (x, z).
    in_front, to_the_right = offset @ (sin(yaw), cos(yaw)), offset @ (cos(yaw), -sin(yaw))
    ours = np.subtract(point_from_unity(there), point_from_unity(here))[[0, 2]]
    mine = yaw_from_unity(turn)
    assert np.isclose(ours @ (sin(mine), cos(mine)), in_front, atol=1e-9)
    assert np.isclose(ours @ (-cos(mine), sin(mine)), to_the_right, atol=1e-9)


@given(degrees)
def test_a_yaw_is_given_once_a_turn(turn: float) -> None:
    assert -np.pi < yaw_from_unity(turn) <= np.pi
    assert abs(remainder(yaw_from_unity(turn) - yaw_from_unity(turn + 360), tau)) < 1e-9


@given(sizes, degrees)
def test_an_upright_box_keeps_its_size(size: tuple[float, float, float], turn: float) -> None:
    assert box_from_unity(size, (0.0, turn, 0.0)) == (size, yaw_from_unity(turn))


@given(sizes, degrees, degrees, degrees)
def test_the_box_of_a_tilted_thing_holds_every_corner_and_no_more(
    size: tuple[float, float, float], x: float, y: float, z: float
) -> None:
    signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
    corners = (signs * np.array(size) / 2) @ unity_euler((x, y, z)).T
    ours = corners * (-1, 1, 1)
    (w, h, d), yaw = box_from_unity(size, (x, y, z))
    local = np.stack(
        [
            ours[:, 0] * cos(yaw) - ours[:, 2] * sin(yaw),
            ours[:, 1],
            ours[:, 0] * sin(yaw) + ours[:, 2] * cos(yaw),
        ],
        axis=1,
    )
    if all(abs((turn + 180) % 360 - 180) >= 1e-3 for turn in (x, z)):
        assert np.allclose(np.abs(local).max(axis=0) * 2, (w, h, d), atol=1e-6)
