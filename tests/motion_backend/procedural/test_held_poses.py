"""Who holds a pose lives: breathes, shifts the weight, looks about; and seats are where their spots say."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import Seat, alive, idle, standing
from motion_backend.procedural.pose import Pose
from motion_backend.skeleton import SEATED_REST, build_skeleton
from scene_graphs.affordances.affordances import floor_spot

SKELETON = build_skeleton(1.70)
FORWARD, TURN, SIDE = range(3)


def stood() -> Pose:
    return standing((0.0, 0.0), 0.0, Bearing(), SKELETON)


@cache
def held(size: float = 1.0, lies: bool = False, seconds: float = 60.0) -> Pose:
    """The same chance for all."""
    pose = stood()
    if lies:
        pose.hips[:] = rotations.axis_to_quat("x", np.array(-np.pi / 2))
    return idle(pose, seconds, size, np.random.default_rng(4), FPS)


def test_who_stands_breathes_fifteen_times_a_minute_or_so_and_sways_by_millimetres() -> None:
    pose = held()
    power = np.abs(np.fft.rfft(pose.arms[:, 0, 2] - pose.arms[:, 0, 2].mean()))
    assert 12 <= 60 * np.fft.rfftfreq(len(pose), 1 / FPS)[power.argmax()] <= 20
    sway = pose.pelvis - stood().pelvis
    assert 0.003 < np.ptp(sway[:, [0, 2]], axis=0).max() < 0.03
    assert (sway[:, 1] <= 1e-9).all(), "nobody grows"
    assert (pose.ankles == stood().ankles).all()
    assert pose.planted.all()


def test_the_calm_move_less_than_the_restless_and_are_no_statues() -> None:
    spans = [np.ptp(held(size).spine, axis=0) for size in (0.2, 1.0, 1.5)]
    assert (np.diff(spans, axis=0) > 0).all()
    assert (spans[0] > 0.02).all()
    assert np.abs(held(1.5).head[:, TURN]).max() < np.radians(60)


def test_who_lies_moves_the_trunk_less_and_does_not_hover_about() -> None:
    assert np.ptp(held(lies=True).spine[:, TURN]) < np.ptp(held().spine[:, TURN])
    assert np.ptp(held(lies=True).head[:, TURN]) == pytest.approx(np.ptp(held().head[:, TURN]))


def test_life_grows_out_of_the_pose_and_what_lives_between_two_poses_begins_and_ends_as_they_are() -> None:
    first = held()
    assert np.abs(first.spine[0] - stood().spine).max() < 0.02
    still = stood().repeat(90)
    living = alive(still, 1.0, np.random.default_rng(1), FPS)
    for part in ("spine", "pelvis"):
        moved = np.abs(getattr(living, part) - getattr(still, part)).max(axis=1)
        assert moved[[0, -1]].max() < 1e-9
        assert moved[30:60].max() > 1e-3
    assert (living.head == still.head).all()
    assert (living.arms == still.arms).all()


def test_a_seat_is_where_its_spot_says_and_knows_its_own_left_and_front() -> None:
    spot = floor_spot("sit", (2.0, 3.0), np.pi / 2)
    seat = Seat.of(spot)
    np.testing.assert_allclose(seat.pelvis, np.add(spot.point, [0.0, SEATED_REST, 0.0]), atol=1e-9)
    np.testing.assert_allclose(seat.to_world([0.0, 0.4, 0.5]), [2.5, 0.4, 3.0], atol=1e-9)  # it faces +X
    np.testing.assert_allclose(seat.to_world([0.5, 0.0, 0.0]), [2.0, 0.0, 2.5], atol=1e-9)
    assert seat.is_low(1.0)
    assert not Seat(np.array([0.0, 0.31, 0.0]), 0.0, 0.3).is_low(1.0)
    assert Seat(np.array([0.0, 0.31, 0.0]), 0.0, 0.3).is_low(1.1)
    low, high = (Seat(np.array([0.0, at, 0.0]), 0.0, 0.3).standing_point(1.0)[1] for at in (0.1, 0.5))
    assert low > high > 0.3, "legs that are not under the seat reach farther"


def test_who_stands_leans_and_looks_as_the_bearing_says_and_feet_point_a_little_outwards() -> None:
    pose = standing((1.0, 2.0), 0.0, Bearing(lean=10.0, head=20.0), SKELETON)
    hips = rotations.quat_to_rotvec(pose.hips)
    assert np.degrees(hips[0] + pose.spine[FORWARD]) == pytest.approx(10)
    assert np.degrees(pose.head[FORWARD]) == pytest.approx(20)
    left, right = rotations.rotate(pose.feet, np.array([0.0, 0.0, 1.0]))
    assert left[0] == pytest.approx(-right[0])
    assert pose.knees[0, 0] == pytest.approx(-pose.knees[1, 0])
    assert 0 < pose.knees[0, 0] < left[0] < 0.2
    assert pose.ankles[:, 0].tolist() == pytest.approx([1.085, 0.915])
    assert 0.98 * SKELETON.standing_height < pose.pelvis[1] < SKELETON.standing_height
