"""A part of an action that a simulated body is to do: its plan, its home, and what is told of it afterwards."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.backend_protocol import History
from motion_backend.body.zero_moment import GRAVITY
from motion_backend.motion import FPS, Motion, Note, PhaseKind, Simulated
from motion_backend.physics.generalized_coordinates import fold, speeds, unfold
from motion_backend.physics.linear_model import State
from motion_backend.physics.mjcf_character import NV, mass_of
from motion_backend.physics.mjcf_scene import Models, models_of, near_way
from motion_backend.physics.mpc import Moment, stacked
from motion_backend.physics.physics_options import Mode
from motion_backend.physics.physics_record import forces_of, weight_error
from motion_backend.physics.reference import ROLLS, Doing, Plan, Reference
from motion_backend.physics.tracker import Tracked
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX, REFERENCE_HEIGHT, Skeleton
from scene_graphs.home import Home

WINDOW, BESIDE = 60, (15, 30)
"""Frames that are simulated among the same boxes, and those before and after whose surroundings count too."""
LOW: Final = 0.35
"""A pelvis below this share of its standing height at the beginning gets up from the floor, and not from a bed."""
KNEES: Final = 0.2
"""A knee that is lower than this share of that carries the body. Before a seat both are twice as high or more."""
DOING: Final = {
    PhaseKind.WALK: Doing.WALKS, PhaseKind.TOUCH: Doing.REACHES, PhaseKind.EDGE: Doing.GOES_DOWN,
    PhaseKind.LIEDOWN: Doing.LIES, PhaseKind.GETUP: Doing.RISES, PhaseKind.STANDUP: Doing.STANDS_UP,
}  # fmt: skip
"""What is followed otherwise."""
HIGH: Final = {Doing.RISES: Doing.LIES, Doing.STANDS_UP: Doing.OTHER}
"""What getting up from a bed, and standing up from it or from a seat, are instead."""
KNEELS_IN: Final = (PhaseKind.STAND, PhaseKind.TOUCH)
"""Where who kneels is followed as who goes down to lie is: on one's knees, for something or to pray."""
GOES_DOWN_IN: Final = 1.3
"""Seconds before and after a knee bears in which the body goes down onto it and comes up."""


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
        before = np.zeros(len(self.past), dtype=np.int8)
        past = Plan(self.past.root_positions, self.past.local_rotations, np.array(self.past.contacts), before)
        boxes = scene_of(self.home).obstacles
        near = self.plan.reaching | np.isin(self.plan.doing, ROLLS)
        things = near_way(self._joints[near], boxes) if near.any() else None
        return Reference.of(past.followed_by(self.plan), self.skeleton, things).part(slice(len(past) - 1, None))

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

    def motion(self, done: Tracked, planned: Motion, mode: Mode = Mode.MPC, why: str = "") -> Motion:
        """The simulated frames of a part, with the contacts that were felt."""
        qpos, qvel = stacked(done.moments[1:])
        roots, local = unfold(qpos, self.reference.wrists[1 : len(done.moments)])
        keyframe, speed = int(planned.actions[0]), np.linalg.norm(qvel[:, :3], axis=1)
        weight = mass_of(self.skeleton.scale * REFERENCE_HEIGHT) * GRAVITY
        record = Simulated(
            keyframe, mode.value, round(len(qpos) / FPS, 3),
            max((float(pressure.root[0]) for pressure in done.pressures[1:]), default=0.0),
            resets=len(done.resets), rewinds=len(done.rewinds),
            rewound_seconds=round(done.rewound / FPS, 2), forces=forces_of(done.pressures[1:]),
            why=why, weight_error=weight_error(done.pressures[1:], speed, weight),
        )  # fmt: skip
        told = (f"fell, and was set back onto the plan {at / FPS:.1f} s into it" for at in done.resets)
        return replace(
            planned,
            root_positions=roots.astype(np.float32),
            local_rotations=local.astype(np.float32),
            contacts=np.array([pressure.planted for pressure in done.pressures[1:]], dtype=np.float32),
            notes=planned.notes + tuple(Note(keyframe, words) for words in told),
            simulated=(record,),
        )


def doing(motion: Motion) -> NDArray[np.int8]:
    """What a motion does in every frame, as far as it is followed otherwise for it: `Doing`. (T,)."""
    found = np.full(len(motion), Doing.OTHER, dtype=np.int8)
    for phase in motion.phases:
        does = DOING.get(phase.kind, Doing.OTHER)
        if does in HIGH and not _low(motion.part(phase.start, phase.start + 1), does):
            does = HIGH[does]
        found[phase.start : phase.stop] = does
        if phase.kind in KNEELS_IN:
            found[phase.start : phase.stop][_kneels(motion.part(phase.start, phase.stop))] = Doing.GOES_DOWN
    return found


def _kneels(motion: Motion) -> NDArray[np.bool_]:
    """In which frames a body kneels, goes down for it or comes up. (T,)."""
    low = np.flatnonzero(_lowest_knee(motion) < KNEES * motion.skeleton.standing_height)
    frames = np.arange(len(motion))
    return np.asarray((np.abs(frames[:, None] - low) <= GOES_DOWN_IN * FPS).any(axis=1))


def _lowest_knee(motion: Motion) -> Array:
    knees: Array = motion.joint_positions()[:, [INDEX["left_knee"], INDEX["right_knee"]], 1].min(axis=1)
    return knees


def _low(beginning: Motion, does: Doing) -> bool:
    """Whether a body gets up from the floor or from its knees, and not from a bed or a seat, by its first frame."""
    low = LOW * beginning.skeleton.standing_height
    if does is Doing.RISES:
        return bool(beginning.root_positions[0, 1] < low)
    return bool(_lowest_knee(beginning)[0] < KNEES * beginning.skeleton.standing_height)


def plan_of(motion: Motion) -> Plan:
    """A motion's arrays, to be followed."""
    roots, local = motion.root_positions.astype(np.float64), motion.local_rotations.astype(np.float64)
    return Plan(roots, local, motion.contacts.astype(np.float64), doing(motion))
