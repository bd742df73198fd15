"""Going to a bed and lying down on it: the performer of liedown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import FPS, Action, Part
from motion_backend.obstacles import Obstacles
from motion_backend.procedural.body import Body, spot_of
from motion_backend.procedural.lie_styles import lie_style
from motion_backend.procedural.lying import Bed
from motion_backend.procedural.reclining import edge_seat, lie_down
from motion_backend.procedural.sitting import lower_onto
from motion_backend.procedural.sitting_down import at_standing_point
from motion_backend.procedural.stances import UP, Seat, idle
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]


def edge_of(body: Body, spot: Spot) -> Seat:
    """The edge of a bed that is sat on before and after lying."""
    return edge_seat(Bed.of(spot), spot.standing, spot.approach, spot.edge, body.skeleton.scale)


def liedown(body: Body, action: Action) -> None:
    """From standing: to the bed, onto its edge, down, and the pose held there."""
    style = lie_style(action.emotion, action.caption)
    spot = spot_of(action)
    seat, bed = edge_of(body, spot), _made(body, spot)
    at_standing_point(body, action, seat)
    body.enter(Part.EDGE)
    body.add(lower_onto(body.pose, seat, style.bearing, body.skeleton))
    body.enter(Part.LIEDOWN)
    body.add(lie_down(body.pose, seat, bed, style, body.skeleton))
    body.add(idle(body.pose, action.hold, 0.6 * style.bearing.restless, body.rng, FPS))


def _made(body: Body, spot: Spot) -> Bed:
    """The bed with what lies on it and stands around it."""
    bed, scale = Bed.of(spot), body.skeleton.scale
    up = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)])
    left = np.array([-up[2], 0.0, up[0]])
    solid = body.scene.obstacles.solid()
    head = np.asarray(spot.point) + 0.68 * scale * up
    return replace(
        bed,
        pillow=_height_above(body.scene.obstacles, head, 0.20),
        end=_foot_end(solid, spot, -up, scale),
        beside=(_room_beside(solid, bed, left, up, scale), _room_beside(solid, bed, -left, up, scale)),
    )


def _room_beside(solid: Obstacles, bed: Bed, aside: Array, up: Array, scale: float) -> float:
    """Distance from the body's middle to what would be in the way of its arm on one side (metres)."""
    for distance in np.arange(0.20, 0.90, 0.03) * scale:
        points = [bed.pelvis + along * scale * up + distance * aside + 0.02 * UP for along in (0.10, 0.30, 0.48, 0.68)]
        if solid.depth(np.stack(points)).max() > -0.03:
            return float(distance)
    return np.inf


def _height_above(obstacles: Obstacles, point: Array, most: float) -> float:
    """How much higher than a point of the mattress the thing on it is (metres), up to `most`."""
    column = point + np.arange(0.60, 0.0, -0.01)[:, None] * [0.0, 1.0, 0.0]
    inside = obstacles.depth(column) > 0
    return float(np.clip(0.60 - 0.01 * np.argmax(inside), 0.0, most)) if inside.any() else 0.0


def _foot_end(solid: Obstacles, spot: Spot, down: Array, scale: float) -> tuple[float, float]:
    """Distance along the bed to what would be in the way of stretched legs, and its height above the mattress."""
    for distance in np.arange(0.45, 0.97, 0.03) * scale:
        height = _height_above(solid, np.asarray(spot.point) + distance * down, 0.60)
        if height > 0.03:
            return float(distance), height
    return np.inf, 0.0
