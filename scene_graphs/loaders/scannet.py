"""ScanNet: a scan's decimated mesh, its segments and their labels, as a room of labelled boxes.

Scans have Z up: (x, y, z) -> (x, z, -y) after the scan's own axis alignment.

The vertices of a PLY file, ascii or binary; nothing else of it is read.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.json_fields import MAX_COORDINATE, LayoutError, read_object, read_rows
from scene_graphs.layout import Array, Layout, Point2
from scene_graphs.loaders.floor_polygon import corners_around
from scene_graphs.loaders.plan_boxes import box_around
from scene_graphs.loaders.room_builder import Intake
from scene_graphs.loaders.scan_rooms import MAX_THINGS, Scan, Thing, room_of_scan
from scene_graphs.loaders.scene_source import Source

MAX_VERTICES: Final = 10_000_000
MAX_WORDS: Final = 5_000_000
"""Numbers of the vertices of an ascii file, colours and all."""
_MAX_HEADER_LENGTH: Final = 1 << 16
_END: Final = b"end_header"
_ORDERS: Final = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_TYPES: Final = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}


def read_ply_vertices(source: Source) -> Array:
    """The points x, y, z in the file's own frame and unit. (N, 3).

    LayoutError if it is no PLY, its vertices do not come first, it is cut off, or a point lies beyond
    `MAX_COORDINATE`.
    """
    data = source.read()
    order, count, columns, start = _header(data, source.name)
    dtype = np.dtype([(name, order + kind) for name, kind in columns])
    if order or not count:
        if len(data) - start < count * dtype.itemsize:
            raise LayoutError(f"{source.name} is cut off: its header promises {count} vertices")
        rows = np.frombuffer(data, dtype, count, start)
        with np.errstate(invalid="ignore"):  # a NaN that signals; it is refused below
            points = np.stack([rows[axis].astype(float) for axis in "xyz"], axis=-1)
    else:
        points = _ascii_points(data[start:], count, [name for name, _ in columns], source.name)
    # A NaN is within no bound.
    if not (np.abs(points) <= MAX_COORDINATE).all():
        raise LayoutError(
            f"{source.name} has vertices that are not within {MAX_COORDINATE:g} m of its origin", "is it metres?"
        )
    return points


def _header(data: bytes, name: str) -> tuple[str, int, list[tuple[str, str]], int]:
    """Byte order ("" for ascii), number of vertices, their columns, and where the data starts."""
    end = data.find(_END, 0, _MAX_HEADER_LENGTH)
    line_end = data.find(b"\n", end)
    if not data.startswith(b"ply") or end < 0 or line_end < 0:
        raise LayoutError(f"{name} is not a PLY file: it has no header from ply to end_header")
    lines = [line.split() for line in data[:end].decode("latin-1").splitlines()]
    formats = [line[1] for line in lines if line[:1] == ["format"] and len(line) > 1]
    elements = [number for number, line in enumerate(lines) if line[:1] == ["element"]]
    if not formats or formats[0] not in _ORDERS:
        raise LayoutError(f"{name}: its format must be one of {', '.join(_ORDERS)}")
    if not elements or len(lines[elements[0]]) != 3 or lines[elements[0]][1] != "vertex":
        raise LayoutError(f"{name}: its first element must be the vertices")
    stop = elements[1] if len(elements) > 1 else len(lines)
    columns: list[tuple[str, str]] = []
    for line in lines[elements[0] + 1 : stop]:
        if line[:1] == ["property"]:
            if len(line) != 3 or line[1] not in _TYPES or line[2] in dict(columns):
                raise LayoutError(f"{name}: a vertex has properties of plain types only, got {' '.join(line)!r:.60}")
            columns.append((line[2], _TYPES[line[1]]))
    if not {"x", "y", "z"} <= dict(columns).keys():
        raise LayoutError(f"{name}: a vertex must have x, y and z")
    told = lines[elements[0]][2]
    if not (told.isascii() and told.isdigit() and len(told) < 12 and int(told) <= MAX_VERTICES):
        raise LayoutError(f"{name} must have at most {MAX_VERTICES} vertices, got {told!r:.20}")
    return _ORDERS[formats[0]], int(told), columns, line_end + 1


def _ascii_points(body: bytes, count: int, names: list[str], name: str) -> Array:
    if count * len(names) > MAX_WORDS:
        raise LayoutError(f"{name} has more than {MAX_WORDS} numbers as text", "save it as binary")
    words = body.split(maxsplit=count * len(names))[: count * len(names)]
    if len(words) < count * len(names):
        raise LayoutError(f"{name} is cut off: its header promises {count} vertices")
    columns = [words[names.index(axis) :: len(names)] for axis in "xyz"]
    try:
        return np.stack([np.fromiter(map(float, column), float, count) for column in columns], axis=-1)
    except ValueError as error:
        raise LayoutError(f"{name} has a vertex that is not numbers: {error}") from error


LICENCE: Final = "ScanNet terms of use: research only, not to be passed on"
AGGREGATION, SEGMENTS = ".aggregation.json", "_vh_clean_2.0.010000.segs.json"
MESH, INFO = "_vh_clean_2.ply", ".txt"
DENSE: Final = "_vh_clean.aggregation.json"
_SMOOTH: Final = 0.05
"""Corners of the floor's hull nearer than this to the line between others go, in metres."""
_MIN_POINTS: Final = 10
"""A thing of fewer points is none."""


