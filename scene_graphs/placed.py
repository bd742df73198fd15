"""What stands in a room: furniture with its place, its front and its shape, and the openings of the walls.

Frame: right-handed, Y up, metres, radians. Yaw is about +Y, counter-clockwise seen from above, and 0 faces +Z.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from scene_graphs.solids import Part, Point3

Array = NDArray[np.float64]
Point2 = tuple[float, float]
Segment = tuple[Point2, Point2]


@dataclass(frozen=True)
class Placed:
    """One object standing in a room (or, with a `room_index/object_id` id, in a home)."""

    id: str
    category: str
    position: Point3
    """Centre of the bottom face."""
    size: Point3
    """Width x, height y, depth z at yaw 0."""
    yaw: float = 0.0
    parent: str | None = None
    """The object it stands on, if any."""
    mesh: str | None = None
    shape: tuple[Part, ...] = ()
    """Solid boxes measured from its mesh, in its own frame; empty = the parametric form of its category."""

    def to_world(self, points: Array | Point3) -> Array:
        """Turn points of the object's own frame (origin at the bottom centre, front +Z) into the room's. (..., 3)."""
        local = np.asarray(points, dtype=float)
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        x, y, z = local[..., 0], local[..., 1], local[..., 2]
        turned: Array = np.stack([cos * x + sin * z, y, -sin * x + cos * z], axis=-1) + np.asarray(self.position)
        return turned

    def to_local(self, points: Array | Point3) -> Array:
        """The inverse of `to_world`. (..., 3)."""
        moved = np.asarray(points, dtype=float) - np.asarray(self.position)
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        x, y, z = moved[..., 0], moved[..., 1], moved[..., 2]
        return np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=-1)

    @cached_property
    def footprint(self) -> Array:
        """The four corners on the floor as [x, z], in order around the box. (4, 2)."""
        w, _, d = self.size
        corners = np.array([[-w, 0, -d], [-w, 0, d], [w, 0, d], [w, 0, -d]]) / 2
        return self.to_world(corners)[:, [0, 2]]

    @property
    def front(self) -> Array:
        """Unit vector of the front as [x, z]. (2,)."""
        return np.array([np.sin(self.yaw), np.cos(self.yaw)])

    @property
    def top(self) -> float:
        """Height of the top face above the floor."""
        return self.position[1] + self.size[1]


def wrap(yaw: float) -> float:
    """The same yaw in [-pi, pi)."""
    return (yaw + pi) % (2 * pi) - pi


@dataclass(frozen=True)
class Opening:
    """A door or window: two points on the outline and the heights between which the wall is open."""

    segment: Segment
    bottom: float = 0.0
    top: float = 2.1
