"""Footsteps along a route: which foot lifts when, and where it lands.

A foot lands where the root will pass at the middle of its stance, so one rule serves walking, turning in place,
stepping aside or back, starting and stopping. Phase grows by one with every step; how the foot itself moves from lift
to landing is in swinging.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.foot_trajectory import TIP_UP, Feet, Swing
from motion_backend.procedural.walk.root_path import Route
from motion_backend.procedural.walk.walk_styles import Walk, usual_width
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

LEAD = 0.35
"""Phase before the first step."""
NARROWER = 0.36
"""How much nearer to each other feet land in full stride than where the body stands (share of the width)."""
TURNING = 0.5
"""Who turns by this much within half a second (radians) steps no narrower than usual where they stand."""
SIDEWAYS = 90.0
"""How far from its way a body faces that steps sideways (degrees)."""
SKIPPING = 0.7
"""Slower than this (metres a second) nobody skips."""
APART = 0.095
"""How near to each other the ankles may pass (metres)."""
FULL_STRIDE = 1.1
"""How far a foot travels in a step that rolls fully from heel to toe (metres)."""


@dataclass(frozen=True)
class Steps:
    """Phase of T frames and what each foot does."""

    phase: Array
    """(T,)."""
    moving: Array
    """(T,) 0 standing, 1 in full stride: scales everything that swings."""
    first: int
    """+1 when the left foot steps first, -1 right."""
    ankles: Array
    """(T, 2, 3)."""
    feet: Array
    """(T, 2, 4)."""
    yaw: Array
    """(T, 2) where they point."""
    toes: Array
    """(T, 2)."""
    planted: Array
    """(T, 2)."""
    hopping: Array
    """(T,) 1 over the steps of a skip, else 0."""


def yaw_of(rotation: Array) -> Array:
    """Heading of a body or foot: where its +Z points on the floor. (...)."""
    forward = rotations.rotate(rotation, np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arctan2(forward[..., 0], forward[..., 2]))


def drift(frames: int, hertz: float, fps: int, rng: np.random.Generator) -> Array:
    """Smooth wandering about zero with unit size: a few slow sines of random phase. (frames,)."""
    time = np.arange(frames) / fps
    rates = hertz * np.array([0.61, 1.0, 1.43])
    phases = rng.uniform(0, 2 * np.pi, 3)
    return np.asarray(np.sin(2 * np.pi * np.outer(time, rates) + phases).sum(axis=1) / 2.1)


def plan_phase(
    route: Route, style: Walk, skeleton: Skeleton, fps: int, rng: np.random.Generator
) -> tuple[Route, Array]:
    """Cadence from speed and turning, then enough standing frames for both feet to come home."""
    turning = np.abs(np.gradient(route.heading)) * fps
    usual = np.sqrt(np.maximum(route.speed, 0.05) / (0.385 * skeleton.scale**1.5)) / style.stride
    usual = usual * (1 + (0.02 + style.uneven) * drift(len(usual), 0.8, fps, rng))
    longest = route.speed / (min(0.76 * style.stride, 0.86) * skeleton.scale)
    if style.aside == SIDEWAYS:
        # Feet that are brought together and apart again must not cross.
        longest = route.speed / (1.5 * style.width * skeleton.scale)
    # A turn takes a step every half right angle or so, a spin fewer: nobody trips along at five steps a second.
    rate = np.maximum.reduce([usual, np.minimum(turning / 0.85, 2.6), longest, np.full_like(usual, 1.25)])
    if style.skips:
        rate = np.where(route.speed > SKIPPING, np.minimum(rate, 1.75), rate)
    # The first steps are short: the foot that stays behind must not be left too far.
    walked = np.cumsum(route.speed) / fps
    starting = np.clip((0.55 * skeleton.scale - walked) / 0.25, 0.0, 1.0)
    rate = np.maximum(rate, np.minimum(route.speed / (0.30 * skeleton.scale), 3.2) * starting)
    # A third of a step goes by before the first foot lifts: the weight shifts and the heel rises.
    phase = np.cumsum(rate) / fps - LEAD
    # Both feet step at least once, and a last step in flight comes down before the end.
    total = max(np.ceil(phase[-1] + 0.5), 2.0) + max(0.0, -style.double / 2) + 0.2
    extra = max(int(np.ceil((total - phase[-1]) / 1.7 * fps)), 1)
    tail = phase[-1] + (total - phase[-1]) * np.arange(1, extra + 1) / extra
    longer = Route(
        np.concatenate([route.position, np.repeat(route.position[-1:], extra, axis=0)]),
        np.concatenate([route.heading, np.repeat(route.heading[-1:], extra)]),
        np.concatenate([route.speed, np.zeros(extra)]),
    )
    return longer, np.concatenate([phase, tail])


def _first_foot(start: Pose, route: Route, style: Walk) -> int:
    """The foot that has further to go steps first; in a turn the inner one, and sideways the leading one."""
    soon = min(20, len(route.heading) - 1)
    turn = float(route.heading[soon] - route.heading[0])
    left = np.array([np.cos(route.heading[0]), -np.sin(route.heading[0])])
    if style.aside == SIDEWAYS:
        return 1 if (route.position[-1] - route.position[0]) @ left >= 0 else -1
    outwards = float((route.position[soon] - route.position[0]) @ left)
    if abs(turn) > 0.15 or abs(outwards) > 0.05:
        return 1 if turn / 0.5 + outwards / 0.1 > 0 else -1
    ahead = np.array([np.sin(route.heading[0]), np.cos(route.heading[0])])
    near, far = (start.ankles[index][[0, 2]] @ ahead for index in (0, 1))
    return 1 if near <= far + 0.01 else -1


def home_ankle(position: Array, heading: Array | float, index: int, width: float, skeleton: Skeleton) -> Array:
    """Where a foot stands under a root at [x, z]. (..., 3)."""
    side = (1 if index == 0 else -1) * width * skeleton.scale
    heading = np.asarray(heading)
    x = position[..., 0] + side * np.cos(heading)
    z = position[..., 1] - side * np.sin(heading)
    return np.stack([x, np.full_like(x, skeleton.ankle_height), z], axis=-1)


@dataclass(frozen=True)
class _Beat:
    """One foot going from one place to the next."""

    index: int
    """0 left, 1 right."""
    window: tuple[float, float]
    """Phase of lift and landing."""
    middle: float
    """Phase at the middle of the stance it lands for."""
    hop: bool = False


def _beats(route: Route, phase: Array, first: int, style: Walk) -> list[_Beat]:
    """Left, right, left, right; in a skip the foot that stands hops on before the other one lands."""
    steps, beats = round(phase[-1]), []
    for k in range(steps):
        index = 0 if (k % 2 == 0) == (first > 0) else 1
        if style.skips and k < steps - 2 and _speed_at(route, phase, k + 0.5) > SKIPPING:
            beats.append(_Beat(1 - index, (k + 0.40, k + 0.72), k + 0.92, hop=True))
            beats.append(_Beat(index, (k + 0.10, k + 0.98), k + 1.25))
        else:
            # Slow steps stand longer on both feet than quick ones.
            double = style.double + (0.10 * max(0.9 - _speed_at(route, phase, k + 0.5), 0) if style.double > 0 else 0)
            beats.append(_Beat(index, (k + double / 2, k + 1 - double / 2), k + 1.5))
    return beats


def _speed_at(route: Route, phase: Array, when: float) -> float:
    return float(route.speed[min(int(np.searchsorted(phase, when)), len(phase) - 1)])


def plan_steps(
    start: Pose, route: Route, phase: Array, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Steps:
    """Where both feet are at every frame, from where they stand at the start."""
    frames = len(phase)
    first = _first_foot(start, route, style)
    feet = Feet.standing(start.ankles, yaw_of(start.feet), frames)
    amount, hopping = np.zeros(frames), np.zeros(frames)
    for beat in _beats(route, phase, first, style):
        swing = _swing_of(beat, feet, route, phase, style, skeleton, rng)
        lift, land = beat.window
        if not beat.hop:
            amount = np.maximum(amount, swing.size * ((phase > np.floor(lift)) & (phase <= np.ceil(land))))
        hopping[(phase > np.floor(lift)) & (phase <= np.ceil(land))] = beat.hop
        feet.add(swing, phase, beat.index)
    ease = smooth(phase + LEAD) * smooth((phase[-1] - phase) / 1.5)
    turned, toes = feet.rolled(np.radians(style.tiptoe) * ease, skeleton)
    return Steps(phase, _soften(amount), first, feet.ankles, turned, feet.yaw, toes, feet.planted, _soften(hopping))


def _swing_of(
    beat: _Beat, feet: Feet, route: Route, phase: Array, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Swing:
    """The step from where the foot stands to where the root will pass over it."""
    side = 1 if beat.index == 0 else -1
    at = min(int(np.searchsorted(phase, beat.middle)), len(phase) - 1)
    speed, heading = float(route.speed[at]), float(route.heading[at])
    ahead = np.array([np.sin(heading), np.cos(heading)])
    under_way = min(speed / 0.9, 1.0)
    # A little behind the middle of its stance: the rising heel carries the ankle forward at the end of it.
    middle = route.position[at] - 0.065 * min(speed, 1.6) * np.cos(np.radians(style.aside)) * ahead
    middle = middle - style.drag * under_way * (beat.index == 1) * ahead
    middle = middle + under_way * (0.006 + 2 * style.uneven * 0.1) * rng.standard_normal(2)
    last = len(phase) - 1
    turned = abs(float(route.heading[min(at + 8, last)] - route.heading[max(at - 8, 0)]))
    turning = min(turned / TURNING, 1.0)
    stance = max(style.width, turning * usual_width())
    width = stance * (1 - (0.0 if style.aside == SIDEWAYS else NARROWER) * under_way * (1 - turning))
    target = home_ankle(middle, heading, beat.index, width, skeleton)
    before = max(int(np.searchsorted(phase, beat.window[0])) - 1, 0)
    origin, yaw = feet.ankles[before, beat.index].copy(), float(feet.yaw[before, beat.index])
    beside = feet.ankles[before, 1 - beat.index]
    target = _clear_of(beside, target, heading, side, min(APART, 1.2 * stance) * skeleton.scale)
    forward = float((target - origin)[[0, 2]] @ ahead) / (FULL_STRIDE * skeleton.scale)
    stride = float(np.clip(forward, -1.0, 1.0))
    dragged = 0.6 if style.drag and beat.index == 1 else 1.0
    return Swing(
        origin,
        target,
        yaw,
        heading + side * 0.10,
        side,
        beat.window,
        clearance=style.clearance * (0.25 if beat.hop else dragged),
        heel_off=np.radians(66) * style.roll * abs(stride) ** 0.7 * (0.3 if beat.hop else 1.0),
        heel_strike=TIP_UP * style.strike * abs(stride) * (0.0 if beat.hop else 1.0),
        scuff=np.radians(style.scuff) * float(np.clip(stride / 0.3, 0.0, 1.0)),
        round=_way_round(origin, target, beside, heading, side) * skeleton.scale,
        backwards=stride < -0.05,
    )


def _clear_of(beside: Array, target: Array, heading: float, side: int, apart: float) -> Array:
    """A landing place moved outwards where it would be too near to the other foot, or across it. (3,)."""
    outward = side * np.array([np.cos(heading), 0.0, -np.sin(heading)])
    along = np.array([np.sin(heading), 0.0, np.cos(heading)])
    gap = target - beside
    lack = apart - float(gap @ outward)
    return np.asarray(target + np.clip(lack, 0.0, 0.12) * (abs(float(gap @ along)) < 0.45) * outward)


def _way_round(start: Array, end: Array, beside: Array, heading: float, side: int) -> float:
    """How much further outwards a foot must swing to pass the other one (metres)."""
    outward = side * np.array([np.cos(heading), 0.0, -np.sin(heading)])
    way = end - start
    share = float(np.clip((beside - start) @ way / max(float(way @ way), 1e-9), 0.0, 1.0))
    gap = float((start + share * way - beside) @ outward)
    return float(np.clip(APART - gap, 0.0, 0.24)) if 0.05 < share < 0.95 else 0.0


def _soften(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, 5.0, mode="constant"))
