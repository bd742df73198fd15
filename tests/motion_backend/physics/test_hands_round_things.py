"""Hands that would swing close by a board are drawn back until they are past it, and end where they were to."""

from __future__ import annotations

from functools import cache

import numpy as np
from acted import touched

from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS
from motion_backend.physics.hands_round_things import hands_round_things
from motion_backend.physics.reference import Plan
from motion_backend.physics.task import plan_of
from motion_backend.skeleton import INDEX, Skeleton

HALF = np.array([0.3, 0.3, 0.01])


@cache
def reach() -> tuple[Plan, Skeleton, int]:
    """A touch, its body, and which hand it is done with: the one that comes to be highest."""
    motion = touched("shelf", "high", "touch high height").motion
    wrists = [INDEX["left_wrist"], INDEX["right_wrist"]]
    return plan_of(motion), motion.skeleton, wrists[int(motion.joint_positions()[:, wrists, 1].max(axis=0).argmax())]


def positions(local: np.ndarray) -> np.ndarray:
    plan, skeleton, _ = reach()
    return skeleton.forward_kinematics(plan.roots, local)[0].astype(np.float64)


def speeds(places: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.gradient(places, axis=0), axis=-1) * FPS


def board_at(point: np.ndarray) -> Obstacles:
    return Obstacles(point[None], HALF[None], np.zeros(1), ("board",), np.zeros(1, dtype=bool))


def before_swing() -> tuple[Obstacles, int]:
    """A board just before the hand where that is quickest, upright and across the way to the shoulder."""
    plan, _, wrist = reach()
    places = positions(plan.local)
    quickest = int(speeds(places[:, wrist]).argmax())
    outwards = places[quickest, wrist] - places[quickest, INDEX["neck"]]
    yaw = float(np.arctan2(outwards[0], outwards[2]))
    board = board_at(places[quickest, wrist] + 0.1 * np.array([np.sin(yaw), 0.0, np.cos(yaw)]))
    return Obstacles(board.centers, board.halves, np.array([yaw]), board.owners, board.soft), quickest


def test_a_hand_is_drawn_back_from_a_board_that_it_swings_by_and_comes_to_rest_where_it_was_to() -> None:
    plan, skeleton, wrist = reach()
    board, quickest = before_swing()
    planned = positions(plan.local)
    found = hands_round_things(plan.roots, plan.local, plan.reaching, skeleton, board)
    led = positions(found)
    nearer = board.inside(planned[:, wrist], 0)[quickest] - board.inside(led[:, wrist], 0)[quickest]
    assert nearer > 0.05
    height = planned[:, wrist, 1]
    touches = (speeds(planned[:, wrist]) < 0.05) & (height > height.max() - 0.02)
    assert touches.any()
    np.testing.assert_allclose(led[touches], planned[touches], atol=2e-3)
    np.testing.assert_allclose(led[0], planned[0], atol=1e-5)
    assert speeds(led[:, wrist]).max() < 2 * speeds(planned[:, wrist]).max(), "the hand jumps"


def test_only_the_arm_that_is_in_the_way_is_moved() -> None:
    plan, skeleton, wrist = reach()
    led = positions(hands_round_things(plan.roots, plan.local, plan.reaching, skeleton, before_swing()[0]))
    side = "left" if wrist == INDEX["left_wrist"] else "right"
    others = [index for name, index in INDEX.items() if name not in (f"{side}_elbow", f"{side}_wrist")]
    np.testing.assert_allclose(led[:, others], positions(plan.local)[:, others], atol=1e-5)


def test_a_hand_is_not_drawn_back_from_what_it_is_to_touch() -> None:
    plan, skeleton, wrist = reach()
    places = positions(plan.local)
    rests = int(np.flatnonzero(plan.reaching & (speeds(places[:, wrist]) < 0.1))[-1])
    for point in (places[rests, wrist], places[rests, wrist] + np.array([0.0, 3.0, 0.0])):
        found = hands_round_things(plan.roots, plan.local, plan.reaching, skeleton, board_at(point))
        np.testing.assert_array_equal(found, plan.local)


def test_who_reaches_for_nothing_is_left_alone() -> None:
    plan, skeleton, _ = reach()
    never = np.zeros(len(plan), dtype=bool)
    assert hands_round_things(plan.roots, plan.local, never, skeleton, before_swing()[0]) is plan.local
