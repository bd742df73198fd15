"""Elbows swing out of what is solid; hands stay where they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.collision_avoidance.elbow_collision import elbows_clear
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton()
HIPS = standing((0.0, 0.0), 0.0, Bearing(arms=("hips", "hips")), SKELETON).repeat(60)


def boxes(*rows: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Obstacles:
    centers, halves = zip(*rows, strict=True)
    names = tuple(f"0/{number}" for number in range(len(rows)))
    return Obstacles(np.array(centers), np.array(halves), np.zeros(len(rows)), names, np.zeros(len(rows), dtype=bool))


def joints(pose: Pose, name: str) -> np.ndarray:
    root, local = solve(pose, SKELETON)
    return SKELETON.forward_kinematics(root, local)[0].astype(np.float64)[:, INDEX[name]]


def wall_at(x: float) -> Obstacles:
    return boxes(((x + 0.05, 1.3, 0.0), (0.05, 1.3, 2.0)))


@pytest.mark.parametrize("into", [0.02, 0.05, 0.08])
def test_an_elbow_in_a_wall_swings_out_and_the_hand_stays(into: float) -> None:
    wall = wall_at(joints(HIPS, "left_elbow")[0, 0] + 0.042 - into)
    swung = elbows_clear(HIPS, SKELETON, wall)
    assert wall.depth(joints(HIPS, "left_elbow")[-1:])[0] > -0.04
    assert wall.depth(joints(swung, "left_elbow")[-1:])[0] < -0.04
    np.testing.assert_allclose(joints(swung, "left_wrist"), joints(HIPS, "left_wrist"), atol=1e-6)


def test_a_segment_begins_with_the_elbows_it_was_given_and_never_snaps() -> None:
    swung = joints(elbows_clear(HIPS, SKELETON, wall_at(joints(HIPS, "left_elbow")[0, 0])), "left_elbow")
    np.testing.assert_allclose(swung[0], joints(HIPS, "left_elbow")[0], atol=1e-9)
    assert np.linalg.norm(np.diff(swung, axis=0), axis=1).max() < 0.05


def test_who_drifts_towards_a_wall_swings_the_elbow_out_where_it_would_be_in_it() -> None:
    way = np.linspace(0.0, 0.12, len(HIPS))[:, None] * [1.0, 0.0, 0.0]
    drifting = replace(HIPS, pelvis=HIPS.pelvis + way, ankles=HIPS.ankles + way[:, None])
    wall = wall_at(joints(drifting, "left_elbow")[-1, 0] - 0.02)
    swung = elbows_clear(drifting, SKELETON, wall)
    before, after = (wall.depth(joints(pose, "left_elbow")) for pose in (drifting, swung))
    assert before.max() == pytest.approx(0.02, abs=0.005)
    assert before[:20].max() < -0.03
    assert after.max() < -0.03


def test_arms_that_are_clear_are_left_alone() -> None:
    swung = elbows_clear(HIPS, SKELETON, wall_at(joints(HIPS, "left_elbow")[0, 0] + 0.06))
    assert (swung.elbows == HIPS.elbows).all()
