"""Where one body takes over from another: it begins as that ended, flings nothing and comes to its own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from motion_backend import rotations
from motion_backend.backend_protocol import History
from motion_backend.motion import FPS, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton
from motion_backend.stride_takeover import FLUNG, HALF_LIFE, joined, joined_within


def standing(frames: int, bent: float = 0.0, height: float = 0.92) -> Motion:
    """A body that stands still, a hip bent by so many degrees."""
    local = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 22, 1))
    local[:, INDEX["left_hip"]] = rotations.axis_to_quat("x", np.full(frames, -np.radians(bent)))
    root = np.tile([0.0, height, 0.0], (frames, 1))
    zero = np.zeros((frames, 4), np.float32)
    return Motion(root.astype(np.float32), local.astype(np.float32), zero, build_skeleton(), np.zeros(frames, np.int32))


def history(motion: Motion) -> History:
    roots, local = motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64)
    return History.of(roots, local, motion.contacts.astype(np.float64))


def changes(before: Motion, after: Motion) -> Array:
    """By how much the fastest joint changes its speed from frame to frame, m/s."""
    places = np.concatenate([before.joint_positions(), after.joint_positions()]).astype(np.float64)
    return np.asarray(np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(axis=1) * FPS)


@pytest.mark.parametrize("bent", [20.0, 60.0, 80.0])
def test_a_body_that_is_off_by_however_much_is_not_flung(bent: float) -> None:
    before, after = standing(4, bent, 0.92 - bent / 500), standing(60)
    assert changes(before, joined(history(before), after)).max() < FLUNG
    assert np.abs(joined(history(before), after).joint_positions()[-1] - after.joint_positions()[-1]).max() < 0.01


def test_a_body_that_is_off_by_little_comes_to_its_own_as_fast_as_it_is_told() -> None:
    before, after = standing(4, 5.0), standing(60)
    found, told = joined(history(before), after), joined_within(history(before), after, HALF_LIFE, HALF_LIFE)
    assert np.array_equal(found.local_rotations, told.local_rotations)


def at_once(before: History, after: Motion) -> Motion:
    return joined_within(before, after, HALF_LIFE, HALF_LIFE)


@pytest.mark.parametrize("way", [joined, at_once])
def test_a_body_that_is_off_by_nothing_is_left_as_it_is(way: Callable[[History, Motion], Motion]) -> None:
    after = standing(20)
    assert np.abs(way(history(standing(4)), after).joint_positions() - after.joint_positions()).max() < 1e-5