class _Files(NamedTuple):
    name: str
    aggregation: Source
    segments: Source
    mesh: Source
    info: Source | None


def read_scannet(source: Source, intake: Intake) -> list[Layout]:
    """The room of a scan: its folder, a folder of scans with the option `scan`, or its .aggregation.json.

    LayoutError if one of the scan's files is missing or damaged, or they belong to different meshes.
    """
    files = _files(source, intake.options.scan)
    info = _info(files.info)
    segments, points = _segments(files), _aligned(read_ply_vertices(files.mesh), info, files)
    if len(segments) != len(points):
        raise LayoutError(
            f"{files.segments.name} has {len(segments)} segIndices, {files.mesh.name} {len(points)} vertices: "
            "one is of the dense mesh",
            f"take {files.name}{SEGMENTS} and {files.name}{MESH}",
        )
    groups = _groups(files, segments, intake)
    under = [rows for label, _, rows in groups if label == "floor"]
    floor_points = points[np.concatenate(under)] if under else points
    things = [
        Thing(f"{label}-{name}", label, box_around(points[rows])) for label, name, rows in groups if label != "floor"
    ]
    layout = room_of_scan(
        Scan(
            id=f"scannet/{files.name}",
            room_type=_room_type(info.get("sceneType", "")) or intake.options.room_type,
            things=things,
            floor=_hull(floor_points),
            level=float(np.quantile(floor_points[:, 1], 0.5 if under else 0.01)) if len(points) else 0.0,
            source="scannet",
            licence=LICENCE,
        ),
        intake,
    )
    if not under:
        intake.guess("floor")
    return [] if layout is None else [layout]


def _files(source: Source, scan: str | None) -> _Files:
    """The files of the scan. LayoutError names the first that is missing."""
    if source.is_folder:
        places = (f"{scan}/{scan}", f"scans/{scan}/{scan}", scan) if scan else ()
        inner = next((place for place in places if source.beside(place + AGGREGATION)), None)
        found = source.beside(inner + AGGREGATION) if inner else None if scan else source.find("*" + AGGREGATION)
        if found is None:
            raise LayoutError(
                f"{source.name} has no {scan or '<scan>'}{AGGREGATION}", "give a scan's folder or name the scan"
            )
        stem = inner if inner else found.name.removesuffix(AGGREGATION)
    else:
        found, stem = source, source.name.removesuffix(AGGREGATION)
    if found.name.endswith(DENSE) or not found.name.endswith(AGGREGATION):
        raise LayoutError(f"{found.name}: give <scan>{AGGREGATION}, which is of the decimated mesh")
    name = stem.rsplit("/", 1)[-1]
    segments, mesh = source.beside(stem + SEGMENTS), source.beside(stem + MESH)
    if segments is None or mesh is None:
        raise LayoutError(f"{found.name} needs {name}{SEGMENTS if segments is None else MESH} beside it")
    return _Files(name, found, segments, mesh, source.beside(stem + INFO))


