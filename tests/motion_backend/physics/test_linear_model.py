"""A frame's linear model says what the simulation does with a state that is a little other."""

from __future__ import annotations

import numpy as np
from simulated import empty_room, walked

from motion_backend.physics.engine import engine
from motion_backend.physics.linear_model import NX, Frame, linearise
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.mpc import Moment
from motion_backend.rotations import Array


def framed(before: Moment, after: Moment) -> Frame:
    return Frame(before.state, before.control, after.control)


def by_simulating(frame: Frame) -> tuple[Array, Array, Array]:
    """The same three matrices by finite differences of MuJoCo's own forward dynamics."""
    mujoco, model = engine(), empty_room().coarse
    data, a, b = mujoco.MjData(model), np.zeros((NX, NX)), np.zeros((NX, NU))
    data.qpos[:], data.qvel[:] = frame.state
    whole = (np.eye(NX), np.zeros((NX, NU)), np.zeros((NX, NU)))
    for share in (0.5, 1.0):
        data.ctrl[:] = frame.before + (frame.after - frame.before) * share
        mujoco.mj_forward(model, data)
        mujoco.mjd_transitionFD(model, data, 1e-6, 0, a, b, None, None)
        mujoco.mj_step(model, data)
        whole = (a @ whole[0], a @ whole[1] + b * share, a @ whole[2] + b * (1 - share))
    return whole


def test_inverse_dynamics_give_what_differences_of_forward_dynamics_give() -> None:
    _, done = walked(40)
    frames = [framed(*both) for both in zip(done.moments[5:-1:6], done.moments[6::6], strict=False)]
    assert len(frames) >= 5
    for frame, found in zip(frames, linearise(empty_room().coarse, frames), strict=True):
        for name, ours, theirs in zip("abc", found, by_simulating(frame), strict=True):
            # Differences about a solver's iterations are good to some thousandths.
            assert np.abs(ours - theirs).max() < 5e-3 * max(float(np.abs(theirs).max()), 1.0), name


def test_a_contact_that_comes_within_a_difference_is_no_slope() -> None:
    # The plan's sole lies on the floor to less than what is added: taken as a slope, that would be a million times it.
    _, done = walked(40)
    touching = framed(done.moments[1], done.moments[2])
    model = linearise(empty_room().coarse, [touching])[0]
    assert np.isfinite(model.a).all()
    assert np.abs(model.a[NV:, :NV]).max() < 2e3
