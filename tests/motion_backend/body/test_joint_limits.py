"""Joints within and beyond what a body can do, and a body that is in itself."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from small_home import contact, small_home

from motion_backend import rotations
from motion_backend.body.joint_limits import (
    CLEARLY,
    beyond_limits,
    cardan,
    limits_share,
    overbent,
    within,
    worst_joint,
)
from motion_backend.body.self_collision import deepest_pair, overlaps, pairs, self_penetration
from motion_backend.director import Director
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.retarget import retarget
from motion_backend.motion import Character, Motion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import hips_within, solve
from motion_backend.skeleton import INDEX, JOINTS, build_skeleton

WALKS = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "motion" / "cmu_bvh"
AXES = np.eye(3)
T_POSE = np.tile(rotations.IDENTITY, (1, 22, 1))
SKELETON = build_skeleton()


def bent(joint: str, axis: str, degrees: float) -> np.ndarray:
    """The T-pose with one joint turned. (1, 22, 4)."""
    local = T_POSE.copy()
    local[0, INDEX[joint]] = rotations.rotvec_to_quat(AXES["xyz".index(axis)] * np.radians(degrees))
    return local


def kinematics(local: np.ndarray) -> Kinematics:
    root = np.tile([0.0, SKELETON.standing_height, 0.0], (len(local), 1)).astype(np.float32)
    feet = np.ones((len(local), 4), np.float32)
    return Kinematics.of(Motion(root, local.astype(np.float32), feet, SKELETON, np.zeros(len(local), np.int32)))


def depth(local: np.ndarray) -> float:
    body = kinematics(local)
    return float(self_penetration(SKELETON, body.positions, body.world)[0])


def test_a_t_pose_is_within_every_limit_and_so_is_a_pelvis_however_it_turns() -> None:
    assert not beyond_limits(T_POSE).any()
    assert not beyond_limits(bent("pelvis", "x", 170)).any()
    assert worst_joint(T_POSE) == ("", 0.0)


@for_each(
    ("joint", "axis", "within", "beyond"),
    [
        ("knee", "x", 145, -20), ("elbow", "y", -150, 25), ("hip", "x", -120, 50), ("ankle", "x", 45, -60),
        ("foot", "x", -60, 70), ("wrist", "z", -80, -110), ("shoulder", "z", -80, 150), ("shoulder", "y", -110, 120),
        ("collar", "z", 30, -40),
    ],
)  # fmt: skip
def test_hinges_bend_one_way_and_both_sides_alike(joint: str, axis: str, within: float, beyond: float) -> None:
    for side, sign in (("left", 1.0), ("right", 1.0 if axis == "x" else -1.0)):
        assert not beyond_limits(bent(f"{side}_{joint}", axis, sign * within)).any()
        found = beyond_limits(bent(f"{side}_{joint}", axis, sign * beyond))
        assert found[0, INDEX[f"{side}_{joint}"]] > CLEARLY
        assert np.count_nonzero(found) == 1


def test_it_is_told_by_how_much_and_for_how_long() -> None:
    local = np.concatenate([T_POSE, T_POSE, T_POSE, bent("left_knee", "x", -15)])
    joint, beyond = worst_joint(local)
    assert joint == "left_knee"
    assert beyond == pytest.approx(np.radians(10))
    assert limits_share(local) == 0.25
    assert limits_share(bent("left_knee", "x", -9)) == 0.0


@given(arrays(float, 3, elements=st.floats(-1.5, 1.5)), st.permutations("xyz"))
def test_cardan_angles_make_the_rotation_again(angles: np.ndarray, order: list[str]) -> None:
    turn = rotations.IDENTITY
    for axis, angle in zip(order, angles, strict=True):
        turn = rotations.compose(turn, rotations.rotvec_to_quat(AXES["xyz".index(axis)] * angle))
    np.testing.assert_allclose(cardan(turn, "".join(order)), angles, atol=1e-6)


@given(arrays(float, (22, 3), elements=st.floats(-2.0, 2.0)))
def test_a_body_in_a_mirror_is_as_far_beyond(turns: np.ndarray) -> None:
    local = rotations.rotvec_to_quat(turns)[None]
    partner = [JOINTS.index(_other(name)) for name in JOINTS]
    mirrored = local[:, partner] * np.array([1.0, -1.0, -1.0, 1.0])
    # The middle of the body is its own mirror image, and its ranges are alike to both sides.
    np.testing.assert_allclose(beyond_limits(mirrored), beyond_limits(local)[:, partner], atol=1e-7)


def _other(name: str) -> str:
    if name.startswith("left_"):
        return "right_" + name[5:]
    return "left_" + name[6:] if name.startswith("right_") else name


def test_sitting_standing_and_lying_bodies_are_within_their_limits() -> None:
    home, backend = small_home(), Director(ProceduralBackend())
    for skill, name in ((Skill.SITDOWN, "chair"), (Skill.LIEDOWN, "bed")):
        caption = "sitting still" if skill is Skill.SITDOWN else "lying still"
        motion, _ = backend.act(home, contact(home, skill, name, caption), backend.begin(home, Character(), 1))
        assert limits_share(motion.local_rotations[[0, -1]]) == 0.0
        assert limits_share(motion.local_rotations) < 0.1


@pytest.mark.skipif(not WALKS.is_dir(), reason="SIMS_TEST_DATA holds no motion/cmu_bvh")
@pytest.mark.parametrize("name", ["07_01", "16_22", "35_17"])
def test_recorded_people_walk_and_run_within_the_limits_and_hardly_touch_themselves(name: str) -> None:
    body = Kinematics.of(retarget(read_clips(WALKS / f"{name}.bvh")[0]).motion)
    assert limits_share(body.motion.local_rotations) == 0.0
    assert self_penetration(SKELETON, body.positions, body.world).max() < 0.04


def test_a_t_pose_is_nowhere_in_itself() -> None:
    assert depth(T_POSE) == 0.0


def test_a_forearm_through_the_head_and_a_leg_through_the_other_are_seen() -> None:
    arm = bent("left_elbow", "y", -150)
    arm[0, INDEX["left_shoulder"]] = rotations.rotvec_to_quat(np.array([0.0, -1.9, 0.3]))
    assert depth(arm) > 0.02
    leg = bent("left_hip", "z", -14)
    body = kinematics(leg)
    assert depth(leg) > 0.03
    assert deepest_pair(SKELETON, body.positions, body.world)[0].startswith("left_")


def test_the_depth_of_two_crossed_bars_is_their_radii_less_their_distance() -> None:
    # The right leg goes back by as much as the left goes in: thighs and shins cross at the middle.
    body = kinematics(T_POSE)
    moved = body.positions.copy()
    left, right = INDEX["left_knee"], INDEX["right_knee"]
    moved[:, right] = moved[:, left] + np.array([0.0, 0.0, 0.05])
    found = overlaps(SKELETON, moved, body.world)[0]
    assert found[pairs().index(("left_shin", "right_shin"))] == pytest.approx(2 * 0.046 - 0.05, abs=1e-6)


def test_overlaps_know_no_time() -> None:
    local = np.concatenate([T_POSE, bent("left_hip", "z", -14), T_POSE])
    body = kinematics(local)
    together = overlaps(SKELETON, body.positions, body.world)
    alone = kinematics(local[1:2])
    np.testing.assert_allclose(together[1:2], overlaps(SKELETON, alone.positions, alone.world))


@given(
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
    st.sampled_from(["left_ankle", "right_ankle", "left_hip", "right_knee"]),
    st.booleans(),
)
def test_a_joint_is_brought_within_its_range_but_one_that_bears_may_bend_deeper(
    vector: list[float], joint: str, loaded: bool
) -> None:
    turn = rotations.rotvec_to_quat(np.array([vector]) / 2)
    beyond = np.tile(rotations.IDENTITY, (1, len(JOINTS), 1))
    beyond[:, INDEX[joint]] = within(joint, turn, loaded)
    deeper = max(-float(overbent(joint, turn)[0, 0]), 0.0) if loaded else 0.0
    assert beyond_limits(beyond)[0, INDEX[joint]] == pytest.approx(deeper, abs=1e-6)


@given(st.floats(0.0, 0.9), st.floats(-0.9, 1.2))
def test_a_body_folded_or_stretched_too_far_tips_its_pelvis_and_leaves_legs_and_trunk_where_they_are(
    drop: float, lean: float
) -> None:
    skeleton = build_skeleton()
    upright = standing((0.0, 0.0), 0.3, Bearing(), skeleton)
    pitch = rotations.compose(rotations.yaw_to_quat(0.3), rotations.rotvec_to_quat(np.array([lean, 0.0, 0.0])))
    folded = replace(upright, pelvis=upright.pelvis - [0.0, 0.75 * drop, 0.0], hips=pitch).repeat(40)
    kept = hips_within(folded, skeleton)
    before, after = (solve(pose, skeleton) for pose in (folded, kept))
    hips = [INDEX["left_hip"], INDEX["right_hip"]]
    assert np.all(np.abs(overbent("left_hip", after[1][:, hips[0]])[:, 0]) < 0.02)
    legs = [INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("hip", "knee", "ankle")]
    there, here = (skeleton.forward_kinematics(*made) for made in (before, after))
    np.testing.assert_allclose(there[0][:, legs], here[0][:, legs], atol=1e-5)
    chest = INDEX["spine3"]
    turned = rotations.compose(rotations.inverse(there[1][:, chest]), here[1][:, chest])
    assert np.linalg.norm(rotations.quat_to_rotvec(turned), axis=-1).max() < 1e-6
