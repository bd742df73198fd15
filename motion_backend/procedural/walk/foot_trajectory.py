"""How a foot moves in a step: heel off, toe off, an arc through the air, heel strike, flat.

The curves are our own, drawn by hand beside the mean step of recorded people (`sims evaluate walks`): ball of the foot
6 cm up in the middle of the swing, foot pitched 60 degrees after toe off and 20 the other way at heel strike. Backwards
it is the same, played backwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import smooth
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

HEEL = np.array([0.0, -0.066, -0.055])
"""Heel from the ankle at the reference height."""
TIP = np.array([0.0, -0.031, 0.068])
"""Tip of the toes from the ball of the foot, likewise."""
TOE_BEND = np.radians(38)
"""Toes bend so far while the heel rises; beyond that the foot tips over their ends."""
HEEL_RISE, SETTLE = 0.40, 0.30
"""Phase from the first rise of the heel to the lift, and from heel strike to the flat foot."""
USUAL = 0.058
"""How high the ball of a walking foot swings (metres)."""
HANGS, DROOP = 0.035, 2.15
"""A foot that is lifted higher than this (metres) hangs down by so many radians for every metre more."""
TIP_UP = np.radians(24)
"""How far the tip of a foot points up at the heel strike of a full step."""
LEAVING, ARRIVING = 0.12, 0.4
"""Speed of the foot as it lifts and as it lands against its mean speed in the air."""

_HEEL_OFF = ((-1.0, 0.0), (-0.5, 0.13), (0.0, 0.61), (0.12, 0.91), (0.21, 1.0), (0.33, 0.85), (0.45, 0.58),
             (0.57, 0.28), (0.7, 0.07), (1.0, 0.0), (2.0, 0.0))  # fmt: skip
_HEEL_STRIKE = ((-1.0, 0.0), (0.45, 0.0), (0.68, 0.38), (0.82, 0.85), (1.0, 1.0), (1.35, 0.5), (1.7, 0.15), (2.0, 0.0))
_SCUFF = ((-1.0, 0.0), (0.0, 0.0), (0.12, 1.0), (0.88, 1.0), (1.0, 0.85), (1.5, 0.1), (2.0, 0.0))
_HEIGHT = ((0.0, 0.0), (0.07, 0.7), (0.18, 0.98), (0.35, 1.0), (0.5, 1.0), (0.64, 0.9), (0.71, 0.64), (0.78, 0.38),
           (0.87, 0.2), (0.94, 0.09), (1.0, 0.0))  # fmt: skip
_LIFTED = ((0.0, 0.0), (0.07, 0.7), (0.18, 0.98), (0.35, 1.0), (0.5, 1.0), (0.65, 0.9), (0.77, 0.64), (0.87, 0.34),
           (0.94, 0.14), (1.0, 0.0))  # fmt: skip
"""How high the ball of the foot is in a usual step, and in what it is lifted higher (shares of the middle)."""
_LEVEL = ((0.0, 0.0), (0.5, 0.0), (0.65, 0.008), (0.77, 0.032), (0.87, 0.032), (0.94, 0.018), (1.0, 0.0))
"""How much higher a foot comes that does not point its tip up (metres)."""


@cache
def _curve(points: tuple[tuple[float, float], ...]) -> tuple[Array, Array]:
    """A smooth curve through points that keeps their shape, finely sampled."""
    from scipy.interpolate import PchipInterpolator

    x, y = np.array(points).T
    fine = np.linspace(x[0], x[-1], 600)
    return fine, np.asarray(PchipInterpolator(x, y)(fine))


@dataclass(frozen=True)
class Swing:
    """One foot on its way from one place on the floor to the next."""

    start: Array
    """(3,) ankle."""
    end: Array
    """(3,)."""
    start_yaw: float
    end_yaw: float
    side: int
    """+1 left, -1 right."""
    window: tuple[float, float]
    """Phase of lift and landing."""
    clearance: float
    """How high the ball of the foot swings in a full step (metres)."""
    heel_off: float
    """How far the foot pitches forward after toe off (radians)."""
    heel_strike: float
    """How far its tip points up at heel strike (radians)."""
    scuff: float = 0.0
    """How far its tip points up all the way, the heel low over the floor (radians)."""
    round: float = 0.0
    """How far outwards it goes round the other leg (metres)."""
    backwards: bool = False

    @property
    def turn(self) -> float:
        """Radians to the left."""
        return float(rotations.wrap(self.end_yaw - self.start_yaw))

    @property
    def bow(self) -> Array:
        """The arc aside in the middle of the way: a little straight ahead, more in a turn. (3,)."""
        yaw = self.start_yaw + 0.5 * self.turn
        outward = self.side * np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        return np.asarray((0.012 + max(self.round, 0.073 * min(abs(self.turn) / 0.5, 1.0))) * outward)

    @property
    def size(self) -> float:
        """0 for a foot that is already there, 1 for a full step."""
        distance = float(np.linalg.norm(self.end - self.start))
        return float(np.clip(max(distance / 0.5, abs(self.turn) / 1.2), 0.0, 1.0))

    def height(self, u: Array) -> Array:
        """How high the ball of the foot is at shares of its way through the air. (T,)."""
        level = (1 - min(self.heel_strike / TIP_UP, 1.0)) * min(self.clearance / USUAL, 1.0)
        usual = min(self.clearance, USUAL)
        lifted = usual * np.interp(u, *_curve(_HEIGHT)) + (self.clearance - usual) * np.interp(u, *_curve(_LIFTED))
        return np.asarray(lifted + level * np.interp(u, *_curve(_LEVEL)))

    def pitch(self, phase: Array) -> Array:
        """How far the foot is pitched about the floor, heel up positive. (T,)."""
        lift, land = self.window
        # The first heel rises from the first frame on, not before.
        rise = min(HEEL_RISE, max(lift - float(phase[0]), 0.05))
        x = np.where(
            phase < lift,
            np.maximum((phase - lift) / rise, -1.0),
            np.where(phase < land, (phase - lift) / (land - lift), 1 + np.minimum((phase - land) / SETTLE, 1.0)),
        )
        if self.backwards:
            x = 1 - x
        rising = self.heel_off * np.interp(x, *_curve(_HEEL_OFF))
        # A foot that is lifted high hangs.
        rising += DROOP * max(self.clearance - HANGS, 0.0) * np.sin(np.pi * np.clip(x, 0.0, 1.0)) ** 2
        falling = self.heel_strike * np.interp(x, *_curve(_HEEL_STRIKE)) + self.scuff * np.interp(x, *_curve(_SCUFF))
        return np.asarray(rising - falling)


@dataclass
class Feet:
    """Both feet over T frames, written step by step: as if flat, and how far they are pitched."""

    ankles: Array
    """(T, 2, 3)."""
    yaw: Array
    """(T, 2)."""
    pitch: Array
    """(T, 2)."""
    bend: Array
    """(T, 2) 1 where toes bend as the heel rises, 0 in the air."""
    planted: Array
    """(T, 2)."""

    @staticmethod
    def standing(ankles: Array, yaw: Array, frames: int) -> Feet:
        """Both feet flat where they are."""
        still, ones = np.zeros((frames, 2)), np.ones((frames, 2))
        return Feet(np.repeat(ankles[None], frames, axis=0), np.repeat(yaw[None], frames, axis=0), still, ones.copy(),
                    ones)  # fmt: skip

    def add(self, swing: Swing, phase: Array, index: int) -> None:
        """Write one step of a foot."""
        if swing.size < 0.04:
            return
        lift, land = swing.window
        share = (phase - lift) / (land - lift)
        after, inside = share > 0, (share > 0) & (share < 1)
        u = np.clip(share[after], 0, 1)
        way = 1 - _on_its_way(1 - u) if swing.backwards else _on_its_way(u)
        self.ankles[after, index] = swing.start + way[:, None] * (swing.end - swing.start)
        self.ankles[after, index] += (np.sin(np.pi * u) ** 2)[:, None] * swing.bow
        self.ankles[after, index, 1] += swing.height(1 - u if swing.backwards else u)
        self.yaw[after, index] = swing.start_yaw + smooth(u) * swing.turn
        self.planted[inside, index] = 0.0
        air = share[inside]
        self.bend[inside, index] = 1 - smooth(air / 0.4) * smooth((1 - air) / 0.3)
        self.pitch[:, index] += swing.pitch(phase)

    def rolled(self, tiptoe: Array, skeleton: Skeleton) -> tuple[Array, Array]:
        """Pitch the feet about heel, ball or tip, moving the ankles along; feet (T, 2, 4) and toe bends (T, 2).

        `tiptoe` (T,) raises both heels throughout (radians).
        """
        pitch = self.pitch + tiptoe[:, None]
        flat = rotations.yaw_to_quat(self.yaw)
        feet = rotations.compose(flat, rotations.axis_to_quat("x", pitch))
        ball = skeleton.offsets[INDEX["left_foot"]]
        heel, tip = HEEL * skeleton.scale, TIP * skeleton.scale
        for pivot, chosen in ((ball, pitch > 0), (heel, pitch < 0)):
            moved = rotations.rotate(flat, pivot) - rotations.rotate(feet, pivot)
            self.ankles += np.where(chosen[..., None], moved, 0.0)
        over = rotations.compose(flat, rotations.axis_to_quat("x", np.maximum(pitch - TOE_BEND, 0.0)))
        self.ankles += rotations.rotate(flat, tip) - rotations.rotate(over, tip)
        return feet, np.clip(pitch, 0.0, TOE_BEND) * self.bend


def _on_its_way(u: Array) -> Array:
    """Share of the way of a swinging foot: moving as it lifts, and still moving as it lands."""

    def at_its_end(u: Array) -> Array:
        return u**3 * (-4 + 7 * u - 3 * u * u)

    return np.asarray(smooth(u) - LEAVING * at_its_end(1 - u) + ARRIVING * at_its_end(u))
