"""Feet that a plan swings through an edge are lifted over it, and others are left where they are."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS
from motion_backend.physics.feet_over_edges import CLEAR, HIGHEST, lift_over_edges
from motion_backend.physics.reference import Doing, Plan, Reference
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()
FRAMES = 60
TOP = 0.4


def swung(height: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """A body whose soles go at a height and a speed (metres a second) along z, past z = 0 in the middle."""
    roots = np.zeros((FRAMES, 3))
    roots[:, 1] = SKELETON.standing_height + height
    roots[:, 2] = (np.arange(FRAMES) - FRAMES / 2) / FPS * speed
    local = np.tile(rotations.IDENTITY, (FRAMES, len(INDEX), 1))
    return roots, local


def bed() -> Obstacles:
    """From z = -0.2 to 0.2, its top at `TOP`."""
    centers, halves = np.array([[0.0, TOP / 2, 0.0]]), np.array([[1.0, TOP / 2, 0.2]])
    return Obstacles(centers, halves, np.zeros(1), ("bed",), np.zeros(1, dtype=bool))


def lift_of(height: float, speed: float) -> np.ndarray:
    roots, local = swung(height, speed)
    return lift_over_edges(*SKELETON.forward_kinematics(roots, local), SKELETON, bed())


def test_a_foot_that_moves_through_an_edge_is_lifted_clear_of_it_and_nowhere_else() -> None:
    lift = lift_of(TOP - 0.05, 1.0)
    assert lift.shape == (FRAMES, 2)
    middle = FRAMES // 2
    assert (lift[middle] >= 0.05 + CLEAR - 1e-3).all()
    assert lift.max() <= HIGHEST
    assert not lift[[0, -1]].any()
    assert np.abs(np.diff(lift, n=2, axis=0)).max() < 0.01, "it comes and goes smoothly"


@pytest.mark.parametrize(("height", "speed"), [(TOP, 0.0), (TOP + 2 * CLEAR, 1.0), (TOP - HIGHEST, 1.0), (0.0, 1.0)])
def test_feet_that_lie_still_or_pass_high_or_far_below_are_left_alone(height: float, speed: float) -> None:
    assert not lift_of(height, speed).any()


@pytest.mark.parametrize("doing", [Doing.LIES, Doing.GOES_DOWN, Doing.WALKS, Doing.OTHER])
def test_only_who_lies_down_lies_or_gets_up_from_a_bed_lifts_feet_over_edges(doing: Doing) -> None:
    roots, local = swung(TOP - 0.05, 1.0)
    plan = Plan(roots, local, np.ones((FRAMES, 4)), np.full(FRAMES, doing, dtype=np.int8))
    with_bed, without = (Reference.of(plan, SKELETON, things) for things in (bed(), None))
    moved = not np.allclose(with_bed.qpos, without.qpos, atol=1e-6)
    assert moved == (doing in (Doing.LIES, Doing.GOES_DOWN))
