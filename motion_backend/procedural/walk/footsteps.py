"""Footsteps along a route: which foot lifts when, and where it lands.

A foot lands where the root will pass at the middle of its stance, so one rule serves walking, turning in place,
stepping aside or back, starting and stopping. Phase grows by one with every step (cadence.py); how the foot itself
moves from lift to landing is in foot_trajectory.py. The numbers are in data/gait/footsteps.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.foot_trajectory import HEEL_RISE, SETTLE, TIP_UP, Feet, Swing, foot_table
from motion_backend.procedural.walk.root_path import Route
from motion_backend.procedural.walk.stride import Step, Stride
from motion_backend.procedural.walk.walk_styles import Walk, usual_width
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from scene_graphs.data_tables import read_table, table

Room = Callable[[Array], Array]
"""How much room there is beside what a body needs at places [x, z]: (N, 2) to (N,) metres."""
LEAD = 0.35
"""Phase before the first step."""
FOOT_ROOM, TIP_ROOM = -0.06, -0.13
"""An ankle, and the tips of toes, may come so much nearer to what is beside the way than a body (metres)."""
TIP, ON_ITS_WAY = 0.17, (0.35, 0.5, 0.65)
"""From an ankle to the tip of its toes (metres at 1.70 m); shares of a foot's way at which it is looked for room."""
SIDEWAYS = 90.0
"""How far from its way a body faces that steps sideways (degrees)."""
DRIFT_RATES, DRIFT_SIZE = (0.61, 1.0, 1.43), 2.1
"""Rates of a drift's sines against the one asked for, in no whole ratio to each other; what their sum is divided by."""
SOFT_FRAMES, SOFT_BEFORE = 5.0, 20
"""Width of the bell that what steps scale is smoothed by, and how far it looks back (frames)."""


@table
class FirstFoot:
    """Which foot steps first."""

    soon_frames: int
    """So much later it is looked where the way goes."""
    turn_from_rad: float
    """A turn, or a step aside, of less does not count."""
    aside_from_m: float
    turn_rad: float
    """Such a turn counts as much as"""
    aside_m: float
    """so far aside."""
    level_m: float
    """Feet are side by side up to here."""


@table
class BeatPhases:
    """Phases of lift, landing and the middle of the next stance."""

    middle: float
    slow_double: float
    """Slow steps stand longer on both feet by this much for every metre a second below `slow_mps`."""
    slow_mps: float
    tiptoe_last_steps: float
    skip_from_mps: float
    """Slower than this nobody skips."""
    hop_lift: float
    hop_land: float
    hop_middle: float
    skip_lift: float
    skip_land: float
    skip_middle: float


@table
class LandingPlace:
    """Where a foot lands."""

    under_way_mps: float
    back_s: float
    """How far behind the middle of its stance, for its speed."""
    back_max_mps: float
    run_back_s: float
    """The same of who runs, at any speed."""
    scatter_m: float
    uneven_m: float
    ahead_max_rad: float
    """A foot comes down turned no further ahead of the body than this,"""
    inwards_max_rad: float
    """and no further towards the other foot."""
    turn_frames: int
    """It is looked so much before and after for a turn."""
    turn_rad: float
    """Who turns by this much steps no narrower than usual where they stand."""
    narrower_share: float
    """How much nearer to each other feet land in full stride than where the body stands."""
    apart_m: float
    """How near to each other the ankles may pass,"""
    apart_ratio: float
    """but no more than this of the width."""
    beside_m: float
    """A foot that lands so near along the way must not come too near to the other."""
    aside_max_m: float


@table
class SwingShape:
    """How a foot gets there."""

    full_stride_m: float
    """A step that rolls fully from heel to toe."""
    splay_rad: float
    swings_out_deg: float
    """How far its tip points outwards half-way."""
    drag_clearance_share: float
    """Of the usual clearance, of a foot that is dragged."""
    hop_clearance_share: float
    high_s: float
    """In the air, and how far, a foot has to be for being lifted as high as the style says:"""
    high_m: float
    high_power: float
    """and how fast that falls off for less."""
    heel_off_deg: float
    heel_off_power: float
    """Of the stride."""
    hop_heel_off_share: float
    beside_heel_off_share: float
    """Of a foot that lifts beside the other, as the first of who stood; all of one that is so far behind it:"""
    behind_m: float
    scuff_stride_share: float
    """Of a full stride, from which on a scuffing foot does so altogether."""
    backwards_share: float
    """Of a full stride backwards, from which on a step is played backwards."""


