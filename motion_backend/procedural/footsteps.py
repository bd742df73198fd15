"""Footsteps along a route: when each foot lifts, where it lands, how it rolls from heel to ball.

A foot lands where the root will pass at the middle of its stance, so one rule serves walking, turning in place,
starting and stopping. Phase grows by one with every step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.route import Route
from motion_backend.procedural.walk_styles import Walk
from motion_backend.skeleton import INDEX, Skeleton

Array = NDArray[np.float64]

LEAD = 0.35
"""Phase before the first step."""


HEEL = np.array([0.0, -0.066, -0.055])
"""Heel from the ankle at the reference height."""


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
    toes: Array
    """(T, 2)."""
    planted: Array
    """(T, 2)."""


def yaw_of(rotation: Array) -> Array:
    """Heading of a body or foot: where its +Z points on the floor. (...)."""
    forward = rotations.rotate(rotation, np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arctan2(forward[..., 0], forward[..., 2]))


def plan_phase(route: Route, style: Walk, skeleton: Skeleton, fps: int) -> tuple[Route, Array]:
    """Cadence from speed and turning, then enough standing frames for both feet to come home."""
    turning = np.abs(np.gradient(route.heading)) * fps
    usual = np.sqrt(np.maximum(route.speed, 0.05) / (0.36 * skeleton.scale**1.5)) / style.stride
    longest = route.speed / (min(0.68 * style.stride, 0.76) * skeleton.scale)
    # A turn takes a step every half right angle or so, a spin fewer: nobody trips along at five steps a second.
    rate = np.maximum.reduce([usual, np.minimum(turning / 0.85, 2.6), longest, np.full_like(usual, 1.25)])
    # The first steps are short: the foot that stays behind must not be left too far.
    walked = np.cumsum(route.speed) / fps
    starting = np.clip((0.55 * skeleton.scale - walked) / 0.25, 0.0, 1.0)
    rate = np.maximum(rate, np.minimum(route.speed / (0.30 * skeleton.scale), 3.2) * starting)
    # A third of a step goes by before the first foot lifts: the weight shifts and the heel rises.
    phase = np.cumsum(rate) / fps - LEAD
    # Both feet step at least once, and a last step in flight comes down before the end.
    total = max(np.ceil(phase[-1] + 0.5), 2.0) + max(0.0, -style.double / 2) + 0.05
    extra = max(int(np.ceil((total - phase[-1]) / 1.7 * fps)), 1)
    tail = phase[-1] + (total - phase[-1]) * np.arange(1, extra + 1) / extra
    longer = Route(
        np.concatenate([route.position, np.repeat(route.position[-1:], extra, axis=0)]),
        np.concatenate([route.heading, np.repeat(route.heading[-1:], extra)]),
        np.concatenate([route.speed, np.zeros(extra)]),
    )
    return longer, np.concatenate([phase, tail])


def _first_foot(start: Pose, route: Route) -> int:
    """The foot that has further to go steps first; in a turn the inner one."""
    turn = route.heading[min(20, len(route.heading) - 1)] - route.heading[0]
    if abs(turn) > 0.15:
        return 1 if turn > 0 else -1
    ahead = np.array([np.sin(route.heading[0]), np.cos(route.heading[0])])
    left, right = (start.ankles[index][[0, 2]] @ ahead for index in (0, 1))
    return 1 if left <= right + 0.01 else -1


def home_ankle(position: Array, heading: Array | float, index: int, width: float, skeleton: Skeleton) -> Array:
    """Where a foot stands under a root at [x, z]. (..., 3)."""
    side = (1 if index == 0 else -1) * width * skeleton.scale
    heading = np.asarray(heading)
    x = position[..., 0] + side * np.cos(heading)
    z = position[..., 1] - side * np.sin(heading)
    return np.stack([x, np.full_like(x, skeleton.ankle_height), z], axis=-1)


def plan_steps(start: Pose, route: Route, phase: Array, style: Walk, skeleton: Skeleton) -> Steps:
    """Where both feet are at every frame, from where they stand at the start."""
    frames = len(phase)
    first = _first_foot(start, route)
    ankles = np.repeat(start.ankles[None], frames, axis=0)
    yaw = np.repeat(yaw_of(start.feet)[None], frames, axis=0)
    pitch = np.zeros((frames, 2))
    planted = np.ones((frames, 2))
    amount = np.zeros(frames)
    for k in range(round(phase[-1])):
        index = 0 if (k % 2 == 0) == (first > 0) else 1
        window = (k + style.double / 2, k + 1 - style.double / 2)
        at = min(int(np.searchsorted(phase, k + 1.5)), frames - 1)
        # A little behind the middle of its stance: the rising heel carries the ankle forward at the end of it.
        ahead = np.array([np.sin(route.heading[at]), np.cos(route.heading[at])])
        middle = route.position[at] - 0.055 * min(float(route.speed[at]), 1.6) * ahead
        target = home_ankle(middle, route.heading[at], index, style.width, skeleton)
        toed_out = float(route.heading[at]) + (1 if index == 0 else -1) * 0.10
        before = max(int(np.searchsorted(phase, window[0])) - 1, 0)
        side = 1 if index == 0 else -1
        foot = _Swing(ankles[before, index].copy(), target, float(yaw[before, index]), toed_out, side)
        amount = np.maximum(amount, foot.size * ((phase > k) & (phase <= k + 1)))
        _swing(foot, phase, window, style, (ankles[:, index], yaw[:, index], pitch[:, index], planted[:, index]))
    ease = smooth(phase + LEAD) * smooth((phase[-1] - phase) / 1.5)
    feet, toes = _roll(ankles, yaw, pitch + np.radians(style.tiptoe) * ease[:, None], skeleton)
    return Steps(phase, _soften(amount), first, ankles, feet, toes, planted)


@dataclass(frozen=True)
class _Swing:
    start: Array
    end: Array
    start_yaw: float
    end_yaw: float
    side: int
    """+1 left, -1 right."""

    @property
    def bow(self) -> Array:
        """How far outwards the foot goes round the other leg: not at all straight ahead, most in a turn. (3,)."""
        turn = float(rotations.wrap(self.end_yaw - self.start_yaw))
        yaw = self.start_yaw + 0.5 * turn
        outward = self.side * np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        return np.asarray(0.085 * min(abs(turn) / 0.5, 1.0) * outward)

    @property
    def size(self) -> float:
        """0 for a foot that is already there, 1 for a full step."""
        turn = abs(float(rotations.wrap(self.end_yaw - self.start_yaw)))
        distance = float(np.linalg.norm(self.end - self.start))
        return float(np.clip(max(distance / 0.5, turn / 1.2), 0.0, 1.0))


def _swing(
    foot: _Swing, phase: Array, window: tuple[float, float], style: Walk, out: tuple[Array, Array, Array, Array]
) -> None:
    """Write one step into the foot's arrays: heel off before, arc, heel first after, then flat until further notice."""
    ankle, yaw, pitch, planted = out
    share = (phase - window[0]) / (window[1] - window[0])
    if foot.size < 0.04:
        return
    after, inside = share > 0, (share > 0) & (share < 1)
    u = np.clip(share[after], 0, 1)
    way = smooth(u)
    ankle[after] = foot.start + way[:, None] * (foot.end - foot.start)
    ankle[after] += (np.sin(np.pi * u) ** 2)[:, None] * foot.bow
    height = style.clearance * (0.55 + 0.45 * foot.size)
    # Up early and down late, so that the ball of the foot is clear of the floor whenever it travels fast.
    ankle[after, 1] += height * np.sin(np.pi * u) ** 0.55 * (1 - 0.25 * u)
    yaw[after] = foot.start_yaw + way * float(rotations.wrap(foot.end_yaw - foot.start_yaw))
    planted[inside] = 0.0
    stride = float(np.clip(np.linalg.norm(foot.end - foot.start) / 0.9, 0.0, 1.0))
    off, strike = np.radians(42) * stride, -np.radians(13) * stride
    begin = max(window[0] - 0.30, -LEAD)
    rise = smooth((phase - begin) / (window[0] - begin))
    leaving = share <= 0
    pitch[leaving] = np.maximum(pitch[leaving], off * rise[leaving])
    pitch[after] = off + (strike - off) * smooth(u / 0.75)
    landed = phase - window[1]
    flat = landed > 0
    pitch[flat] = strike * (1 - smooth(landed[flat] / 0.22))


def _roll(ankles: Array, yaw: Array, pitch: Array, skeleton: Skeleton) -> tuple[Array, Array]:
    """Pitch the feet about ball or heel, moving the ankles with them; returns feet (T, 2, 4) and toe bends (T, 2)."""
    ball = skeleton.offsets[INDEX["left_foot"]]
    heel = HEEL * skeleton.scale
    flat = rotations.yaw_to_quat(yaw)
    bend = np.zeros((*pitch.shape, 3))
    bend[..., 0] = pitch
    feet = rotations.compose(flat, rotations.rotvec_to_quat(bend))
    for pivot, chosen in ((ball, pitch > 0), (heel, pitch < 0)):
        moved = rotations.rotate(flat, pivot) - rotations.rotate(feet, pivot)
        ankles += np.where(chosen[..., None], moved, 0.0)
    return feet, np.maximum(pitch, 0.0)


def _soften(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, 5.0, mode="constant"))
