"""Placed furniture and rooms: the `Layout` every reader fills and every stage reads, and its JSON.

Frame: right-handed, Y up, metres, radians. Yaw is about +Y, counter-clockwise seen from above, and 0 faces +Z.

A room's native JSON, pieces, their shapes, openings and outlines, is read with a bound on everything.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from pathlib import Path
from typing import Any, Final

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.boxes import MAX_PARTS, ROLES, THINNEST, Part, Point3
from scene_graphs.errors import FieldPath
from scene_graphs.furniture import canonical
from scene_graphs.json_fields import (
    MAX_COORDINATE,
    LayoutError,
    Row,
    read_number,
    read_point2,
    read_point3,
    read_rows,
    read_text,
    read_texts,
)

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


def placed_from_row(row: Row, where: FieldPath) -> Placed:
    """A piece of furniture; `pos` is read as `position` and its category is made canonical."""
    position = row.get("position", row.get("pos"))
    size = read_point3(row.get("size"), where / "size", MIN_SIZE, MAX_SIZE)
    return Placed(
        id=read_text(row, "id", where),
        category=canonical(read_text(row, "category", where)),
        position=read_point3(position, where / "position", -MAX_COORDINATE, MAX_COORDINATE),
        size=size,
        yaw=read_number(row.get("yaw", 0.0), where / "yaw", -100.0, 100.0),
        parent=None if row.get("parent") is None else read_text(row, "parent", where),
        mesh=None if row.get("mesh") is None else read_text(row, "mesh", where),
        shape=_shape(row.get("shape"), where / "shape", size),
    )


def _shape(value: Any, where: FieldPath, size: Point3) -> tuple[Part, ...]:
    if value is None:
        return ()
    if not isinstance(value, list) or len(value) > MAX_PARTS:
        raise LayoutError(f"must be a list of at most {MAX_PARTS} boxes [role, low, high]", at=where)
    return tuple(_part(item, where / index, size) for index, item in enumerate(value))


def _part(value: Any, where: FieldPath, size: Point3) -> Part:
    if not isinstance(value, list) or len(value) != 3 or not (isinstance(value[0], str) and value[0] in ROLES):
        raise LayoutError(f"must be [role, low, high] with a role of {', '.join(sorted(ROLES))}", at=where)
    low, high = (read_point3(corner, where, -MAX_SIZE, MAX_SIZE) for corner in value[1:])
    (w, h, d), s = size, _SLACK
    inside = all(
        least - s <= start and start + THINNEST / 2 <= end and end <= most + s
        for start, end, least, most in zip(low, high, (-w / 2, 0.0, -d / 2), (w / 2, h, d / 2), strict=True)
    )
    if not inside:
        raise LayoutError("must lie in its piece's box, x and z centred on 0 and y from 0, low before high", at=where)
    return Part(value[0], low, high)


def check_ids(objects: list[Placed], where: FieldPath) -> None:
    """Refuse ids that occur twice and parents that are not there."""
    ids = [placed.id for placed in objects]
    for index, placed in enumerate(objects):
        if placed.id in ids[:index]:
            raise LayoutError(
                f"{placed.id!r} occurs twice", "give every object its own id", at=where / "objects" / index / "id"
            )
        if placed.parent is not None and (placed.parent == placed.id or placed.parent not in ids):
            raise LayoutError(f"{placed.parent!r} is no other object's id", at=where / "objects" / index / "parent")


def check_crowd(objects: list[Placed], where: FieldPath) -> None:
    """Refuse a heap of things: what stands near what would take minutes to find."""
    if len(objects) * len(objects) * (len(objects) - 1) / 2 <= MAX_CROWDED:
        return
    outlines = [shapely.Polygon(placed.footprint) for placed in objects]
    pairs = len(shapely.STRtree(outlines).query(outlines, "dwithin", NEAR)[0]) // 2
    if pairs * len(objects) > MAX_CROWDED:
        raise LayoutError(
            f"are a heap: {pairs} pairs of {len(objects)} stand within {NEAR} m", "is it metres?", at=where / "objects"
        )


def segment_from_row(row: Row, where: FieldPath) -> Segment:
    """Two points on the floor."""
    ends = row.get("segment")
    if not isinstance(ends, list) or len(ends) != 2:
        raise LayoutError(f"must be two [x, z] points, got {ends!r:.60}", at=where / "segment")
    start, end = (read_point2(point, where / "segment" / index) for index, point in enumerate(ends))
    return start, end


def opening_from_row(row: Row, where: FieldPath) -> Opening:
    """A door or window."""
    segment = segment_from_row(row, where)
    bottom = read_number(row.get("bottom", 0.0), where / "bottom", 0.0, MAX_SIZE)
    top = read_number(row.get("top", 2.1), where / "top", 0.0, MAX_SIZE)
    if top <= bottom:
        raise LayoutError(f"must be above bottom, got {top} and {bottom}", at=where / "top")
    return Opening(segment, bottom, top)


def read_outline(row: Row, where: FieldPath) -> tuple[Point2, ...]:
    """The corners of the floor, turned counter-clockwise as seen from above."""
    corners, place = row.get("floor_polygon"), where / "floor_polygon"
    if not isinstance(corners, list) or not 3 <= len(corners) <= MAX_CORNERS:
        raise LayoutError(f"must be a list of 3 to {MAX_CORNERS} [x, z] corners in metres", at=place)
    points = [read_point2(corner, place / index) for index, corner in enumerate(corners)]
    while len(points) > 1 and points[0] == points[-1]:
        points.pop()
    polygon = shapely.Polygon(points) if len(points) >= 3 else None
    if polygon is None or not polygon.is_valid or polygon.area < 0.5:
        raise LayoutError(
            "must be a simple polygon of at least 0.5 square metres", "order its corners around", at=place
        )
    low_x, low_z, high_x, high_z = polygon.bounds
    if max(high_x - low_x, high_z - low_z) > MAX_ROOM_WIDTH:
        raise LayoutError(
            f"must fit in {MAX_ROOM_WIDTH:g} by {MAX_ROOM_WIDTH:g} metres", "is it in centimetres?", at=place
        )
    # Seen from above [x, z] is a left-handed pair: counter-clockwise there is clockwise to shapely.
    return tuple(reversed(points)) if polygon.exterior.is_ccw else tuple(points)


__all__ = [
    "MAX_CORNERS",
    "MAX_CROWDED",
    "MAX_OBJECTS",
    "MAX_ROOM_WIDTH",
    "MAX_SIZE",
    "MAX_TAGS",
    "MIN_ROOM_HEIGHT",
    "MIN_SIZE",
    "NEAR",
    "Array",
    "Layout",
    "LayoutError",
    "Opening",
    "Placed",
    "Point2",
    "Point3",
    "Segment",
    "layout_from_dict",
    "layout_to_dict",
    "read_layouts",
    "write_layouts",
]

MAX_LAYOUTS = 200_000
_MAX_BYTES = 1 << 29


@dataclass(frozen=True)
class Layout:
    """One furnished room."""

    id: str
    room_type: str
    """One of `furniture.ROOM_TYPES`, or another name that a reader met."""
    floor_polygon: tuple[Point2, ...]
    """[x, z] corners, not closed, counter-clockwise seen from above (so the shoelace sum in (x, z) is negative)."""
    height: float = 2.7
    doors: tuple[Opening, ...] = ()
    windows: tuple[Opening, ...] = ()
    objects: tuple[Placed, ...] = ()
    tags: tuple[str, ...] = field(default=())
    """Every room type it can serve, `room_type` first."""
    source: str = "generated"
    licence: str = "MIT"

    @cached_property
    def area(self) -> float:
        """Of the floor, in square metres."""
        return float(shapely.Polygon(self.floor_polygon).area)

    def object(self, object_id: str) -> Placed:
        """The object of that id, or KeyError naming the ids there are."""
        for placed in self.objects:
            if placed.id == object_id:
                return placed
        raise KeyError(f"no object {object_id!r} in layout {self.id!r}; it has {', '.join(o.id for o in self.objects)}")


def layout_to_dict(layout: Layout) -> dict[str, Any]:
    """The native JSON row of a layout (docs/architecture.md); `layout_from_dict` is its exact inverse."""
    return {
        "id": layout.id,
        "source": layout.source,
        "licence": layout.licence,
        "room_type": layout.room_type,
        "tags": list(layout.tags),
        "floor_polygon": [list(corner) for corner in layout.floor_polygon],
        "height": layout.height,
        "doors": [opening_to_row(door) for door in layout.doors],
        "windows": [opening_to_row(window) for window in layout.windows],
        "objects": [placed_to_row(placed) for placed in layout.objects],
    }


_LAYOUT: Final = FieldPath(("layout",))


def layout_from_dict(row: Row, where: FieldPath = _LAYOUT) -> Layout:
    """Read one native row; `pos` is read as `position`, categories are made canonical, the outline's winding is set.

    `where` names the row in errors. LayoutError if a field is missing, out of bounds or of another type.
    """
    room_type = read_text(row, "room_type", where)
    objects = [placed_from_row(item, place) for item, place in read_rows(row, "objects", where, MAX_OBJECTS)]
    check_ids(objects, where)
    check_crowd(objects, where)
    return Layout(
        id=read_text(row, "id", where),
        room_type=room_type,
        floor_polygon=read_outline(row, where),
        height=read_number(row.get("height", 2.7), where / "height", MIN_ROOM_HEIGHT, MAX_SIZE),
        doors=tuple(opening_from_row(item, place) for item, place in read_rows(row, "doors", where, 100)),
        windows=tuple(opening_from_row(item, place) for item, place in read_rows(row, "windows", where, 100)),
        objects=tuple(objects),
        tags=read_texts(row, "tags", where, MAX_TAGS) or (room_type,),
        source=read_text(row, "source", where, "user"),
        licence=read_text(row, "licence", where, "unknown"),
    )


def read_layouts(path: str | Path, most_bytes: int = _MAX_BYTES) -> list[Layout]:
    """Read rooms from .json (one row or a list) or .jsonl (a row a line), either with .gz behind it.

    LayoutError, naming file and line, for the first row that is not a valid layout or repeats an id, or where the file
    has more than `most_bytes` when it is unpacked.
    """
    file = Path(path)
    layouts: list[Layout] = []
    seen: set[str] = set()
    for where, row in _read_rows(file, most_bytes):
        if not isinstance(row, dict):
            raise LayoutError("must be an object with id, room_type, floor_polygon and objects", at=where)
        layout = layout_from_dict(row, where)
        if layout.id in seen:
            raise LayoutError(f"{layout.id!r} occurs twice", "give every room its own id", at=where / "id")
        seen.add(layout.id)
        layouts.append(layout)
        if len(layouts) > MAX_LAYOUTS:
            raise LayoutError(f"{file.name} holds more than {MAX_LAYOUTS} rooms", "split it")
    return layouts


def write_layouts(path: str | Path, layouts: Iterable[Layout]) -> None:
    """Write rooms as .json (a list) or .jsonl, gzipped if the name ends in .gz; the same rooms give the same bytes."""
    file = Path(path)
    rows = (layout_to_dict(layout) for layout in layouts)
    texts: Iterable[str]
    if ".jsonl" in file.suffixes:
        texts = (json.dumps(row, separators=(",", ":"), allow_nan=False) for row in rows)
    else:
        texts = [json.dumps(list(rows), indent=1, allow_nan=False)]
    with file.open("wb") as plain:
        # No name and no time stamp, so that a library made again is the same file.
        packed = gzip.GzipFile("", "wb", 9, plain, mtime=0) if file.suffix == ".gz" else nullcontext(plain)
        with packed as stream:
            stream.writelines(f"{text}\n".encode() for text in texts)


def _read_rows(file: Path, most_bytes: int) -> Iterator[tuple[FieldPath, Any]]:
    if not {".json", ".jsonl"} & set(file.suffixes):
        raise LayoutError(f"{file.name}: rooms are read from .json, .jsonl, .json.gz or .jsonl.gz")
    try:
        with gzip.open(file) if file.suffix == ".gz" else file.open("rb") as stream:
            data = stream.read(most_bytes + 1)
        if len(data) > most_bytes:
            raise LayoutError(f"{file.name} is larger than {most_bytes >> 20} MiB", "split it")
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LayoutError(f"{file.name} is not UTF-8 text ({error.reason} at byte {error.start})") from error
    except (OSError, EOFError, zlib.error) as error:
        raise LayoutError(f"{file.name} cannot be read, it is missing, cut off or damaged: {error}") from error
    if ".jsonl" in file.suffixes:
        for number, line in enumerate(text.split("\n"), start=1):
            if line.strip():
                where = FieldPath((f"{file.name} line {number}",))
                yield where, _parse(line, where)
        return
    parsed = _parse(text, FieldPath((file.name,)))
    for index, row in enumerate(parsed if isinstance(parsed, list) else [parsed]):
        yield FieldPath((f"{file.name} [{index}]",)), row


def _parse(text: str, where: FieldPath) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise LayoutError(f"is not JSON: {error}", at=where) from error