@table
class FootstepTable:
    """data/gait/footsteps.toml: metres at 1.70 m."""

    first_foot: FirstFoot
    beat: BeatPhases
    place: LandingPlace
    swing: SwingShape


def footstep_table() -> FootstepTable:
    """The numbers of stepping."""
    rows: FootstepTable = read_table("motion_backend", "gait/footsteps.toml", FootstepTable)
    return rows


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
    tiptoe: Array
    """(T, 2) how far both heels are raised (radians)."""
    flat: Array
    """(T, 2, 3) where ankles would be if feet did not roll."""
    made: tuple[Step, ...]
    """Every step of either foot."""

    def wave(self, at: float) -> Array:
        """A wave of unit size, highest at that phase of every step. (T,)."""
        return np.asarray(np.cos(2 * np.pi * (self.phase - at)))


def yaw_of(rotation: Array) -> Array:
    """Heading of a body or foot: where its +Z points on the floor. (...)."""
    forward = rotations.rotate(rotation, np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arctan2(forward[..., 0], forward[..., 2]))


def drift(frames: int, hertz: float, fps: int, rng: np.random.Generator) -> Array:
    """Smooth wandering about zero with unit size: a few slow sines of random phase. (frames,)."""
    time = np.arange(frames) / fps
    rates = hertz * np.array(DRIFT_RATES)
    phases = rng.uniform(0, 2 * np.pi, len(DRIFT_RATES))
    return np.asarray(np.sin(2 * np.pi * np.outer(time, rates) + phases).sum(axis=1) / DRIFT_SIZE)


def _first_foot(start: Pose, route: Route, style: Walk) -> int:
    """The foot that has further to go steps first; in a turn the inner one, and sideways the leading one."""
    row = footstep_table().first_foot
    soon = min(row.soon_frames, len(route.heading) - 1)
    turn = float(route.heading[soon] - route.heading[0])
    left = np.array([np.cos(route.heading[0]), -np.sin(route.heading[0])])
    if style.aside == SIDEWAYS:
        return 1 if (route.position[-1] - route.position[0]) @ left >= 0 else -1
    outwards = float((route.position[soon] - route.position[0]) @ left)
    if abs(turn) > row.turn_from_rad or abs(outwards) > row.aside_from_m:
        return 1 if turn / row.turn_rad + outwards / row.aside_m > 0 else -1
    ahead = np.array([np.sin(route.heading[0]), np.cos(route.heading[0])])
    near, far = (start.ankles[index][[0, 2]] @ ahead for index in (0, 1))
    return 1 if near <= far + row.level_m else -1


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

    number: int
    """Of the step in the walk."""
    index: int
    """0 left, 1 right."""
    window: tuple[float, float]
    """Phase of lift and landing."""
    middle: float
    """Phase at the middle of the stance it lands for."""
    hop: bool = False


def _beats(route: Route, phase: Array, first: int, style: Walk, begun: int) -> list[_Beat]:
    """Left, right, left, right, after those that have `begun`; in a skip the foot that stands hops on before the
    other one lands."""
    row, steps, beats = footstep_table().beat, round(phase[-1]), []
    for k in range(begun + 1, steps):
        index = 0 if (k % 2 == 0) == (first > 0) else 1
        speed = _speed_at(route, phase, k + 0.5)
        if style.skips and k < steps - 2 and speed > row.skip_from_mps:
            beats.append(_Beat(k, 1 - index, (k + row.hop_lift, k + row.hop_land), k + row.hop_middle, hop=True))
            beats.append(_Beat(k, index, (k + row.skip_lift, k + row.skip_land), k + row.skip_middle))
        else:
            # Slow steps stand longer on both feet than quick ones.
            double = style.double + (row.slow_double * max(row.slow_mps - speed, 0) if style.double > 0 else 0)
            sooner = style.character.beat_sides_share * (1 if index == 0 else -1)
            beats.append(_Beat(k, index, (k + double / 2 - sooner, k + 1 - double / 2 - sooner), k + row.middle))
    return beats


