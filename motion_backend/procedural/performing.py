"""The state machine of SIMS 3.4: what each skill needs before it, then the skill itself.

Rest is left before walking, and a contact skill starts from its standing point with the body turned as it should be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS, Action, Posture, Skill
from motion_backend.obstacles import Obstacles
from motion_backend.procedural.footsteps import yaw_of
from motion_backend.procedural.gait import walk
from motion_backend.procedural.gestures import gesture
from motion_backend.procedural.guarding import arms_in
from motion_backend.procedural.handling import LONGER, Laid, arms_on_the_way, handling_of, with_both_hands
from motion_backend.procedural.interactions import edge_seat, lie_down, rise_to_edge, sit_down, stand_up
from motion_backend.procedural.lie_styles import lie_style
from motion_backend.procedural.lying import Bed
from motion_backend.procedural.moods import bearing_of
from motion_backend.procedural.palms import free_palm, other_hand
from motion_backend.procedural.pose import Pose, interpolate, settle_from
from motion_backend.procedural.reaching import touch
from motion_backend.procedural.route import resample
from motion_backend.procedural.sit_styles import sit_style
from motion_backend.procedural.stances import SHIN_REACH, Seat, bend, idle
from motion_backend.procedural.styles import Bearing, arm_arrays
from motion_backend.procedural.walk_styles import Walk, walk_style
from motion_backend.skeleton import HAND_REST, Skeleton
from scene_graphs.homes import Home
from scene_graphs.navigation import NoPath, Walkable
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]
Point = tuple[float, float]
AT_THE_SPOT = 0.04
"""A body this near to a standing point (metres) need not walk to it."""
FACING_IT = 0.12
"""And this near to the wanted yaw (radians) need not turn."""


SHORT_WAY = 0.20
"""A body that faces where it will face steps straight to a place nearer than this (metres)."""
TURNING_ROUND = 1.2
"""A body that arrives turned away from where it will face by more (radians) turns before the last step."""
NARROW_ARMS = {
    "open": ("raised", 0.80),
    "balance": ("hang", 0.80),
    "hips": ("hang", 0.50),
    "pockets": ("hang", 0.45),
    "behind_back": ("hang", 0.40),
}
"""What arms do where elbows or hands would meet furniture, and the clearance (metres) they need: joy goes up."""
STAYING = 0.7
"""How long arms take into the pose they are held in where the body stays, and out of it (seconds)."""
ELBOW_ROOM = 0.26
"""Clearance beyond which there is no better place to turn on the spot (metres)."""


@dataclass(frozen=True)
class Scene:
    """A home with what is worked out about it once."""

    home: Home
    walkable: Walkable
    obstacles: Obstacles


@dataclass
class Body:
    """One action being made: frames so far, the last pose, and what it rests on."""

    scene: Scene
    skeleton: Skeleton
    rng: np.random.Generator
    pose: Pose
    posture: Posture
    rest: Spot | None
    frames: list[Pose]

    def add(self, frames: Pose) -> None:
        """Append frames and take the last as the present pose."""
        self.frames.append(frames)
        self.pose = frames.at(len(frames) - 1)

    @property
    def place(self) -> Point:
        """Pelvis on the floor plan."""
        return float(self.pose.pelvis[0]), float(self.pose.pelvis[2])

    @property
    def yaw(self) -> float:
        """Heading of the pelvis."""
        return float(yaw_of(self.pose.hips))


def _rise(body: Body, bearing: Bearing) -> None:
    """Leave the seat or bed and stand."""
    spot = body.rest
    if body.posture is Posture.STANDING or spot is None:
        return
    if body.posture is Posture.LYING:
        bed, seat = Bed.of(spot), _edge(body, spot)
        body.add(rise_to_edge(body.pose, seat, bed, bearing, body.skeleton))
    else:
        seat = Seat.of(spot)
    out = SHIN_REACH * body.skeleton.scale * np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    where = (float(seat.pelvis[0] + out[0]), float(seat.pelvis[2] + out[1]))
    body.add(stand_up(body.pose, seat, where, bearing, body.skeleton))
    body.posture, body.rest = Posture.STANDING, None


def _edge(body: Body, spot: Spot) -> Seat:
    return edge_seat(Bed.of(spot), spot.standing, spot.approach, spot.edge, body.skeleton.scale)


def _go(body: Body, goal: Point, facing: float | None, action: Action) -> None:
    """Walk to a place and end up facing a yaw, in the style of the action."""
    near = float(np.hypot(goal[0] - body.place[0], goal[1] - body.place[1])) < AT_THE_SPOT
    turned = facing is None or abs(float(rotations.wrap(facing - body.yaw))) < FACING_IT
    if near and turned:
        return
    style = walk_style(action.emotion, action.caption if action.skill is Skill.LOCO else "walk")
    arms = arms_on_the_way(body.pose, style.bearing.arms)
    style = replace(style, bearing=replace(style.bearing, arms=arms))
    path = body.scene.walkable.path(body.place, goal) if not near else np.array([body.place, goal])
    turning = None
    if turned and float(np.hypot(goal[0] - body.place[0], goal[1] - body.place[1])) < SHORT_WAY:
        path = np.array([body.place, goal])
    else:
        turning = _turning_place(body, path, goal, facing)
    if style.spin and not near:
        path = _spin_on_the_way(body, path, style)
        style = replace(style, spin=0.0)
    if turning is None or facing is None:
        _stride(body, path, facing, style)
        return
    _stride(body, body.scene.walkable.path(body.place, turning), facing, style)
    _stride(body, np.array([body.place, goal]), facing, style)


def _stride(body: Body, path: Array, facing: float | None, style: Walk) -> None:
    """Walk along a path; arms that are spread come in where there is no room for them."""
    frames = walk(body.pose, path, facing, style, body.skeleton, body.rng)
    if style.bearing.arms[0] in NARROW_ARMS:
        places = frames.pelvis[:, [0, 2]]
        room = np.array([body.scene.walkable.clearance((float(x), float(z))) for x, z in places])
        frames = arms_in(frames, room / body.skeleton.scale, *NARROW_ARMS[style.bearing.arms[0]])
    body.add(frames)


def _spin_on_the_way(body: Body, path: Array, style: Walk) -> Array:
    """Walk to the roomiest place of the path's second half and spin there; returns the way that is left."""
    points = resample(path)
    half = points[len(points) // 2 :]
    room = [body.scene.walkable.clearance((float(x), float(z))) for x, z in half]
    split = len(points) // 2 + int(np.argmax(room))
    _stride(body, points[: split + 1], None, style)
    return np.concatenate([[body.place], points[split:]])


def _turning_place(body: Body, path: Array, goal: Point, facing: float | None) -> Point | None:
    """Where to turn round before backing up to a seat, away from it; None where no turning round is needed."""
    if facing is None or len(path) < 2:
        return None
    step = path[-1] - path[-2]
    if float(np.abs(rotations.wrap(np.arctan2(step[0], step[1]) - facing))) < TURNING_ROUND:
        return None
    ahead = np.array([np.sin(facing), np.cos(facing)])
    places = [(float(goal[0] + d * ahead[0]), float(goal[1] + d * ahead[1])) for d in (0.32, 0.26, 0.20, 0.14)]
    room = [min(body.scene.walkable.clearance(place), ELBOW_ROOM) for place in places]
    best = int(np.argmax(room))
    return places[best] if room[best] > body.scene.walkable.clearance(goal) + 0.04 else None


def _loco(body: Body, action: Action) -> None:
    bearing = bearing_of(action.emotion, action.caption)
    _rise(body, bearing)
    if action.goal is None:
        _stay(body, action)
        return
    before = len(body.frames)
    _go(body, action.goal, action.facing, action)
    if len(body.frames) == before:
        body.add(idle(body.pose, 1.0, bearing.restless, body.rng, FPS))


def _stay(body: Body, action: Action) -> None:
    """Stand where the body is, arms as the caption has them, and let them hang again."""
    style = walk_style(action.emotion, action.caption)
    bearing = replace(style.bearing, arms=arms_on_the_way(body.pose, style.bearing.arms))
    at_ease = replace(body.pose, **_carriage(replace(bearing, arms=arms_on_the_way(body.pose, ("hang", "hang")))))
    held = replace(body.pose, **_carriage(bearing))
    body.add(interpolate([0.0, STAYING / bearing.tempo], [body.pose, held], FPS))
    restless = bearing_of(action.emotion, action.caption).restless
    body.add(gesture(idle(body.pose, action.hold, restless, body.rng, FPS), style.doing))
    if style.bearing.arms != ("hang", "hang"):
        body.add(interpolate([0.0, STAYING / bearing.tempo], [body.pose, at_ease], FPS))


def _carriage(bearing: Bearing) -> dict[str, Array]:
    """How a standing body holds trunk, head and arms."""
    wrists, elbows = arm_arrays(*bearing.arms)
    lean, head = np.radians(bearing.lean), np.radians(bearing.head)
    return {"spine": bend(0.7 * lean), "head": bend(head), "arms": wrists, "elbows": elbows}


def _spot_of(action: Action) -> Spot:
    if action.spot is None:
        raise NoPath(f"keyframe {action.keyframe}: {action.skill} has no place to go to")
    return action.spot


def _at_standing_point(body: Body, action: Action, seat: Seat) -> None:
    """Stand where shins will be upright once seated, back to the seat."""
    out = SHIN_REACH * body.skeleton.scale * np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    _go(body, (float(seat.pelvis[0] + out[0]), float(seat.pelvis[2] + out[1])), seat.yaw, action)


def _sitdown(body: Body, action: Action) -> None:
    style = sit_style(action.emotion, action.caption)
    spot = _spot_of(action)
    seat = Seat.of(spot)
    if body.posture is not Posture.STANDING:
        _rise(body, style.bearing)
    _at_standing_point(body, action, seat)
    reach = _leg_room(body, seat)
    body.add(sit_down(body.pose, seat, style, body.skeleton, reach))
    body.add(gesture(idle(body.pose, action.hold, style.bearing.restless, body.rng, FPS), style.doing))
    body.posture, body.rest = Posture.SEATED, spot


def _leg_room(body: Body, seat: Seat) -> tuple[float, float]:
    """How far ahead of the pelvis each foot may go before it meets something (metres)."""
    ahead = np.arange(0.44, 0.86, 0.02)
    room = []
    for side in (1, -1):
        points = np.array([seat.to_world((side * 0.12, up, a + 0.16)) for a in ahead for up in (0.06, 0.22)])
        hit = body.scene.obstacles.solid().depth(points).reshape(len(ahead), -1).max(axis=1) > -0.03
        room.append(float(ahead[np.argmax(hit)] - 0.02) if hit.any() else float(ahead[-1]))
    return room[0], room[1]


def _liedown(body: Body, action: Action) -> None:
    style = lie_style(action.emotion, action.caption)
    spot = _spot_of(action)
    if body.posture is Posture.LYING or (body.rest is not None and body.rest.object_id != spot.object_id):
        _rise(body, style.bearing)
    if body.posture is Posture.SEATED:
        _rise(body, style.bearing)
    seat, bed = _edge(body, spot), Bed.of(spot)
    _at_standing_point(body, action, seat)
    pillow = _pillow(body, spot, bed)
    body.add(lie_down(body.pose, seat, bed, style, body.skeleton, pillow))
    body.add(idle(body.pose, action.hold, 0.6 * style.bearing.restless, body.rng, FPS))
    body.posture, body.rest = Posture.LYING, spot


def _pillow(body: Body, spot: Spot, bed: Bed) -> float:
    """How much higher than the mattress the thing under the head is (metres)."""
    head = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)]) * 0.68 * body.skeleton.scale
    column = np.asarray(spot.point) + head + np.arange(0.30, 0.0, -0.01)[:, None] * [0.0, 1.0, 0.0]
    inside = body.scene.obstacles.depth(column) > 0
    return float(np.clip(0.30 - 0.01 * np.argmax(inside), 0.0, 0.14)) if inside.any() else 0.0


