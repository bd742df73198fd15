"""Placed furniture and rooms: the `Layout` every reader fills and every stage reads, and its JSON.

Frame: right-handed, Y up, metres, radians. Yaw is about +Y, counter-clockwise seen from above, and 0 faces +Z.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.fields import (
    FARTHEST,
    LayoutError,
    Row,
    read_number,
    read_point2,
    read_point3,
    read_rows,
    read_text,
    read_texts,
)
from scene_graphs.furniture import canonical

__all__ = [
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

Array = NDArray[np.float64]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]
Segment = tuple[Point2, Point2]

MOST_OBJECTS = 500
MOST_CORNERS = 400
MOST_LAYOUTS = 200_000
SMALLEST, LARGEST = 1e-4, 30.0
"""No object is shorter or longer, in metres."""
LOWEST = 1.5
"""No room is lower, in metres."""
WIDEST = 60.0
"""No room is wider: maps of the floor take memory by its area."""
MOST_TAGS = 100
NEAR = 1.2
"""Objects whose footprints are this near, in metres, are joined in a room's graph."""
MOST_CROWDED = 1_000_000
"""Objects of a room times pairs of them that stand near each other; 13,000 in the fullest of 539 real rooms."""
_MOST_BYTES = 1 << 29


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


@dataclass(frozen=True)
class Opening:
    """A door or window: two points on the outline and the heights between which the wall is open."""

    segment: Segment
    bottom: float = 0.0
    top: float = 2.1


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
        "doors": [_opening_to_dict(door) for door in layout.doors],
        "windows": [_opening_to_dict(window) for window in layout.windows],
        "objects": [_placed_to_dict(placed) for placed in layout.objects],
    }


def layout_from_dict(row: Row, where: str = "layout") -> Layout:
    """Read one native row; `pos` is read as `position`, categories are made canonical, the outline's winding is set.

    `where` names the row in errors. LayoutError if a field is missing, out of bounds or of another type.
    """
    room_type = read_text(row, "room_type", where)
    objects = [_placed(item, place) for item, place in read_rows(row, "objects", where, MOST_OBJECTS)]
    _check_ids(objects, where)
    _check_crowd(objects, where)
    return Layout(
        id=read_text(row, "id", where),
        room_type=room_type,
        floor_polygon=_outline(row, where),
        height=read_number(row.get("height", 2.7), f"{where}.height", LOWEST, LARGEST),
        doors=tuple(_opening(item, place) for item, place in read_rows(row, "doors", where, 100)),
        windows=tuple(_opening(item, place) for item, place in read_rows(row, "windows", where, 100)),
        objects=tuple(objects),
        tags=read_texts(row, "tags", where, MOST_TAGS) or (room_type,),
        source=read_text(row, "source", where, "user"),
        licence=read_text(row, "licence", where, "unknown"),
    )


def read_layouts(path: str | Path, most_bytes: int = _MOST_BYTES) -> list[Layout]:
    """Read rooms from .json (one row or a list) or .jsonl (a row a line), either with .gz behind it.

    LayoutError, naming file and line, for the first row that is not a valid layout or repeats an id, or where the file
    has more than `most_bytes` when it is unpacked.
    """
    file = Path(path)
    layouts: list[Layout] = []
    seen: set[str] = set()
    for where, row in _read_rows(file, most_bytes):
        if not isinstance(row, dict):
            raise LayoutError(f"{where} must be an object with id, room_type, floor_polygon and objects")
        layout = layout_from_dict(row, where)
        if layout.id in seen:
            raise LayoutError(f"{where}.id {layout.id!r} occurs twice; give every room its own id")
        seen.add(layout.id)
        layouts.append(layout)
        if len(layouts) > MOST_LAYOUTS:
            raise LayoutError(f"{file.name} holds more than {MOST_LAYOUTS} rooms; split it")
    return layouts


def write_layouts(path: str | Path, layouts: Iterable[Layout]) -> None:
    """Write rooms as .json (a list) or .jsonl, gzipped if the name ends in .gz; the same rooms give the same bytes."""
    file = Path(path)
    rows = [layout_to_dict(layout) for layout in layouts]
    if ".jsonl" in file.suffixes:
        text = "".join(json.dumps(row, separators=(",", ":"), allow_nan=False) + "\n" for row in rows)
    else:
        text = json.dumps(rows, indent=1, allow_nan=False) + "\n"
    # No time stamp, so that a library made again is the same file.
    data = gzip.compress(text.encode(), 9, mtime=0) if file.suffix == ".gz" else text.encode()
    file.write_bytes(data)


