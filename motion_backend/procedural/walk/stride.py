"""A body in the middle of a walk: what the next walk needs so as to go on from there without a stop.

A walk that is told where the next one leads plans past its own end, and is cut off there: with a foot in the air, a
heel rising or another one coming down. The walk that follows takes up those steps and goes on with the same beat.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion_backend.procedural.walk.foot_trajectory import SETTLE, Swing
from motion_backend.rotations import Array

BEATS = 2
"""Left and right: after so many steps everything is as it was."""


@dataclass(frozen=True)
class Step:
    """One foot's way from lift to landing, and which step of the walk it is."""

    number: int
    """Counted from 0 with the first foot's first step; the two feet of one hop share it."""
    index: int
    """0 left, 1 right."""
    swing: Swing
    hop: bool = False
    """Whether the foot that stands hops on, as in a skip."""

    def begun(self, phase: float) -> bool:
        """Whether its heel has begun to rise."""
        return self.swing.window[0] - self.swing.rise < phase

    def over(self, phase: float) -> bool:
        """Whether its foot has come to stand flat."""
        return self.swing.window[1] + SETTLE <= phase

    def later(self, phases: int) -> Step:
        """The same step, counted from so many phases earlier."""
        lift, land = self.swing.window
        moved = replace(self.swing, window=(lift + phases, land + phases))
        return replace(self, number=self.number + phases, swing=moved)


@dataclass(frozen=True)
class Stride:
    """A walking body at its last frame."""

    phase: float
    """Of its walk, in [0, 2): it grows by one with every step."""
    begun: int
    """Number of the last step whose heel has begun to rise."""
    first: int
    """+1 when even steps are those of the left foot, -1 of the right."""
    speed: float
    """Of the root along its way (metres a second)."""
    step_m: float
    """How far the root goes with a step."""
    place: Array
    """(2,) root [x, z]: without sway and surge, which the pelvis has besides."""
    heading: float
    """Yaw that the body faces, likewise."""
    moving: float
    """0 standing, 1 in full stride."""
    ankles: Array
    """(2, 3) where the feet stood, flat, before the steps that are under way."""
    yaw: Array
    """(2,) where they pointed then."""
    steps: tuple[Step, ...]
    """Those under way: a heel that rises, a foot in the air, one that is not flat yet."""
    tiptoe: Array
    """(2,) how far both heels are raised (radians)."""
    spread: Array
    """(2,) share of the arm pose that each arm is in."""
    arms_onward: Array | None
    """(2, 3) how far its wrists would go in the next frame, in the chest's frame (arm lengths); None where that is not
    known."""
    shift: Array
    """(K, 3) how far the pelvis was shifted in the last frames for the balance of the body (balance_pass.py)."""
    rest: Array
    """(N, 2) [x, z] the way it was going to go on by: its first point is `place`, its last the next walk's goal."""
    borrowed: bool = False
    """Whether another backend moved the body so far: what it is off in height dies away in the motion that is made
    (`stride_takeover.joined`), and not in the handles before that as well."""

    def to_lists(self) -> dict[str, Any]:
        """Plain lists and numbers for a BodyState's memory."""
        told = {name: np.asarray(value).tolist() for name, value in vars(self).items() if name != "steps"}
        told["steps"] = [
            {**vars(step), "swing": {name: np.asarray(value).tolist() for name, value in vars(step.swing).items()}}
            for step in self.steps
        ]
        return told

    @staticmethod
    def from_lists(memory: dict[str, Any]) -> Stride:
        """Back from `to_lists`."""
        names = ("place", "ankles", "yaw", "tiptoe", "spread", "arms_onward", "shift", "rest")
        arrays = {name: np.asarray(memory[name]) for name in names if memory[name] is not None}
        return Stride(**{**memory, **arrays, "steps": tuple(_step(one) for one in memory["steps"])})


def _step(memory: dict[str, Any]) -> Step:
    swing = memory["swing"]
    points = {"start": np.asarray(swing["start"]), "end": np.asarray(swing["end"]), "window": tuple(swing["window"])}
    return Step(**{**memory, "swing": Swing(**{**swing, **points})})
