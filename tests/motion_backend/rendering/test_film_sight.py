"""What a camera sees of a body, and what crowds its picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend.motion import Character, Motion
from motion_backend.rendering.film_cuts import Framing, Subject
from motion_backend.rendering.film_sight import Appearances, Look
from motion_backend.rendering.rasterizer import orbit
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import IDENTITY
from motion_backend.skeleton import INDEX, build_skeleton


def with_knees_drawn_up(radians: float) -> Motion:
    """One frame of who stands in the air with the thighs raised that far."""
    skeleton = build_skeleton(Character().height)
    turns = np.tile(np.float32(IDENTITY), (1, len(skeleton.names), 1))
    for hip in ("left_hip", "right_hip"):
        turns[0, INDEX[hip]] = [-np.sin(radians / 2), 0.0, 0.0, np.cos(radians / 2)]
    return Motion(
        root_positions=np.array([[0.0, skeleton.standing_height, 0.0]], np.float32),
        local_rotations=turns,
        contacts=np.ones((1, 4), np.float32),
        skeleton=skeleton,
        actions=np.zeros(1, np.int32),
    )


def face_of(motion: Motion, legs: bool = True) -> Look:
    """How a face is shown by a camera before it; with legs that count or not."""
    seen = Appearances.of(motion, Framing(0, 1, Subject.FACE), 16 / 9)
    x, y, z = motion.joint_positions()[0, INDEX["head"]].tolist()
    return replace(seen, legs=seen.legs & legs).look([], orbit((x, y - 0.15, z), 1.25, 0.0, 0.0))


def test_a_picture_of_a_face_that_is_full_of_thighs_is_none() -> None:
    standing, curled = (with_knees_drawn_up(radians) for radians in (0.0, 2.0))
    assert face_of(standing).enough
    assert not face_of(curled).enough
    assert face_of(curled, legs=False).enough, "nothing hides the face itself"


def standing_with(*solids: Solid) -> float:
    """How much a picture of somebody standing appeals, seen from 4 m before them, with some things in it."""
    motion = with_knees_drawn_up(0.0)
    seen = Appearances.of(motion, Framing(0, 1), 16 / 9)
    return seen.look([WALL, *solids], orbit((0.0, 0.9, 0.0), 4.0, 0.0, 0.1)).appeal


def upright(low: tuple[float, float], high: tuple[float, float], z: float, opacity: float = 1.0) -> Solid:
    """A board across the view from low to high [x, y]."""
    (left, bottom), (right, top) = low, high
    corners = [(left, bottom, z), (right, bottom, z), (right, top, z), (left, top, z)]
    return Solid(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]), opacity=opacity)


WALL = upright((-9.0, 0.0), (9.0, 9.0), -2.5)


def test_the_less_of_a_body_is_seen_and_the_more_stands_before_it_the_less_a_picture_appeals() -> None:
    free = standing_with()
    beside = [standing_with(upright((0.5, 0.0), (0.5 + wide, 2.0), 1.5)) for wide in (0.2, 0.5)]
    before = standing_with(upright((-0.2, 0.0), (0.2, 1.1), 0.6))
    assert free > beside[0] > beside[1]
    assert free > before
    rug = upright((0.5, 0.0), (1.0, 0.2), 1.5)
    assert standing_with(rug) == free, "what lies on the floor stands before nobody"


def test_a_lampshade_behind_a_head_is_a_clutter_and_glass_and_what_is_elsewhere_are_none() -> None:
    head = float(with_knees_drawn_up(0.0).joint_positions()[0, INDEX["head"], 1])
    shade = ((-0.12, head + 0.10), (0.12, head + 0.40))
    free = standing_with()
    assert standing_with(upright(*shade, z=-1.0)) < free - 0.3
    assert standing_with(upright(*shade, z=-1.0, opacity=0.25)) == free
    assert standing_with(upright((0.8, 0.9), (1.1, 1.2), z=-1.0)) == free
