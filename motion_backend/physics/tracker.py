"""A plan followed to its end: window by window, with rewinding after a fall, and a counted reset where that fails."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.physics.contact_forces import ContactReader, Pressure
from motion_backend.physics.engine import engine
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.mjcf_scene import Models
from motion_backend.physics.mpc import Controller, Effort, Moment, moment_of
from motion_backend.physics.reference import Doing, Reference
from motion_backend.rotations import Array

EFFORTS: Final = (Effort(), Effort(24, 2), Effort(28, 2, 2), Effort(30, 2, 2))
"""The usual one, and what is tried after the first, the second and the third fall at a place."""
AT_LEAST: Final = {Doing.RISES: 2, Doing.GOES_DOWN: 1, Doing.LIES: 1}
"""Which of them is begun with where more than feet touches something: with less the body fell as it got up from the
floor, and staggered on one knee."""
UNPREPARED: Final = 6
"""Rounds in which a horizon is improved that no last one has left controls for."""
BACK: Final = (1.3, 2.0, 3.0)
"""Seconds that are gone back before each of those."""
RECOVERED: Final = 1.0
"""Seconds beyond the fall after which it is left behind."""
UNSURE: Final = 0.1
"""A pelvis farther from its plan (metres) at the end of a part may fall in the next one, which cannot mend it."""
TRIED: Final = 0.8
"""Seconds of the next part that are tried then, and thrown away."""
FALLEN: Final = 0.4
"""A pelvis farther from its plan (metres) has fallen, or was carried off."""
TIPPED: Final = 1.3
"""And so has one that is turned away from it by more (radians)."""


@dataclass
class Tracked:
    """What came of a plan: a moment and a pressure for each of its frames, the first being where it began."""

    moments: list[Moment]
    pressures: list[Pressure]
    resets: list[int] = field(default_factory=list)
    """Frames in which the body was set onto the plan."""
    rewinds: list[int] = field(default_factory=list)
    """Frames in which it had fallen, and was gone back from."""
    rewound: int = 0
    """Frames that were thrown away."""
    ahead: Array = field(default_factory=lambda: np.zeros((0, NU)))
    """Offsets of controls for what comes next. (K, 30)."""


@dataclass(frozen=True)
class Tracker:
    """What does not change from frame to frame."""

    models_at: Callable[[int], Models]
    """The window that a frame is simulated in."""
    reference: Reference
    scale: float
    """Of the body, against 1.70 m."""
    between: Callable[[], None] = lambda: None
    """Called between any two windows; may raise."""

    def track(self, start: Moment, ahead: Array, frames: int) -> Tracked:
        """Follow so many frames of the reference from where a body is; the rest of it is looked ahead at, and tried
        where the body is far from its plan at the end: what falls there is mended here, before it."""
        done = Tracked([start], [Pressure()], ahead=ahead)
        data, reader = self._scratch()
        falls, beyond, until, left = 0, 0, frames, ahead
        while (at := len(done.moments) - 1) < until:
            self.between()
            least = AT_LEAST.get(Doing(self.reference.doing[at]), 0)
            stop = frames if at < frames else until
            self._window(done, EFFORTS[max(falls, least)], data, reader, stop - at)
            at = len(done.moments) - 1
            if fallen(done.moments[-1], self.reference.qpos[at]):
                if at > frames and falls == len(BACK):
                    break
                falls, beyond, until = self._recovered(done, falls), max(beyond, at), frames
            elif at == frames:
                until, left = self._tried_until(done, frames), done.ahead
            elif falls and at > beyond + RECOVERED * FPS:
                falls = beyond = 0
        if until > frames:
            del done.moments[frames + 1 :], done.pressures[frames + 1 :]
            done.ahead = left
        return done

    def _tried_until(self, done: Tracked, frames: int) -> int:
        """The frame until which is tried what comes next, at the end of what is to be followed."""
        away = np.linalg.norm(done.moments[frames].state.qpos[:3] - self.reference.qpos[frames][:3])
        known = len(self.reference) - 1 - EFFORTS[0].horizon
        return frames if away <= UNSURE else max(min(frames + round(TRIED * FPS), known), frames)

    def _scratch(self) -> tuple[Any, ContactReader]:
        model = self.models_at(0).fine
        return engine().MjData(model), ContactReader.of(model, self.scale)

    def _window(self, done: Tracked, effort: Effort, data: Any, reader: ContactReader, left: int) -> None:
        """Plan a horizon and play its first frames."""
        at = len(done.moments) - 1
        controller = Controller(self.models_at(at), data, self.reference, reader)
        if not len(done.ahead):
            effort = replace(effort, rounds=UNPREPARED)
        found = controller.improve(done.moments[-1], at, done.ahead, effort)
        played = min(effort.played, left)
        moments, pressures = controller.play(done.moments[-1], at, found.offsets[:played])
        done.moments += moments
        done.pressures += pressures
        done.ahead = found.offsets[played:]

    def _recovered(self, done: Tracked, falls: int) -> int:
        """Go back before a fall, farther each time; else set the body onto the plan. How often it has fallen now."""
        at = len(done.moments) - 1
        done.ahead = np.zeros((0, NU))
        if falls < len(BACK) and done.moments[0].finite:
            back = max(at - round(BACK[falls] * FPS), 0)
            done.rewinds.append(at)
            done.rewound += at - back
            del done.moments[back + 1 :], done.pressures[back + 1 :]
            return falls + 1
        done.resets.append(at)
        done.moments[at] = moment_of(self.reference, at)
        for frame, moment in enumerate(done.moments):
            if not moment.finite:
                done.moments[frame] = moment_of(self.reference, frame)
        return 0


def fallen(now: Moment, planned: Array) -> bool:
    """Whether a body's pelvis is too far from where a plan (45,) has it, or its numbers are none."""
    if not now.finite:
        return True
    away = float(np.linalg.norm(now.state.qpos[:3] - planned[:3]))
    turned = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(_xyzw(planned)), _xyzw(now.state.qpos)))
    return away > FALLEN or float(np.linalg.norm(turned)) > TIPPED


def _xyzw(qpos: Array) -> Array:
    return np.array([*qpos[4:7], qpos[3]])