def _read_rows(file: Path, most_bytes: int) -> Iterator[tuple[str, Any]]:
    if not {".json", ".jsonl"} & set(file.suffixes):
        raise LayoutError(f"{file.name}: rooms are read from .json, .jsonl, .json.gz or .jsonl.gz")
    try:
        with gzip.open(file) if file.suffix == ".gz" else file.open("rb") as stream:
            data = stream.read(most_bytes + 1)
        if len(data) > most_bytes:
            raise LayoutError(f"{file.name} is larger than {most_bytes >> 20} MiB; split it")
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LayoutError(f"{file.name} is not UTF-8 text ({error.reason} at byte {error.start})") from error
    except (OSError, EOFError, zlib.error) as error:
        raise LayoutError(f"{file.name} cannot be read, it is missing, cut off or damaged: {error}") from error
    if ".jsonl" in file.suffixes:
        for number, line in enumerate(text.splitlines(), start=1):
            if line.strip():
                yield f"{file.name} line {number}", _parse(line, f"{file.name} line {number}")
        return
    parsed = _parse(text, file.name)
    for index, row in enumerate(parsed if isinstance(parsed, list) else [parsed]):
        yield f"{file.name} [{index}]", row


def _parse(text: str, where: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise LayoutError(f"{where} is not JSON: {error}") from error


def _placed_to_dict(placed: Placed) -> dict[str, Any]:
    row: dict[str, Any] = {
        "id": placed.id,
        "category": placed.category,
        "position": list(placed.position),
        "size": list(placed.size),
        "yaw": placed.yaw,
    }
    return row | {key: value for key in ("parent", "mesh") if (value := getattr(placed, key)) is not None}


def _opening_to_dict(opening: Opening) -> dict[str, Any]:
    return {"segment": [list(end) for end in opening.segment], "bottom": opening.bottom, "top": opening.top}


def _placed(row: Row, where: str) -> Placed:
    position = row.get("position", row.get("pos"))
    return Placed(
        id=read_text(row, "id", where),
        category=canonical(read_text(row, "category", where)),
        position=read_point3(position, f"{where}.position", -FARTHEST, FARTHEST),
        size=read_point3(row.get("size"), f"{where}.size", SMALLEST, LARGEST),
        yaw=read_number(row.get("yaw", 0.0), f"{where}.yaw", -100.0, 100.0),
        parent=None if row.get("parent") is None else read_text(row, "parent", where),
        mesh=None if row.get("mesh") is None else read_text(row, "mesh", where),
    )


def _check_ids(objects: list[Placed], where: str) -> None:
    ids = [placed.id for placed in objects]
    for index, placed in enumerate(objects):
        if placed.id in ids[:index]:
            raise LayoutError(f"{where}.objects[{index}].id {placed.id!r} occurs twice; give every object its own id")
        if placed.parent is not None and (placed.parent == placed.id or placed.parent not in ids):
            raise LayoutError(f"{where}.objects[{index}].parent {placed.parent!r} is no other object's id")


def _check_crowd(objects: list[Placed], where: str) -> None:
    """Refuse a heap of things: what stands near what would take minutes to find."""
    if len(objects) * len(objects) * (len(objects) - 1) / 2 <= MOST_CROWDED:
        return
    outlines = [shapely.Polygon(placed.footprint) for placed in objects]
    pairs = len(shapely.STRtree(outlines).query(outlines, "dwithin", NEAR)[0]) // 2
    if pairs * len(objects) > MOST_CROWDED:
        raise LayoutError(
            f"{where}.objects are a heap: {pairs} pairs of {len(objects)} stand within {NEAR} m; is it metres?"
        )


def _opening(row: Row, where: str) -> Opening:
    ends = row.get("segment")
    if not isinstance(ends, list) or len(ends) != 2:
        raise LayoutError(f"{where}.segment must be two [x, z] points on the outline, got {ends!r}")
    start, end = (read_point2(point, f"{where}.segment[{index}]") for index, point in enumerate(ends))
    bottom = read_number(row.get("bottom", 0.0), f"{where}.bottom", 0.0, LARGEST)
    top = read_number(row.get("top", 2.1), f"{where}.top", 0.0, LARGEST)
    if top <= bottom:
        raise LayoutError(f"{where}.top must be above bottom, got {top} and {bottom}")
    return Opening((start, end), bottom, top)


def _outline(row: Row, where: str) -> tuple[Point2, ...]:
    corners, place = row.get("floor_polygon"), f"{where}.floor_polygon"
    if not isinstance(corners, list) or not 3 <= len(corners) <= MOST_CORNERS:
        raise LayoutError(f"{place} must be a list of 3 to {MOST_CORNERS} [x, z] corners in metres")
    points = [read_point2(corner, f"{place}[{index}]") for index, corner in enumerate(corners)]
    if points[0] == points[-1]:
        points.pop()
    polygon = shapely.Polygon(points) if len(points) >= 3 else None
    if polygon is None or not polygon.is_valid or polygon.area < 0.5:
        raise LayoutError(f"{place} must be a simple polygon of at least 0.5 square metres; order its corners around")
    low_x, low_z, high_x, high_z = polygon.bounds
    if max(high_x - low_x, high_z - low_z) > WIDEST:
        raise LayoutError(f"{place} must fit in {WIDEST:g} by {WIDEST:g} metres; is it in centimetres?")
    # Seen from above [x, z] is a left-handed pair: counter-clockwise there is clockwise to shapely.
    return tuple(reversed(points)) if polygon.exterior.is_ccw else tuple(points)
