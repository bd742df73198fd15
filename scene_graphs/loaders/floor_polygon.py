"""The floor of a room from what a scene file has of it: triangles, tiles, or only the furniture that stands there.

The floor of a plain 3D scene: what its floor covers, or what its walls enclose.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry.base import BaseGeometry

from scene_graphs.layout import Array, Placed, Point2, Segment

GROW: Final = 1e-4
"""Triangles are grown by this before they are united, so that shared edges leave no cracks."""
SIMPLIFY: Final = 0.02
AROUND: Final = 0.5
"""Free floor around furniture where the floor is not known, in metres."""
ON_WALL: Final = 0.6
"""An opening may be drawn this far from the outline it belongs to: walls have a thickness."""
MIN_FLOOR_WIDTH: Final = 0.3
MAX_CORNERED: Final = 2_000
"""Corners of what polygons are united to on the way; a grid of crossing slivers would have millions."""


def floor_from_triangles(triangles: ArrayLike) -> list[Point2] | None:
    """The outline of the largest connected floor; None if there is none. Triangles are (N, 3, 2) [x, z] in metres.

    Holes are filled: an outline is one simple polygon. Corners nearer than 2 cm to the line between others go.
    """
    corners = np.asarray(triangles, dtype=float).reshape(-1, 3, 2)
    corners = corners[np.isfinite(corners).all(axis=(1, 2))]
    if not len(corners):
        return None
    return _outline(united(_grown(shapely.make_valid(shapely.polygons(corners)))))


def floor_from_boxes(boxes: ArrayLike) -> list[Point2] | None:
    """The outline of floor tiles (N, 4) [low x, low z, high x, high z]; None if there is none."""
    sides = np.asarray(boxes, dtype=float).reshape(-1, 4)
    sides = sides[np.isfinite(sides).all(axis=1)]
    if not len(sides):
        return None
    return _outline(united(_grown(shapely.box(*sides.T))))


def united(polygons: NDArray[np.object_]) -> shapely.Geometry:
    """The union of polygons (N,); of a tangle, whose corners become many more or than `MAX_CORNERED`, the hull.

    Neighbours are united first, two and two, so that what they are united to is never much larger than the outcome.
    """
    polygons = polygons[~shapely.is_empty(polygons)]
    if not len(polygons):
        return shapely.Polygon()
    middles = shapely.get_coordinates(shapely.centroid(polygons))
    strips = max(1, int(np.sqrt(len(polygons) / 2)))
    strip = np.argsort(np.argsort(middles[:, 0], kind="stable"), kind="stable") * strips // len(polygons)
    level = polygons[np.lexsort((middles[:, 1], strip))]
    most = 2 * shapely.get_num_coordinates(level).sum()
    while len(level) > 1:
        corners = shapely.get_num_coordinates(level)
        if corners.max() > MAX_CORNERED or corners.sum() > most:
            return shapely.GeometryCollection(list(polygons)).convex_hull
        if len(level) % 2:
            level = np.concatenate([level, np.array([shapely.Polygon()], dtype=object)])
        level = np.asarray(shapely.union(level[::2], level[1::2]), dtype=object)
    geometry: shapely.Geometry = level[0]
    return geometry


def floor_around(objects: Sequence[Placed], around: float = AROUND) -> list[Point2]:
    """A rectangle around furniture with some free floor."""
    corners = np.concatenate([placed.footprint for placed in objects])
    (low_x, low_z), (high_x, high_z) = corners.min(axis=0) - around, corners.max(axis=0) + around
    return corners_around(shapely.box(low_x, low_z, high_x, high_z).exterior)


def corners_around(ring: BaseGeometry) -> list[Point2]:
    """The corners of a closed ring as an outline has them: [x, z] in metres, the first not repeated."""
    return [(float(x), float(z)) for x, z in ring.coords[:-1]]


def on_outline(segment: Segment, floor: Sequence[Point2]) -> Segment | None:
    """The stretch of the outline's nearest side that an opening covers; None if no side is near and long enough."""
    ends = np.asarray(segment, dtype=float)
    if ends.shape != (2, 2) or not np.isfinite(ends).all():
        return None
    outline = np.asarray(floor, dtype=float)
    best: tuple[float, Segment] | None = None
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        length = float(np.hypot(*(end - start)))
        if length < MIN_FLOOR_WIDTH:
            continue
        along = (end - start) / length
        positions = np.clip((ends - start) @ along, 0.0, length)
        away = float(np.abs((ends - start) @ np.array([-along[1], along[0]])).max())
        if away > ON_WALL or abs(positions[1] - positions[0]) < MIN_FLOOR_WIDTH:
            continue
        on = start + positions[:, None] * along
        if best is None or away < best[0]:
            best = away, ((float(on[0, 0]), float(on[0, 1])), (float(on[1, 0]), float(on[1, 1])))
    return None if best is None else best[1]


def _grown(areas: Any) -> NDArray[np.object_]:
    return np.asarray(shapely.buffer(areas, GROW, cap_style="flat", join_style="bevel"), dtype=object)


def _outline(area: shapely.Geometry) -> list[Point2] | None:
    pieces = [piece for piece in shapely.get_parts(area) if isinstance(piece, shapely.Polygon)]
    if not pieces:
        return None
    largest = max(pieces, key=lambda piece: piece.area)
    simple = shapely.Polygon(largest.exterior).simplify(SIMPLIFY)
    return corners_around(simple.exterior) if isinstance(simple, shapely.Polygon) and not simple.is_empty else None


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
