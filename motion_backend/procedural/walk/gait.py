"""Walking: footsteps planned along a route, stance feet that do not move, and a body carried over them.

The route comes first (route.py), then the feet (footsteps.py, swinging.py); here is what rides on them: pelvis over its
support, hips and chest turning against each other, gaze; arms are in arm_swing.py.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, settle_from, smooth
from motion_backend.procedural.walk.arm_swing import swing_arms
from motion_backend.procedural.walk.footsteps import LEAD, Steps, drift, plan_phase, plan_steps, yaw_of
from motion_backend.procedural.walk.root_path import Route, evenly, plan_route
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

SPIN_RATE = 2.8
"""How fast a body spins about itself (radians a second)."""
PACE_SPREAD = 0.03
"""Two walks of one style differ in speed by about this share."""
SURGE = 0.013
"""How far the pelvis runs ahead of its mean way after each heel strike, and behind before it (metres)."""
LEANING = 0.045
"""How much further forward the trunk is carried in walking than in standing (radians)."""
LATE, DROPS_LATE = 0.06, 0.2
"""How much later than half-way through a stance the body is farthest over the foot, and the other side of the pelvis
lowest (share of a step)."""
HOP = 0.07
"""How far the pelvis goes up and down in a skip (metres)."""


def walk(
    start: Pose, path: Array, end_yaw: float | None, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Pose:
    """Walk from a standing pose along a path (N, 2), ending on both feet at its end, facing `end_yaw` if given."""
    fps = FPS
    pace = 1 + PACE_SPREAD * float(np.clip(rng.standard_normal(), -2, 2))
    style = replace(style, release=end_yaw is not None, speed=style.speed * pace)
    speed, aside = style.speed * skeleton.scale, float(np.radians(style.aside))
    route = plan_route(path, float(yaw_of(start.hips)), end_yaw, speed, fps, aside)
    if style.spin:
        route = _with_spin(route, style.spin, fps)
    if style.wobble:
        route = _staggering(route, style.wobble, rng, fps)
    route, phase = plan_phase(route, style, skeleton, fps, rng)
    steps = plan_steps(start, route, phase, style, skeleton, rng)
    pose = _carry(start, route, steps, style, skeleton, rng)
    return settle_from(start, pose, fps)


def _with_spin(route: Route, turns: float, fps: int) -> Route:
    """Whole turns on the spot, half-way along where the body is fastest or at the end of a short way."""
    frames = int((turns * 2 * np.pi / SPIN_RATE + 0.4) * fps)
    at = len(route.heading) - 1
    angle = 2 * np.pi * turns * evenly(frames, fps)
    return Route(
        np.concatenate([route.position, np.repeat(route.position[at : at + 1], frames, axis=0)]),
        np.concatenate([route.heading, route.heading[at] + angle]),
        np.concatenate([route.speed, np.zeros(frames)]),
    )


def _staggering(route: Route, size: float, rng: np.random.Generator, fps: int) -> Route:
    frames = len(route.heading)
    ease = smooth(np.arange(frames) / 20) * smooth((frames - 1 - np.arange(frames)) / 20)
    aside = 0.07 * size * ease * drift(frames, 0.45, fps, rng)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    yaw = route.heading + np.radians(9) * size * ease * drift(frames, 0.4, fps, rng)
    return Route(route.position + aside[:, None] * left, yaw, route.speed)


def _carry(start: Pose, route: Route, steps: Steps, style: Walk, skeleton: Skeleton, rng: np.random.Generator) -> Pose:
    """Everything above the feet: pelvis over its support, hips and chest turning against each other, arms, gaze."""
    frames = len(steps.phase)
    bearing, first = style.bearing, steps.first
    moving = steps.moving * smooth((steps.phase[-1] - steps.phase) / 0.8)
    cycle, wave = np.cos(np.pi * steps.phase), np.sin(np.pi * (steps.phase - LATE))
    drop = np.sin(np.pi * (steps.phase - DROPS_LATE))
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    ahead = np.stack([np.sin(route.heading), np.cos(route.heading)], axis=1)
    unsteady = style.wobble * drift(frames, 0.5, FPS, rng)
    # The slower the steps, the further the body goes over to each foot.
    aside = -first * style.sway * np.clip(1.35 - 0.45 * route.speed, 0.5, 1.2) * wave * moving + 0.03 * unsteady
    brisk = np.clip(route.speed, 0.0, 1.2) * moving * np.cos(np.radians(style.aside))
    surge = SURGE * brisk * np.cos(2 * np.pi * (steps.phase - 0.24))
    ground = route.position + aside[:, None] * left + surge[:, None] * ahead
    hip_turn = np.radians(style.twist) * first * cycle * moving
    roll = -np.radians(style.hips) * first * drop * moving
    # A bowed body straightens up a little where it arrives, so as not to bump its head.
    arriving = smooth((np.arange(frames) - frames + 30) / 30)
    lean = np.radians(bearing.lean) * (1 - 0.55 * arriving * (bearing.lean > 8))
    lean = lean + LEANING * brisk + 0.03 * np.clip(route.speed - 1.0, 0, 1)
    tilt = 0.3 * lean + 0.014 * brisk * np.cos(2 * np.pi * (steps.phase + 0.2))
    hips = rotations.compose(
        rotations.yaw_to_quat(route.heading + hip_turn),
        rotations.rotvec_to_quat(np.stack([tilt, np.zeros(frames), roll], axis=1)),
    )
    jolt = 0.014 * brisk * np.cos(2 * np.pi * (steps.phase + 0.14)) + 3 * style.stamp * _landing(steps)
    looking = 0.25 * np.radians(style.veer) * moving
    spine = np.stack([0.7 * lean + 0.10 * unsteady + jolt, looking - 1.7 * hip_turn, -roll + 0.12 * unsteady], axis=1)
    arms, elbows = swing_arms(style, steps, route.speed)
    pose = Pose(
        pelvis=np.stack([ground[:, 0], np.zeros(frames), ground[:, 1]], axis=1),
        hips=hips,
        spine=spine,
        head=_gaze(route, style, hip_turn, (unsteady, jolt), rng),
        ankles=steps.ankles,
        feet=steps.feet,
        toes=steps.toes,
        knees=_knees(hips, steps.yaw),
        arms=arms,
        elbows=elbows,
        reach=np.repeat(start.reach[None], frames, axis=0),
        reaching=np.zeros((frames, 2)),
        palms=np.repeat(start.palms[None], frames, axis=0),
        pressing=np.zeros((frames, 2)),
        planted=steps.planted,
    )
    return replace(pose, pelvis=_height(pose, route, steps, style, skeleton))


def _gaze(route: Route, style: Walk, hip_turn: Array, moved: tuple[Array, Array], rng: np.random.Generator) -> Array:
    """The head: it looks where the way goes, keeps level over the steps, and does what the mood does. (T, 3)."""
    frames = len(route.heading)
    unsteady, jolt = moved
    coming = np.concatenate([route.heading[12:], np.full(min(12, frames), route.heading[-1])])[:frames]
    ease = smooth(np.arange(frames) / 20) * smooth((frames - 1 - np.arange(frames)) / 15)
    turn = np.clip(coming - route.heading, -0.6, 0.6) + 0.7 * hip_turn
    turn = turn + np.radians(style.glance) * ease * drift(frames, 0.4, FPS, rng)
    seconds = np.arange(frames) / FPS
    turn = turn + np.radians(style.veer) * smooth(seconds / 0.5) * smooth((seconds[-1] - seconds) / 0.9)
    upright = 0.6 * LEANING * np.clip(route.speed, 0.0, 1.2) + 0.1 * np.clip(route.speed - 1.2, 0, 1)
    nod = np.radians(style.bearing.head) - upright + 0.12 * unsteady - 0.7 * jolt
    nod = nod + np.radians(style.nod) * ease * drift(frames, 0.35, FPS, rng)
    return np.stack([nod, turn, np.radians(style.tilt) * ease + 0.08 * unsteady], axis=1)


def _landing(steps: Steps) -> Array:
    """1 just after each foot comes down, 0 otherwise. (T,)."""
    since = (steps.phase + 0.02) % 1.0
    return np.asarray(np.exp(-(((since - 0.12) / 0.10) ** 2)) * steps.moving)


def _knees(hips: Array, feet: Array) -> Array:
    """Knees point between where the pelvis (T, 4) and the foot (T, 2) yaw point. (T, 2, 3)."""
    forward = np.array([0.0, 0.0, 1.0])
    pelvis = rotations.rotate(rotations.yaw_to_quat(yaw_of(hips)), forward)
    foot = rotations.rotate(rotations.yaw_to_quat(feet), forward)
    return rotations.normalize(pelvis[:, None] + 2.0 * foot)


def _height(pose: Pose, route: Route, steps: Steps, style: Walk, skeleton: Skeleton) -> Array:
    """Pelvis positions with the height that the bounce asks for and the legs allow. (T, 3)."""
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    pelvis = pose.pelvis.copy()
    at_rest = skeleton.standing_height * 0.998 - (0.004 + 0.3 * style.crouch) * skeleton.scale
    # Long steps need bent knees, or the body would fall into each of them.
    lower = 0.004 + (0.014 * np.clip(route.speed / 0.8, 0.0, 1.0) + 0.025 * np.clip(route.speed - 1.1, 0.0, 0.7)) * (
        style.double > 0
    )
    walking = skeleton.standing_height * 0.996 - (style.crouch + lower) * skeleton.scale
    # The last step ends upright: legs straighten as the feet come together.
    ending = smooth((steps.phase[-1] - steps.phase) / 0.8)
    under_way = np.clip(1.6 * steps.moving, 0.0, 1.0) * ending * smooth((steps.phase - steps.phase[0]) / 0.7)
    carried = at_rest + under_way * (walking - at_rest)
    lifted = 0.05 * skeleton.scale * np.sin(np.radians(style.tiptoe)) + 0.01 * (style.tiptoe > 0)
    carried = carried + lifted * smooth(steps.phase + LEAD) * smooth((steps.phase[-1] - steps.phase) / 1.5)
    wanted = carried + skeleton.scale * ending * _bounce(route, steps, style)
    leg = -float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1]) * 0.998
    limits = []
    for index, name in enumerate(("left", "right")):
        hip = rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{name}_hip"]])
        gap = np.hypot(*(pelvis + hip - pose.ankles[:, index])[:, [0, 2]].T)
        top = pose.ankles[:, index, 1] + np.sqrt(np.maximum(leg**2 - gap**2, 0.04)) - hip[:, 1]
        # Feet in the air do not hold the body down.
        limits.append(np.where(pose.planted[:, index] > 0, top, np.maximum(top, carried - 0.04)))
    # The least of a few frames, then smoothed over no more than these: never above what the legs allow, and no corner.
    low = minimum_filter1d(np.minimum(wanted, np.minimum(*limits)), 5, mode="nearest")
    pelvis[:, 1] = gaussian_filter1d(low, 1.0, radius=2, mode="nearest")
    return pelvis


def _bounce(route: Route, steps: Steps, style: Walk) -> Array:
    """Up and down with the steps: highest over the standing leg, in running and skipping in the air. (T,)."""
    quick = np.clip(route.speed / 1.1, 0.25, 1.4)
    if style.double > 0:
        beat = -np.cos(2 * np.pi * (steps.phase + 0.05))
        walked = style.bounce * quick * beat - style.stamp * _landing(steps)
    else:
        walked = style.bounce * np.minimum(quick, 1.0) * (np.cos(2 * np.pi * steps.phase) - 0.9)
    skipped = HOP * (np.cos(2 * np.pi * (steps.phase - 0.56)) - 0.75) * 0.5
    return np.asarray(steps.moving * (walked + steps.hopping * (skipped - walked)))
