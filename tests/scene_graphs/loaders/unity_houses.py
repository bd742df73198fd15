"""Turns rooms of ours into files of Unity's frame, as their sources would have written them."""

from __future__ import annotations

from math import degrees, hypot
from typing import Any

from scene_graphs.layout import Layout, Opening, Placed, Point2

Json = dict[str, Any]
_ROOM_TYPES = {"living_room": "LivingRoom", "bedroom": "Bedroom", "kitchen": "Kitchen", "bathroom": "Bathroom"}


def vector(x: float, y: float, z: float) -> Json:
    return {"x": x, "y": y, "z": z}


def procthor_house(layout: Layout, assets: dict[str, str]) -> Json:
    """A house of one room; `assets` names the model of every object."""
    corners = [vector(-x, 0.0, z) for x, z in layout.floor_polygon]
    walls = [
        {
            "id": f"wall|2|{index}",
            "roomId": "room|2",
            "polygon": [start, end, {**start, "y": layout.height}, {**end, "y": layout.height}],
        }
        for index, (start, end) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True))
    ]
    rows = {placed.id: _object(placed, assets[placed.id]) for placed in layout.objects}
    for placed in layout.objects:
        if placed.parent is not None:
            rows[placed.parent]["children"].append(rows[placed.id])
    return {
        "rooms": [{"id": "room|2", "roomType": _ROOM_TYPES.get(layout.room_type, "Bedroom"), "floorPolygon": corners}],
        "walls": walls,
        "doors": [_hole(opening, walls, f"door|1|{index}") for index, opening in enumerate(layout.doors)],
        "windows": [_hole(opening, walls, f"window|1|{index}") for index, opening in enumerate(layout.windows)],
        "objects": [rows[placed.id] for placed in layout.objects if placed.parent is None],
    }


def _object(placed: Placed, asset: str) -> Json:
    x, y, z = placed.position
    return {
        "id": placed.id,
        "assetId": asset,
        "position": vector(-x, y + placed.size[1] / 2, z),
        "rotation": vector(0.0, -degrees(placed.yaw), 0.0),
        "kinematic": True,
        "children": [],
    }


def _hole(opening: Opening, walls: list[Json], name: str) -> Json:
    """Along the nearest wall, measured from its first corner."""
    best: tuple[float, Json, list[float]] | None = None
    for wall in walls:
        start, end = wall["polygon"][:2]
        length = hypot(end["x"] - start["x"], end["z"] - start["z"])
        along = ((end["x"] - start["x"]) / length, (end["z"] - start["z"]) / length)
        places = [_along((-x, z), start, along) for x, z in opening.segment]
        beyond = max(0.0, -min(t for t, _ in places), max(t for t, _ in places) - length)
        away = max(abs(side) for _, side in places) + beyond
        if best is None or away < best[0]:
            best = away, wall, [t for t, _ in places]
    assert best is not None
    _, wall, (first, second) = best
    hole = [vector(first, opening.bottom, 0.0), vector(second, opening.top, 0.0)]
    return {"id": name, "room0": "room|2", "room1": "room|1", "wall0": wall["id"], "holePolygon": hole}


def _along(point: Point2, start: Json, along: Point2) -> Point2:
    x, z = point[0] - start["x"], point[1] - start["z"]
    return (x * along[0] + z * along[1], x * along[1] - z * along[0])
