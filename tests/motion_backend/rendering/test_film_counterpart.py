"""Who looks out of a window, waits at a door or stands before a mirror is seen with it."""

from __future__ import annotations

from functools import cache

import numpy as np
from upright_body import walking

from motion_backend.motion import Motion
from motion_backend.rendering.film_counterpart import Counterpart, Kind
from motion_backend.rendering.film_shots import film_shots
from motion_backend.scene import scene_of
from planner_service.grounding.opening_places import opening_place
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout, Placed
from scene_graphs.layout_library import built_in_layouts

SIZE = (160, 90)


@cache
def homes() -> tuple[tuple[Home, tuple[float, float, float]], ...]:
    """Some homes with where one stands to look out of a window."""
    made = [home_from_layouts([room], seed=0) for room in built_in_layouts()[:6]]
    found = [(home, opening_place(home, scene_of(home).walkable, "window", 0, None)) for home in made]
    return tuple((home, (*place.standing, place.facing)) for home, place in found if place is not None)


def doors() -> list[tuple[Home, tuple[float, float, float]]]:
    """The same for doors."""
    found = [(home, opening_place(home, scene_of(home).walkable, "door", 0, None)) for home, _ in homes()]
    return [(home, (*place.standing, place.facing)) for home, place in found if place is not None]


def counterpart(home: Home, motion: Motion) -> Counterpart | None:
    return Counterpart.of(home, motion, *seen(motion))


def seen(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """World joints and their rotations."""
    joints, turns = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    return joints.astype(np.float64), turns


def test_who_stands_before_a_window_and_faces_it_is_seen_with_it_from_within():
    assert len(homes()) >= 3
    for home, at in homes():
        motion = walking(at, 0.0)
        found = counterpart(home, motion)
        assert found is not None
        for shot in film_shots(home, motion, [0], SIZE[0] / SIZE[1]):
            eye = np.asarray(shot.camera.eye)
            assert found.side.faces(eye[[0, 2]]), "a window is not seen from without"
            points = np.concatenate([found.corners, motion.joint_positions()[0]])
            x, y, _ = np.moveaxis(shot.camera.project(shot.camera.view(points), SIZE), -1, 0)
            assert ((x >= 0) & (x <= SIZE[0]) & (y >= 0) & (y <= SIZE[1])).all()


def test_who_has_it_at_the_back_or_walks_by_looks_out_of_none():
    for home, (x, z, yaw) in homes():
        away, there = counterpart(home, walking((x, z, yaw + np.pi), 0.0)), counterpart(home, walking((x, z, yaw), 0.0))
        assert there is not None
        assert away is None or not np.allclose(away.corners, there.corners)
        assert counterpart(home, walking((x - 40 * np.sin(yaw), z - 40 * np.cos(yaw), yaw), 0.0)) is None


def test_who_waits_at_a_door_is_seen_with_it_from_within() -> None:
    assert len(doors()) >= 2
    for home, at in doors():
        motion = walking(at, 0.0)
        found = counterpart(home, motion)
        assert found is not None
        assert found.kind is Kind.DOOR
        for shot in film_shots(home, motion, [0], SIZE[0] / SIZE[1]):
            assert found.side.faces(np.asarray(shot.camera.eye)[[0, 2]]), "a door is not seen through"
            x, y, _ = np.moveaxis(shot.camera.project(shot.camera.view(found.corners), SIZE), -1, 0)
            assert ((x >= 0) & (x <= SIZE[0]) & (y >= 0) & (y <= SIZE[1])).all()


def test_who_stands_before_a_mirror_has_its_front_before_them_and_who_is_behind_it_its_back() -> None:
    mirror = Placed("m", "mirror", (2.0, 0.0, 2.0), (0.6, 1.6, 0.08))
    room = Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)), objects=(mirror,))
    home = home_from_layouts([room], seed=0)
    (mirror,) = home.objects
    x, _, z = mirror.position
    ahead = np.asarray(mirror.to_world(np.array([0.0, 0.0, 0.8])))
    yaw = float(np.arctan2(x - ahead[0], z - ahead[2]))
    found = counterpart(home, walking((float(ahead[0]), float(ahead[2]), yaw), 0.0))
    assert found is not None
    assert found.kind is Kind.MIRROR
    assert found.side.faces(ahead[[0, 2]])
    assert not found.side.faces(2 * np.array([x, z]) - ahead[[0, 2]])
    turned = counterpart(home, walking((float(ahead[0]), float(ahead[2]), yaw + np.pi), 0.0))
    assert turned is None or turned.kind is not Kind.MIRROR
