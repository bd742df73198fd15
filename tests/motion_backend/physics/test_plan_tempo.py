"""Plans that get up from the floor are slowed, and no others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from simulated import walk

from motion_backend.motion import FPS, Motion, Phase, PhaseKind
from motion_backend.physics.plan_tempo import SLOWER, feasible, from_floor


def on_the_floor(motion: Motion) -> Motion:
    """The walk, with its first two seconds told to be a getting up, on the floor."""
    roots = motion.root_positions - np.array([0.0, 0.75, 0.0], dtype=np.float32)
    phases = (Phase(PhaseKind.GETUP, 0, 60), Phase(PhaseKind.WALK, 60, len(motion)))
    return replace(motion, root_positions=roots, phases=phases)


def test_a_walk_is_as_fast_as_planned() -> None:
    assert feasible(walk()) is walk()


def test_getting_up_takes_longer_and_what_follows_does_not() -> None:
    motion = on_the_floor(walk())
    slower = feasible(motion)
    assert from_floor(motion).sum() == 60
    rise, rest = slower.phases
    assert rise.stop == rest.start
    assert rest.stop == len(slower)
    assert rise.stop - rise.start > 0.9 * SLOWER * 60
    assert abs((rest.stop - rest.start) - (len(motion) - 60)) < 0.5 * FPS


def test_the_way_is_the_same_and_smooth() -> None:
    motion = on_the_floor(walk())
    slower = feasible(motion)
    np.testing.assert_array_equal(slower.root_positions[0], motion.root_positions[0])
    np.testing.assert_allclose(slower.root_positions[-1], motion.root_positions[-1], atol=1e-3)
    gaps = np.linalg.norm(slower.root_positions[:, None] - motion.root_positions, axis=-1).min(axis=1)
    assert gaps.max() < 0.03
    steps = np.linalg.norm(np.diff(slower.root_positions, axis=0), axis=1)
    assert steps.max() <= np.linalg.norm(np.diff(motion.root_positions, axis=0), axis=1).max() + 1e-6
    np.testing.assert_allclose(np.linalg.norm(slower.local_rotations, axis=-1), 1, atol=1e-5)
    assert set(np.unique(slower.contacts)) <= {0.0, 1.0}
