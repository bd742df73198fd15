"""The physics backend: what the procedural body plans, done by a body under gravity that only its own joints move."""

from __future__ import annotations

import json
import os
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from motion_backend.backend_protocol import BodyState, History, Part
from motion_backend.motion import FPS, Character, Motion, Note, Simulated
from motion_backend.physics.engine import engine
from motion_backend.physics.generalized_coordinates import fold, speeds, unfold
from motion_backend.physics.linear_model import State
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.mjcf_scene import Models, models_of, near_way
from motion_backend.physics.mpc import Moment, stacked
from motion_backend.physics.physics_record import MODE, forces_of
from motion_backend.physics.reference import Plan, Reference
from motion_backend.physics.tracker import Tracked, Tracker
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import REFERENCE_HEIGHT, Skeleton, build_skeleton
from scene_graphs.home import Home

LOOKED_AHEAD: Final = 45
"""Frames of what comes next that a plan goes on with: more than the longest horizon."""
WINDOW, BESIDE = 60, (15, 30)
"""Frames that are simulated among the same boxes, and those before and after whose surroundings count too."""
BUDGET: Final = 3600.0
"""Seconds that a story may take in all, where `SIMS_PHYSICS_SECONDS` says nothing else."""
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
        """A story's budget in seconds; `between` is called between any two windows and may raise, to cancel."""
        engine()
        self.budget = float(os.environ.get("SIMS_PHYSICS_SECONDS", BUDGET)) if budget is None else budget
        self.between = between
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
        plan = _plan_of(motion).followed_by(self._next(home, upcoming, after, _plan_of(motion)))
        if why := _impossible(plan, state):
            return _refused(motion, why), state
        task = Task(home, build_skeleton(state.height), planned.history, plan)
        try:
            done = self._tracked(task, state, len(motion))
        except OutOfTimeError:
            return _refused(
                motion, f"kinematic from here on, because {self.budget:.0f} s of simulating are over"
            ), state
        made = task.motion(done, motion)
        return made, state.after(part, made, self.name, _memory(done, after))

    def _next(self, home: Home, upcoming: Sequence[Part], after: BodyState, plan: Plan) -> Plan:
        """What comes after a plan, as far as a horizon looks: the beginning of the next part, else its last frame."""
        for index, part in enumerate(upcoming):
            motion, _ = self._planner.advance(home, part, upcoming[index + 1 :], after)
            if len(motion):
                found = _plan_of(motion).part(slice(LOOKED_AHEAD))
                return found.followed_by(found.last(LOOKED_AHEAD - len(found)))
        return plan.last(LOOKED_AHEAD)

    def _tracked(self, task: Task, state: BodyState, frames: int) -> Tracked:
        story, started = (id(task.home), state.seed), time.monotonic()
        end = started + self.budget - self._taken.get(story, 0.0)

        def tick() -> None:
            self.between()
            if time.monotonic() >= end:
                raise OutOfTimeError

        tracker = Tracker(task.models_at, task.reference, task.skeleton.scale, tick)
        start, ahead = (
            _left_by(state) if state.backend == self.name else (task.taken_up(state.history), np.zeros((0, NU)))
        )
        try:
            return tracker.track(start, ahead, frames)
        finally:
            self._taken[story] = self._taken.get(story, 0.0) + time.monotonic() - started


@dataclass(frozen=True)
class Task:
    """A part that is to be followed, in its home."""

    home: Home
    skeleton: Skeleton
    past: History
    """The plan's last frames before it: the reference begins with the last of them."""
    plan: Plan

    @cached_property
    def reference(self) -> Reference:
        """From the frame before the part to the end of what is looked ahead at."""
        past = Plan(self.past.root_positions, self.past.local_rotations, np.array(self.past.contacts))
        return Reference.of(past.followed_by(self.plan), self.skeleton).part(slice(len(past) - 1, None))

    @cached_property
    def _joints(self) -> Array:
        joints: Array = self.skeleton.forward_kinematics(self.plan.roots, self.plan.local)[0].astype(np.float64)
        return joints

    @cached_property
    def _windows(self) -> dict[int, Models]:
        return {}

    def models_at(self, frame: int) -> Models:
        """The body among the boxes near its way around a frame."""
        window = frame // WINDOW
        if window not in self._windows:
            before, after = BESIDE
            frames = slice(max(window * WINDOW - before, 0), (window + 1) * WINDOW + after)
            boxes = near_way(self._joints[frames], scene_of(self.home).obstacles)
            self._windows[window] = models_of(self.skeleton.scale * REFERENCE_HEIGHT, boxes)
        return self._windows[window]

    def taken_up(self, history: History) -> Moment:
        """The body where another backend left it, with the speeds it had."""
        qpos = fold(history.root_positions, history.local_rotations)
        return Moment(State(qpos[-1], speeds(qpos)[-1]), np.zeros(NV), self.reference.controls[0].copy())

    def motion(self, done: Tracked, planned: Motion) -> Motion:
        """The simulated frames of a part, with the contacts that were felt."""
        qpos, _ = stacked(done.moments[1:])
        roots, local = unfold(qpos, self.reference.wrists[1 : len(done.moments)])
        keyframe = int(planned.actions[0])
        record = Simulated(
            keyframe, MODE, round(len(qpos) / FPS, 3),
            max((float(pressure.root[0]) for pressure in done.pressures[1:]), default=0.0),
            resets=len(done.resets), rewinds=len(done.rewinds),
            rewound_seconds=round(done.rewound / FPS, 2), forces=forces_of(done.pressures[1:]),
        )  # fmt: skip
        resets = tuple(
            Note(keyframe, f"fell, and was set back onto the plan {at / FPS:.1f} s into it") for at in done.resets
        )
        return replace(
            planned,
            root_positions=roots.astype(np.float32),
            local_rotations=local.astype(np.float32),
            contacts=np.array([pressure.planted for pressure in done.pressures[1:]], dtype=np.float32),
            notes=planned.notes + resets,
            simulated=(record,),
        )


def _plan_of(motion: Motion) -> Plan:
    arrays = (motion.root_positions, motion.local_rotations, motion.contacts)
    return Plan(*(array.astype(np.float64) for array in arrays))


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
