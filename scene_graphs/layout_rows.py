"""The fields of a room's native JSON: pieces, their shapes, openings and outlines, read with a bound on everything."""

from __future__ import annotations

from typing import Any

import shapely

from scene_graphs.fields import MAX_COORDINATE, LayoutError, Row, read_number, read_point2, read_point3, read_text
from scene_graphs.furniture import canonical
from scene_graphs.placed import Opening, Placed, Point2, Segment
from scene_graphs.solids import MAX_PARTS, ROLES, THINNEST, Part, Point3

MAX_OBJECTS = 500
MAX_CORNERS = 400
MIN_SIZE, MAX_SIZE = 1e-4, 30.0
"""No object is shorter or longer, in metres."""
MIN_ROOM_HEIGHT = 1.5
"""No room is lower, in metres."""
MAX_ROOM_WIDTH = 60.0
"""No room is wider: maps of the floor take memory by its area."""
MAX_TAGS = 100
NEAR = 1.2
"""Objects whose footprints are this near, in metres, are joined in a room's graph."""
MAX_CROWDED = 1_000_000
"""Objects of a room times pairs of them that stand near each other; 13,000 in the fullest of 539 real rooms."""
_SLACK = 0.05
"""How far a part may stand out of its piece's box, in metres."""


def placed_to_row(placed: Placed) -> dict[str, Any]:
    """The JSON of a piece; what it does not have is left out."""
    row: dict[str, Any] = {
        "id": placed.id,
        "category": placed.category,
        "position": list(placed.position),
        "size": list(placed.size),
        "yaw": placed.yaw,
    }
    row |= {key: value for key in ("parent", "mesh") if (value := getattr(placed, key)) is not None}
    return row | ({"shape": [[part.role, [*part.low], [*part.high]] for part in placed.shape]} if placed.shape else {})


def opening_to_row(opening: Opening) -> dict[str, Any]:
    """The JSON of a door or window."""
    return {"segment": [list(end) for end in opening.segment], "bottom": opening.bottom, "top": opening.top}


def placed_from_row(row: Row, where: str) -> Placed:
    """A piece of furniture; `pos` is read as `position` and its category is made canonical."""
    position = row.get("position", row.get("pos"))
    size = read_point3(row.get("size"), f"{where}.size", MIN_SIZE, MAX_SIZE)
    return Placed(
        id=read_text(row, "id", where),
        category=canonical(read_text(row, "category", where)),
        position=read_point3(position, f"{where}.position", -MAX_COORDINATE, MAX_COORDINATE),
        size=size,
        yaw=read_number(row.get("yaw", 0.0), f"{where}.yaw", -100.0, 100.0),
        parent=None if row.get("parent") is None else read_text(row, "parent", where),
        mesh=None if row.get("mesh") is None else read_text(row, "mesh", where),
        shape=_shape(row.get("shape"), f"{where}.shape", size),
    )


def _shape(value: Any, where: str, size: Point3) -> tuple[Part, ...]:
    if value is None:
        return ()
    if not isinstance(value, list) or len(value) > MAX_PARTS:
        raise LayoutError(f"{where} must be a list of at most {MAX_PARTS} boxes [role, low, high]")
    return tuple(_part(item, f"{where}[{index}]", size) for index, item in enumerate(value))


def _part(value: Any, where: str, size: Point3) -> Part:
    if not isinstance(value, list) or len(value) != 3 or not (isinstance(value[0], str) and value[0] in ROLES):
        raise LayoutError(f"{where} must be [role, low, high] with a role of {', '.join(sorted(ROLES))}")
    low, high = (read_point3(corner, where, -MAX_SIZE, MAX_SIZE) for corner in value[1:])
    (w, h, d), s = size, _SLACK
    inside = all(
        least - s <= start and start + THINNEST / 2 <= end and end <= most + s
        for start, end, least, most in zip(low, high, (-w / 2, 0.0, -d / 2), (w / 2, h, d / 2), strict=True)
    )
    if not inside:
        raise LayoutError(f"{where} must lie in its piece's box, x and z centred on 0 and y from 0, low before high")
    return Part(value[0], low, high)


def check_ids(objects: list[Placed], where: str) -> None:
    """Refuse ids that occur twice and parents that are not there."""
    ids = [placed.id for placed in objects]
    for index, placed in enumerate(objects):
        if placed.id in ids[:index]:
            raise LayoutError(f"{where}.objects[{index}].id {placed.id!r} occurs twice; give every object its own id")
        if placed.parent is not None and (placed.parent == placed.id or placed.parent not in ids):
            raise LayoutError(f"{where}.objects[{index}].parent {placed.parent!r} is no other object's id")


def check_crowd(objects: list[Placed], where: str) -> None:
    """Refuse a heap of things: what stands near what would take minutes to find."""
    if len(objects) * len(objects) * (len(objects) - 1) / 2 <= MAX_CROWDED:
        return
    outlines = [shapely.Polygon(placed.footprint) for placed in objects]
    pairs = len(shapely.STRtree(outlines).query(outlines, "dwithin", NEAR)[0]) // 2
    if pairs * len(objects) > MAX_CROWDED:
        raise LayoutError(
            f"{where}.objects are a heap: {pairs} pairs of {len(objects)} stand within {NEAR} m; is it metres?"
        )


def segment_from_row(row: Row, where: str) -> Segment:
    """Two points on the floor."""
    ends = row.get("segment")
    if not isinstance(ends, list) or len(ends) != 2:
        raise LayoutError(f"{where}.segment must be two [x, z] points, got {ends!r:.60}")
    start, end = (read_point2(point, f"{where}.segment[{index}]") for index, point in enumerate(ends))
    return start, end


def opening_from_row(row: Row, where: str) -> Opening:
    """A door or window."""
    segment = segment_from_row(row, where)
    bottom = read_number(row.get("bottom", 0.0), f"{where}.bottom", 0.0, MAX_SIZE)
    top = read_number(row.get("top", 2.1), f"{where}.top", 0.0, MAX_SIZE)
    if top <= bottom:
        raise LayoutError(f"{where}.top must be above bottom, got {top} and {bottom}")
    return Opening(segment, bottom, top)


def read_outline(row: Row, where: str) -> tuple[Point2, ...]:
    """The corners of the floor, turned counter-clockwise as seen from above."""
    corners, place = row.get("floor_polygon"), f"{where}.floor_polygon"
    if not isinstance(corners, list) or not 3 <= len(corners) <= MAX_CORNERS:
        raise LayoutError(f"{place} must be a list of 3 to {MAX_CORNERS} [x, z] corners in metres")
    points = [read_point2(corner, f"{place}[{index}]") for index, corner in enumerate(corners)]
    while len(points) > 1 and points[0] == points[-1]:
        points.pop()
    polygon = shapely.Polygon(points) if len(points) >= 3 else None
    if polygon is None or not polygon.is_valid or polygon.area < 0.5:
        raise LayoutError(f"{place} must be a simple polygon of at least 0.5 square metres; order its corners around")
    low_x, low_z, high_x, high_z = polygon.bounds
    if max(high_x - low_x, high_z - low_z) > MAX_ROOM_WIDTH:
        raise LayoutError(f"{place} must fit in {MAX_ROOM_WIDTH:g} by {MAX_ROOM_WIDTH:g} metres; is it in centimetres?")
    # Seen from above [x, z] is a left-handed pair: counter-clockwise there is clockwise to shapely.
    return tuple(reversed(points)) if polygon.exterior.is_ccw else tuple(points)
