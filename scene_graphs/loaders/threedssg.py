"""3DSSG over 3RScan: scene graphs of scanned rooms as furniture graphs, and rooms where the scan's boxes are there.

Scans have Z up: (x, y, z) -> (x, z, -y).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import atan2
from typing import Any, Final

import numpy as np

from scene_graphs.errors import FieldPath
from scene_graphs.furniture import Furniture, affordances, is_known
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_parts
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError, Row, read_object, read_rows, read_text
from scene_graphs.layout import MAX_SIZE, Layout, Point2
from scene_graphs.loaders.floor_polygon import floor_from_triangles
from scene_graphs.loaders.frames import numbers
from scene_graphs.loaders.plan_boxes import UprightBox
from scene_graphs.loaders.room_builder import STRUCTURE, Intake
from scene_graphs.loaders.scan_rooms import MAX_THINGS, Scan, Thing, category_of, room_of_scan
from scene_graphs.loaders.scene_source import Source

MAX_SCANS: Final = 10_000
MAX_RELATIONS: Final = 200_000
LICENCE: Final = "3RScan terms of use: research only, not to be passed on"
BOXES: Final = "semseg.v2.json"
_FILE: Final = "an object with scans or segGroups"

SUPPORT: Final = frozenset(
    {"supported by", "attached to", "standing on", "lying on", "hanging on", "connected to", "leaning against"}
    | {"part of", "belonging to", "build in", "standing in", "lying in", "hanging in", "inside", "cover"}
)
SPATIAL: Final = frozenset({"left", "right", "front", "behind", "close by"})
"""The relations that join two pieces; what compares them or calls them the same does not."""


def graph_from_3dssg(objects: Any, relationships: Any, scan: str) -> FurnitureGraph:
    """The furniture of one scan, joined where a spatial or support relation names both.

    `objects` and `relationships` are the parsed objects.json and relationships.json. The building itself and small
    unknown things that rest on furniture are left out; nodes keep the scan's ids as `object_id`. LayoutError if
    objects.json does not have the scan or a field is of another type.
    """
    labels = {
        _id(row, "id", where): read_text(row, "label", where)
        for entry, place in _entries(objects, "objects.json", scan)
        for row, where in read_rows(entry, "objects", place, MAX_THINGS)
    }
    if not labels:
        raise LayoutError(f"objects.json: scans has no objects of a scan {scan!r:.60}", "take one of its scans[].scan")
    relations = list(_relations(relationships, scan))
    building = {name for name, label in labels.items() if category_of(label) in STRUCTURE}
    resting = {a for a, b, relation in relations if relation in SUPPORT and b in labels and b not in building}
    kept = [
        name
        for name in sorted(labels, key=lambda name: (len(name), name))
        if name not in building and (name not in resting or is_known(category_of(labels[name])))
    ]
    nodes = _numbered([category_of(labels[name]) for name in kept])
    places = {name: place for place, name in enumerate(kept)}
    joined = {(places[a], places[b]) for a, b, _ in relations if a in places and b in places and a != b}
    graph = graph_from_parts(nodes, sorted(joined))
    for node, name in zip(nodes, kept, strict=True):
        graph.nodes[node].update(object_id=name, offers=affordances(node.category))
    return graph


def read_3dssg(source: Source, intake: Intake) -> list[Layout]:
    """The rooms whose boxes are there: a semseg.v2.json, a scan's folder, or objects.json with the scans beside it.

    The option `scan` names one of them. LayoutError, saying what is missing, where there are labels but no boxes.
    """
    layouts = (_layout(file, name, intake) for file, name in _boxes_files(source, intake))
    return [layout for layout in layouts if layout is not None]


def _boxes_files(source: Source, intake: Intake) -> Iterator[tuple[Source, str]]:
    """The files of boxes, each with its scan's name."""
    scan = intake.options.scan
    listed = source.beside("objects.json") if source.is_folder else source
    if source.is_folder and (alone := source.beside(BOXES)) is not None:
        yield alone, scan or source.name
        return
    if listed is None:
        found = source.beside(f"{scan}/{BOXES}") if scan else None
        if found is None or scan is None:
            raise LayoutError(
                f"{source.name} has no {BOXES} and no objects.json", "give a scan's folder, or name the scan"
            )
        yield found, scan
        return
    row = read_object(listed.json(), listed.at, _FILE)
    if "segGroups" in row:
        name = row.get("scan_id")
        yield listed, name if isinstance(name, str) and name else scan or listed.name.split(".")[0]
        return
    if "scans" not in row:
        raise LayoutError(f"{listed.name} must be an object with scans or segGroups: 3DSSG's objects.json or a {BOXES}")
    found_any = False
    for entry, place in read_rows(row, "scans", listed.at, MAX_SCANS):
        name = read_text(entry, "scan", place)
        if scan in (None, name) and (boxes := source.beside(f"{name}/{BOXES}")) is not None:
            found_any = True
            yield boxes, name
    if not found_any:
        raise LayoutError(
            f"{listed.name} has labels and relations but no boxes: put <scan>/{BOXES} of 3RScan beside it, or read it "
            "as a furniture graph only (graph_from_3dssg)"
        )