def _speed_at(route: Route, phase: Array, when: float) -> float:
    return float(route.speed[min(int(np.searchsorted(phase, when)), len(phase) - 1)])


def plan_steps(
    start: Pose,
    route: Route,
    phase: Array,
    style: Walk,
    skeleton: Skeleton,
    rng: np.random.Generator,
    stride: Stride | None = None,
    room: Room = lambda places: np.full(len(places), np.inf),
) -> Steps:
    """Where both feet are at every frame, from where they stand at the start, or in the stride they are in."""
    frames = len(phase)
    first = _first_foot(start, route, style) if stride is None else stride.first
    made = [] if stride is None else list(stride.steps)
    feet = Feet.standing(start.ankles, yaw_of(start.feet), frames)
    if stride is not None:
        feet = Feet.standing(stride.ankles, stride.yaw, frames)
        for step in made:
            feet.add(step.swing, phase, step.index)
    hopping = np.zeros(frames)
    for beat in _beats(route, phase, first, style, -1 if stride is None else stride.begun):
        swing = _swing_of(beat, feet, route, phase, style, skeleton, rng, room)
        middle = min(int(np.searchsorted(phase, sum(swing.window) / 2)), frames - 1)
        swing = _roomy(swing, feet.ankles[middle, 1 - beat.index], room)
        hopping[_during(swing, phase)] = beat.hop
        feet.add(swing, phase, beat.index)
        made.append(Step(beat.number, beat.index, swing, beat.hop))
    tiptoe, flat = _tiptoe(phase, style, stride), feet.ankles.copy()
    turned, toes = feet.rolled(tiptoe, skeleton)
    amount = _moving(made, phase, 0.0 if stride is None else stride.moving)
    return Steps(
        phase, amount, first, feet.ankles, turned, feet.yaw, toes, feet.planted, _soften(hopping), tiptoe, flat,
        tuple(made),
    )  # fmt: skip


def _during(swing: Swing, phase: Array) -> Array:
    """The frames of the step that a swing belongs to. (T,) of bool."""
    lift, land = swing.window
    return np.asarray((phase > np.floor(lift)) & (phase <= np.ceil(land)))


def _moving(made: Sequence[Step], phase: Array, before: float) -> Array:
    """How full the stride is at each frame, after what it was `before`. (T,)."""
    amount = np.zeros(len(phase))
    for step in made:
        if not step.hop:
            amount = np.maximum(amount, step.swing.size * _during(step.swing, phase))
    return _soften(np.concatenate([np.full(SOFT_BEFORE, before), amount]))[SOFT_BEFORE:]


def _tiptoe(phase: Array, style: Walk, stride: Stride | None) -> Array:
    """How far both heels are raised. (T, 2) radians."""
    begin, since = (np.zeros(2), -LEAD) if stride is None else (stride.tiptoe, stride.phase)
    own = [max(style.character.of_side("heel", "deg", side), 0.0) for side in (1, -1)]
    raised = begin + (np.radians(style.tiptoe + np.array(own)) - begin) * smooth(phase - since)[:, None]
    ending = smooth((phase[-1] - phase) / footstep_table().beat.tiptoe_last_steps)
    return np.asarray(raised * ending[:, None])