def _rest_over(body: Body, action: Action) -> None:
    bearing = bearing_of(action.emotion, action.caption)
    before = len(body.frames)
    _rise(body, bearing)
    if len(body.frames) == before:
        body.add(settle_from(body.pose, idle(body.pose, 0.8, bearing.restless, body.rng, FPS), FPS))
    else:
        body.add(idle(body.pose, 0.3, bearing.restless, body.rng, FPS))


def _touch(body: Body, action: Action) -> None:
    bearing = bearing_of(action.emotion, action.caption)
    spot = _spot_of(action)
    _rise(body, bearing)
    _go(body, spot.standing, spot.facing, action)
    normal = np.asarray(spot.normal, dtype=np.float64)
    goal = np.asarray(spot.point) + HAND_REST * normal
    palm = free_palm(body.scene.obstacles, spot, goal, action.hand)
    doing = handling_of(action.caption)
    hold = max(action.hold, 1.2, LONGER.get(doing, 0.0))
    other = (
        other_hand(body.scene.obstacles, spot, goal, action.hand, body.skeleton.scale)
        if with_both_hands(action.caption)
        else None
    )
    laid, depth = Laid(goal, palm, normal, action.hand, other), body.scene.obstacles.solid().depth
    body.add(touch(body.pose, laid, (bearing, hold), body.skeleton, depth, doing))


SKILLS: dict[Skill, Callable[[Body, Action], None]] = {
    Skill.LOCO: _loco,
    Skill.SITDOWN: _sitdown,
    Skill.LIEDOWN: _liedown,
    Skill.STANDUP: _rest_over,
    Skill.GETUP: _rest_over,
    Skill.TOUCH: _touch,
}
