"""How a frame answers to small changes: what simulated states would do, many frames at once.

Forward dynamics are differentiated through inverse ones: where F(q, v, a, u) = 0 is what the simulation keeps to, the
acceleration answers by δa = -F_a⁻¹ (F_q δq + F_v δv + F_u δu). MuJoCo's `mjd_inverseFD` gives F_q and F_v by finite
differences; F_a and F_u are known in closed form (active constraints and servos). No constraint is solved again, which
`mjd_transitionFD` does for every number: it takes three times as long for the same matrices.

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
from motion_backend.physics.mjcf_character import NU, NV, SIMULATED
from motion_backend.physics.physics_options import physics_options
from motion_backend.rotations import Array

NX: Final = 2 * NV
"""Numbers of a small change of a state: of its position in the tangent space, and of its velocity."""
EPSILON: Final = 1e-6
"""What is added to each number."""
JUMPS: Final = 1e7
"""A finite difference beyond this (N/m, Nm/rad) is no slope: a contact came or went within `EPSILON`."""
_TURNING: Final = np.array([3, *(joint.qvel for joint in SIMULATED if not joint.axis)])
"""Where in qvel the angular velocities of the pelvis and of ball joints begin. (9,)."""
_BLOCKS: Final = (_TURNING[:, None] + np.arange(3))[:, :, None], (_TURNING[:, None] + np.arange(3))[:, None, :]


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
    """The linear models of some frames, in their order; `model` is a mujoco.MjModel with discrete inverse dynamics."""
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
    whole = Linear(np.eye(NX), np.zeros((NX, NU)), np.zeros((NX, NU)))
    for step in range(steps):
        share = (step + 1) / steps
        data.ctrl[:] = frame.before + (frame.after - frame.before) * share
        a, b = _step(mujoco, model, data)
        whole = Linear(a @ whole.a, a @ whole.b + b * share, a @ whole.c + b * (1 - share))
    return whole


def _step(mujoco: Any, model: Any, data: Any) -> tuple[Array, Array]:
    """Simulate a step, and how the state after it answers to the state (72, 72) and the controls (72, 30) before."""
    seconds, before = model.opt.timestep, State(data.qpos.copy(), data.qvel.copy())
    mujoco.mj_step(model, data)
    after, warm = State(data.qpos.copy(), data.qvel.copy()), data.qacc_warmstart.copy()
    inertia, driven = _inertia(mujoco, model, data, seconds), _driven(mujoco, model, data)
    data.qpos[:], data.qvel[:] = before
    data.qacc[:] = (after.qvel - before.qvel) / seconds
    by_place, by_speed = np.empty((NV, NV)), np.empty((NV, NV))
    mujoco.mjd_inverseFD(model, data, EPSILON, True, by_place, by_speed, None, None, None, None, None)
    if np.abs(by_place).max() > JUMPS:
        other = np.empty((NV, NV))
        mujoco.mjd_inverseFD(model, data, -EPSILON, True, other, None, None, None, None, None, None)
        by_place = np.where(np.abs(other) < np.abs(by_place), other, by_place)
    speed = np.linalg.solve(inertia, np.concatenate([-by_place.T, -by_speed.T, driven], axis=1))
    speed *= seconds
    speed[:, NV:NX] += np.eye(NV)
    turned, moved = _integrated(after.qvel, seconds)
    place = moved @ speed
    place[:, :NV] += turned
    data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = *after, warm
    return np.concatenate([place[:, :NX], speed[:, :NX]]), np.concatenate([place[:, NX:], speed[:, NX:]])


def _inertia(mujoco: Any, model: Any, data: Any, seconds: float) -> Array:
    """F_a (36, 36): what the acceleration between two steps takes, by mass, damping and active constraints."""
    mass, moment, free = np.zeros((NV, NV)), _moment(mujoco, data), _unlimited(model, data)
    mujoco.mj_fullM(model, data, mass)
    damped = mass - seconds * (moment.T * (model.actuator_biasprm[:, 2] * free)) @ moment
    every = data.efc_J.reshape(-1, NV)
    active = every @ data.qacc < data.efc_aref
    rows, held = every[active], data.efc_D[active]
    # The solver's acceleration is that of the whole step less what damping takes within it (implicitfast).
    undamped = np.empty((NV, NV))
    mujoco.mj_solveM(model, data, undamped, np.ascontiguousarray(damped.T))
    answers: Array = damped + (rows.T * held) @ rows @ undamped.T
    return answers


def _driven(mujoco: Any, model: Any, data: Any) -> Array:
    """-F_u (36, 30): what a servo's control adds, of those that are not at their limit."""
    driven: Array = _moment(mujoco, data).T * (model.actuator_gainprm[:, 0] * _unlimited(model, data))
    return driven


def _moment(mujoco: Any, data: Any) -> Array:
    moment = np.zeros((NU, NV))
    mujoco.mju_sparse2dense(moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    return moment


def _unlimited(model: Any, data: Any) -> Array:
    low, high = model.actuator_forcerange.T
    free: Array = (data.actuator_force > low) & (data.actuator_force < high)
    return free


def _integrated(qvel: Array, seconds: float) -> tuple[Array, Array]:
    """How a position after a step answers to the one before, and to the velocity (36,) it was moved by. (36, 36)."""
    turned, moved = np.eye(NV), seconds * np.eye(NV)
    turn = -seconds * qvel[_TURNING[:, None] + np.arange(3)]
    angle = np.linalg.norm(turn, axis=1)[:, None, None] + 1e-12
    cross = np.zeros((len(turn), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = turn
    cross[:, [1, 2, 0], [2, 0, 1]] = -turn
    twice = cross @ cross
    versed = np.where(angle > 1e-4, (1 - np.cos(angle)) / angle**2, 0.5)
    turned[_BLOCKS] = np.eye(3) + np.sinc(angle / np.pi) * cross + versed * twice
    cubic = np.where(angle > 1e-2, (angle - np.sin(angle)) / angle**3, 1 / 6)
    moved[_BLOCKS] = seconds * (np.eye(3) + versed * cross + cubic * twice)
    return turned, moved
