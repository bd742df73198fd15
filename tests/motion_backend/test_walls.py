"""Which side of a wall is in its room, and which walls a camera looks through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each

from motion_backend.rendering.motion_figures import around, home_props
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.walls import Side
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Opening, Placed

PICTURE = Placed("picture", "picture", (2.0, 1.4, 0.02), (0.8, 0.6, 0.03))
CORNERED = Layout(
    "cornered",
    "living_room",
    ((0.0, 0.0), (0.0, 5.0), (2.5, 5.0), (2.5, 2.5), (5.0, 2.5), (5.0, 0.0)),
    windows=(Opening(((1.0, 0.0), (1.6, 0.0)), 0.9, 2.0),),
    objects=(PICTURE,),
)
HOME = home_from_layouts([CORNERED], 0)
PROPS = home_props(HOME)
BODY = np.array([[x, y, z] for x in (1.0, 1.4) for y in (0.1, 1.0, 1.7) for z in (1.0, 1.4)])
SIDES = [side for wall in HOME.walls if (side := Side.of(wall, HOME)) is not None]


def hidden(eye: np.ndarray, solids: list, point: np.ndarray) -> bool:
    """Whether any triangle is between an eye and a point, by the signed volumes of tetrahedra."""
    for solid in solids:
        a, b, c = np.moveaxis(np.asarray(solid.vertices, dtype=float)[solid.faces], 1, 0)

        def volume(p, q, r, s):
            return np.sign(np.einsum("fk,fk->f", np.cross(q - p, r - p), s - p))

        parted = volume(a, b, c, eye) != volume(a, b, c, point)
        first, second, third = (volume(eye, point, p, q) for p, q in ((a, b), (b, c), (c, a)))
        if (parted & (first == second) & (second == third) & (first != 0)).any():
            return True
    return False


@for_each("yaw", np.arange(4) * np.pi / 2 + 0.4)
@for_each("middle", [(1.2, 1.2), (4.2, 1.2), (1.2, 4.2)])
def test_no_wall_of_a_cornered_room_hides_a_body_from_any_side(yaw: float, middle: tuple[float, float]) -> None:
    body = BODY + np.array([middle[0] - 1.2, 0.0, middle[1] - 1.2])
    camera = orbit((middle[0], 0.9, middle[1]), 4.0, yaw, 0.36)
    shown = around(PROPS, camera, body, HOME.room_at(middle))
    assert not any(hidden(np.array(camera.eye), shown, point) for point in body)
    assert any(prop.name.startswith("wall") and any(prop.solid is solid for solid in shown) for prop in PROPS)


def test_walls_seen_from_the_room_are_shown_with_their_windows_and_pictures_and_else_none_of_it_is() -> None:
    on_the_wall = {prop.name for prop in PROPS if prop.side is not None and abs(prop.low[2]) < 0.2 and prop.high[2] < 1}
    assert {name.split()[0] for name in on_the_wall} == {"wall", "window"}
    assert any("picture" in name for name in on_the_wall)
    for yaw, seen in ((0.0, True), (np.pi, False)):
        shown = around(PROPS, orbit((1.2, 0.9, 1.2), 4.0, yaw, 0.36), BODY, 0)
        names = {prop.name for prop in PROPS if any(prop.solid is solid for solid in shown)}
        assert on_the_wall <= names if seen else not on_the_wall & names


def test_the_outside_of_every_wall_is_outside_and_its_room_behind_it() -> None:
    assert len(SIDES) == 6
    for side in SIDES:
        middle = (side.start + side.end) / 2
        assert HOME.room_at(tuple(middle + 0.1 * side.outward)) is None
        assert side.room == HOME.room_at(tuple(middle - 0.1 * side.outward)) == 0
        assert side.faces(middle - side.outward)
        assert not side.faces(middle + side.outward)
        assert side.crosses(middle + side.outward, np.array([middle - side.outward]))
        assert not side.crosses(middle + side.outward, np.array([middle + 0.01 * side.outward]))
        assert side.distance(middle + 0.3 * side.outward) == pytest.approx(0.3)
        assert side.distance(side.end + (side.end - side.start)) == pytest.approx(np.hypot(*(side.end - side.start)))


WARDROBE = Placed("wardrobe", "wardrobe", (1.2, 0.0, 0.35), (1.2, 2.1, 0.6))
NIGHTSTAND = Placed("nightstand", "nightstand", (2.2, 0.0, 0.3), (0.5, 0.5, 0.4))
FURNISHED = home_from_layouts([replace(CORNERED, windows=(), objects=(WARDROBE, NIGHTSTAND))], 0)


@for_each(("body", "behind", "stays"), [(1.6, True, False), (1.6, False, True), (0.0, True, True)])
def test_what_stands_tall_against_a_wall_goes_with_it_whole_unless_the_body_is_at_it(
    body: float, behind: bool, stays: bool
) -> None:
    props = home_props(FURNISHED)
    (piece,) = (placed for placed in FURNISHED.objects if placed.category == "wardrobe")
    front = piece.to_world(np.array([0.0, 1.0, piece.size[2] / 2]))
    sides = [side for wall in FURNISHED.walls if (side := Side.of(wall, FURNISHED)) is not None]
    wall = next(side for side in sides if side.bears(piece))
    inward = -np.array([wall.outward[0], 0.0, wall.outward[1]])
    points = front + (0.06 + body) * inward + np.array([[0.0, y, 0.0] for y in (-0.9, 0.0, 0.6)])
    eye = points[1] + (-4.5 if behind else 2.0) * inward + [0.0, 0.6, 0.0]
    camera = Camera(tuple(eye.tolist()), tuple(points[1].tolist()))
    shown = around(props, camera, points, 0)
    drawn = [any(one.solid is solid for solid in shown) for one in props if one.name.startswith(piece.id + ":")]
    low = [any(one.solid is solid for solid in shown) for one in props if "nightstand" in one.name]
    assert set(drawn) == {stays}, "whole"
    assert set(low) == {True}, "what is low hides nobody"