def _info(file: Source | None) -> dict[str, str]:
    """The lines "name = value" of the scan's .txt."""
    pairs = (line.split("=", 1) for line in (file.text().splitlines() if file else ()))
    return {pair[0].strip(): pair[1].strip() for pair in pairs if len(pair) == 2}


def _segments(files: _Files) -> NDArray[np.int64]:
    """The segment of every vertex. (N,)."""
    row = read_object(files.segments.json(), files.segments.at, "a JSON object")
    try:
        segments = np.asarray(row.get("segIndices"), dtype=np.int64)
    except (TypeError, ValueError, OverflowError):
        segments = np.zeros((0, 0), dtype=np.int64)
    if segments.ndim != 1:
        raise LayoutError("must be a list of whole numbers, one a vertex", at=files.segments.at / "segIndices")
    return segments


def _aligned(points: Array, info: dict[str, str], files: _Files) -> Array:
    """The points along the room's walls, Y up. (N, 3)."""
    if "axisAlignment" in info:
        place = f"{files.name}{INFO}: axisAlignment"
        try:
            matrix = np.array([float(number) for number in info["axisAlignment"].split()[:17]]).reshape(4, 4)
        except ValueError as error:
            raise LayoutError("must be 16 numbers", at=place) from error
        turn, move = matrix[:3, :3], matrix[:3, 3]
        if not (np.abs(matrix) <= MAX_COORDINATE).all() or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-3):
            raise LayoutError(f"must be a rotation and a move within {MAX_COORDINATE:g} m", at=place)
        points = points @ turn.T + move
    upright: Array = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=-1)
    return upright


def _groups(files: _Files, segments: NDArray[np.int64], intake: Intake) -> list[tuple[str, str, NDArray[np.intp]]]:
    """Label, id and vertices of every labelled thing."""
    row = read_object(files.aggregation.json(), files.aggregation.at, "a JSON object")
    order = np.argsort(segments, kind="stable")
    names, starts = np.unique(segments[order], return_index=True)
    vertices = dict(zip(names.tolist(), np.split(order, starts[1:]), strict=True)) if len(names) else {}
    asked = missing = 0
    found: list[tuple[str, str, NDArray[np.intp]]] = []
    for group, place in read_rows(row, "segGroups", files.aggregation.at, MAX_THINGS):
        listed = group.get("segments")
        if not isinstance(listed, list) or not all(isinstance(number, int) for number in listed):
            raise LayoutError("must be a list of whole numbers", at=place / "segments")
        label = word.strip().lower() if isinstance(word := group.get("label"), str) else ""
        owned = [vertices[number] for number in set(listed) if number in vertices]
        asked, missing = asked + len(set(listed)), missing + len(set(listed)) - len(owned)
        rows = np.sort(np.concatenate(owned)) if owned else np.zeros(0, dtype=np.intp)
        if len(rows) < _MIN_POINTS:
            intake.drop(f"it has fewer than {_MIN_POINTS} points", label)
        else:
            found.append((label, str(group.get("objectId", len(found)))[:20], rows))
    if missing * 2 > asked:
        raise LayoutError(
            f"{files.aggregation.name} names {missing} of {asked} segments that {files.segments.name} does not have: "
            "one is of the dense mesh"
        )
    return found


def _hull(points: Array) -> list[Point2] | None:
    """The outline around points seen from above."""
    hull = shapely.MultiPoint(points[:, [0, 2]]).convex_hull.simplify(_SMOOTH)
    if not isinstance(hull, shapely.Polygon) or hull.is_empty:
        return None
    return corners_around(hull.exterior)


def _room_type(scene: str) -> str | None:
    """ "Bedroom / Hotel" -> "bedroom"."""
    word = scene.split("/")[0].strip()[:60]
    return word if word.isprintable() and word else None
