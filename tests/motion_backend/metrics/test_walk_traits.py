"""Numbers of one second of walking are those that one would measure with ruler and protractor."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend.metrics.walk_traits import traits
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, build_skeleton

FRAMES = 31


def standing(frames: int = FRAMES) -> Array:
    """Arms stretched out to the sides, toes on the floor. (1, T, 22, 3)."""
    return np.tile(build_skeleton().rest_positions, (1, frames, 1, 1))


def only(joints: Array) -> dict[str, float]:
    return {name: float(values[0]) for name, values in traits(joints).items()}


def test_a_body_in_its_rest_pose_has_straight_knees_and_elbows_an_upright_trunk_and_level_arms() -> None:
    found = only(standing())
    for name, degrees in {
        "knee bend": 0, "elbow bend": 0, "thigh forward": 0, "trunk pitch": 0, "trunk roll": 0, "trunk twist": 0,
        "pelvis roll": 0, "pelvis yaw": 0, "shoulder roll": 0, "arm outwards": 90, "toes outwards": 0,
    }.items():  # fmt: skip
        assert found[f"{name}, °: mean"] == pytest.approx(degrees, abs=3), name
    assert found["ankle outwards, cm: mean"] == pytest.approx(8.8, abs=0.1)
    assert found["speed, m/s"] == 0
    assert max(value for name, value in found.items() if "movement" in name) < 1e-9


def test_who_walks_a_metre_in_a_second_walks_at_that_speed() -> None:
    joints = standing()
    joints[..., 2] += np.linspace(0, 1, FRAMES)[:, None]
    # A window of one second has one frame more than steps.
    assert only(joints)["speed, m/s"] == pytest.approx(FRAMES / (FRAMES - 1))


def test_a_foot_lifted_half_of_the_time_counts_in_mean_and_movement_beside_the_other_and_not_in_the_lowest() -> None:
    before, joints = only(standing(40)), standing(40)
    joints[:, :20, INDEX["left_ankle"], 1] += 0.10
    after = only(joints)
    height = "ankle height, cm"
    assert after[f"{height}: mean"] - before[f"{height}: mean"] == pytest.approx(2.5)
    assert after[f"{height}: movement"] == pytest.approx(2.5)
    assert after[f"{height}: left beside right"] == pytest.approx(5)
    assert after[f"{height}: movement, left beside right"] == pytest.approx(5)
    assert after[f"{height}: lowest"] == pytest.approx(before[f"{height}: lowest"])
    changed = {name.split(",")[0] for name in after if after[name] != pytest.approx(before[name], abs=1e-6)}
    assert changed <= {"ankle height", "knee bend", "toes outwards"}


def test_a_mirrored_body_has_the_same_traits_but_for_those_of_the_middle_which_change_their_sign() -> None:
    rng = np.random.default_rng(2)
    joints = standing() + 0.03 * rng.standard_normal((1, FRAMES, len(JOINTS), 3))
    other = {"left": "right", "right": "left"}
    swapped = [
        INDEX[f"{other[side]}_{part}"] if (side := name.partition("_")[0]) in other and (part := name.partition("_")[2])
        else INDEX[name]
        for name in JOINTS
    ]  # fmt: skip
    before, after = only(joints), only(joints[:, :, swapped] * [-1.0, 1.0, 1.0])
    aside = ("pelvis aside", "pelvis roll", "pelvis yaw", "shoulder roll", "shoulder yaw", "trunk twist", "trunk roll")
    for name, value in before.items():
        sign = -1 if name.startswith(aside) and name.endswith("mean") else 1
        assert after[name] == pytest.approx(sign * value, abs=1e-5), name


def test_arms_that_swing_together_or_against_each_other_and_against_legs_are_told_apart() -> None:
    beat = 0.2 * np.sin(2 * np.pi * np.arange(FRAMES) / FRAMES)
    for right, leg in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)):
        joints = standing()
        for side in ("left", "right"):  # arms that hang
            joints[:, :, INDEX[f"{side}_wrist"]] = joints[:, :, INDEX[f"{side}_shoulder"]] - [0.0, 0.5, 0.0]
        joints[0, :, INDEX["left_wrist"], 2] += beat
        joints[0, :, INDEX["right_wrist"], 2] += right * beat
        joints[0, :, INDEX["right_knee"], 2] += leg * beat
        joints[0, :, INDEX["left_knee"], 2] += leg * right * beat
        found = only(joints)
        assert found["arms, left with right: correlation"] == pytest.approx(right, abs=0.02)
        assert found["arm with the other leg: correlation"] == pytest.approx(leg, abs=0.02)
        assert found["arm forward, °: movement"] == pytest.approx(np.degrees(np.arctan(beat / 0.5)).std(), rel=0.02)


def test_what_trembles_has_more_jerk_and_only_where_it_trembles() -> None:
    before, joints = only(standing()), standing()
    joints[0, :, INDEX["left_wrist"]] += 0.01 * (np.arange(FRAMES) % 2)[:, None]
    after = only(joints)
    assert before["wrists, m/s³: jerk"] == before["trunk, m/s³: jerk"] == after["trunk, m/s³: jerk"] == 0
    assert after["wrists, m/s³: jerk"] > 100
