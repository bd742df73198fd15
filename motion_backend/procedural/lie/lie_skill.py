"""Lying down on a bed or a free floor, staying there and getting up: the performers of lying and of leaving a bed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend.backend_protocol import Part
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS, Action, PhaseKind, Posture
from motion_backend.procedural.body_state import Body, Point, spot_of, spot_under
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import UP, Seat, idle
from motion_backend.procedural.lie.lie_keys import lie_keys, paced
from motion_backend.procedural.lie.lie_on_floor import Mat, kneel_down, kneel_up, lie_down_from_knees, rise_to_knees
from motion_backend.procedural.lie.lie_pose import Bed, lacking
from motion_backend.procedural.lie.lie_styles import lie_style, own_way
from motion_backend.procedural.lie.lie_transition import edge_seat, lie_down, on_the_edge, rise_to_edge, turn_over
from motion_backend.procedural.sit.sit_keys import sit_keys
from motion_backend.procedural.sit.sit_legs import at_front
from motion_backend.procedural.sit.sit_skill import leave_seat
from motion_backend.procedural.sit.sit_styles import Seated
from motion_backend.procedural.sit.sit_transition import NOTHING, lower_onto
from motion_backend.procedural.touch.gestures import gesture
from motion_backend.procedural.walk.walk_skill import go
from motion_backend.rotations import Array
from scene_graphs.affordances.affordances import Spot

FLOOR = 0.02
"""What is lain on is the floor if it is no higher than this (metres)."""
CALM = 0.6
"""How restless one is that lies, against the same mood on the feet."""
TO_HEAD = 0.68
"""From the pelvis to the middle of the head (metres at 1.70 m)."""
MAX_PILLOW = 0.20
"""What is higher under a head is not lain on (metres)."""
HIGH, HIGH_STEP = 0.60, 0.01
"""How high over a mattress it is looked what lies on it, and how finely (metres)."""
BESIDE, ARM_HEIGHTS = np.arange(0.20, 0.90, 0.03), (0.02, -0.05)
"""Where it is looked for room beside the body (metres at 1.70 m), and how high over the pelvis: for arms, and for hands
on the mattress beside something hardly higher (metres)."""
ARM = (0.10, 0.30, 0.48, 0.68)
"""How far towards the head from the pelvis arms are that lie beside the body or above it (metres at 1.70 m)."""
NEARLY = 0.03
"""Points that are so near to something are as good as in it, and a mattress may be as uneven (metres)."""
FEET = np.arange(0.45, 0.97, 0.03)
"""Where it is looked for what ends a bed at the feet, from the pelvis (metres at 1.70 m)."""


def before_bed(body: Body, action: Action) -> tuple[Point, float]:
    """Where to stand, and the yaw, before the edge of the bed is sat on or the floor knelt on."""
    spot = spot_of(action)
    if _on_floor(spot):
        return Mat(_made(body, spot), body.skeleton).standing_point, spot.facing
    seat = _edge_of(body, spot)
    return seat.standing_point(body.skeleton.scale), seat.yaw


def lie(body: Body, part: Part) -> None:
    """From standing: onto the edge of the bed, or onto the knees on the floor; down, and into the pose; or from where
    the body sits, or lies already."""
    action = part.action
    keys = paced(lie_keys(), body.rng)
    style = own_way(lie_style(action.emotion, action.caption), keys.own, body.seed, body.rng)
    spot = spot_of(action)
    made = _made(body, spot)
    body.note(*lacking(style, made, body.skeleton, keys.pose))
    if body.posture is Posture.LYING:
        body.enter(PhaseKind.LIEDOWN)
        body.add(turn_over(body.pose, made, style, body.skeleton, keys))
        return
    if body.posture is Posture.SEATED:
        body.enter(PhaseKind.LIEDOWN)
        seat = at_front(Seat.of(spot_under(body)), body.skeleton.scale)
        body.add(on_the_edge(body.pose, seat, style.bearing, body.skeleton, keys, sit_keys().up.gather))
        body.add(lie_down(body.pose, seat, made, style, body.skeleton, keys))
        body.holds = NOTHING
        return
    body.enter(PhaseKind.WALK)
    go(body, *before_bed(body, action), action)
    body.enter(PhaseKind.EDGE)
    if _on_floor(spot):
        mat = Mat(made, body.skeleton)
        body.add(kneel_down(body.pose, mat, style.bearing, keys.floor_down))
        body.enter(PhaseKind.LIEDOWN)
        body.add(lie_down_from_knees(body.pose, mat, style, keys))
    else:
        seat = _edge_of(body, spot)
        sat = Seated(bearing=style.bearing)
        body.add(lower_onto(body.pose, seat, sat, NOTHING, body.skeleton, sit_keys().down))
        body.enter(PhaseKind.LIEDOWN)
        body.add(lie_down(body.pose, seat, made, style, body.skeleton, keys))


def stay_lying(body: Body, part: Part) -> None:
    """Lie for a while."""
    style = lie_style(part.action.emotion, part.action.caption)
    held = idle(body.pose, part.hold, CALM * style.bearing.restless, body.rng, FPS)
    body.add(gesture(held, style.doing, rng=body.rng))


def sit_up(body: Body, bearing: Bearing, seat: Seat) -> None:
    """From lying to sitting on a seat at the edge."""
    keys = paced(lie_keys(), body.rng)
    body.add(rise_to_edge(body.pose, seat, Bed.of(spot_under(body), body.skeleton.scale), bearing, body.skeleton, keys))


def get_up(body: Body, bearing: Bearing) -> None:
    """From lying to the edge of the bed, or from the floor to the knees."""
    spot = spot_under(body)
    if _on_floor(spot):
        body.add(rise_to_knees(body.pose, _mat(body, spot), bearing, paced(lie_keys(), body.rng)))
    else:
        sit_up(body, bearing, _edge_of(body, spot))


def leave_bed(body: Body, bearing: Bearing) -> None:
    """From the edge of the bed, or from the knees, to standing."""
    spot = spot_under(body)
    if not _on_floor(spot):
        leave_seat(body, _edge_of(body, spot), bearing)
        return
    body.add(kneel_up(body.pose, _mat(body, spot), bearing, paced(lie_keys(), body.rng).floor_up))


def _mat(body: Body, spot: Spot) -> Mat:
    return Mat(Bed.of(spot, body.skeleton.scale), body.skeleton)


def _on_floor(spot: Spot) -> bool:
    return spot.point[1] < FLOOR


def _edge_of(body: Body, spot: Spot) -> Seat:
    """The edge of a bed that is sat on before and after lying."""
    return edge_seat(Bed.of(spot, body.skeleton.scale), spot.standing, spot.approach, spot.edge, body.skeleton.scale)


def _made(body: Body, spot: Spot) -> Bed:
    """The bed with what lies on it and stands around it."""
    scale = body.skeleton.scale
    bed = Bed.of(spot, scale)
    up = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)])
    left = np.array([-up[2], 0.0, up[0]])
    solid = body.scene.obstacles.solid()
    head = np.asarray(spot.point) + TO_HEAD * scale * up
    return replace(
        bed,
        pillow=_height_above(body.scene.obstacles, head, MAX_PILLOW),
        end=_foot_end(solid, spot, -up, scale),
        beside=(_room_beside(solid, bed, left, up, scale), _room_beside(solid, bed, -left, up, scale)),
    )


def _room_beside(solid: Obstacles, bed: Bed, aside: Array, up: Array, scale: float) -> float:
    """Distance from the body's middle to what would be in the way of its arm on one side (metres)."""
    for distance in BESIDE * scale:
        places = [bed.pelvis + along * scale * up + distance * aside for along in ARM]
        points = [place + height * UP for place in places for height in ARM_HEIGHTS]
        if solid.depth(np.stack(points)).max() > -NEARLY:
            return float(distance)
    return np.inf


def _height_above(obstacles: Obstacles, point: Array, most: float) -> float:
    """How much higher than a point of the mattress the thing on it is (metres), up to `most`."""
    column = point + np.arange(HIGH, 0.0, -HIGH_STEP)[:, None] * [0.0, 1.0, 0.0]
    inside = obstacles.depth(column) > 0
    return float(np.clip(HIGH - HIGH_STEP * np.argmax(inside), 0.0, most)) if inside.any() else 0.0


def _foot_end(solid: Obstacles, spot: Spot, down: Array, scale: float) -> tuple[float, float]:
    """Distance along the bed to what would be in the way of stretched legs, and its height above the mattress."""
    for distance in FEET * scale:
        height = _height_above(solid, np.asarray(spot.point) + distance * down, HIGH)
        if height > NEARLY:
            return float(distance), height
    return np.inf, 0.0
