"""The floor of a plain 3D scene: what its floor covers, or what its walls enclose."""

from __future__ import annotations

from typing import Final

import numpy as np
import shapely
from numpy.typing import ArrayLike

from scene_graphs.loaders.floors import SIMPLIFY, corners_around, floor_from_triangles, united
from scene_graphs.placed import Array, Point2

GAP: Final = 0.6
"""Half the width of the widest doorway that does not break the ring of walls, in metres."""
_MIN_ENCLOSED: Final = 1.0
_STRAIGHT: Final = 1e-3
_MAX_TRIANGLES: Final = 20_000
"""Of more, only the hull is taken."""


def floor_of_scene(floors: ArrayLike, walls: ArrayLike) -> list[Point2] | None:
    """The outline of the floor, else the floor inside the ring of walls; of several rings, or none, the hull of all.

    Both are triangles (N, 3, 2) seen from above, [x, z] in metres. None if neither spans an area.
    """
    covered, standing = (np.asarray(triangles, dtype=float).reshape(-1, 3, 2) for triangles in (floors, walls))
    if len(covered) and (floor := floor_from_triangles(covered) if _is_small(covered) else _hull(covered)):
        return floor
    rooms = _rings(standing) if _is_small(standing) else []
    return _corners(rooms[0]) if len(rooms) == 1 else _hull(standing)


def _is_small(triangles: Array) -> bool:
    return len(triangles) <= _MAX_TRIANGLES


def _hull(triangles: Array) -> list[Point2] | None:
    hull = shapely.convex_hull(shapely.multipoints(triangles.reshape(-1, 2)))
    return _corners(hull) if isinstance(hull, shapely.Polygon) and hull.area >= _MIN_ENCLOSED else None


def _corners(floor: shapely.Polygon) -> list[Point2]:
    return corners_around(floor.exterior.simplify(SIMPLIFY))


def _rings(corners: Array) -> list[shapely.Polygon]:
    """The areas that walls go around, however thin the walls are."""
    lines = shapely.linestrings(corners[:, [0, 1, 2, 0]])
    # Clean outlines first: a mitre on the sharp corners of single triangles would be a spike.
    outlines = shapely.buffer(lines, _STRAIGHT, cap_style="flat", join_style="bevel")
    walls = shapely.simplify(united(np.asarray(outlines, dtype=object)), 2 * _STRAIGHT)
    thick = shapely.buffer(walls, GAP - _STRAIGHT, join_style="mitre", mitre_limit=1.5)
    inner = [
        shapely.Polygon(ring).simplify(_STRAIGHT).buffer(GAP, join_style="mitre")
        for piece in shapely.get_parts(thick)
        for ring in piece.interiors
    ]
    return [area for area in inner if isinstance(area, shapely.Polygon) and area.area >= _MIN_ENCLOSED]