def _swing_of(
    beat: _Beat,
    feet: Feet,
    route: Route,
    phase: Array,
    style: Walk,
    skeleton: Skeleton,
    rng: np.random.Generator,
    room: Room,
) -> Swing:
    """The step from where the foot stands to where the root will pass over it."""
    rows, side = footstep_table(), 1 if beat.index == 0 else -1
    place, shape = rows.place, rows.swing
    at = min(int(np.searchsorted(phase, beat.middle)), len(phase) - 1)
    heading = _faces(route, at, min(int(np.searchsorted(phase, beat.window[1])), len(phase) - 1), side, place)
    before = max(int(np.searchsorted(phase, beat.window[0])) - 1, 0)
    origin, yaw = feet.ankles[before, beat.index].copy(), float(feet.yaw[before, beat.index])
    beside = feet.ankles[before, 1 - beat.index]
    middle = _stance(beat, route, at, style, place, rng)
    stance, width = _widths(route, at, style, place)
    width += side * style.character.width_sides_m
    target = home_ankle(middle, float(route.heading[at]), beat.index, width, skeleton)
    apart = min(place.apart_m, place.apart_ratio * stance) * skeleton.scale
    target = _clear_of(beside, target, (heading, side, skeleton.scale), apart, room)
    # A foot rolls off over its toes as it points then, and lands on its heel as it points there.
    full = shape.full_stride_m * skeleton.scale
    leaves, stride = (_forward(target - origin, points, full) for points in (yaw, heading))
    dragged = shape.drag_clearance_share if style.drag and beat.index == 1 else 1.0
    clearance = style.clearance * style.character.clearance_sides_ratio**side
    usual = foot_table().air.usual_m
    far = float(np.linalg.norm(target - origin)) / skeleton.scale
    # Who runs lifts feet high that go far, and not where he gets going and slows down; others not in small quick steps.
    high = abs(leaves) if style.double < 0 else _high(beat, phase, far) ** (not style.skips)
    if clearance > usual:
        clearance = usual + high * (clearance - usual)
    rolled = np.radians(shape.heel_off_deg) * style.roll * abs(leaves) ** shape.heel_off_power
    behind = float(np.clip(abs(_forward(beside - origin, yaw, shape.behind_m * skeleton.scale)), 0.0, 1.0))
    rolled *= shape.beside_heel_off_share + (1 - shape.beside_heel_off_share) * behind
    return Swing(
        origin,
        target,
        yaw,
        heading + side * (shape.splay_rad + np.radians(style.character.of_side("toes", "deg", side))),
        side,
        beat.window,
        clearance=clearance * (shape.hop_clearance_share if beat.hop else dragged),
        heel_off=rolled * (shape.hop_heel_off_share if beat.hop else 1.0),
        heel_strike=TIP_UP * style.strike * abs(stride) * (0.0 if beat.hop else 1.0),
        scuff=np.radians(style.scuff) * float(np.clip(stride / shape.scuff_stride_share, 0.0, 1.0)),
        backwards=leaves + stride < -2 * shape.backwards_share,
        swings_out=np.radians(shape.swings_out_deg) * style.character.of_side("toes_swing", "ratio", side),
        # The first heel rises from the first frame on, not before, and none before its foot has come down.
        rise=min(
            HEEL_RISE, 1 + style.double - SETTLE, max(beat.window[0] - float(phase[0]), foot_table().way.rise_min_phase)
        ),
        scale=skeleton.scale,
    )


def _high(beat: _Beat, phase: Array, far: float) -> float:
    """How high a foot is lifted that goes so far (metres at 1.70 m), of how high it is in long steps with time to."""
    shape, (lift, land) = footstep_table().swing, np.searchsorted(phase, beat.window)
    return float(min((land - lift) / (shape.high_s * FPS), far / shape.high_m, 1.0) ** shape.high_power)


def _roomy(swing: Swing, beside: Array, room: Room) -> Swing:
    """The same with less of an arc aside, or with one to the other side as far as the foot that stands (3,) leaves it,
    where there is no room for a foot."""
    share, bow = np.array(ON_ITS_WAY), float(np.linalg.norm(swing.bow))
    ankles = np.outer(1 - share, swing.start) + np.outer(share, swing.end) + swing.bow
    lack = _lack(ankles, swing.start_yaw + share * swing.turn, swing.scale, room)
    apart = footstep_table().place.apart_m * swing.scale
    inwards = float((ankles[1] - beside) @ swing.bow) / bow - bow - apart
    return replace(swing, bow_share=max(1 - lack / bow, -max(inwards / bow, 1.0))) if lack else swing


