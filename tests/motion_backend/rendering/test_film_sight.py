"""What a camera sees of a body, and what crowds its picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend.motion import Character, Motion
from motion_backend.rendering.film_cuts import Framing, Subject
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.rasterizer import orbit
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


def face_of(motion: Motion, legs: bool = True) -> float:
    """How well a face is shown by a camera before it; with legs that count or not."""
    seen = Appearances.of(motion, Framing(0, 1, Subject.FACE), 16 / 9)
    x, y, z = motion.joint_positions()[0, INDEX["head"]].tolist()
    return replace(seen, legs=seen.legs & legs).shown([], orbit((x, y - 0.15, z), 1.25, 0.0, 0.0))


def test_a_picture_of_a_face_that_is_full_of_thighs_is_none() -> None:
    standing, curled = (with_knees_drawn_up(radians) for radians in (0.0, 2.0))
    assert Appearances.enough(face_of(standing))
    assert not Appearances.enough(face_of(curled))
    assert Appearances.enough(face_of(curled, legs=False)), "nothing hides the face itself"
