"""How different bodies sit: the same whoever sits where, zero for the same, and what it is for what is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_motions import standing_still, tumbling

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import ContactGoal, Motion, Skill
from planner_service.evaluation import diversity as measured
from planner_service.evaluation.diversity import (
    FRAMES,
    contact_frames,
    diversity,
    local_positions,
    pairwise_distances,
)


def seated(frames: int) -> Motion:
    """A body whose pelvis is where it is to be from its tenth frame on."""
    away = np.zeros((frames, 3))
    away[:10, 0] = 1.0
    still = standing_still(root=away)
    x, y, z = still.root_positions[-1].tolist()
    return replace(still, goals=(ContactGoal("pelvis", (x, y, z)),))


def test_two_seconds_from_the_start_of_the_contact_count() -> None:
    found = contact_frames(seated(100), Skill.SITDOWN)
    assert found is not None
    assert found.shape == (FRAMES, 22, 3) == (60, 22, 3)
    assert np.abs(found[:, 0]).max() == 0, "seen from the pelvis"
    assert contact_frames(seated(70), Skill.SITDOWN) is not None
    assert contact_frames(seated(69), Skill.SITDOWN) is None, "not long enough"
    assert contact_frames(replace(seated(100), goals=()), Skill.SITDOWN) is None


def test_where_and_which_way_a_body_sits_makes_no_difference() -> None:
    motion = tumbling(20)
    turn = rotations.yaw_to_quat(1.3)
    local = motion.local_rotations.astype(np.float64)
    local[:, 0] = rotations.compose(turn, local[:, 0])
    roots = rotations.rotate(turn, motion.root_positions.astype(np.float64)) + np.array([3.0, 0.5, 1.0])
    elsewhere = replace(motion, local_rotations=local.astype(np.float32), root_positions=roots.astype(np.float32))
    here, there = (local_positions(Kinematics.of(one), slice(3, 9)) for one in (motion, elsewhere))
    assert here.shape == (6, 22, 3)
    np.testing.assert_allclose(here, there, atol=1e-5)


def test_distances_are_those_of_two_bodies_all_of_whose_joints_are_so_far_apart() -> None:
    one = np.random.default_rng(0).normal(size=(5, 22, 3))
    apart = one + np.array([0.3, 0.0, 0.4])
    whole, frame = pairwise_distances(np.stack([one, apart]))
    assert frame == pytest.approx(0.5)
    assert whole == pytest.approx(0.5 * np.sqrt(5 * 22))
    assert pairwise_distances(np.stack([one, apart, one]))[1] == pytest.approx(2 * 0.5 / 3)


def test_equal_samples_do_not_differ_and_one_alone_has_no_diversity() -> None:
    one = np.random.default_rng(0).normal(size=(5, 22, 3)).astype(np.float32)
    assert diversity([one]) is None
    assert diversity([one, one]) == {"apd_pos": 0.0, "apd_pos_spread": 0.0, "apd_pos_frame": 0.0, "samples": 2.0}


def test_of_many_samples_a_number_is_drawn_and_the_seed_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measured, "SAMPLES", 7)
    many = list(np.random.default_rng(0).normal(size=(12, 2, 22, 3)).astype(np.float32))
    found = diversity(many, 3)
    assert found is not None
    assert found["samples"] == 7
    assert 0 < found["apd_pos_spread"] < 0.1 * found["apd_pos"]
    assert found == diversity(many, 3) != diversity(many, 4)
