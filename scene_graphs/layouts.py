"""Placed furniture and rooms: the `Layout` every reader fills and every stage reads, and its JSON.

Frame: right-handed, Y up, metres, radians. Yaw is about +Y, counter-clockwise seen from above, and 0 faces +Z.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import shapely

from scene_graphs.fields import LayoutError, Row, read_number, read_rows, read_text, read_texts
from scene_graphs.layout_rows import (
    MAX_CORNERS,
    MAX_CROWDED,
    MAX_OBJECTS,
    MAX_ROOM_WIDTH,
    MAX_SIZE,
    MAX_TAGS,
    MIN_ROOM_HEIGHT,
    MIN_SIZE,
    NEAR,
    check_crowd,
    check_ids,
    opening_from_row,
    opening_to_row,
    placed_from_row,
    placed_to_row,
    read_outline,
)
from scene_graphs.placed import Array, Opening, Placed, Point2, Segment
from scene_graphs.solids import Point3

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


def layout_from_dict(row: Row, where: str = "layout") -> Layout:
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
        height=read_number(row.get("height", 2.7), f"{where}.height", MIN_ROOM_HEIGHT, MAX_SIZE),
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
            raise LayoutError(f"{where} must be an object with id, room_type, floor_polygon and objects")
        layout = layout_from_dict(row, where)
        if layout.id in seen:
            raise LayoutError(f"{where}.id {layout.id!r} occurs twice; give every room its own id")
        seen.add(layout.id)
        layouts.append(layout)
        if len(layouts) > MAX_LAYOUTS:
            raise LayoutError(f"{file.name} holds more than {MAX_LAYOUTS} rooms; split it")
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
        for number, line in enumerate(text.split("\n"), start=1):
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
