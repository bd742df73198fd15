"""Where a model stands in a scene: its place, turn and scale, read out of JSON rows without trusting them.

Unity's frame to ours: left-handed, Y up, metres, clockwise degrees.

Mirroring x does it: x -> -x, yaw = -degrees. Doing nothing would leave every room a mirror image of itself.
"""

from __future__ import annotations

from math import atan2, hypot, pi
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scene_graphs.boxes import Point3
from scene_graphs.json_fields import MAX_COORDINATE, Row
from scene_graphs.layout import Array, Point2

MIN_SCALE, MAX_SCALE = 1e-5, 5.0
UPRIGHT: Final = 0.995
"""Cosine of the largest tilt that is taken for none."""


class Pose(NamedTuple):
    """World point = place + turn(scale * model point), in the scene's frame: right-handed, Y up, metres."""

    place: Point3
    turn: tuple[float, float, float, float]
    """Unit quaternion x, y, z, w."""
    scale: Point3

    @property
    def yaw(self) -> float:
        """The heading of the model's +Z; a scale that is negative along it turns the front round."""
        x, y, z, w = self.turn
        heading = atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y))
        return heading if self.scale[2] > 0 else heading - pi * (1 if heading > 0 else -1)

    @property
    def is_upright(self) -> bool:
        """Whether it is turned about the vertical only."""
        x, _, z, _ = self.turn
        return 1 - 2 * (x * x + z * z) >= UPRIGHT

    @property
    def is_identity(self) -> bool:
        """Whether it changes nothing."""
        return self == _IDENTITY

    def to_world(self, points: Array) -> Array:
        """Turn points of the model into the scene's. (N, 3)."""
        if self.is_identity:
            return points
        scaled = points * np.asarray(self.scale)
        axis, w = np.asarray(self.turn[:3]), self.turn[3]
        side = np.cross(axis, scaled)
        turned: Array = scaled + 2 * (w * side + np.cross(axis, side)) + np.asarray(self.place)
        return turned


_IDENTITY: Final = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0))


def read_pose(row: Row) -> Pose | str:
    """The pose in `pos`, `rot` (xyzw) and `scale` of a row, an absent one changing nothing; else what is wrong."""
    place = numbers(row.get("pos", (0, 0, 0)), 3, MAX_COORDINATE)
    turn = numbers(row.get("rot", (0, 0, 0, 1)), 4, MAX_COORDINATE)
    scale = numbers(row.get("scale", (1, 1, 1)), 3, MAX_COORDINATE)
    if place is None or turn is None or scale is None:
        return "its place, turn or scale is not a list of numbers in metres"
    if not MIN_SCALE <= min(map(abs, scale)) <= max(map(abs, scale)) <= MAX_SCALE:
        return f"its scale is smaller than {MIN_SCALE:g} or larger than {MAX_SCALE:g}"
    length = hypot(*turn)
    if length < 0.5:
        return "its turn is not a quaternion"
    x, y, z, w = (number / length for number in turn)
    return Pose((place[0], place[1], place[2]), (x, y, z, w), (scale[0], scale[1], scale[2]))


def numbers(value: Any, count: int, most: float) -> tuple[float, ...] | None:
    """That many finite numbers, none farther from 0 than `most`; None for anything else."""
    if not isinstance(value, list | tuple) or len(value) != count:
        return None
    # A NaN is within no bound.
    if not all(isinstance(n, int | float) and not isinstance(n, bool) and abs(n) <= most for n in value):
        return None
    return tuple(float(number) for number in value)


def coordinates(value: Any, most: float = MAX_COORDINATE) -> Array | None:
    """A flat list x, y, z, x, ... as points; None for anything else or a point farther than `most`. (N, 3)."""
    if not isinstance(value, list) or not value or len(value) % 3:
        return None
    try:
        flat = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return None
    return flat.reshape(-1, 3) if flat.ndim == 1 and bool((np.abs(flat) <= most).all()) else None


def corners_of(faces: Any, count: int) -> NDArray[np.int64] | None:
    """A flat list of triangle corners as rows of point numbers; None for anything else or a number out of range."""
    if not isinstance(faces, list) or not faces or len(faces) % 3:
        return None
    try:
        flat = np.asarray(faces, dtype=np.int64)
    except (TypeError, ValueError, OverflowError):
        return None
    in_range = flat.ndim == 1 and bool(((flat >= 0) & (flat < count)).all())
    return flat.reshape(-1, 3) if in_range else None


_MIRROR = np.diag([-1.0, 1.0, 1.0])
_UPRIGHT = 1e-3


def point_from_unity(point: Point3) -> Point3:
    """The same place in our frame."""
    return (-point[0], point[1], point[2])


def plan_from_unity(x: float, z: float) -> Point2:
    """The same place of a plan, as [x, z]."""
    return (-x, z)


def yaw_from_unity(degrees: float) -> float:
    """The same turn about the vertical, in (-pi, pi]."""
    turn = -np.radians(degrees % 360.0)
    return float(turn + 2 * pi if turn <= -pi else turn)


def box_from_unity(size: Point3, degrees: Point3) -> tuple[Point3, float]:
    """Size and yaw of the upright box around one that is turned by Unity's Euler angles about x, y and z."""
    if all(abs((angle + 180.0) % 360.0 - 180.0) < _UPRIGHT for angle in (degrees[0], degrees[2])):
        return size, yaw_from_unity(degrees[1])
    turn = _MIRROR @ _turn_from_euler(degrees) @ _MIRROR
    front = turn[:, 2]
    upright = np.hypot(front[0], front[2]) < _UPRIGHT
    yaw = yaw_from_unity(degrees[1]) if upright else atan2(front[0], front[2])
    w, h, d = np.abs(_about_y(yaw).T @ turn) @ np.asarray(size)
    return (float(w), float(h), float(d)), float(yaw)


def _turn_from_euler(degrees: Point3) -> Array:
    """Unity turns about z first, then x, then y. (3, 3)."""
    x, _, z = np.radians(degrees)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    turn: Array = _about_y(np.radians(degrees[1])) @ about_x @ about_z
    return turn


def _about_y(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