def _lack(ankles: Array, yaw: Array, scale: float, room: Room) -> float:
    """How much room a foot lacks (metres) where it is worst: ankles (N, 3), yaw (N,)."""
    tips = ankles[:, [0, 2]] + TIP * scale * np.stack([np.sin(yaw), np.cos(yaw)], axis=1)
    return max(FOOT_ROOM - float(room(ankles[:, [0, 2]]).min()), TIP_ROOM - float(room(tips).min()), 0.0)


def _faces(route: Route, at: int, lands: int, side: int, place: LandingPlace) -> float:
    """Yaw of a foot that lands at one frame and has the body over it at another."""
    ahead = side * float(route.heading[at] - route.heading[lands])
    return float(route.heading[lands] + side * np.clip(ahead, -place.inwards_max_rad, place.ahead_max_rad))


def _forward(way: Array, yaw: float, full: float) -> float:
    """How much of a full step a way is for who looks that way; negative backwards."""
    return float(np.clip((way[0] * np.sin(yaw) + way[2] * np.cos(yaw)) / full, -1.0, 1.0))


def _stance(beat: _Beat, route: Route, at: int, style: Walk, place: LandingPlace, rng: np.random.Generator) -> Array:
    """Where the root will be in the middle of a stance, at frame `at`, as the foot that lands for it takes it. (2,)."""
    speed, heading = float(route.speed[at]), float(route.heading[at])
    ahead, under_way = np.array([np.sin(heading), np.cos(heading)]), min(speed / place.under_way_mps, 1.0)
    # A little behind the middle of its stance: the rising heel carries the ankle forward at the end of it.
    back = place.run_back_s * speed if style.double < 0 else place.back_s * min(speed, place.back_max_mps)
    behind = back * np.cos(np.radians(style.aside))
    middle = route.position[at] - behind * ahead
    longer = style.character.step_sides_m * (1 if beat.index == 0 else -1) - style.drag * (beat.index == 1)
    middle = middle + under_way * longer * ahead
    scatter = under_way * (place.scatter_m + style.uneven * place.uneven_m)
    return np.asarray(middle + scatter * rng.standard_normal(2))


def _widths(route: Route, at: int, style: Walk, place: LandingPlace) -> tuple[float, float]:
    """Half as far as feet are apart where the body stands, and where it walks, at frame `at` (metres at 1.70 m)."""
    last = len(route.heading) - 1
    after, before = min(at + place.turn_frames, last), max(at - place.turn_frames, 0)
    turning = min(abs(float(route.heading[after] - route.heading[before])) / place.turn_rad, 1.0)
    stance = max(style.width, turning * usual_width())
    under_way = min(float(route.speed[at]) / place.under_way_mps, 1.0)
    narrower = 0.0 if style.aside == SIDEWAYS else place.narrower_share
    straight_on = under_way * (1 - turning)
    return stance, stance * (1 - narrower * straight_on) * style.character.width_ratio**straight_on


def _clear_of(beside: Array, target: Array, faces: tuple[float, int, float], apart: float, room: Room) -> Array:
    """A landing place moved outwards where it would be too near to the other foot, or across it. (3,).

    Where there is no room for that the feet come down before each other. `faces` is yaw, side and size of the foot.
    """
    row, (heading, side, scale) = footstep_table().place, faces
    outward = side * np.array([np.cos(heading), 0.0, -np.sin(heading)])
    along = np.array([np.sin(heading), 0.0, np.cos(heading)])
    gap = target - beside
    ahead = min(abs(float(gap @ along)) / row.beside_m, 1.0)
    aside = float(np.clip(apart - float(gap @ outward), 0.0, row.aside_max_m)) * (ahead < 1)
    clear = target + aside * outward
    lack = _lack(clear[None], np.array([heading]), scale, room) if aside else 0.0
    return np.asarray(clear - min(lack, ahead * aside) * outward)


def _soften(values: Array) -> Array:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, SOFT_FRAMES, mode="constant"))
