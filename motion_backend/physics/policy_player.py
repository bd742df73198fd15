"""A policy that moves a simulated body: it is asked in every frame, and nothing is looked ahead."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from motion_backend.physics.contact_forces import ContactReader, Pressure
from motion_backend.physics.engine import engine
from motion_backend.physics.mpc import MOST_OFFSET, Controller, Moment
from motion_backend.physics.policy_view import View
from motion_backend.physics.tracker import Tracked, fallen
from motion_backend.rotations import Array

ASKED_EVERY: int = 30
"""Frames between two looks whether anybody still wants the motion."""


class Acts(Protocol):
    """Whatever gives offsets of controls (N, 30) for observations (N, O)."""

    def offsets(self, observed: Array) -> Array:
        """What is added to the plan's controls (N, 30) for observations (N, O), in radians."""
        ...


@dataclass(frozen=True)
class PolicyPlayer:
    """A body in its home that a policy can move."""

    view: View
    data: Any
    """A mujoco.MjData, scratch space."""
    contacts: ContactReader

    @staticmethod
    def of(view: View) -> PolicyPlayer:
        """For the task that is seen."""
        model = view.task.models_at(0).fine
        return PolicyPlayer(view, engine().MjData(model), ContactReader.of(model, view.task.skeleton.scale))

    def controller(self, at: int) -> Controller:
        """What simulates a frame."""
        return Controller(self.view.task.models_at(at), self.data, self.view.task.reference, self.contacts)

    def observe(self, now: Moment, at: int) -> Array:
        """What the policy sees. (1, O)."""
        qpos, qvel, controls = (row[None] for row in (now.state.qpos, now.state.qvel, now.control))
        return self.view.observe(qpos, qvel, controls, np.array([at]))

    def step(self, now: Moment, at: int, offset: Array) -> tuple[Moment, Pressure]:
        """A frame in which the control runs to the plan's next one and an offset (30,), as large as the teacher's."""
        (moment,), (pressure,) = self.controller(at).play(now, at, np.clip(offset, -MOST_OFFSET, MOST_OFFSET)[None])
        return moment, pressure

    def play(self, policy: Acts, start: Moment, frames: int, between: Callable[[], None] = lambda: None) -> Tracked:
        """So many frames, or as many as there are until the body has fallen; those that it fell in are there."""
        done = Tracked([start], [Pressure()])
        for at in range(frames):
            if at % ASKED_EVERY == 0:
                between()
            moment, pressure = self.step(done.moments[-1], at, policy.offsets(self.observe(done.moments[-1], at))[0])
            done.moments.append(moment)
            done.pressures.append(pressure)
            if fallen(moment, self.view.task.reference.qpos[at + 1]):
                break
        return done
