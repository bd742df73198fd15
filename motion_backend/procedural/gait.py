"""Walking: footsteps planned along a route, stance feet that do not move, and a body carried over them.

The route comes first (route.py); a foot lands where the root will pass at the middle of its stance, so one rule
serves walking, turning in place, starting and stopping. Phase grows by one with every step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.pose import Pose, settle_from, smooth
from motion_backend.procedural.route import Route, plan_route
from motion_backend.procedural.styles import ARMS, Walk, arm_arrays
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


def walk(
    start: Pose, path: Array, end_yaw: float | None, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Pose:
    """Walk from a standing pose along a path (N, 2), ending on both feet at its end, facing `end_yaw` if given."""
    fps = 30
    route = plan_route(path, float(yaw_of(start.hips)), end_yaw, style.speed * skeleton.scale, fps)
    if style.spin:
        route = _with_spin(route, style.spin, fps)
    if style.wobble:
        route = _staggering(route, style.wobble, rng, fps)
    route, phase = _phase(route, style, skeleton, fps)
    steps = _steps(start, route, phase, style, skeleton)
    pose = _carry(start, route, steps, style, skeleton, rng)
    return settle_from(start, pose, fps)


def _with_spin(route: Route, turns: float, fps: int) -> Route:
    """Whole turns on the spot, half-way along where the body is fastest or at the end of a short way."""
    frames = int(turns * 2 * np.pi / 4.2 * fps)
    at = len(route.heading) - 1
    angle = 2 * np.pi * turns * smooth(np.arange(1, frames + 1) / frames)
    return Route(
        np.concatenate([route.position, np.repeat(route.position[at : at + 1], frames, axis=0)]),
        np.concatenate([route.heading, route.heading[at] + angle]),
        np.concatenate([route.speed, np.zeros(frames)]),
    )


def drift(frames: int, hertz: float, fps: int, rng: np.random.Generator) -> Array:
    """Smooth wandering about zero with unit size: a few slow sines of random phase. (frames,)."""
    time = np.arange(frames) / fps
    rates = hertz * np.array([0.61, 1.0, 1.43])
    phases = rng.uniform(0, 2 * np.pi, 3)
    return np.asarray(np.sin(2 * np.pi * np.outer(time, rates) + phases).sum(axis=1) / 2.1)


def _staggering(route: Route, size: float, rng: np.random.Generator, fps: int) -> Route:
    frames = len(route.heading)
    ease = smooth(np.arange(frames) / 20) * smooth((frames - 1 - np.arange(frames)) / 20)
    aside = 0.07 * size * ease * drift(frames, 0.45, fps, rng)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    yaw = route.heading + np.radians(9) * size * ease * drift(frames, 0.4, fps, rng)
    return Route(route.position + aside[:, None] * left, yaw, route.speed)


def _phase(route: Route, style: Walk, skeleton: Skeleton, fps: int) -> tuple[Route, Array]:
    """Cadence from speed and turning, then enough standing frames for both feet to come home."""
    turning = np.abs(np.gradient(route.heading)) * fps
    usual = np.sqrt(np.maximum(route.speed, 0.05) / (0.36 * skeleton.scale**1.5)) / style.stride
    longest = route.speed / (min(0.68 * style.stride, 0.76) * skeleton.scale)
    rate = np.maximum.reduce([usual, turning / 0.72, longest, np.full_like(usual, 1.25)])
    # A third of a step goes by before the first foot lifts: the weight shifts and the heel rises.
    phase = np.cumsum(rate) / fps - LEAD
    total = np.ceil(phase[-1] + 0.5)
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


def _steps(start: Pose, route: Route, phase: Array, style: Walk, skeleton: Skeleton) -> Steps:
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
        foot = _Swing(ankles[before, index].copy(), target, float(yaw[before, index]), toed_out)
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
    height = style.clearance * (0.35 + 0.65 * foot.size)
    # Up early and down late, so that the ball of the foot is clear of the floor whenever it travels fast.
    ankle[after, 1] += height * np.sin(np.pi * u) ** 0.55 * (1 - 0.25 * u)
    yaw[after] = foot.start_yaw + way * float(rotations.wrap(foot.end_yaw - foot.start_yaw))
    planted[inside] = 0.0
    stride = float(np.clip(np.linalg.norm(foot.end - foot.start) / 0.9, 0.0, 1.0))
    off, strike = np.radians(34) * stride, -np.radians(13) * stride
    begin = max(window[0] - 0.42, -LEAD)
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


def _carry(start: Pose, route: Route, steps: Steps, style: Walk, skeleton: Skeleton, rng: np.random.Generator) -> Pose:
    """Everything above the feet: pelvis over its support, hips and chest turning against each other, arms, gaze."""
    frames = len(steps.phase)
    bearing, moving, first = style.bearing, steps.moving, steps.first
    cycle, wave = np.cos(np.pi * steps.phase), np.sin(np.pi * steps.phase)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    unsteady = style.wobble * drift(frames, 0.5, 30, rng)
    aside = -first * style.sway * wave * moving + 0.03 * unsteady
    ground = route.position + aside[:, None] * left
    hip_turn = np.radians(style.twist) * first * cycle * moving
    roll = -np.radians(2.5) * first * wave * moving
    # A bowed body straightens up a little where it arrives, so as not to bump its head.
    arriving = smooth((np.arange(frames) - frames + 30) / 30)
    lean = np.radians(bearing.lean) * (1 - 0.55 * arriving * (bearing.lean > 8))
    lean = lean + 0.03 * np.clip(route.speed - 1.0, 0, 1)
    hips = rotations.compose(
        rotations.yaw_to_quat(route.heading + hip_turn),
        rotations.rotvec_to_quat(np.stack([np.full(frames, 0.3) * lean, np.zeros(frames), roll], axis=1)),
    )
    spine = np.stack([0.7 * lean + 0.10 * unsteady, -1.7 * hip_turn, -1.4 * roll + 0.12 * unsteady], axis=1)
    ahead = np.concatenate([route.heading[12:], np.full(min(12, frames), route.heading[-1])])[:frames]
    gaze = np.clip(ahead - route.heading, -0.6, 0.6) + 0.7 * hip_turn
    nod = np.radians(bearing.head) - 0.1 * np.clip(route.speed - 1.2, 0, 1) + 0.12 * unsteady
    arms, elbows = _swinging(style, steps, 30)
    pose = Pose(
        pelvis=np.stack([ground[:, 0], np.zeros(frames), ground[:, 1]], axis=1),
        hips=hips,
        spine=spine,
        head=np.stack([nod, gaze, 0.08 * unsteady], axis=1),
        ankles=steps.ankles,
        feet=steps.feet,
        toes=steps.toes,
        knees=_knees(hips, steps.feet),
        arms=arms,
        elbows=elbows,
        reach=np.repeat(start.reach[None], frames, axis=0),
        reaching=np.zeros((frames, 2)),
        palms=np.repeat(start.palms[None], frames, axis=0),
        pressing=np.zeros((frames, 2)),
        planted=steps.planted,
    )
    return replace(pose, pelvis=_height(pose, steps, style, skeleton))


def _knees(hips: Array, feet: Array) -> Array:
    """Knees point between where the pelvis and the foot point. (T, 2, 3)."""
    forward = np.array([0.0, 0.0, 1.0])
    pelvis = rotations.rotate(rotations.yaw_to_quat(yaw_of(hips)), forward)
    foot = rotations.rotate(rotations.yaw_to_quat(yaw_of(feet)), forward)
    return rotations.normalize(pelvis[:, None] + 1.2 * foot)


def _height(pose: Pose, steps: Steps, style: Walk, skeleton: Skeleton) -> Array:
    """Pelvis positions with the height that the bounce asks for and the legs allow. (T, 3)."""
    from scipy.ndimage import gaussian_filter1d

    pelvis = pose.pelvis.copy()
    beat = -np.cos(2 * np.pi * steps.phase) * (1 if style.double > 0 else -1)
    carried = skeleton.standing_height * 0.993 - (style.crouch + 0.012) * skeleton.scale
    carried = carried + 0.05 * skeleton.scale * np.sin(np.radians(style.tiptoe)) + 0.01 * (style.tiptoe > 0)
    wanted = carried + style.bounce * skeleton.scale * steps.moving * (beat - (0.3 if style.double > 0 else 0.0))
    leg = -float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1]) * 0.994
    limits = []
    for index, name in enumerate(("left", "right")):
        hip = rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{name}_hip"]])
        gap = np.hypot(*(pelvis + hip - pose.ankles[:, index])[:, [0, 2]].T)
        top = pose.ankles[:, index, 1] + np.sqrt(np.maximum(leg**2 - gap**2, 0.04)) - hip[:, 1]
        # Feet in the air do not hold the body down.
        limits.append(np.where(pose.planted[:, index] > 0, top, np.maximum(top, carried - 0.09)))
    allowed = np.minimum(*limits)
    low = np.minimum(wanted, allowed)
    eased = gaussian_filter1d(low - wanted, 2.5, mode="nearest")
    pelvis[:, 1] = np.minimum(wanted + eased, allowed)
    return pelvis


def _spread(frames: int, arms: str, fps: int) -> Array:
    """Share of an arm pose that takes room: arms open once the body is under way and come down before it arrives."""
    if arms not in ("open", "balance"):
        return np.ones(frames)
    at = np.arange(frames) / fps
    return smooth((at - 0.25) / 0.8) * smooth((at[-1] - at) / 0.7)


def _swinging(style: Walk, steps: Steps, fps: int) -> tuple[Array, Array]:
    """Wrists and elbow directions: arms that hang swing against the legs, others keep their pose. (T, 2, 3) each."""
    frames = len(steps.phase)
    fixed, poles = arm_arrays(*style.bearing.arms)
    wrists, elbows = np.repeat(fixed[None], frames, axis=0), np.repeat(poles[None], frames, axis=0)
    upper, lower = 0.541, 0.459
    for index, side in ((0, 1), (1, -1)):
        beat = side * steps.first * np.cos(np.pi * steps.phase) * steps.moving
        if style.bearing.arms[index] in ("hang", "bent"):
            bent = style.elbow + (25 if style.bearing.arms[index] == "bent" else 0)
            swing = np.radians(style.swing) * beat + np.radians(3)
            bend = np.radians(8 + (bent - 8) * (0.35 + 0.65 * steps.moving)) + 0.35 * np.maximum(swing, 0)
            shoulder, fore = swing - 0.25 * bend, swing + 0.75 * bend
            wrists[:, index, 1] = -upper * np.cos(shoulder) - lower * np.cos(fore)
            wrists[:, index, 2] = upper * np.sin(shoulder) + lower * np.sin(fore)
            wrists[:, index, 0] = side * (0.17 - 0.10 * np.maximum(np.sin(swing), 0))
            wrists[:, index] *= np.minimum(1, 0.985 / np.linalg.norm(wrists[:, index], axis=1))[:, None]
        else:
            wrists[:, index, 2] += 0.02 * beat
            spread = _spread(frames, style.bearing.arms[index], fps)
            hang = np.asarray(ARMS["hang"].wrist) * [side, 1, 1]
            between = hang + spread[:, None] * (wrists[:, index] - hang)
            length = np.linalg.norm(hang) + spread * (np.linalg.norm(wrists[:, index], axis=1) - np.linalg.norm(hang))
            wrists[:, index] = rotations.normalize(between) * length[:, None]
        if style.tap:
            beating = np.maximum(np.sin(2 * np.pi * 1.6 * np.arange(frames) / fps + (0 if side > 0 else np.pi)), 0)
            wrists[:, index, 2] += 0.16 * beating
    return wrists, elbows
