"""Turns rooms of ours into files of Unity's frame, as their sources would have written them."""

from __future__ import annotations

from math import degrees, hypot, pi
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


ASSETS: dict[str, Any] = {
    "Bed_13": ["Bed", [1.0, 0.9, 2.0]],
    "Bed_2": ["Bed", [1.8, 0.9, 2.1]],
    "Sofa_1": ["Sofa", [1.6, 0.8, 0.9]],
    "Stool_3": ["Stool", [0.4, 0.7, 0.4]],
    "Side_Table_1": ["SideTable", [0.5, 0.6, 0.4]],
    "Side_Table_2": ["SideTable", [1.0, 0.6, 0.4]],
    "RoboTHOR_office_chair_x": ["Chair", [0.6, 0.9, 0.6]],
    "Chair_1": ["Chair", [0.5, 0.9, 0.5]],
    "Dog_Bed_1": ["DogBed", [0.7, 0.2, 0.6]],
    "pillow_1": ["Pillow", [0.5, 0.1, 0.3]],
}
ROOM = Layout(
    "houses/0/2",
    "bedroom",
    ((-4.0, 0.0), (-4.0, 3.0), (0.0, 3.0), (0.0, 0.0)),
    2.7,
    (Opening(((-0.5, 0.0), (-1.4, 0.0)), 0.0, 2.1),),
    (Opening(((0.0, 1.0), (0.0, 2.2)), 0.9, 2.0),),
    (
        Placed("2|0", "double_bed", (-3.0, 0.0, 1.8), (1.8, 0.9, 2.1), pi),
        Placed("small|2|0", "pillow", (-3.0, 0.5, 2.6), (0.5, 0.1, 0.3), 0.4, "2|0"),
        Placed("2|1", "nightstand", (-1.7, 0.0, 2.7), (0.5, 0.6, 0.4), pi),
    ),
    source="procthor",
    licence="unknown",
)
MODELS = {"2|0": "Bed_2", "small|2|0": "pillow_1", "2|1": "Side_Table_1"}
HOUSE = procthor_house(ROOM, MODELS)


def node(
    number: int, class_name: str, category: str, center: tuple[float, ...], size: tuple[float, ...], prefab: str = ""
) -> dict[str, Any]:
    box = {"center": list(center), "size": list(size)}
    return {"id": number, "class_name": class_name, "category": category, "prefab_name": prefab, "bounding_box": box}


def edge(start: int, relation: str, end: int) -> dict[str, Any]:
    return {"from_id": start, "to_id": end, "relation_type": relation}


def flat() -> dict[str, Any]:
    """A bedroom of two tiles beside a living room of one, with a door between them. Unity's frame."""
    furniture = [
        node(10, "bed", "Furniture", (4.0, 0.14, 1.25), (2.0, 0.28, 1.4)),
        node(11, "pillow", "Decor", (4.8, 0.5, 1.25), (0.4, 0.1, 0.5)),
        node(12, "closet", "Furniture", (1.0, 1.0, 0.3), (1.5, 2.0, 0.6)),
        node(13, "sink", "Furniture", (1.5, 0.9, 2.2), (0.6, 0.0, 0.4)),
        node(14, "mug", "Props", (1.5, 0.9, 2.2), (0.1, 0.1, 0.1)),
    ]
    sofa = [node(20, "sofa", "Furniture", (-1.25, 0.43, 2.0), (1.9, 0.86, 0.9))]
    inside = [edge(n["id"], "INSIDE", 1) for n in furniture] + [edge(20, "INSIDE", 2)]
    tiles = [
        *(node(3 + i, "floor", "Floor", (1.25 + 2.5 * i, 0.0, 1.25), (2.5, 0.0, 2.5)) for i in range(2)),
        node(6, "floor", "Floor", (-1.25, 0.0, 1.25), (2.5, 0.0, 2.5)),
    ]
    rooms = [
        node(1, "bedroom", "Rooms", (2.5, 1.25, 1.25), (5.5, 2.5, 3.0)),
        node(2, "livingroom", "Rooms", (-1.25, 1.25, 1.25), (2.5, 2.5, 2.5)),
    ]
    jamb = node(7, "doorjamb", "Doors", (0.0, 1.03, 1.25), (0.12, 2.06, 0.93))
    return {
        "nodes": [*rooms, *tiles, jamb, *furniture, *sofa],
        "edges": [
            *inside,
            *(edge(tile["id"], "INSIDE", 2 if tile["id"] == 6 else 1) for tile in tiles),
            edge(7, "INSIDE", 1),
            edge(11, "ON", 10),
        ],
    }
