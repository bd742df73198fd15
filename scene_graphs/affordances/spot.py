"""A spot: one place on an object where a body can do one thing, and the plan geometry spots are found with."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, inf, sin

from scene_graphs.furniture_shapes import Part
from scene_graphs.json_fields import Json
from scene_graphs.layout import Placed, Point2, Point3

REACH_AHEAD = 0.42
"""Horizontal distance from a seated pelvis to the feet, so to where the pelvis was when standing (body of 1.70 m)."""
FORWARD: Point2 = (0.0, 1.0)
"""Front of a piece in its own plan (x, z)."""


@dataclass(frozen=True)
class Spot:
    """One place on an object where a body can do one thing, in the frame the object is placed in (metres, radians)."""

    affordance: str
    """sit, lie or touch."""
    object_id: str
    point: Point3
    """On the surface: under the pelvis (sit, lie) or where the hand goes (touch)."""
    normal: Point3
    """Unit, out of the surface."""
    facing: float
    """Yaw the sitter looks to; yaw the standing body looks to (touch); yaw from the pelvis to the head (lie)."""
    standing: Point2
    """[x, z] of the pelvis standing before and after."""
    approach: float
    """Yaw of the body at `standing` just before: back to the seat (sit) or to the bed (lie), towards it (touch).

    Who lies down on the floor looks to where the head will be.
    """
    edge: float = 0.0
    """sit, lie: horizontal distance from `point` to the edge of the surface towards `standing`."""
    back: float = inf
    """sit: distance from `point` to the backrest plane; lie: to the head end of the surface."""
    side: float = 0.0
    """lie: distance from `point` to the foot end."""
    height: str = "medium"
    """touch: low, medium or high."""


def spot_to_dict(spot: Spot | None) -> Json | None:
    """Plain values of a spot, or None of none; what is endless is None."""
    if spot is None:
        return None
    return {name: (None if value == inf else value) for name, value in vars(spot).items()}


def spot_from_dict(row: Json | None) -> Spot | None:
    """The inverse of `spot_to_dict`, also once lists have come back for tuples."""
    if row is None:
        return None
    plain: Json = {name: inf if value is None else value for name, value in row.items()}
    plain |= {name: tuple(value) for name, value in plain.items() if isinstance(value, list)}
    return Spot(**plain)


def extent(part: Part, u: Point2) -> float:
    """Size of a part along the axis u, (1, 0) or (0, 1) in [x, z] or their negatives."""
    return abs(u[0]) * part.size[0] + abs(u[1]) * part.size[2]


def dot(point: Point3, u: Point2) -> float:
    """How far a point lies in the plan direction u."""
    return point[0] * u[0] + point[2] * u[1]


def ahead(local: Point3, u: Point2, distance: float) -> Point3:
    """The point that far on in the plan direction u, at the same height."""
    return (local[0] + u[0] * distance, local[1], local[2] + u[1] * distance)


def plan_distance(part: Part, point: Point3) -> float:
    """Distance in plan from a point to a part."""
    dx, dz = (max(abs(point[axis] - part.center[axis]) - part.size[axis] / 2, 0.0) for axis in (0, 2))
    return float((dx * dx + dz * dz) ** 0.5)


def to_world(placed: Placed, local: Point3) -> Point3:
    """A point of the piece's own frame in the frame it is placed in."""
    x, y, z = local
    turn, straight = sin(placed.yaw), cos(placed.yaw)
    return (
        straight * x + turn * z + placed.position[0],
        y + placed.position[1],
        -turn * x + straight * z + placed.position[2],
    )
