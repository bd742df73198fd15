"""The JSON of a home: whole layouts, where they stand, the walls around them and the doorways between."""

from __future__ import annotations

from typing import Any, Final

from scene_graphs.fields import MAX_COORDINATE, LayoutError, Row, read_number, read_point3, read_rows
from scene_graphs.homes import MAX_ROOMS, Home, Room, Wall
from scene_graphs.layout_rows import opening_from_row, opening_to_row, segment_from_row
from scene_graphs.layouts import MAX_SIZE, layout_from_dict, layout_to_dict

MAX_WALLS: Final = 2000
MAX_OPENINGS: Final = 50
"""Of one wall, and doorways of one home."""


def home_to_dict(home: Home) -> dict[str, Any]:
    """The JSON of a home, whole layouts included; `home_from_dict` is its exact inverse."""
    return {
        "rooms": [
            {"layout": layout_to_dict(room.layout), "offset": list(room.offset), "yaw": room.yaw} for room in home.rooms
        ],
        "walls": [
            {
                "segment": [list(end) for end in wall.segment],
                "height": wall.height,
                "openings": [opening_to_row(opening) for opening in wall.openings],
            }
            for wall in home.walls
        ],
        "doorways": [opening_to_row(doorway) for doorway in home.doorways],
    }


def home_from_dict(row: Row, where: str = "home") -> Home:
    """Read a home. LayoutError naming the field that is missing, out of bounds or of another type."""
    rooms = tuple(_room(item, place) for item, place in read_rows(row, "rooms", where, MAX_ROOMS))
    if not rooms:
        raise LayoutError(f"{where}.rooms must hold 1 to {MAX_ROOMS} rooms, each with layout, offset and yaw")
    walls = tuple(
        Wall(
            segment_from_row(item, place),
            read_number(item.get("height"), f"{place}.height", 0.0, MAX_SIZE),
            tuple(opening_from_row(inner, at) for inner, at in read_rows(item, "openings", place, MAX_OPENINGS)),
        )
        for item, place in read_rows(row, "walls", where, MAX_WALLS)
    )
    doorways = tuple(opening_from_row(item, place) for item, place in read_rows(row, "doorways", where, MAX_OPENINGS))
    return Home(rooms, walls, doorways)


def _room(row: Row, where: str) -> Room:
    layout = row.get("layout")
    if not isinstance(layout, dict):
        raise LayoutError(f"{where}.layout must be an object, got {type(layout).__name__}")
    return Room(
        layout_from_dict(layout, f"{where}.layout"),
        read_point3(row.get("offset"), f"{where}.offset", -MAX_COORDINATE, MAX_COORDINATE),
        read_number(row.get("yaw", 0.0), f"{where}.yaw", -100.0, 100.0),
    )
