"""Arms of made frames go out of furniture as those of the procedural body do, and nothing else of a body moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.scene_collision import Obstacles
from motion_backend.furniture_clearance import arms_aside
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import chest_frame, solve
from motion_backend.procedural.takeover import poses_of
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

PART = Part(PartKind.WALK, Action(Skill.LOCO, "steadily walking forward", Emotion.NEUTRAL, goal=(0.0, 4.0)))
LEFT_ARM = [INDEX[f"left_{joint}"] for joint in ("shoulder", "elbow")]
REST = [index for index in INDEX.values() if index not in LEFT_ARM]


def walks() -> Motion:
    """Four metres along +Z."""
    skeleton, style = build_skeleton(), walk_style(Emotion.NEUTRAL, "steadily walking forward")
    way = np.array([[0.0, 0.0], [0.0, 4.0]])
    start = standing((0.0, 0.0), 0.0, Bearing(), skeleton)
    pose = walk(start, way, None, style, skeleton, np.random.default_rng(0))
    root, local = solve(pose, skeleton)
    return Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(root), dtype=np.int32),
    )


def beside(motion: Motion, deep: float) -> tuple[Obstacles, int]:
    """A box at the left hand's height that is so deep in its way in mid-walk, and the frame in which it comes by."""
    wrists = motion.joint_positions()[:, INDEX["left_wrist"]].astype(np.float64)
    frame = len(motion) // 2
    y, z = wrists[frame, 1:]
    outside = float(wrists[:, 0].max()) + 0.035
    half = np.array([0.2, 0.3, 0.1])
    center = np.array([outside - deep + half[0], y, z])
    return Obstacles(center[None], half[None], np.zeros(1), ("box",), np.zeros(1, dtype=bool)), frame


def depth(motion: Motion, obstacles: Obstacles) -> Array:
    return penetration(Kinematics.of(motion), obstacles, None)


@pytest.mark.parametrize("deep", [0.04, 0.07])
def test_an_arm_goes_out_of_a_box_and_the_rest_of_the_body_stays(deep: float) -> None:
    motion = walks()
    obstacles, frame = beside(motion, deep)
    aside = arms_aside(motion, PART, obstacles)
    assert depth(motion, obstacles).max() > CLEARLY_IN
    assert depth(aside, obstacles).max() < CLEARLY_IN
    assert np.array_equal(aside.root_positions, motion.root_positions)
    assert np.abs(aside.local_rotations[:, REST] - motion.local_rotations[:, REST]).max() < 1e-6
    away = np.abs(np.arange(len(motion)) - frame) > 45
    assert np.abs(aside.local_rotations[away] - motion.local_rotations[away]).max() < 1e-6


def test_an_arm_goes_there_and_back_without_a_jump() -> None:
    motion = walks()
    obstacles, _ = beside(motion, 0.07)
    hand = INDEX["left_wrist"]
    before, after = (
        np.linalg.norm(np.diff(one.joint_positions()[:, hand].astype(np.float64), 2, axis=0), axis=-1).max()
        for one in (motion, arms_aside(motion, PART, obstacles))
    )
    assert after * motion.fps < before * motion.fps + 0.2


def test_arms_that_are_in_nothing_are_left_as_they_are() -> None:
    motion = walks()
    far = Obstacles(np.array([[9.0, 0.5, 0.0]]), np.full((1, 3), 0.2), np.zeros(1), ("box",), np.zeros(1, dtype=bool))
    assert arms_aside(motion, PART, far) is motion


def test_a_body_is_told_in_handles_that_put_its_wrists_and_feet_where_they_are() -> None:
    motion = walks()
    bent = motion.local_rotations.copy()
    # A body whose spine does not bend in equal parts, as recorded ones do not.
    bent[:, [INDEX["spine1"], INDEX["spine3"]]] = bent[:, [INDEX["spine3"], INDEX["spine1"]]]
    body = replace(motion, local_rotations=bent)
    root, local, contacts = (
        one.astype(np.float64) for one in (body.root_positions, body.local_rotations, body.contacts)
    )
    pose = poses_of(root, local, contacts, body.skeleton)
    root, local = solve(pose, body.skeleton)
    found = body.skeleton.forward_kinematics(root, local)[0]
    ends = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("wrist", "ankle")]
    assert np.abs(found[:, ends] - body.joint_positions()[:, ends]).max() < 0.01
    assert len(chest_frame(pose, body.skeleton)[0]) == len(body)
