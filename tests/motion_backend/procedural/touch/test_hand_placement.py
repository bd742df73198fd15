"""How hands lie on what they touch: with their skin on it, and on nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import skin
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.touch.hand_captions import Laid
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.touch.hand_placement import Depth
from motion_backend.procedural.touch.reach import Manner, touch
from motion_backend.procedural.touch.touch_keys import touch_keys
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, INDEX, build_skeleton

SKELETON, MANNEQUIN, KEYS = build_skeleton(1.70), build_mannequin(build_skeleton(1.70)), touch_keys()
UP, BACK = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])


def nothing(points: Array) -> Array:
    """Nowhere is anything."""
    return np.full(len(points), -1.0)


def hand_on(height: float, normal: Array, hand: str, depth: Depth = nothing) -> tuple[Array, Array]:
    """The skin of a hand (V, 3) laid on a surface at that height before a body at the origin, and where its fingers
    point."""
    ahead = 0.45
    goal = np.array([0.0, height, ahead]) + HAND_REST * normal
    laid = Laid(goal, palm_on(normal, 0.0, hand), normal, hand)
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    whole = touch(start, laid, Manner(Bearing(), 1.2), SKELETON, depth, KEYS, np.random.default_rng(0))
    root, local = solve(whole, SKELETON)
    wrists = SKELETON.forward_kinematics(root, local)[0][:, INDEX[f"{hand}_wrist"]]
    at = slice(int(np.argmin(np.linalg.norm(wrists - goal, axis=1))), None, len(whole))
    points = skin(MANNEQUIN, SKELETON, root[at], local[at])[0][0]
    own = MANNEQUIN.joints[np.arange(len(points)), MANNEQUIN.weights.argmax(axis=1)] == INDEX[f"{hand}_wrist"]
    world = SKELETON.forward_kinematics(root[at], local[at])[1][0, INDEX[f"{hand}_wrist"]]
    return points[own], rotations.rotate(world, np.array([1.0 if hand == "left" else -1.0, 0.0, 0.0]))


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize(("height", "normal"), [(0.75, UP), (0.95, UP), (0.45, BACK), (1.0, BACK), (1.15, BACK)])
def test_the_skin_of_a_hand_meets_the_surface_and_is_not_in_it(height: float, normal: Array, hand: str) -> None:
    points, _ = hand_on(height, normal, hand)
    over = (points - [0.0, height, 0.45]) @ normal
    assert -0.015 < over.min() < 0.025


def test_fingers_turn_aside_where_something_stands_before_them() -> None:
    def row_of_books(points: Array) -> Array:
        return np.asarray(np.where(points[:, 1] > 0.83, points[:, 2] - 0.52, -1.0))

    free, straight = hand_on(0.83, UP, "left")
    shelved, aside = hand_on(0.83, UP, "left", row_of_books)
    assert row_of_books(free).max() > 0.06
    assert row_of_books(shelved).max() < 0.02
    assert straight[2] > aside[2] + 0.3