def _layout(file: Source, name: str, intake: Intake) -> Layout | None:
    row = read_object(file.json(), file.at, _FILE)
    if "segGroups" not in row:
        raise LayoutError(f"is missing: a scan's boxes are in {BOXES}", at=file.at / "segGroups")
    things: list[Thing] = []
    for group, _ in read_rows(row, "segGroups", file.at, MAX_THINGS):
        label, number = group.get("label"), group.get("objectId", group.get("id"))
        box = _box(group.get("obb"))
        if not isinstance(label, str):
            intake.drop("it has no label", str(number)[:20] if isinstance(number, int | str) else "")
        elif box is None:
            intake.drop("its obb is no centroid, axesLengths and normalizedAxes in metres", label)
        else:
            things.append(Thing(f"{label[:60]}-{number if isinstance(number, int | str) else len(things)}", label, box))
    floors = [thing.box for thing in things if thing.label.strip().lower() == "floor"]
    furniture = [thing for thing in things if thing.label.strip().lower() != "floor"]
    return room_of_scan(
        Scan(
            id=f"3rscan/{name}",
            room_type=intake.options.room_type,
            things=furniture,
            floor=_floor(floors),
            level=_level(floors, furniture),
            source="3rscan",
            licence=LICENCE,
        ),
        intake,
    )


def _box(obb: Any) -> UprightBox | None:
    """The upright box of an oriented one, Z up; its width lies along the longer axis in plan."""
    if not isinstance(obb, dict):
        return None
    middle = numbers(obb.get("centroid"), 3, MAX_COORDINATE)
    lengths = numbers(obb.get("axesLengths"), 3, MAX_SIZE)
    axes = numbers(obb.get("normalizedAxes"), 9, 1.01)
    if middle is None or lengths is None or axes is None:
        return None
    rows = np.array(axes).reshape(3, 3)
    up = int(np.argmax(np.abs(rows[:, 2])))
    if abs(rows[up, 2]) < 0.5:
        return None
    long, short = sorted((axis for axis in range(3) if axis != up), key=lambda axis: -lengths[axis])
    x, y, z = middle
    height = lengths[up]
    yaw = atan2(float(rows[long, 1]), float(rows[long, 0]))
    return UprightBox((x, z - height / 2, -y), (lengths[long], height, lengths[short]), yaw)


def _floor(boxes: list[UprightBox]) -> list[Point2] | None:
    """The outline of the floor's boxes."""
    quads = [box.corners[[0, 1, 5, 4]][:, [0, 2]] for box in boxes]
    return floor_from_triangles([triangle for q in quads for triangle in (q[[0, 1, 2]], q[[0, 2, 3]])])


def _level(floors: list[UprightBox], things: list[Thing]) -> float:
    """The height of the floor's upper side, else of what stands lowest."""
    if floors:
        return float(np.median([box.position[1] + box.size[1] / 2 for box in floors]))
    return min((thing.box.position[1] for thing in things), default=0.0)


def _relations(relationships: Any, scan: str) -> Iterator[tuple[str, str, str]]:
    """Subject, object and name of the relations that count, of all entries of the scan."""
    for entry, place in _entries(relationships, "relationships.json", scan):
        rows = entry.get("relationships", [])
        if not isinstance(rows, list) or len(rows) > MAX_RELATIONS:
            raise LayoutError(f"must be a list of at most {MAX_RELATIONS} relations", at=place / "relationships")
        for number, row in enumerate(rows):
            if not isinstance(row, list) or len(row) != 4 or not isinstance(row[3], str):
                raise LayoutError(
                    "must be [subject, object, relation id, its name]", at=place / "relationships" / number
                )
            if row[3] in SPATIAL or row[3] in SUPPORT:
                where = place / "relationships" / number
                yield _id({"subject": row[0]}, "subject", where), _id({"object": row[1]}, "object", where), row[3]


def _entries(file: Any, name: str, scan: str) -> Iterator[tuple[Row, FieldPath]]:
    """All entries of a scan: its relations may come in several."""
    at = FieldPath((name,))
    for entry, place in read_rows(read_object(file, at, _FILE), "scans", at, MAX_SCANS):
        if entry.get("scan") == scan:
            yield entry, place


def _numbered(categories: list[str]) -> list[Furniture]:
    counts: Counter[str] = Counter()
    nodes = []
    for category in categories:
        counts[category] += 1
        nodes.append(Furniture(category, counts[category]))
    return nodes


def _id(row: Row, key: str, where: FieldPath) -> str:
    """An id as text: objects.json has texts where relationships.json has numbers."""
    value = row.get(key)
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1 << 63:
        return str(value)
    return read_text(row, key, where)
