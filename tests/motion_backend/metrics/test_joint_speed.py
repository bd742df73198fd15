"""Joints turn as fast as they were made to turn, and only what is wild by name may be faster than people."""

from __future__ import annotations

import numpy as np
import pytest
from acted import Body, lain, risen_from, sat, touched, walked
from for_each import for_each
from sample_motions import standing_still, tumbling

from motion_backend import rotations
from motion_backend.metrics.joint_speed import MOST, WILD, fastest_joint, joint_speeds
from motion_backend.motion import FPS
from motion_backend.skeleton import INDEX
from planner_service.scripts.captions import captions

SAMPLES = {
    "walk": lambda: walked("smoothly forward walk"),
    "march": lambda: walked("marching with swinging arms"),
    "stomp": lambda: walked("stomping heavily"),
    "sit on a chair": lambda: sat("chair", "sitting still"),
    "lie on a bed": lambda: lain("bed", "lying still"),
    "lie on the floor": lambda: lain("floor", "lying still"),
    "stand up": lambda: risen_from("chair", "stand up"),
    "touch": lambda: touched("shelf", "medium", "touch medium height", home="hall"),
}


def test_a_joint_that_turns_steadily_turns_at_its_own_speed_whatever_the_sign_of_its_quaternions() -> None:
    motion = standing_still(40)
    local = motion.local_rotations.astype(np.float64)
    local[:, INDEX["left_wrist"]] = rotations.axis_to_quat("y", np.arange(40) * 3.0 / FPS)
    local[::2] *= -1
    speeds = joint_speeds(local, FPS)
    assert speeds[:, INDEX["left_wrist"]] == pytest.approx(3.0, rel=1e-6)
    assert np.delete(speeds, INDEX["left_wrist"], axis=1).max() == 0
    joint, speed = fastest_joint(local, FPS)
    assert joint == "left_wrist"
    assert speed == pytest.approx(3.0, rel=1e-6)


def test_speeds_are_the_same_in_a_mirror_backwards_and_at_another_rate() -> None:
    local = tumbling(30).local_rotations
    speeds = joint_speeds(local, FPS)
    assert joint_speeds(local[::-1], FPS) == pytest.approx(speeds[::-1])
    assert joint_speeds(local * np.array([1, -1, -1, 1]), FPS) == pytest.approx(speeds)
    assert joint_speeds(local, 2 * FPS) == pytest.approx(2 * speeds)
    assert fastest_joint(local[:1], FPS) == ("", 0.0)


def test_what_is_wild_by_name_is_among_the_captions() -> None:
    assert {caption for some in captions().values() for caption in some} >= WILD


@for_each("name", list(SAMPLES))
def test_no_joint_of_a_sample_is_faster_than_a_person_turns_it(name: str) -> None:
    body: Body = SAMPLES[name]()
    joint, speed = fastest_joint(body.motion.local_rotations, FPS)
    assert speed <= MOST, f"{joint} turns at {speed:.0f} rad/s"
