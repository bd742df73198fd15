"""How a frame answers to small changes: finite differences of MuJoCo about simulated states, many frames at once.

MuJoCo works in C without Python's lock, so that frames are spread over threads. Each is done from its own state by its
own data, without a warm start: results do not depend on how many threads there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import local
from typing import Any, Final, NamedTuple

import numpy as np

from motion_backend.motion import FPS
from motion_backend.physics.engine import engine
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.physics_options import physics_options
from motion_backend.rotations import Array

NX: Final = 2 * NV
"""Numbers of a small change of a state: of its position in the tangent space, and of its velocity."""
EPSILON: Final = 1e-6
"""What is added to each number."""


class State(NamedTuple):
    """A body at one moment."""

    qpos: Array
    """(45,)."""
    qvel: Array
    """(36,)."""


class Frame(NamedTuple):
    """One frame to be linearised: its state, and the controls at its beginning and its end (30,)."""

    state: State
    before: Array
    after: Array


class Linear(NamedTuple):
    """δstate' = A δstate + B δ(control at the end) + C δ(control at the beginning)."""

    a: Array
    """(72, 72)."""
    b: Array
    """(72, 30)."""
    c: Array
    """(72, 30)."""


_own = local()


@cache
def _pool(size: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(size, "linearise")


def linearise(model: Any, frames: Sequence[Frame]) -> list[Linear]:
    """The linear models of some frames, in their order; `model` is a mujoco.MjModel."""
    threads = physics_options().linearising
    if threads == 1 or len(frames) == 1:
        return [_linearise(model, frame) for frame in frames]
    return list(_pool(threads).map(lambda frame: _linearise(model, frame), frames))


def _linearise(model: Any, frame: Frame) -> Linear:
    mujoco = engine()
    data = getattr(_own, "data", None)
    if data is None:
        data = _own.data = mujoco.MjData(model)
    steps = round(1 / (FPS * model.opt.timestep))
    data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = frame.state.qpos, frame.state.qvel, 0.0
    a, b = np.zeros((NX, NX)), np.zeros((NX, NU))
    whole = Linear(np.eye(NX), np.zeros((NX, NU)), np.zeros((NX, NU)))
    for step in range(steps):
        share = (step + 1) / steps
        data.ctrl[:] = frame.before + (frame.after - frame.before) * share
        if step == 0:
            mujoco.mj_forward(model, data)
        mujoco.mjd_transitionFD(model, data, EPSILON, 0, a, b, None, None)
        if step + 1 < steps:
            mujoco.mj_step(model, data)
        whole = Linear(a @ whole.a, a @ whole.b + b * share, a @ whole.c + b * (1 - share))
    return whole
