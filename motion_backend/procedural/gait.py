"""Walking: footsteps planned along a route, stance feet that do not move, and a body carried over them.

The route comes first (route.py), then the feet (footsteps.py); here is what rides on them: pelvis over its support,
hips and chest turning against each other, arms and gaze.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.footsteps import LEAD, Steps, plan_phase, plan_steps, yaw_of
from motion_backend.procedural.pose import Pose, settle_from, smooth
from motion_backend.procedural.route import Route, plan_route
from motion_backend.procedural.styles import ARMS, arm_arrays
from motion_backend.procedural.walk_styles import Walk
from motion_backend.skeleton import INDEX, Skeleton

Array = NDArray[np.float64]
SPIN_RATE = 2.8
"""How fast a body spins about itself (radians a second)."""


def walk(
    start: Pose, path: Array, end_yaw: float | None, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Pose:
    """Walk from a standing pose along a path (N, 2), ending on both feet at its end, facing `end_yaw` if given."""
    fps = FPS
    style = replace(style, release=end_yaw is not None)
    route = plan_route(path, float(yaw_of(start.hips)), end_yaw, style.speed * skeleton.scale, fps)
    if style.spin:
        route = _with_spin(route, style.spin, fps)
    if style.wobble:
        route = _staggering(route, style.wobble, rng, fps)
    route, phase = plan_phase(route, style, skeleton, fps)
    steps = plan_steps(start, route, phase, style, skeleton)
    pose = _carry(start, route, steps, style, skeleton, rng)
    return settle_from(start, pose, fps)


def _with_spin(route: Route, turns: float, fps: int) -> Route:
    """Whole turns on the spot, half-way along where the body is fastest or at the end of a short way."""
    frames = int((turns * 2 * np.pi / SPIN_RATE + 0.4) * fps)
    at = len(route.heading) - 1
    # Even turning with a short ease at both ends: a peak would take more steps than feet can make.
    share = np.arange(1, frames + 1) / frames
    ease = 0.4 * fps / frames
    angle = np.cumsum(smooth(share / ease) * smooth((1 - share) / ease))
    angle = 2 * np.pi * turns * angle / angle[-1]
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


def _carry(start: Pose, route: Route, steps: Steps, style: Walk, skeleton: Skeleton, rng: np.random.Generator) -> Pose:
    """Everything above the feet: pelvis over its support, hips and chest turning against each other, arms, gaze."""
    frames = len(steps.phase)
    bearing, moving, first = style.bearing, steps.moving, steps.first
    cycle, wave = np.cos(np.pi * steps.phase), np.sin(np.pi * steps.phase)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    unsteady = style.wobble * drift(frames, 0.5, FPS, rng)
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
    arms, elbows = _swinging(style, steps)
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
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    pelvis = pose.pelvis.copy()
    beat = -np.cos(2 * np.pi * steps.phase) * (1 if style.double > 0 else -1)
    at_rest = skeleton.standing_height * 0.998 - (0.004 + 0.3 * style.crouch) * skeleton.scale
    walking = skeleton.standing_height * 0.993 - (style.crouch + 0.012) * skeleton.scale
    # The last step ends upright: legs straighten as the feet come together.
    ending = smooth((steps.phase[-1] - steps.phase) / 0.8)
    under_way = np.clip(1.6 * steps.moving, 0.0, 1.0) * ending
    carried = at_rest + under_way * (walking - at_rest)
    lifted = 0.05 * skeleton.scale * np.sin(np.radians(style.tiptoe)) + 0.01 * (style.tiptoe > 0)
    carried = carried + lifted * smooth(steps.phase + LEAD) * smooth((steps.phase[-1] - steps.phase) / 1.5)
    quick = np.clip(np.hypot(*np.gradient(pelvis[:, [0, 2]], axis=0).T) * FPS / 0.8, 0.35, 1.0)
    bounce = style.bounce * skeleton.scale * steps.moving * quick * ending
    wanted = carried + bounce * (beat - (0.9 if style.double > 0 else 0.0))
    leg = -float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1]) * 0.998
    limits = []
    for index, name in enumerate(("left", "right")):
        hip = rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{name}_hip"]])
        gap = np.hypot(*(pelvis + hip - pose.ankles[:, index])[:, [0, 2]].T)
        top = pose.ankles[:, index, 1] + np.sqrt(np.maximum(leg**2 - gap**2, 0.04)) - hip[:, 1]
        # Feet in the air do not hold the body down.
        limits.append(np.where(pose.planted[:, index] > 0, top, np.maximum(top, carried - 0.09)))
    # The least of a few frames, then smoothed over no more than these: never above what the legs allow, and no corner.
    low = minimum_filter1d(np.minimum(wanted, np.minimum(*limits)), 5, mode="nearest")
    pelvis[:, 1] = gaussian_filter1d(low, 1.0, radius=2, mode="nearest")
    return pelvis


def _spread(frames: int, arms: str, release: bool) -> Array:
    """Share of an arm pose: open arms wait until the body is under way, and all but those that carry something
    come down where something is begun."""
    at = np.arange(frames) / FPS
    takes_room = arms in ("open", "balance")
    begun = smooth((at - 0.25) / 0.8) if takes_room else np.ones(frames)
    comes_down = takes_room or (release and arms != "carry")
    return begun * smooth((at[-1] - at) / 0.7) if comes_down else begun


def _swinging(style: Walk, steps: Steps) -> tuple[Array, Array]:
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
            spread = _spread(frames, style.bearing.arms[index], style.release)
            hang = np.asarray(ARMS["hang"].wrist) * [side, 1, 1]
            between = hang + spread[:, None] * (wrists[:, index] - hang)
            length = np.linalg.norm(hang) + spread * (np.linalg.norm(wrists[:, index], axis=1) - np.linalg.norm(hang))
            wrists[:, index] = rotations.normalize(between) * length[:, None]
        if style.tap:
            beating = np.maximum(np.sin(2 * np.pi * 1.6 * np.arange(frames) / FPS + (0 if side > 0 else np.pi)), 0)
            wrists[:, index] += [0.14 * side, 0.06 * side, 0.02]
            wrists[:, index, 2] += 0.16 * beating
    return wrists, elbows
