"""Scenes of every format are read as the rooms that they were when somebody last looked at them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from recorded import agrees
from scans import OBJECTS, RELATIONSHIPS, ROOM, ply, scan, semseg, write
from scenes_at_hand import obj_of, scene_of
from unity_houses import ASSETS, HOUSE, flat

from benchmarks.houses import synthetic_house
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.layout_library import built_in_index
from scene_graphs.loaders import Imported, Options, Source, read_scene
from scene_graphs.loaders.threedssg import graph_from_3dssg

MESHES = "dining-room-0004"


def test_scenes_are_as_recorded(tmp_path: Path) -> None:
    scene = scene_of(built_in_index().layout(MESHES))
    assets = Source.of_bytes("boxes.json", json.dumps(ASSETS).encode())
    write(tmp_path, scan()[0], scan()[1], ply(scan()[2]))
    found = {
        "3d-front": read("3d-front", json.dumps(synthetic_house(3, 3, 15))),
        "procthor": read("procthor", json.dumps(HOUSE), assets=assets),
        "procthor without sizes": read("procthor", json.dumps(HOUSE)),
        "virtualhome": read("virtualhome", json.dumps(flat())),
        "3dssg": read("3dssg", json.dumps(semseg(*ROOM))),
        "scannet": told(read_scene(tmp_path, "scannet")),
        "glb": read("glb", scene.export(file_type="glb")),
        "obj": read("obj", obj_of(scene)),
    }
    graph = graph_from_3dssg(OBJECTS, RELATIONSHIPS, "s1")
    edges = sorted(" - ".join(sorted(f"{node}" for node in edge)) for edge in graph.edges)
    agrees("scenes", found | {"graph of 3dssg": {"nodes": len(graph), "edges": edges}})


def read(kind: str, text: str | bytes, **options: Any) -> dict[str, Any]:
    data = text.encode() if isinstance(text, str) else text
    return told(read_scene(Source.of_bytes(f"it.{kind}", data), kind, Options(**options)))


def told(imported: Imported) -> dict[str, Any]:
    """The report, and every room in a few rows."""
    return {"report": imported.report.to_dict(), "rooms": {room.id: rows(room) for room in imported.layouts}}


def rows(room: Layout) -> dict[str, Any]:
    return {
        "is": f"{room.room_type}: {', '.join(room.tags)}; {room.source}, {room.licence}",
        "floor": short(*(number for point in room.floor_polygon for number in point), room.height),
        "doors": [gap(door) for door in room.doors],
        "windows": [gap(window) for window in room.windows],
        "objects": {f"{placed.id}, {placed.category}, on {placed.parent}": numbers(placed) for placed in room.objects},
    }


def gap(opening: Opening) -> list[float]:
    return short(*opening.segment[0], *opening.segment[1], opening.bottom, opening.top)


def numbers(placed: Placed) -> list[float]:
    """Place, size, heading; then how many boxes its shape has, and their sum of both corners."""
    corners = [part.low[axis] + part.high[axis] for part in placed.shape for axis in range(3)]
    return short(*placed.position, *placed.size, placed.yaw, len(placed.shape), sum(corners))


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
