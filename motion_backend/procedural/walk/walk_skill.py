"""Walking somewhere, and staying where one stands: the performers of loco.

Ways that are not the shortest: a curve to the front left or right, and pacing to and fro.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final
from zlib import crc32

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import FPS, Action, PhaseKind, Skill
from motion_backend.procedural.body_state import Body, Point
from motion_backend.procedural.contrapposto import contrapposto
from motion_backend.procedural.emotion_style import Bearing, arm_arrays, bearing_of
from motion_backend.procedural.held_poses import SPINE_LEAN, bend, idle, idle_table
from motion_backend.procedural.pose import Pose, interpolate, settle_from
from motion_backend.procedural.touch.gestures import Room, gesture, leaves_an_arm, room_for
from motion_backend.procedural.touch.hand_captions import arms_on_the_way
from motion_backend.procedural.walk.gait import walk_on
from motion_backend.procedural.walk.gait_character import gait_character
from motion_backend.procedural.walk.root_path import SPACING, resample
from motion_backend.procedural.walk.walk_styles import Walk, style_of, walk_style
from motion_backend.procedural.walk.way_junction import ThroughWay, through_way, way_from
from motion_backend.rotations import Array
from scene_graphs.navigation.path_planner import Walkable

BOWS = (0.24, 0.18, 0.12, 0.07)
"""How far a curved way goes aside against its length, the widest that has room."""
ROOM = 0.02
"""What a detour leaves free beyond what the body needs (metres)."""
LONG_ENOUGH = 1.0
"""Ways shorter than this (metres) are gone straight and once."""
STRAIGHT_ON = "no room for a curve: straight on, looking to that side"
BEAT = 2.4
"""How far somebody who paces goes before turning round (metres),"""
BEAT_SHARE = 0.9
"""but no more than this of the way."""


def curved(path: Array, left: bool, walkable: Walkable) -> Array:
    """A path (N, 2) that bends to the left or right all the way, as far as there is room; else as it was."""
    points = resample(path)
    way = points[-1] - points[0]
    length = float(np.hypot(*way))
    if length < LONG_ENOUGH:
        return path
    # To end up on the left it first goes out on the right.
    outward = np.array([-way[1], way[0]]) / length * (1.0 if left else -1.0)
    arch = 4 * np.linspace(0, 1, len(points)) * np.linspace(1, 0, len(points))
    for bow in BOWS:
        curve = points + (bow * length * arch)[:, None] * outward
        if _is_free(curve, walkable):
            return np.asarray(curve)
    return path


def to_and_fro(path: Array, walkable: Walkable) -> list[Array]:
    """The ways of pacing along a path: there, back a good part of it, and there again; once where it is short."""
    points = resample(path)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if steps.sum() < LONG_ENOUGH:
        return [path]
    to_end = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    turn = int(np.argmax(to_end <= min(BEAT, BEAT_SHARE * float(steps.sum()))))
    back = points[turn:][::-1]
    return [points, back, points[turn:]] if _is_free(back, walkable) else [path]


def _is_free(points: Array | Sequence[Array], walkable: Walkable) -> bool:
    return bool((walkable.field.at(np.asarray(points[::3])) >= walkable.radius + ROOM).all())


AT_THE_SPOT = 0.04
"""A body this near to a standing point (metres) need not walk to it."""
FACING_IT = 0.12
"""And this near to the wanted yaw (radians) need not turn."""
SHORT_WAY = 0.20
"""A body that has not to turn round steps straight to a place nearer than this (metres)."""
TURNING_ROUND = 1.2
"""A body that is turned away from where it will face by more (radians) does not."""
SPREAD = {"open": "embracing", "balance": "balance_ahead"}
"""Arms that need room beside a way, and what they do where there is none."""
IN_POSE, BOTH_OUT = 0.4, 0.6
"""An arm is in a pose it is this near to (arm lengths); where not both are for so much of a way, that is no room."""
STAYING = 0.7
"""How long arms take into the pose they are held in where the body stays, and out of it (seconds)."""
TAKES_UP: Final = (0.6, 1.2)
"""Seconds until what is used on the way is before the eyes, and until it has been looked at."""
LOOKS_DOWN: Final = 0.5
"""How far the head is bent for that (radians)."""
LEGS = ("pelvis", "hips", "ankles", "feet", "toes")
"""The handles of who stands."""
LEGS_DO = {"pelvis": 0.06, "hips": 0.12} | dict.fromkeys(("ankles", "feet", "toes"), 1e-6)
"""Legs do something of their own that moves these by more than this: bobbing knees leave the weight free to go."""
ROOM_TO_STEP = 0.08
"""What is free about who steps on the spot, beyond what the body needs (metres)."""
QUICK, RUNS = 1.7, 2.0
"""Who is to be faster (m/s) walks quickly, and runs."""
HASTE = re.compile(r"\b(?:quick|run|rush|hurr|dash|fast)", re.IGNORECASE)
"""Words of a caption that ask for haste."""
OFTEN, NEARLY, OVER = 0.9, 0.9, 5
"""A way with so little room that all but the fastest frames, this share, are slower than so much of it is told; of
where the body gets in so many frames, since it surges with every step."""
GOES_ON = 1.0
"""So far a walk leads on after a spin, where it is twice as long (metres)."""
HALTS = 0.6
"""How far a walk goes on that has to stop (metres)."""
FLUNG: Final = frozenset({"kick"})
"""What flings a leg forwards."""
SWINGS: Final = (np.array([-0.2, -0.1, 0.0]), np.array([0.25, 0.45, 0.65]), np.arange(0.3, 1.0, 0.08))
"""Where that leg comes: to the left, up and ahead of the place where the body stands (metres at 1.70 m),"""
SWING_ROOM: Final = 0.06
"""with so much room about it (metres)."""
SWING_TURNS: Final = tuple(sorted(np.arange(-np.pi, np.pi, np.pi / 12).tolist(), key=abs))
"""How far the body may turn for it, the least first (radians)."""
OPEN_WAYS: Final = 16
"""In so many directions open floor is looked for,"""
OPEN_AWAY: Final = np.arange(0.0, 2.5, 0.15)
"""so far away (metres),"""
OPEN_BESIDE: Final = np.array([0.0, 0.125, 0.25])
"""of who does it at a piece, and is to stay by that, only so far;"""
OPEN_AHEAD: Final = (0.4, 0.8, 1.2, 1.6)
"""and so far ahead of who stands there it is open (metres)."""
LANE: Final = 0.3
"""A strip of floor that one is down on is free so far to either side (metres at 1.70 m);"""
LANE_LOOKS: Final = 24
"""at so many places along it it is looked."""
NO_LANE: Final = "no room to stretch out on the floor: on the knees"
KNEES: Final = 0.5
"""How much of their way feet then go back."""
LEAVES_BEFORE = 0.5
"""So far before its end (metres) a way is left by who goes to another place near there."""


def go(body: Body, goal: Point, facing: float | None, action: Action, onward: Point | None = None) -> None:
    """Walk to a place and end up facing a yaw, in the style of the action.

    Where the way leads `onward` to another place, the body passes by this one in stride, if there is room for that.
    """
    made = len(body.frames)
    if action.by is not None:
        _go(body, action.by, None, action, goal)
    _go(body, goal, facing, action, onward)
    if asks_for_haste(action) and len(body.frames) > made:
        _note_no_room(body, made, walk_style(action.emotion, action.caption).speed)


def _go(body: Body, goal: Point, facing: float | None, action: Action, onward: Point | None) -> None:
    away = float(np.hypot(goal[0] - body.place[0], goal[1] - body.place[1]))
    near, to_turn = away < AT_THE_SPOT, 0.0 if facing is None else abs(float(rotations.wrap(facing - body.yaw)))
    if near and to_turn < FACING_IT:
        if body.stride is not None:
            halt(body, action)
        return
    style = style_of(action)
    if style.begins != ("hang", "hang") and body.stride is None and not near:
        _take_up(body, style)
    body.enter(PhaseKind.WALK)
    arms = arms_on_the_way(body.pose, style.bearing.arms, action.holds)
    style = replace(style, bearing=replace(style.bearing, arms=arms), character=gait_character(body.seed))
    path = _way_to(body, goal) if not near else np.array([body.place, goal])
    if away < SHORT_WAY and to_turn < TURNING_ROUND:
        path = np.array([body.place, goal])
    if style.spin and not near:
        path = _spin_on_the_way(body, path, style)
        style = replace(style, spin=0.0)
    if style.veer and not near:
        straight, path = path, curved(path, style.veer > 0, body.scene.walkable)
        if path is straight:
            body.note(STRAIGHT_ON)
    if style.to_and_fro and not near:
        *before, path = to_and_fro(path, body.scene.walkable)
        for way in before:
            _stride(body, way, None, style)
    _stride(body, path, facing, style, None if near else onward)


def _take_up(body: Body, style: Walk) -> None:
    """Lift what is used on the way before one, and look at it for a moment."""
    body.enter(PhaseKind.STAND)
    wrists, elbows = arm_arrays(*style.begins)
    free = {"reaching": np.zeros(2), "pressing": np.zeros(2)}
    looks = replace(body.pose, arms=wrists, elbows=elbows, head=bend(LOOKS_DOWN), **free)
    body.add(interpolate([0.0, *(one / style.bearing.tempo for one in TAKES_UP)], [body.pose, looks, looks], FPS))


def asks_for_haste(action: Action) -> bool:
    """Whether a walk is there to be quick: one that only leads to a thing is as quick as the way there allows."""
    return action.skill is Skill.LOCO and action.object_id is None and bool(HASTE.search(action.caption))


def _note_no_room(body: Body, made: int, speed: float) -> None:
    """Say so where the way, walked in all frames but the first that were `made` before it, was too short to get up to
    a speed (m/s)."""
    if speed <= QUICK:
        return
    places = np.concatenate([one.pelvis for one in body.frames[made:]])[:, [0, 2]]
    pace = np.linalg.norm(places[OVER:] - places[:-OVER], axis=1) * FPS / OVER
    if len(pace) and float(np.quantile(pace, OFTEN)) < NEARLY * speed * body.skeleton.scale:
        body.note(f"no room to {'run' if speed > RUNS else 'walk quickly'}: the way is too short")


def _way_to(body: Body, goal: Point) -> Array:
    """The path (N, 2) to a place: who is walking goes on by the way that the last walk was to go on by, and leaves it
    before its end where that is not the place."""
    if body.stride is None:
        return body.scene.walkable.path(body.place, goal)
    rest = body.stride.rest
    if np.hypot(*(rest[-1] - goal)) < AT_THE_SPOT:
        return rest
    rest = rest[: max(len(rest) - int(LEAVES_BEFORE / SPACING), len(rest) // 2, 2)]
    return np.concatenate([rest, body.scene.walkable.path((float(rest[-1, 0]), float(rest[-1, 1])), goal)[1:]])


def halt(body: Body, action: Action) -> None:
    """Come to a stand out of a walk that nothing follows after all."""
    stride = body.stride
    if stride is not None:
        ahead = np.array([np.sin(stride.heading), np.cos(stride.heading)])
        _stride(body, np.stack([stride.place, stride.place + HALTS * ahead]), None, walk_style(action.emotion, "walk"))


def _stride(body: Body, path: Array, facing: float | None, style: Walk, onward: Point | None = None) -> None:
    """Walk along a path."""
    stride, body.stride = body.stride, None
    if stride is None and not style.aside:
        path = way_from(path, body.yaw, lambda points: _is_free(points, body.scene.walkable))
    way = _through(body, path, onward) if onward is not None and not style.spin else None
    points, cut = (path, None) if way is None else (way.points, way.cut_m)
    end = facing if way is None else None
    walkable = body.scene.walkable

    def spare(places: Array) -> Array:
        return np.asarray(walkable.field.at(places) - walkable.radius)

    before, state = SPREAD.get(style.bearing.arms[0]), body.rng.bit_generator.state
    solid = body.scene.obstacles.solid()
    walked = walk_on(body.pose, points, end, style, body.skeleton, body.rng, stride, cut, spare, solid.depth)
    if before is not None and _held_back(walked[0], style.bearing.arms):
        body.note("no room for open arms: to the front")
        style = replace(style, bearing=replace(style.bearing, arms=(before, before)))
        body.rng.bit_generator.state = state
        walked = walk_on(body.pose, points, end, style, body.skeleton, body.rng, stride, cut, spare, solid.depth)
    frames, body.stride, body.beyond = walked
    body.add(gesture(frames, style.doing))


def _held_back(walked: Pose, arms: tuple[str, str]) -> bool:
    """Whether not both arms are in their pose for most of the time from where one of them is until none is any more."""
    out = np.linalg.norm(walked.arms - arm_arrays(*arms)[0], axis=-1) < IN_POSE
    some = np.flatnonzero(out.any(axis=1))
    return bool(len(some)) and float(out[some[0] : some[-1] + 1].all(axis=1).mean()) < BOTH_OUT


def _through(body: Body, path: Array, onward: Point) -> ThroughWay | None:
    """The way by the end of a path and on to another place; None where it is the same place, or there is no room."""
    here = float(path[-1, 0]), float(path[-1, 1])
    if np.hypot(onward[0] - here[0], onward[1] - here[1]) < AT_THE_SPOT:
        return None
    walkable = body.scene.walkable
    ways = np.concatenate([resample(path), resample(leaving := walkable.path(here, onward))])

    def fits(points: Array) -> bool:
        # Where the planner leads there is room; only what the joining adds has to be looked at.
        new = np.linalg.norm(points[:, None] - ways[None], axis=2).min(axis=1) > ROOM
        return bool((walkable.field.at(points[new]) >= walkable.radius + ROOM).all())

    return through_way(path, leaving, fits)


def _spin_on_the_way(body: Body, path: Array, style: Walk) -> Array:
    """Walk to the roomiest place of the path's second half and spin there; returns the way that is left."""
    points = resample(path)
    half = points[len(points) // 2 : max(len(points) - int(GOES_ON / SPACING), len(points) // 2 + 1)]
    split = len(points) // 2 + int(np.argmax(body.scene.walkable.field.at(half)))
    _stride(body, points[: split + 1], None, style)
    return np.concatenate([[body.place], points[split:]])


def _where_legs_swing(body: Body) -> float:
    """The yaw nearest to where the body looks in which a leg that is flung forwards meets nothing, else the one in
    which it is least deep in something."""
    solid, scale = body.scene.obstacles.solid(), body.skeleton.scale
    yaws = body.yaw + np.array(SWING_TURNS)
    aside, up, ahead = np.meshgrid(*SWINGS, indexing="ij")
    x, z = (scale * one.ravel() for one in (aside, ahead))
    sin, cos = np.sin(yaws)[:, None], np.cos(yaws)[:, None]
    points = np.stack(
        [body.place[0] + cos * x + sin * z, np.broadcast_to(scale * up.ravel(), (len(yaws), x.size)),
         body.place[1] - sin * x + cos * z], axis=-1,
    )  # fmt: skip
    deepest = solid.depth(points.reshape(-1, 3)).reshape(len(yaws), -1).max(axis=1)
    free = np.flatnonzero(deepest < -SWING_ROOM)
    return float(yaws[free[0] if len(free) else np.argmin(deepest)])


def _free(body: Body, place: Point) -> float:
    """What is free about who stands at a place, beyond what the body needs (metres)."""
    walkable = body.scene.walkable
    return float(walkable.field.at(np.array([place]))[0]) - walkable.radius


def _make_room(body: Body, action: Action, needed: Room) -> float:
    """Go to where there is room for what is done on the spot; returns how much of its ways over the floor there is."""
    room = needed.about_m * body.skeleton.scale
    if needed.lane_m is not None:
        wide, place, yaw = _open_lane(body, needed.lane_m)
        go(body, place, yaw, replace(action, caption="walk"))
        body.enter(PhaseKind.STAND)
        if wide < LANE * body.skeleton.scale:
            body.note(NO_LANE)
            return KNEES
        return 1.0
    if needed.gone_for and _free(body, body.place) < room:
        far = OPEN_AWAY if action.object_id is None else OPEN_BESIDE
        go(body, *_open_floor(body, room, far), replace(action, caption="walk"))
        body.enter(PhaseKind.STAND)
    return min(max(_free(body, body.place), 0.0) / room, 1.0) if room else 1.0


def _open_lane(body: Body, lane: tuple[float, float]) -> tuple[float, Point, float]:
    """How wide the nearest free strip of floor is to either side (metres), where one stands on it and looks along it;
    the widest where none is wide enough. It begins so far behind and ends so far ahead (metres at 1.70 m)."""
    scale, wanted = body.skeleton.scale, LANE * body.skeleton.scale
    yaws = body.yaw + np.array(SWING_TURNS)
    ways = np.stack([np.sin(yaws), np.cos(yaws)], axis=-1)
    along = np.linspace(-lane[0], lane[1], LANE_LOOKS)[:, None, None] * scale * ways  # (looks, yaws, 2)
    best = (-1.0, body.place, body.yaw)
    for place in _in_sight(body):
        free = body.scene.walkable.field.at((np.array(place) + along).reshape(-1, 2)).reshape(LANE_LOOKS, -1)
        wide = np.minimum(free.min(axis=0), wanted)
        turn = int(np.argmax(wide))
        if wide[turn] > best[0]:
            best = (float(wide[turn]), place, float(rotations.wrap(yaws[turn])))
        if best[0] >= wanted:
            break
    return best


def _in_sight(body: Body) -> list[Point]:
    """Places to stand at that are in sight, the nearest first."""
    yaws, here = np.arange(OPEN_WAYS) * 2 * np.pi / OPEN_WAYS, np.array(body.place)
    ways = np.stack([np.sin(yaws), np.cos(yaws)], axis=-1)
    found = [body.place, *(tuple((here + away * way).tolist()) for away in OPEN_AWAY[1:] for way in ways)]
    return [place for place in found if body.scene.walkable.sees(body.place, place) and _free(body, place) > 0]


def _open_floor(body: Body, room: float, far: Array) -> tuple[Point, float]:
    """The nearest place in sight with so much room about it (metres), else the roomiest, of those so far away; and
    where one looks there."""
    yaws, here = np.arange(OPEN_WAYS) * 2 * np.pi / OPEN_WAYS, np.array(body.place)
    ways = np.stack([np.sin(yaws), np.cos(yaws)], axis=-1)
    found = [(float(away), tuple((here + away * way).tolist())) for away in far for way in ways]
    seen = [(away, place) for away, place in found if body.scene.walkable.sees(body.place, place)]
    place = max(seen, key=lambda one: (min(_free(body, one[1]), room), -one[0]), default=(0.0, body.place))[1]
    ahead = np.array(place) + np.array(OPEN_AHEAD)[:, None, None] * ways  # (N, ways, 2)
    open_to = body.scene.walkable.field.at(ahead.reshape(-1, 2)).reshape(len(OPEN_AHEAD), -1).mean(axis=0)
    return place, float(yaws[int(np.argmax(open_to))])


def stay(body: Body, part: Part) -> None:
    """Stand where the body is: for loco with the arms as the caption has them, and let them hang again."""
    action = part.action
    bearing = bearing_of(action.emotion, action.caption)
    restless = bearing.restless
    style = walk_style(action.emotion, action.caption if action.skill is Skill.LOCO else "walk")
    does_it = style.stays > 0 and bool(style.doing)
    # Who does this does it in one way, and another thing or another person otherwise.
    habit = np.random.default_rng((body.seed, crc32(action.caption.encode())))
    if action.stands and not does_it:
        said = style.bearing.waits
        waits = said if said != bearing.waits else idle_table().waiting(said, habit)
        _stand_about(body, part.hold, replace(bearing, waits=waits))
        return
    if not does_it and (action.skill is not Skill.LOCO or action.goal is not None):
        held = settle_from(body.pose, _idle(body, part.hold, restless), FPS)
        body.add(_from_leg_to_leg(body, held, held, restless))
        return
    if style.doing in FLUNG:
        go(body, body.place, _where_legs_swing(body), replace(action, caption="walk"))
        body.enter(PhaseKind.STAND)
    spread = _make_room(body, action, room_for(style.doing))
    arms = idle_table().beside(style.bearing.arms, habit) if leaves_an_arm(style.doing) else style.bearing.arms
    bearing = replace(style.bearing, arms=arms_on_the_way(body.pose, arms))
    at_ease = replace(body.pose, **_carriage(replace(bearing, arms=arms_on_the_way(body.pose, ("hang", "hang")))))
    body.add(interpolate([0.0, STAYING / bearing.tempo], [body.pose, replace(body.pose, **_carriage(bearing))], FPS))
    held = _idle(body, part.hold, restless)
    body.add(_from_leg_to_leg(body, held, gesture(held, style.doing, spread, body.rng), restless))
    if arms != ("hang", "hang"):
        stands = {name: getattr(body.pose, name) for name in LEGS}
        body.add(interpolate([0.0, STAYING / bearing.tempo], [body.pose, replace(at_ease, **stands)], FPS))


def _idle(body: Body, seconds: float, restless: float) -> Pose:
    return idle(body.pose, seconds, restless, body.rng, FPS)


def _from_leg_to_leg(body: Body, held: Pose, done: Pose, restless: float, goes_on: bool = False) -> Pose:
    """Frames of who does something where it stands, its weight on one leg and then on the other; as they were where the
    legs do something as well, or a hand lies on a thing."""
    busy = any(np.abs(getattr(done, name) - getattr(held, name)).max() > LEGS_DO[name] for name in LEGS)
    if busy or done.reaching.any() or not done.planted.all():
        return done
    room = _free(body, body.place) >= ROOM_TO_STEP
    steps = room and all(part.kind in (PartKind.WALK, PartKind.TURN) for part in body.upcoming[:1])
    return contrapposto(done, body.skeleton, restless, body.rng, goes_on=goes_on, steps=steps)


def _stand_about(body: Body, seconds: float, bearing: Bearing) -> None:
    """Stand as who has nothing more to do: the weight on one leg, arms as the mood has them."""
    arms = arms_on_the_way(body.pose, bearing.waits)
    held = replace(body.pose, **_carriage(replace(bearing, arms=arms)), reaching=np.zeros(2), pressing=np.zeros(2))
    comes = round(min(STAYING / bearing.tempo, seconds / 2) * FPS) / FPS
    body.add(interpolate([0.0, comes], [body.pose, held], FPS))
    stood = _idle(body, seconds - comes, bearing.restless)
    body.add(_from_leg_to_leg(body, stood, stood, bearing.restless, goes_on=True))


def _carriage(bearing: Bearing) -> dict[str, Array]:
    """How a standing body holds trunk, head and arms."""
    wrists, elbows = arm_arrays(*bearing.arms)
    lean, head = np.radians(bearing.lean), np.radians(bearing.head)
    return {"spine": bend(SPINE_LEAN * lean), "head": bend(head), "arms": wrists, "elbows": elbows}
