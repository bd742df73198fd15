"""The physics backend: what the procedural body plans, done by a body under gravity that only its own joints move."""

from __future__ import annotations

import json
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from motion_backend.backend_protocol import BodyState, Part
from motion_backend.motion import FPS, Character, Motion
from motion_backend.physics.engine import engine
from motion_backend.physics.linear_model import State
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.mpc import Moment
from motion_backend.physics.physics_options import Mode, PhysicsOptions, physics_options
from motion_backend.physics.reference import Plan
from motion_backend.physics.task import Task, plan_of
from motion_backend.physics.tracker import Tracked, Tracker
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton
from scene_graphs.home import Home

if TYPE_CHECKING:
    from motion_backend.physics.policy_mode import PolicyMode

LOOKED_AHEAD: Final = 45
"""Frames of what comes next that a plan goes on with: more than the longest horizon."""
STORIES: Final = 64
"""Of so many stories it is known what they have taken."""
TALLEST: Final = 2.0
"""Metres: taller bodies were not tried."""


class OutOfTimeError(Exception):
    """A story has taken as long as it may."""


class PhysicsBackend:
    """Simulated motion (MuJoCo), tracked by model-predictive control; no weights, no root force."""

    name = "physics"

    def __init__(self, budget: float | None = None, between: Callable[[], None] = lambda: None) -> None:
        """A story's budget in seconds, else this process's; `between` is called between any two windows and may raise,
        to cancel."""
        engine()
        self.budget = physics_options().seconds if budget is None else budget
        self.between = between
        self._policies = _policies(physics_options())
        self._planner = ProceduralBackend()
        self._taken: OrderedDict[tuple[int, int], float] = OrderedDict()

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, where the procedural body would."""
        self._taken[id(home), seed] = 0.0
        while len(self._taken) > STORIES:
            self._taken.popitem(last=False)
        return self._planner.begin(home, character, seed)

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do one part, all of it, in one unbroken simulation that goes on from the part before."""
        own = state.backend == self.name
        planned = BodyState.from_dict(state.memory["plan"]) if own else state
        motion, after = self._planner.advance(home, part, upcoming, planned)
        if not motion.completed:
            return motion, state
        if not len(motion):
            memory = state.memory | {"plan": _plain(after)} if own else after.memory
            return motion, state.after(part, motion, state.backend, memory)
        plan = plan_of(motion).followed_by(self._next(home, upcoming, after, plan_of(motion)))
        if why := _impossible(plan, state):
            return _refused(motion, why), state
        task = Task(home, build_skeleton(state.height), planned.history, plan)
        try:
            done, mode, why = self._done(task, part, motion, state)
        except OutOfTimeError:
            over = f"kinematic from here on, because {self.budget:.0f} s of simulating are over"
            return _refused(motion, over), state
        made = task.motion(done, motion, mode, why)
        return made, state.after(part, made, self.name, _memory(done, after))

    def _next(self, home: Home, upcoming: Sequence[Part], after: BodyState, plan: Plan) -> Plan:
        """What comes after a plan, as far as a horizon looks: the beginning of the next part, else its last frame."""
        for index, part in enumerate(upcoming):
            motion, _ = self._planner.advance(home, part, upcoming[index + 1 :], after)
            if len(motion):
                found = plan_of(motion).part(slice(LOOKED_AHEAD))
                return found.followed_by(found.last(LOOKED_AHEAD - len(found)))
        return plan.last(LOOKED_AHEAD)

    def _done(self, task: Task, part: Part, planned: Motion, state: BodyState) -> tuple[Tracked, Mode, str]:
        """A part in the simulation, who did it, and why no policy did."""
        story, started = (id(task.home), state.seed), time.monotonic()
        end = started + self.budget - self._taken.get(story, 0.0)

        def tick() -> None:
            self.between()
            if time.monotonic() >= end:
                raise OutOfTimeError

        start, ahead = (
            _left_by(state) if state.backend == self.name else (task.taken_up(state.history), np.zeros((0, NU)))
        )
        try:
            why = ""
            if self._policies is not None:
                done, why = self._policies.play(task, part, planned, start, tick)
                if done is not None:
                    return done, Mode.POLICY, ""
            tracker = Tracker(task.models_at, task.reference, task.skeleton.scale, tick)
            return tracker.track(start, ahead, len(planned)), Mode.MPC, why
        finally:
            self._taken[story] = self._taken.get(story, 0.0) + time.monotonic() - started


def _policies(told: PhysicsOptions) -> PolicyMode | None:
    """Who plays policies; None where nobody asked for them, and torch is not loaded."""
    if told.mode is not Mode.POLICY:
        return None
    from motion_backend.physics.policy_mode import PolicyMode

    return PolicyMode(told.policies)


def _impossible(plan: Plan, state: BodyState) -> str:
    """Why a plan cannot be followed; empty where it can."""
    if state.height > TALLEST:
        return f"a simulated body is at most {TALLEST} m tall"
    if (jump := plan.jump()) is not None:
        return f"the plan jumps after {jump / FPS:.1f} s"
    return ""


def _refused(motion: Motion, why: str) -> Motion:
    return replace(motion, completed=False, reason=why)


def _memory(done: Tracked, after: BodyState) -> dict[str, Any]:
    """What the next part goes on from, as lists and numbers."""
    last = done.moments[-1]
    return {
        "plan": _plain(after),
        "qpos": last.state.qpos.tolist(),
        "qvel": last.state.qvel.tolist(),
        "warm": last.warm.tolist(),
        "control": last.control.tolist(),
        "ahead": done.ahead.tolist(),
    }


def _left_by(state: BodyState) -> tuple[Moment, Array]:
    """The moment, and the controls for what comes next, that were remembered."""
    qpos, qvel, warm, control = (np.array(state.memory[name]) for name in ("qpos", "qvel", "warm", "control"))
    return Moment(State(qpos, qvel), warm, control), np.array(state.memory["ahead"]).reshape(-1, NU)


def _plain(state: BodyState) -> Any:
    """A body state as JSON gives it back."""
    return json.loads(json.dumps(state.to_dict()))
