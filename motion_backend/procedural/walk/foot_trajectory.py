"""How a foot moves in a step: heel off, toe off, an arc through the air, heel strike, flat.

The curves are our own, drawn by hand beside the mean step of recorded people (`sims evaluate walks`): ball of the foot
6 cm up in the middle of the swing, foot pitched 60 degrees after toe off and 20 the other way at heel strike. Backwards
it is the same, played backwards. Curves and numbers are in data/gait/foot_trajectory.toml.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import cache

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import smooth
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton
from scene_graphs.data_tables import read_table, table

HEEL = np.array([0.0, -0.066, -0.055])
"""Heel from the ankle at the reference height."""
TIP = np.array([0.0, -0.031, 0.068])
"""Tip of the toes from the ball of the foot, likewise."""
HEEL_RISE, SETTLE = 0.47, 0.30
"""Phase from the first rise of the heel to the lift, and from heel strike to the flat foot."""
SAMPLES = 600
"""Of a curve."""
ROUNDED = 0.036
"""Width of the bell that the corners of a curve are rounded by, in phases: a limb has no jumps of acceleration."""
TIP_UP = np.radians(25)
"""How far the tip of a foot points up at the heel strike of a full step."""


@table
class CurvePoint:
    """A share of something at a phase of a step."""

    at: float
    """-1 to 0 the heel rises, 0 to 1 the foot is in the air, 1 to 2 it comes down flat."""
    share: float


@table
class HeightPoint:
    """A height at a share of the way through the air."""

    at: float
    up_m: float


@table
class FootCurves:
    """What feet go through in a step."""

    heel_off: tuple[CurvePoint, ...]
    """How far the heel has risen."""
    heel_strike: tuple[CurvePoint, ...]
    """How far the tip of the foot points up."""
    scuff: tuple[CurvePoint, ...]
    """The same of a foot that scuffs."""
    usual: tuple[CurvePoint, ...]
    """How high the ball of the foot is in a usual step,"""
    lifted: tuple[CurvePoint, ...]
    """and in what it is lifted higher."""
    level: tuple[HeightPoint, ...]
    """How much higher a foot comes that does not point its tip up."""


@table
class FootWay:
    """Its way over the floor."""

    bow_m: float
    """The arc aside in the middle of the way, straight ahead,"""
    bow_turn_m: float
    """and in a turn of"""
    bow_turn_rad: float
    """or more."""
    full_m: float
    """A full step goes so far,"""
    full_rad: float
    """or turns so far."""
    size_min: float
    """Of a full step: a foot that would go less stays."""
    out_power: float
    """A foot points farthest outwards where its share of the way through the air, to this power, is a half."""
    rise_min_phase: float
    """The least a heel takes to rise, where a step begins at once."""
    leaving_ratio: float
    """Speed of the foot as it lifts, and"""
    arriving_ratio: float
    """as it lands, against its mean speed in the air."""
    toes_stretch_share: float
    """Of the time in the air, in which toes that were bent stretch,"""
    toes_bend_share: float
    """and in which they can bend again."""
    toe_bend_deg: float
    """So far toes bend while the heel rises; beyond that the foot tips over their ends."""


@table
class FootInAir:
    """How high it swings."""

    usual_m: float
    """Of the ball of a walking foot."""
    gentle_share: float
    """Of the way through the air, over which a flat foot is lifted, and put down."""
    hangs_from_m: float
    """A foot that is lifted higher than this hangs down by"""
    droop_rad_per_m: float


@table
class FootTable:
    """data/gait/foot_trajectory.toml: metres at 1.70 m."""

    way: FootWay
    air: FootInAir
    curve: FootCurves


def foot_table() -> FootTable:
    """How a foot moves in a step."""
    rows: FootTable = read_table("motion_backend", "gait/foot_trajectory.toml", FootTable)
    return rows


@cache
def _curve(name: str) -> tuple[Array, Array]:
    """A smooth curve near the points of that name, through the first and the last, finely sampled."""
    from scipy.interpolate import PchipInterpolator
    from scipy.ndimage import gaussian_filter1d

    x, y = np.array([astuple(point) for point in getattr(foot_table().curve, name)]).T
    fine = np.linspace(x[0], x[-1], SAMPLES)
    values, wide = PchipInterpolator(x, y)(fine), ROUNDED / (fine[1] - fine[0])
    beyond = np.pad(values, SAMPLES - 1, mode="reflect", reflect_type="odd")
    return fine, np.asarray(gaussian_filter1d(beyond, wide))[SAMPLES - 1 : 1 - SAMPLES]


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
    """How high the ball of the foot swings in a full step (metres at 1.70 m)."""
    heel_off: float
    """How far the foot pitches forward after toe off (radians)."""
    heel_strike: float
    """How far its tip points up at heel strike (radians)."""
    scuff: float = 0.0
    """How far its tip points up all the way, the heel low over the floor (radians)."""
    backwards: bool = False
    swings_out: float = 0.0
    """How far its tip points outwards half-way (radians)."""
    rise: float = HEEL_RISE
    """Phase from the first rise of its heel to the lift."""
    scale: float = 1.0
    """Size of the body against one of 1.70 m."""
    bow_share: float = 1.0
    """How much of its arc aside there is room for."""

    @property
    def turn(self) -> float:
        """Radians to the left."""
        return float(rotations.wrap(self.end_yaw - self.start_yaw))

    @property
    def bow(self) -> Array:
        """The arc aside in the middle of the way: a little straight ahead, more in a turn. (3,)."""
        row, yaw = foot_table().way, self.start_yaw + 0.5 * self.turn
        outward = self.side * np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        turning = row.bow_turn_m * min(abs(self.turn) / row.bow_turn_rad, 1.0)
        return np.asarray((row.bow_m + turning) * self.bow_share * self.scale * outward)

    @property
    def size(self) -> float:
        """0 for a foot that is already there, 1 for a full step."""
        row, distance = foot_table().way, float(np.linalg.norm(self.end - self.start))
        return float(np.clip(max(distance / (row.full_m * self.scale), abs(self.turn) / row.full_rad), 0.0, 1.0))

    def height(self, u: Array) -> Array:
        """How high the ball of the foot is at shares of its way through the air. (T,)."""
        row = foot_table().air
        flat, usual = 1 - min(self.heel_strike / TIP_UP, 1.0), min(self.clearance, row.usual_m)
        level = flat * min(self.clearance / row.usual_m, 1.0)
        lifted = usual * np.interp(u, *_curve("usual")) + (self.clearance - usual) * np.interp(u, *_curve("lifted"))
        # A foot that does not roll is lifted gently, and put down so where it does not go far ahead.
        down = flat * (1.0 if self.backwards else 1 - self.size)
        gently = [1 - share * (1 - smooth(at / row.gentle_share)) for share, at in ((flat, u), (down, 1 - u))]
        return np.asarray(self.scale * (lifted + level * np.interp(u, *_curve("level"))) * gently[0] * gently[1])

    def pitch(self, phase: Array) -> Array:
        """How far the foot is pitched about the floor, heel up positive. (T,)."""
        (lift, land), row = self.window, foot_table()
        x = np.where(
            phase < lift,
            np.maximum((phase - lift) / self.rise, -1.0),
            np.where(phase < land, (phase - lift) / (land - lift), 1 + np.minimum((phase - land) / SETTLE, 1.0)),
        )
        if self.backwards:
            x = 1 - x
        rising = self.heel_off * np.interp(x, *_curve("heel_off"))
        # A foot that is lifted high hangs.
        high = max(self.clearance - row.air.hangs_from_m, 0.0)
        rising += row.air.droop_rad_per_m * high * np.sin(np.pi * np.clip(x, 0.0, 1.0)) ** 2
        falling = self.heel_strike * np.interp(x, *_curve("heel_strike")) + self.scuff * np.interp(x, *_curve("scuff"))
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
        row = foot_table().way
        if swing.size < row.size_min:
            return
        lift, land = swing.window
        share = (phase - lift) / (land - lift)
        after, inside = share > 0, (share > 0) & (share < 1)
        u = np.clip(share[after], 0, 1)
        way = 1 - _on_its_way(1 - u) if swing.backwards else _on_its_way(u)
        self.ankles[after, index] = swing.start + way[:, None] * (swing.end - swing.start)
        self.ankles[after, index] += (np.sin(np.pi * u) ** 2)[:, None] * swing.bow
        self.ankles[after, index, 1] += swing.height(1 - u if swing.backwards else u)
        aside = swing.swings_out * swing.size * np.sin(np.pi * u**row.out_power) ** 2
        self.yaw[after, index] = swing.start_yaw + smooth(u) * swing.turn + swing.side * aside
        self.planted[inside, index] = 0.0
        air = share[inside]
        self.bend[inside, index] = 1 - smooth(air / row.toes_stretch_share) * smooth((1 - air) / row.toes_bend_share)
        self.pitch[:, index] += swing.pitch(phase)

    def rolled(self, tiptoe: Array, skeleton: Skeleton) -> tuple[Array, Array]:
        """Pitch the feet about heel, ball or tip, moving the ankles along; feet (T, 2, 4) and toe bends (T, 2).

        `tiptoe` (T, 2) raises both heels throughout (radians).
        """
        pitch, toe_bend = self.pitch + tiptoe, np.radians(foot_table().way.toe_bend_deg)
        flat = rotations.yaw_to_quat(self.yaw)
        feet = rotations.compose(flat, rotations.axis_to_quat("x", pitch))
        ball = skeleton.offsets[INDEX["left_foot"]]
        heel, tip = HEEL * skeleton.scale, TIP * skeleton.scale
        for pivot, chosen in ((ball, pitch > 0), (heel, pitch < 0)):
            moved = rotations.rotate(flat, pivot) - rotations.rotate(feet, pivot)
            self.ankles += np.where(chosen[..., None], moved, 0.0)
        over = rotations.compose(flat, rotations.axis_to_quat("x", np.maximum(pitch - toe_bend, 0.0)))
        self.ankles += rotations.rotate(flat, tip) - rotations.rotate(over, tip)
        return feet, np.clip(pitch, 0.0, toe_bend) * self.bend


def _on_its_way(u: Array) -> Array:
    """Share of the way of a swinging foot: moving as it lifts, and still moving as it lands."""

    row = foot_table().way

    def at_its_end(u: Array) -> Array:
        return u**3 * (-4 + 7 * u - 3 * u * u)

    return np.asarray(smooth(u) - row.leaving_ratio * at_its_end(1 - u) + row.arriving_ratio * at_its_end(u))
