"""Walking: footsteps planned along a route, stance feet that do not move, and a body carried over them.

The route comes first (root_path.py), then the feet (footsteps.py, foot_trajectory.py); here is what rides on them:
pelvis over its support, hips and chest turning against each other, gaze (numbers in carriage.py). How high the pelvis
is, is in pelvis_height.py, arms are in arm_swing.py.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, settle_from, smooth
from motion_backend.procedural.walk.arm_swing import Depth, arm_spread, swing_arms
from motion_backend.procedural.walk.cadence import cadence, plan_phase
from motion_backend.procedural.walk.carriage import Lean, carriage
from motion_backend.procedural.walk.footsteps import Room, Steps, drift, plan_steps, yaw_of
from motion_backend.procedural.walk.pelvis_height import landing, lifted
from motion_backend.procedural.walk.root_path import SPACING, Route, evenly, plan_route, resample
from motion_backend.procedural.walk.stride import BEATS, Stride
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.procedural.walk.way_junction import junction_table
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

BEYOND = 24
"""So many frames are known of how a walk would have gone on that is cut off (its weight is shifted for them)."""
ABOUT = 3
"""Frames about such a frame in which feet are slow."""
LANDS = 1.0
"""A foot that comes down in one of the next two frames counts as going so far (metres): rather any other frame."""
NEAR = 0.2
"""Who has gone so far along a way is no farther than this from there (metres)."""
REJOINS = 0.8
"""Who is beside a way has come back to it after so much of it (metres)."""


def walk(
    start: Pose, path: Array, end_yaw: float | None, style: Walk, skeleton: Skeleton, rng: np.random.Generator
) -> Pose:
    """Walk from a standing pose along a path (N, 2), ending on both feet at its end, facing `end_yaw` if given."""
    return walk_on(start, path, end_yaw, style, skeleton, rng)[0]


def walk_on(
    start: Pose,
    path: Array,
    end_yaw: float | None,
    style: Walk,
    skeleton: Skeleton,
    rng: np.random.Generator,
    stride: Stride | None = None,
    cut_m: float | None = None,
    room: Room = lambda places: np.full(len(places), np.inf),
    depth: Depth = lambda points: np.full(len(points), -np.inf),
) -> tuple[Pose, Stride | None, Pose | None]:
    """Walk as `walk` does, from a body in the `stride` that the last walk left it in, where there is one.

    With `cut_m` the path goes on after the walk is over, so many metres along it: the body does not stop there, and its
    stride is returned (`way_junction.through_way` joins two ways and says where). Without, it ends standing. Nobody
    staggers beyond the `room` that there is, nor holds arms out into what is solid, which points (N, 3) are so deep in.
    """
    fps, row = FPS, carriage().way
    luck = float(np.clip(rng.standard_normal(), -row.pace_spread_max_sigmas, row.pace_spread_max_sigmas))
    pace = 1 + row.pace_spread_share * luck
    style = replace(style.in_character(), release=end_yaw is not None, speed=style.speed * pace)
    speed, aside = style.speed * skeleton.scale, float(np.radians(style.aside))
    if style.spin:
        path, spun = _way_to_spin_on(path, style)
    if stride is None:
        route = plan_route(path, float(yaw_of(start.hips)), end_yaw, speed, fps, aside)
    else:
        path = np.concatenate([stride.place[None], path[1:]])
        begun = plan_route(path, stride.heading, end_yaw, speed, fps, aside, stride.speed)
        route = begun.after(stride.place, stride.heading, stride.speed)
    if style.spin:
        route = _with_spin(route, style.spin, spun)
    if style.wobble:
        route = _staggering(route, style.wobble, rng, fps, room)
    route, steps = _stepping(start, route, style, skeleton, rng, stride, room)
    spread = arm_spread(route, style, skeleton.scale, depth, stride)
    pose = _carry(start, route, steps, style, skeleton, rng, spread, stride is not None)
    pose = settle_from(start, pose, fps) if stride is None else _taken_up(start, pose, stride, fps)
    if cut_m is None:
        return pose, None, None
    reached = route.reaches(cut_m)
    last = _as_feet_change(steps, pose.pelvis, reached)
    between = slice(min(reached, last), max(reached, last) + 1)
    onwards_m = float(np.linalg.norm(np.diff(route.position[between], axis=0), axis=1).sum())
    gone_m = max(cut_m + (onwards_m if last > reached else -onwards_m), 0.0)
    made = last + 1 - (stride is not None)
    onward = pose.arms[made] - pose.arms[made - 1] if 0 < made < len(pose) else None
    stride = replace(_stride_at(last, path, gone_m, route, steps, spread), arms_onward=onward)
    return pose.at(slice(0, made)), stride, pose.at(slice(made, made + BEYOND))


def _stepping(
    start: Pose,
    route: Route,
    style: Walk,
    skeleton: Skeleton,
    rng: np.random.Generator,
    stride: Stride | None,
    room: Room,
) -> tuple[Route, Steps]:
    """The steps along a route, with the time that the last ones need: who goes on another way than he came along
    hurries his next steps, so as not to leave a foot behind that was put down for the old way."""
    row, state = cadence(), rng.bit_generator.state
    best: tuple[Route, Steps] | None = None
    least = np.inf
    for hurry in row.hurry_ratios:
        rng.bit_generator.state = state
        longer, phase = plan_phase(route, style, skeleton, FPS, rng, stride, hurry)
        steps = plan_steps(start, longer, phase, style, skeleton, rng, stride, room)
        away = np.linalg.norm(steps.ankles[..., [0, 2]] - longer.position[:, None], axis=-1) * steps.planted
        if best is not None and away.max() >= least:
            break
        best, least = (longer, steps), float(away.max())
        if stride is None or least < row.left_behind_m * skeleton.scale:
            break
    assert best is not None
    return best


def _as_feet_change(steps: Steps, pelvis: Array, frame: int) -> int:
    """The frame within half a step of that one about which feet are slowest and change their pace least, while the body
    goes on: nobody changes his walk in mid-swing, as a foot comes down on a leg that then gives, nor over a foot."""
    from scipy.ndimage import maximum_filter1d

    sooner, later = junction_table().feet_change_steps
    about = np.array([-sooner, later]) + steps.phase[frame]
    first, last = np.clip(np.searchsorted(steps.phase, about), (frame + 1) // 2, len(steps.phase) - 1)
    if last <= first:
        return frame
    # What comes just before and after these frames counts as well.
    gone = np.diff(steps.ankles, axis=0)
    rough = rotations.length(gone) + rotations.length(np.diff(gone, axis=0, prepend=gone[:1]))
    rough = maximum_filter1d(rough[..., 0].max(axis=1), ABOUT, mode="nearest")[first:last]
    speed = rotations.length(np.diff(pelvis[:, [0, 2]], axis=0))[first:last, 0]
    lands = np.append((np.diff(steps.planted, axis=0) > 0).any(axis=1), (False, False))
    landing = (lands[:-1] | lands[1:])[first:last]
    return int(first + np.argmin(np.where(speed >= np.median(speed), rough + LANDS * landing, np.inf)))


def _taken_up(start: Pose, pose: Pose, stride: Stride, fps: int) -> Pose:
    """A walk whose first frame is the pose it starts from, and is over already."""
    settled, row = settle_from(start, pose, fps), carriage().way
    if stride.borrowed:
        # A leg that is held high as well stays straight until its foot lifts, and pops then.
        pelvis = np.stack([settled.pelvis[:, 0], pose.pelvis[:, 1], settled.pelvis[:, 2]], axis=1)
        settled = replace(settled, pelvis=pelvis)
    apart = start.arms - pose.arms[0]
    if float(np.linalg.norm(apart, axis=-1).max()) < row.same_arms:
        # Arms go on swinging: what little they are off fades out.
        fade = 1 - smooth(np.arange(len(pose)) / (row.same_arms_s * fps))
        poles = fade[:, None, None] * (start.elbows - pose.elbows[0])
        settled = replace(settled, arms=pose.arms + fade[:, None, None] * apart, elbows=pose.elbows + poles)
    if stride.arms_onward is not None and len(pose) > 1:
        # They go on as fast as they went, too.
        frames = np.arange(len(pose))
        swung = frames * (1 - smooth(frames / (row.same_arms_s * fps)))
        faster = stride.arms_onward - (settled.arms[1] - start.arms)
        settled = replace(settled, arms=settled.arms + swung[:, None, None] * faster)
    return settled.at(slice(1, len(settled)))


def _stride_at(frame: int, path: Array, gone_m: float, route: Route, steps: Steps, spread: Array) -> Stride:
    """What a walk that goes on leaves the next one at a frame, at which so much of the path is behind it."""
    phase = float(steps.phase[frame])
    begun = [step for step in steps.made if step.begun(phase)]
    under_way = [step for step in begun if not step.over(phase)]
    ankles, yaw = steps.flat[frame].copy(), steps.yaw[frame].copy()
    for step in reversed(under_way):
        ankles[step.index], yaw[step.index] = step.swing.start, step.swing.start_yaw
    earlier = BEATS * int(np.floor(phase / BEATS))
    points = resample(path)
    # A way that turns back comes by the same place again.
    first = max(int((gone_m - NEAR) / SPACING), 0)
    about = points[first : first + 2 * int(NEAR / SPACING)]
    here = first + int(np.argmin(np.linalg.norm(about - route.position[frame], axis=1)))
    # Who staggers is beside the way, and comes back to it little by little.
    beside = 1 - smooth(SPACING * np.arange(len(points) - here) / REJOINS)
    rest = points[here:] + beside[:, None] * (route.position[frame] - points[here])
    return Stride(
        phase=phase - earlier,
        begun=max((step.number for step in begun if not step.hop), default=-1) - earlier,
        first=steps.first,
        speed=float(route.speed[frame]),
        step_m=float(route.speed[frame] / (FPS * (steps.phase[frame] - steps.phase[frame - 1]))),
        place=route.position[frame],
        heading=float(rotations.wrap(route.heading[frame])),
        moving=float(steps.moving[frame]),
        ankles=ankles,
        yaw=yaw,
        steps=tuple(step.later(-earlier) for step in under_way),
        tiptoe=steps.tiptoe[frame],
        spread=spread[frame],
        arms_onward=None,
        shift=np.zeros((0, 3)),
        rest=rest,
    )


def _way_to_spin_on(path: Array, style: Walk) -> tuple[Array, Array]:
    """A path (N, 2) without its end, over which whole turns are made, and that end. (M, 2) each.

    Who runs stops there.
    """
    row, points = carriage().way, resample(path)
    wanted = row.spin_mps * style.spin * 2 * np.pi / row.spin_rad_per_s * (style.double > 0)
    split = max(len(points) - 1 - int(wanted / SPACING), len(points) // 2)
    return points[: split + 1], points[split:]


def _with_spin(route: Route, turns: float, spun: Array) -> Route:
    """Whole turns made while going on along points (M, 2)."""
    row = carriage().way
    frames = int((turns * 2 * np.pi / row.spin_rad_per_s + row.spin_eases_s) * FPS)
    share = evenly(frames, FPS)
    along = share * (len(spun) - 1)
    places = np.stack([np.interp(along, np.arange(len(spun)), spun[:, axis]) for axis in (0, 1)], axis=1)
    speed = np.linalg.norm(np.diff(places, axis=0, prepend=spun[:1]), axis=1) * FPS
    return Route(
        np.concatenate([route.position, places]),
        np.concatenate([route.heading, route.heading[-1] + 2 * np.pi * turns * share]),
        np.concatenate([route.speed, speed]),
    )


def _staggering(route: Route, size: float, rng: np.random.Generator, fps: int, room: Room) -> Route:
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    row, frames = carriage().way, len(route.heading)
    at = np.arange(frames)
    ease = smooth(at / row.stagger_ease_frames) * smooth((frames - 1 - at) / row.stagger_ease_frames)
    # Before it is narrow one pulls oneself together.
    eases = int(row.stagger_ease_frames)
    free = minimum_filter1d(np.clip(room(route.position), 0.0, row.stagger_room_m), 2 * eases, mode="nearest")
    ease = ease * gaussian_filter1d(free / row.stagger_room_m, eases / 2, mode="nearest")
    aside = row.stagger_aside_m * size * ease * drift(frames, row.stagger_aside_hz, fps, rng)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    turned = np.radians(row.stagger_turn_deg) * size * ease * drift(frames, row.stagger_turn_hz, fps, rng)
    yaw = route.heading + turned
    return Route(route.position + aside[:, None] * left, yaw, route.speed)


def _carry(
    start: Pose,
    route: Route,
    steps: Steps,
    style: Walk,
    skeleton: Skeleton,
    rng: np.random.Generator,
    spread: Array,
    in_stride: bool,
) -> Pose:
    """Everything above the feet: pelvis over its support, hips and chest turning against each other, arms, gaze."""
    row, frames = carriage(), len(steps.phase)
    moving = steps.moving * smooth((steps.phase[-1] - steps.phase) / row.sway.last_steps)
    unsteady = style.wobble * drift(frames, row.drunk.hz, FPS, rng)
    brisk = np.clip(route.speed, 0.0, row.surge.brisk_max_mps) * moving * np.cos(np.radians(style.aside))
    ground = _support(route, steps, style, (moving, brisk, unsteady))
    wander = _wander(frames, rng)
    hips, spine, hip_turn, jolt = _trunk(route, steps, style, (moving, brisk, unsteady))
    spine = spine + moving[:, None] * wander[:, :3]
    arms, elbows = swing_arms(style, steps, route.speed, spread, wander[:, 3:7].reshape(-1, 2, 2))
    pose = Pose(
        pelvis=np.stack([ground[:, 0], np.zeros(frames), ground[:, 1]], axis=1),
        hips=hips,
        spine=spine,
        head=_gaze(route, style, hip_turn, (unsteady, jolt), rng) + moving[:, None] * wander[:, 7:],
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
    return replace(pose, pelvis=lifted(pose, route, steps, style, skeleton, in_stride))


def _trunk(
    route: Route, steps: Steps, style: Walk, moved: tuple[Array, Array, Array]
) -> tuple[Array, Array, Array, Array]:
    """Hips (T, 4) and spine (T, 3) that turn and tip against each other; of these how far the hips turn with the steps,
    and the jolts of the chest. (T,) each; `moved` as in `_support`."""
    (moving, brisk, unsteady), row, own = moved, carriage(), style.character
    hip_turn, counter = (
        np.radians(style.twist) * steps.first * np.cos(np.pi * (steps.phase - late)) * moving
        for late in (row.lean.hips_late_share, -row.lean.counter_early_share)
    )
    roll, shoulders = _rolls(steps, style, moving)
    lean, walking = _leaning(route, style, brisk)
    nods = own.nod_ratio * brisk
    tilt = (
        row.lean.hips_share * lean + walking + row.lean.hips_wave_rad * nods * steps.wave(row.lean.hips_wave_at_phase)
    )
    hips = rotations.compose(
        rotations.yaw_to_quat(route.heading + hip_turn + np.radians(own.hips_turn_deg) * moving),
        rotations.rotvec_to_quat(np.stack([tilt, np.zeros_like(tilt), roll], axis=1)),
    )
    jolt = row.lean.jolt_rad * nods * steps.wave(row.lean.jolt_at_phase)
    jolt = jolt + row.lean.stamp_rad_per_m * style.stamp * landing(steps)
    forward = row.lean.spine_share * lean + row.drunk.lean_rad * unsteady + jolt
    turned = row.lean.looks_share * np.radians(style.veer) * moving
    turned = turned + np.radians(own.shoulder_turn_deg) * moving - row.lean.counter_ratio * own.counter_ratio * counter
    turned = turned + _chest_first(route)
    spine = np.stack([forward, turned, shoulders - roll + row.drunk.side_rad * unsteady], axis=1)
    return hips, spine, hip_turn, jolt


def _rolls(steps: Steps, style: Walk, moving: Array) -> tuple[Array, Array]:
    """How far pelvis and shoulders are tipped, the left side up. (T,) radians each."""
    row, own = carriage().sway, style.character
    tips = -np.radians(style.hips) * steps.first * moving
    roll = tips * np.sin(np.pi * (steps.phase - row.drops_late_share))
    shoulders = tips * np.sin(np.pi * (steps.phase - row.drops_late_share - row.shoulders_late_share))
    shoulders = row.shoulders_ratio * own.shoulder_swing_ratio * shoulders + np.radians(own.shoulder_roll_deg) * moving
    return roll + np.radians(own.hips_roll_deg) * moving, shoulders


def _wander(frames: int, rng: np.random.Generator) -> Array:
    """What trunk (3), arms (2 each) and head (3) do that no step asks for: slow wandering, and the tremble of steps
    taken on a real floor. (T, 10) radians."""
    row = carriage().wander
    slow = np.repeat([row.trunk_deg, row.arms_deg, row.head_deg], (3, 4, 3))
    quick = np.repeat([row.trunk_trembles_deg, row.arms_tremble_deg, row.head_trembles_deg], (3, 4, 3))
    wandered = [
        one * drift(frames, row.hz, FPS, rng) + other * drift(frames, row.trembles_hz, FPS, rng)
        for one, other in zip(slow, quick, strict=True)
    ]
    return np.asarray(np.radians(np.stack(wandered, axis=1)))


def _support(route: Route, steps: Steps, style: Walk, moved: tuple[Array, Array, Array]) -> Array:
    """Where the pelvis is on the floor: over the foot that bears, ahead of its mean way after it came down. (T, 2).

    `moved` is how much the body moves, how briskly, and how unsteadily, (T,) each.
    """
    (moving, brisk, unsteady), row = moved, carriage()
    wave = np.sin(np.pi * (steps.phase - row.sway.late_share))
    slow = np.clip(
        row.sway.standing_ratio - row.sway.less_per_mps * route.speed, row.sway.min_ratio, row.sway.max_ratio
    )
    aside = -steps.first * style.sway * slow * wave * moving + row.drunk.aside_m * unsteady
    surge = row.surge.ahead_m * brisk * steps.wave(row.surge.at_phase)
    left = np.stack([np.cos(route.heading), -np.sin(route.heading)], axis=1)
    ahead = np.stack([np.sin(route.heading), np.cos(route.heading)], axis=1)
    return np.asarray(route.position + aside[:, None] * left + surge[:, None] * ahead)


def _leaning(route: Route, style: Walk, brisk: Array) -> tuple[Array, Array]:
    """How far trunk and pelvis bend forwards, and how far a body in its walk leans from its hips. (T,) each."""
    row, frames = carriage().lean, len(route.heading)
    # A bowed body straightens up a little where it arrives, so as not to bump its head.
    since = np.arange(frames) - frames + row.straightens_frames
    arriving = smooth(np.asarray(since / row.straightens_frames))
    bowed = style.bearing.lean > row.bowed_from_deg
    lean = np.radians(style.bearing.lean) * (1 - row.straightens_share * arriving * bowed)
    fast = np.clip(route.speed - row.fast_from_mps, 0, row.fast_within_mps)
    return np.asarray(lean), np.asarray(row.walking_rad * brisk + row.fast_rad_per_mps * fast + _falling(route, row))


def _falling(route: Route, row: Lean) -> Array:
    """How far a body that sets out falls forward before its steps catch it. (T,)."""
    ahead = np.minimum(np.arange(len(route.speed)) + round(row.falls_ahead_s * FPS), len(route.speed) - 1)
    to_come = np.maximum(route.speed[ahead] - route.speed, 0.0)
    gone = np.cumsum(route.speed) / FPS
    return np.asarray(row.falls_rad_per_mps * to_come * np.clip(1.0 - gone / row.falls_within_m, 0.0, 1.0))


def _gaze(route: Route, style: Walk, hip_turn: Array, moved: tuple[Array, Array], rng: np.random.Generator) -> Array:
    """The head: it looks where the way goes, keeps level over the steps, and does what the mood does. (T, 3)."""
    table, frames = carriage(), len(route.heading)
    (unsteady, jolt), row = moved, table.gaze
    at = np.arange(frames)
    ease = smooth(at / row.start_frames) * smooth((frames - 1 - at) / row.end_frames)
    turn = np.clip(_coming(route, row.ahead_frames), -row.turn_max_rad, row.turn_max_rad) + row.counter_ratio * hip_turn
    turn = turn - _chest_first(route)
    turn = turn + np.radians(style.glance) * ease * drift(frames, row.glance_hz, FPS, rng)
    seconds = at / FPS
    veering = smooth(seconds / row.veer_start_s) * smooth((seconds[-1] - seconds) / row.veer_end_s)
    turn = turn + np.radians(style.veer) * veering
    level = row.level_share * table.lean.walking_rad * np.clip(route.speed, 0.0, table.surge.brisk_max_mps)
    upright = level + row.fast_rad_per_mps * np.clip(route.speed - row.fast_from_mps, 0, row.fast_within_mps)
    nod = np.radians(style.bearing.head) - upright + table.drunk.nod_rad * unsteady - row.jolt_share * jolt
    nod = nod + np.radians(style.nod) * ease * drift(frames, row.nod_hz, FPS, rng)
    return np.stack([nod, turn, np.radians(style.tilt) * ease + table.drunk.tilt_rad * unsteady], axis=1)


def _coming(route: Route, frames: int) -> Array:
    """How far the way will have turned so many frames later. (T,) radians."""
    later = np.concatenate([route.heading[frames:], np.full(frames, route.heading[-1])])
    return np.asarray(later[: len(route.heading)] - route.heading)


def _chest_first(route: Route) -> Array:
    """How far the chest has turned into a turn before the pelvis. (T,) radians."""
    row = carriage().gaze
    return np.asarray(np.clip(_coming(route, row.chest_ahead_frames), -row.chest_max_rad, row.chest_max_rad))


def _knees(hips: Array, feet: Array) -> Array:
    """Knees point between where the pelvis (T, 4) and the foot (T, 2) yaw point. (T, 2, 3)."""
    forward = np.array([0.0, 0.0, 1.0])
    row, ahead = carriage().knees, yaw_of(hips)[:, None]
    off = np.clip(rotations.wrap(feet - ahead), -row.foot_max_rad, row.foot_max_rad)
    ahead = ahead - row.inwards_rad * np.array([1.0, -1.0])
    pelvis, foot = (rotations.rotate(rotations.yaw_to_quat(yaw), forward) for yaw in (ahead, ahead + off))
    return rotations.normalize(pelvis + row.foot_ratio * foot)
