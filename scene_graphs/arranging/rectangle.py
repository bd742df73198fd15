"""Rectangles on the floor: what a piece of furniture covers, what must stay clear, and whether two of them meet."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from scene_graphs.layouts import Point2


class Rectangle(NamedTuple):
    """A rectangle on the floor plane, turned about its middle (metres)."""

    x: float
    z: float
    half_width: float
    half_depth: float
    cos: float = 1.0
    sin: float = 0.0

    @property
    def corners(self) -> tuple[Point2, ...]:
        """[x, z] of the four corners, in order around."""
        return tuple(self.at(i * self.half_width, j * self.half_depth) for i, j in ((-1, -1), (-1, 1), (1, 1), (1, -1)))

    def at(self, right: float, ahead: float) -> Point2:
        """The point so far along the rectangle's own x and z axes from its middle."""
        return (self.x + self.cos * right + self.sin * ahead, self.z - self.sin * right + self.cos * ahead)

    def meets(self, other: Rectangle, gap: float = 0.0) -> bool:
        """Whether the two share floor, or (gap > 0) come about that near: no axis of either separates them."""
        x, z = other.x - self.x, other.z - self.z
        along = abs(self.cos * other.cos + self.sin * other.sin)
        across = abs(self.sin * other.cos - self.cos * other.sin)
        return (
            abs(self.cos * x - self.sin * z)
            < self.half_width + other.half_width * along + other.half_depth * across + gap
            and abs(self.sin * x + self.cos * z)
            < self.half_depth + other.half_width * across + other.half_depth * along + gap
            and abs(other.cos * x - other.sin * z)
            < other.half_width + self.half_width * along + self.half_depth * across + gap
            and abs(other.sin * x + other.cos * z)
            < other.half_depth + self.half_width * across + self.half_depth * along + gap
        )


def rectangle(middle: Point2, width: float, depth: float, yaw: float = 0.0) -> Rectangle:
    """The rectangle of that width (its own x) and depth (its own z) at yaw 0, turned about +Y."""
    return Rectangle(middle[0], middle[1], width / 2, depth / 2, cos(yaw), sin(yaw))
