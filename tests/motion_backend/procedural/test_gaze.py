"""Where the eyes go: heads turn to what is looked at, as far as heads turn, and let go of it again."""

from __future__ import annotations

import numpy as np
import pytest
from acted import touched

from motion_backend import rotations
from motion_backend.motion import FPS, Posture
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.gaze import Look, gaze_table, turned_to
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON, FRAMES = build_skeleton(1.70), 2 * FPS
STANDING = standing((0.0, 0.0), 0.0, Bearing(), SKELETON).repeat(FRAMES)
NEAR: float = float(np.radians(25))


def looking(target: tuple[float, float, float], posture: Posture = Posture.STANDING) -> Pose:
    """A body at the origin, facing +Z, that looks somewhere all the time."""
    return turned_to(STANDING, [Look(np.array(target), np.ones(FRAMES))], posture, SKELETON, gaze_table())


def off_target(pose: Pose, target: tuple[float, float, float]) -> Array:
    """Angle between where the head points and the target. (T,) radians."""
    positions, world = SKELETON.forward_kinematics(*solve(pose, SKELETON))
    ahead = rotations.rotate(world[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
    way = rotations.normalize(np.asarray(target) - positions[:, INDEX["head"]])
    return np.asarray(np.arccos(np.clip(np.sum(ahead * way, axis=1), -1.0, 1.0)))


@pytest.mark.parametrize("target", [(0.5, 0.9, 0.5), (-1.5, 1.6, 1.0), (0.0, 0.75, 0.9), (2.0, 2.2, 2.0)])
def test_a_head_comes_to_point_at_what_is_looked_at(target: tuple[float, float, float]) -> None:
    angle = off_target(looking(target), target)
    assert angle[-1] < np.radians(10)
    assert angle[0] == pytest.approx(off_target(STANDING, target)[0], abs=1e-6)


def test_nobody_looks_behind_himself_or_turns_his_head_further_than_it_goes() -> None:
    for angle in np.radians(np.arange(-180, 180, 15)):
        pose = looking((3 * np.sin(angle), 0.2, 3 * np.cos(angle)))
        assert np.abs(pose.head - STANDING.head).max() < np.radians(75)
        assert np.abs(np.diff(pose.head, axis=0)).max() * FPS < 6.0
    np.testing.assert_allclose(looking((0.0, 1.5, -3.0)).head, STANDING.head, atol=1e-6)


def test_the_head_of_who_lies_only_rolls_on_its_pillow() -> None:
    pose = looking((3.0, 0.0, 1.0), Posture.LYING)
    np.testing.assert_allclose(pose.spine, STANDING.spine)
    assert 0.2 < pose.head[-1, 1] < 0.5


def test_in_the_second_before_a_hand_is_there_the_head_points_at_the_thing() -> None:
    for piece, height, caption in (
        ("shelf", "medium", "touch medium height"),
        ("table", "medium", "touch medium height"),
    ):
        body = touched(piece, height, caption)
        spot, motion = body.action.spot, body.motion
        assert spot is not None
        positions, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
        there = int(np.argmin(np.linalg.norm(body.at("right_wrist") - np.array(motion.goals[0].position), axis=1)))
        before = slice(max(there - FPS // 2, 0), there)
        ahead = rotations.rotate(world[before, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
        way = rotations.normalize(np.asarray(spot.point) - positions[before, INDEX["head"]])
        assert (np.arccos(np.sum(ahead * way, axis=1)) < NEAR).mean() > 0.6, caption
