"""Unity's frame to ours: left-handed, Y up, metres, clockwise degrees.

Mirroring x does it: x -> -x, yaw = -degrees. Doing nothing would leave every room a mirror image of itself.
"""

from __future__ import annotations

from math import atan2, pi

import numpy as np

from scene_graphs.placed import Array, Point2
from scene_graphs.solids import Point3

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
