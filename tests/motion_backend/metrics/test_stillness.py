"""Nothing that lives is frozen: a body is where none of its joints moves, and a recorded one never is."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from sample_motions import standing_still

from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.stillness import FROZEN, fastest_speeds, frozen_share
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.retarget import retarget
from motion_backend.motion import FPS
from motion_backend.skeleton import INDEX

CLIPS = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "motion"
QUIET = ("mit_bvh/fair1_wave_hello.bvh", "deepmimic/humanoid3d_getup_faceup.txt")
"""Recorded people who stand about and wave, and who get up and stop."""


def swaying(speed: float, frames: int = 61) -> Kinematics:
    """A body that goes to and fro at a steady speed (m/s)."""
    way = np.abs(np.arange(frames) % 20 - 10) * speed / FPS
    return Kinematics.of(standing_still(root=np.outer(way, [1.0, 0.0, 0.0])))


def test_a_statue_is_frozen_in_every_frame_and_a_body_that_sways_is_in_none() -> None:
    assert frozen_share(Kinematics.of(standing_still())) == 1.0
    assert frozen_share(swaying(2 * FROZEN)) == 0.0
    assert frozen_share(swaying(FROZEN / 2)) == 1.0


def test_one_joint_that_moves_is_life() -> None:
    motion = standing_still()
    motion.local_rotations[:, INDEX["neck"], 0] = 0.02 * np.sin(np.arange(len(motion)))
    assert frozen_share(Kinematics.of(motion)) < 0.1


def test_the_speed_of_a_frame_is_that_of_its_fastest_joint() -> None:
    assert fastest_speeds(swaying(0.5))[1:9] == pytest.approx(0.5, rel=1e-3)
    assert not np.isfinite(fastest_speeds(Kinematics.of(standing_still(1)))).any()


@pytest.mark.skipif(not CLIPS.is_dir(), reason="SIMS_TEST_DATA holds no motion")
def test_recorded_people_are_never_frozen() -> None:
    motions = [retarget(clip).motion for name in QUIET for clip in read_clips(CLIPS / name)]
    assert [frozen_share(Kinematics.of(motion)) for motion in motions] == [0.0] * len(motions)
