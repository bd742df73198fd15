"""Walking by motion matching: six times a second the recorded frame that fits best is looked for and played on from.

What a jump leaves between the body and the new frames is an offset that dies away (inertialisation, Bollo, GDC 2018).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.matching.walk_database import (
    WAY,
    WalkDatabase,
    features_now,
    wanted_way,
)
from motion_backend.motion import FPS
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS, build_skeleton
from motion_backend.walk_generator import Ahead, Frames, yaw_of

WINDOW: Final = 5
"""Frames between two searches: six a second."""
HALF_LIFE: Final = 0.15
"""Seconds in which an offset is half gone."""
DAMPING: Final = 2 * np.log(2) / HALF_LIFE
"""Of the critically damped spring that takes it away, a second."""
BETTER: Final = 0.02
"""By how much (squared distance) another frame must fit better to be jumped to."""
NEAR: Final = 8
"""Frames within which another one of the same clip is no other."""
STEER_AT: Final = 20
"""The frame ahead that a body is steered towards. With a nearer one it would steer against its own sway."""
STEER: Final = 0.03
"""Share of what it heads beside it that is taken away a frame,"""
STEER_PER_M: Final = 1.2
"""but no more than so many radians for each metre it goes:"""
STEER_MOST: Final = 0.06
"""no more than that a frame, either."""
STEER_FROM: Final = 0.2
"""Metres to that place, from which it has a direction."""


@dataclass(frozen=True)
class _Offset:
    """What the body has besides what is played, and how fast that changes: it dies away."""

    turns: Array
    """(22, 3) rotation vectors."""
    spins: Array
    """(22, 3) a second."""
    height: float
    """Of the pelvis, metres, and how fast"""
    climb: float
    """it grows, metres a second."""
    drift: Array
    """(2,) over the floor, metres a second."""

    def after(self, seconds: Array) -> tuple[Array, Array, Array]:
        """Turns (T, 22, 3), heights (T,) and how far it has drifted (T, 2) at those times."""
        fade, at = np.exp(-DAMPING * seconds), seconds[:, None, None]
        turns = fade[:, None, None] * (self.turns + (self.spins + DAMPING * self.turns) * at)
        heights = fade * (self.height + (self.climb + DAMPING * self.height) * seconds)
        return turns, heights, np.multiply.outer((1 - fade) / DAMPING, self.drift)

    def later(self, seconds: float) -> _Offset:
        """What is left of it by then."""
        fade = float(np.exp(-DAMPING * seconds))
        pull, rise = self.spins + DAMPING * self.turns, self.climb + DAMPING * self.height
        return _Offset(
            turns=fade * (self.turns + pull * seconds),
            spins=fade * (self.spins - DAMPING * pull * seconds),
            height=fade * (self.height + rise * seconds),
            climb=fade * (self.climb - DAMPING * rise * seconds),
            drift=fade * self.drift,
        )


_NOTHING: Final = _Offset(np.zeros((len(JOINTS), 3)), np.zeros((len(JOINTS), 3)), 0.0, 0.0, np.zeros(2))


@dataclass
class FrameMatcher:
    """A body that walks by recorded frames."""

    database: WalkDatabase
    past: Frames
    """At least the last two frames that it made, or was in."""
    playing: int = -1
    """The recorded frame that the last one was; -1 before the first."""
    turn: float = 0.0
    """Yaw from the recording to the world."""
    played: list[int] = field(default_factory=list)
    """Recorded frames that were shown, in order."""
    _offset: _Offset = _NOTHING
    """As it was in the last frame."""

    def window(self, ahead: Ahead) -> Frames:
        """The next frames: on from where the recording is, or from another of its frames that fits better by now."""
        self._look_for_better(ahead)
        base = self.database
        shown = self.playing + np.arange(1, WINDOW + 1)
        turned = self.turn + np.cumsum(self._steering(ahead))
        turns, heights, drifted = self._offset.after(np.arange(1, WINDOW + 1) / FPS)
        local = rotations.compose(base.local[shown], rotations.rotvec_to_quat(turns))
        local[:, 0] = rotations.compose(rotations.yaw_to_quat(turned), local[:, 0])
        steps = np.diff(base.root[self.playing : shown[-1] + 1], axis=0)
        root = np.cumsum(rotations.rotate(rotations.yaw_to_quat(turned), steps), axis=0)
        root[:, [0, 2]] += self.past.root[-1, [0, 2]] + drifted
        root[:, 1] = base.root[shown, 1] + heights
        self.playing, self.turn = int(shown[-1]), float(turned[-1])
        self.played += shown.tolist()
        found = Frames(root, local)
        self.past = self.past.then(found)[-2:]
        self._offset = self._offset.later(WINDOW / FPS)
        return found

    def _look_for_better(self, ahead: Ahead) -> None:
        """Jump to the frame that fits best, if it is clearly better or what is played comes to its end."""
        base, place = self.database, self.past.root[-1, [0, 2]]
        if self.playing < 0:
            heading = float(yaw_of(self.past.local[-1, 0]))
            pose = features_now(self.past.root, self.past.local, build_skeleton())
        else:
            heading = float(base.heading[self.playing]) + self.turn
            pose = base.features[self.playing, WAY.stop :]
        wanted = np.concatenate([wanted_way(ahead.places, ahead.yaws, place, heading), pose])
        best, cost = base.nearest(wanted)
        if self.playing >= 0 and base.left[self.playing] > WINDOW:
            own = float(np.sum((wanted - base.features[self.playing]) ** 2))
            if abs(best - self.playing) < NEAR or own - cost <= BETTER:
                return
        self.turn = heading - float(base.heading[best])
        self.playing = best
        self._offset = self._left_over()

    def _left_over(self) -> _Offset:
        """What the body's last frames have that those of the recording have not."""
        base, shown = self.database, [self.playing - 1, self.playing]
        turn = rotations.yaw_to_quat(self.turn)
        theirs, ours, root = base.local[shown], self.past.local[-2:], self.past.root[-2:]
        theirs[:, 0] = rotations.compose(turn, theirs[:, 0])
        if len(ours) < len(shown):
            ours, root = np.repeat(ours, 2, axis=0), np.repeat(root, 2, axis=0)
        speed = FPS * (root[1] - root[0] - rotations.rotate(turn, base.root[shown[1]] - base.root[shown[0]]))
        return _Offset(
            turns=rotations.quat_to_rotvec(rotations.compose(rotations.inverse(theirs[1]), ours[1])),
            spins=FPS * (_turned(ours) - _turned(theirs)),
            height=float(root[1, 1] - base.root[self.playing, 1]),
            climb=float(speed[1]),
            drift=speed[[0, 2]],
        )

    def _steering(self, ahead: Ahead) -> Array:
        """How far the body is turned in each of the coming frames towards its way. (WINDOW,) radians."""
        base, place = self.database, self.past.root[-1, [0, 2]]
        to = ahead.places[STEER_AT] - place
        if float(np.hypot(*to)) < STEER_FROM:
            return np.zeros(WINDOW)
        heading = float(base.heading[self.playing]) + self.turn
        beside = float(rotations.wrap(np.arctan2(*to) - heading))
        shown = base.root[self.playing : self.playing + WINDOW + 1][:, [0, 2]]
        most = np.minimum(STEER_PER_M * np.linalg.norm(np.diff(shown, axis=0), axis=1), STEER_MOST)
        return np.clip(beside * STEER * (1 - STEER) ** np.arange(WINDOW), -most, most)


def _turned(local: Array) -> Array:
    """How far every joint turns from the first of two frames to the second. (2, 22, 4) to (22, 3)."""
    return rotations.quat_to_rotvec(rotations.compose(rotations.inverse(local[0]), local[1]))
