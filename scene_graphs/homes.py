"""Several rooms as one home: "combined by an offset distance with bounding edges as walls" (SIMS 8.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Final

import numpy as np
import shapely

from scene_graphs.fields import FARTHEST, LayoutError, Row, read_number, read_point2, read_point3, read_rows
from scene_graphs.joining import WALL_GAP, HomeError, Pose, plan_home, span_on
from scene_graphs.layouts import (
    Array,
    Layout,
    Opening,
    Placed,
    Point2,
    Point3,
    Segment,
    layout_from_dict,
    layout_to_dict,
)

__all__ = ["MOST_ROOMS", "Home", "HomeError", "Room", "Wall", "home_from_dict", "home_from_layouts", "home_to_dict"]

MOST_ROOMS: Final = 4


@dataclass(frozen=True)
class Room:
    """A layout and where it stands: p_home = R_y(yaw) p + offset."""

    layout: Layout
    offset: Point3 = (0.0, 0.0, 0.0)
    yaw: float = 0.0

    @property
    def pose(self) -> Pose:
        """The same on the floor plane."""
        return Pose((self.offset[0], self.offset[2]), self.yaw)


@dataclass(frozen=True)
class Wall:
    """One side of a room, thin and upright, in the home's frame."""

    segment: Segment
    height: float
    openings: tuple[Opening, ...] = ()
    """Doorways to other rooms, doors and windows to the outside; their segments lie on the wall's."""


@dataclass(frozen=True)
class Home:
    """Rooms, the walls around them and the doorways between them."""

    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    doorways: tuple[Opening, ...] = ()
    """On the middle line between two rooms' walls."""

    @cached_property
    def objects(self) -> tuple[Placed, ...]:
        """All furniture in the home's frame, with ids "room_index/object_id"."""
        return tuple(
            _at_home(placed, room, index) for index, room in enumerate(self.rooms) for placed in room.layout.objects
        )

    @cached_property
    def _by_id(self) -> dict[str, Placed]:
        return {placed.id: placed for placed in self.objects}

    def object(self, object_id: str) -> Placed:
        """The object of that home-wide id, or KeyError naming the ids there are."""
        if object_id not in self._by_id:
            raise KeyError(f"no object {object_id!r} in this home; it has {', '.join(self._by_id)}")
        return self._by_id[object_id]

    def room_polygon(self, index: int) -> Array:
        """The outline of a room in the home's frame, [x, z] corners, not closed. (N, 2)."""
        room = self.rooms[index]
        return room.pose.to_home(np.asarray(room.layout.floor_polygon, dtype=float))

    @cached_property
    def _outlines(self) -> tuple[shapely.Polygon, ...]:
        return tuple(shapely.Polygon(self.room_polygon(index)) for index in range(len(self.rooms)))

    def room_at(self, point: Point2) -> int | None:
        """The room a point on the floor lies in; in a doorway the nearer room; None outside the home."""
        gaps = [outline.distance(shapely.Point(point)) for outline in self._outlines]
        nearest = int(np.argmin(gaps))
        if gaps[nearest] <= 1e-9:
            return nearest
        here = shapely.Point(point)
        in_doorway = any(shapely.LineString(d.segment).distance(here) <= WALL_GAP / 2 + 1e-6 for d in self.doorways)
        return nearest if in_doorway else None


def home_from_layouts(layouts: Sequence[Layout], seed: int) -> Home:
    """Stand 1 to 4 rooms side by side and cut a doorway where two of them meet; the first room keeps its frame.

    Every room can be walked to from every other. The same layouts and seed give the same home. HomeError if there are
    too few or many rooms, or a room has no free wall for a doorway.
    """
    if not 1 <= len(layouts) <= MOST_ROOMS:
        raise HomeError(f"a home has 1 to {MOST_ROOMS} rooms, got {len(layouts)}")
    plan = plan_home(layouts, seed)
    rooms = tuple(
        Room(layout, (pose.offset[0], 0.0, pose.offset[1]), pose.yaw)
        for layout, pose in zip(layouts, plan.poses, strict=True)
    )
    return Home(rooms, _walls(rooms, plan.doorways), plan.doorways)


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
                "openings": [_opening_to_dict(opening) for opening in wall.openings],
            }
            for wall in home.walls
        ],
        "doorways": [_opening_to_dict(doorway) for doorway in home.doorways],
    }


def home_from_dict(row: Row, where: str = "home") -> Home:
    """Read a home. LayoutError naming the field that is missing, out of bounds or of another type."""
    rooms = tuple(_room(item, place) for item, place in read_rows(row, "rooms", where, MOST_ROOMS))
    if not rooms:
        raise LayoutError(f"{where}.rooms must hold 1 to {MOST_ROOMS} rooms, each with layout, offset and yaw")
    walls = tuple(
        Wall(
            _segment(item, place),
            read_number(item.get("height"), f"{place}.height", 0.0, 30.0),
            tuple(_opening(inner, at) for inner, at in read_rows(item, "openings", place, 50)),
        )
        for item, place in read_rows(row, "walls", where, 2000)
    )
    doorways = tuple(_opening(item, place) for item, place in read_rows(row, "doorways", where, 50))
    return Home(rooms, walls, doorways)


def _at_home(placed: Placed, room: Room, index: int) -> Placed:
    x, z = room.pose.to_home(np.array([placed.position[0], placed.position[2]]))
    return replace(
        placed,
        id=f"{index}/{placed.id}",
        position=(float(x), placed.position[1] + room.offset[1], float(z)),
        yaw=placed.yaw + room.yaw,
        parent=None if placed.parent is None else f"{index}/{placed.parent}",
    )


def _walls(rooms: tuple[Room, ...], doorways: tuple[Opening, ...]) -> tuple[Wall, ...]:
    """The bounding edges of every room, with the doorways cut in and openings onto other rooms' walls closed."""
    outlines = [shapely.Polygon(room.pose.to_home(np.asarray(room.layout.floor_polygon))) for room in rooms]
    walls = []
    for index, room in enumerate(rooms):
        corners = np.asarray(outlines[index].exterior.coords)
        others = shapely.union_all([outline for i, outline in enumerate(outlines) if i != index])
        own = [_moved(opening, room.pose) for opening in (*room.layout.doors, *room.layout.windows)]
        outside = [
            opening for opening in own if others.is_empty or others.distance(shapely.LineString(opening.segment)) > 0.5
        ]
        for start, end in pairwise(corners):
            cut = _on_wall(doorways, start, end)
            lines = [shapely.LineString(doorway.segment) for doorway in cut]
            kept = [
                opening
                for opening in _on_wall(outside, start, end)
                if all(line.distance(shapely.LineString(opening.segment)) > 0.05 for line in lines)
            ]
            walls.append(Wall((_pair(start), _pair(end)), room.layout.height, (*cut, *kept)))
    return tuple(walls)


def _on_wall(openings: Sequence[Opening], start: Array, end: Array) -> list[Opening]:
    """The openings of one wall, moved onto its line."""
    length = float(np.hypot(*(end - start)))
    if length == 0:
        return []
    along = (end - start) / length
    found = []
    for opening in openings:
        if (span := span_on(opening, start, along, length)) is not None:
            low, high = span
            found.append(replace(opening, segment=(_pair(start + along * low), _pair(start + along * high))))
    return found


def _moved(opening: Opening, pose: Pose) -> Opening:
    start, end = pose.to_home(np.asarray(opening.segment, dtype=float))
    return replace(opening, segment=(_pair(start), _pair(end)))


def _pair(point: Array) -> Point2:
    return float(point[0]), float(point[1])


def _opening_to_dict(opening: Opening) -> dict[str, Any]:
    return {"segment": [list(end) for end in opening.segment], "bottom": opening.bottom, "top": opening.top}


def _room(row: Row, where: str) -> Room:
    layout = row.get("layout")
    if not isinstance(layout, dict):
        raise LayoutError(f"{where}.layout must be an object, got {type(layout).__name__}")
    return Room(
        layout_from_dict(layout, f"{where}.layout"),
        read_point3(row.get("offset"), f"{where}.offset", -FARTHEST, FARTHEST),
        read_number(row.get("yaw", 0.0), f"{where}.yaw", -100.0, 100.0),
    )


def _segment(row: Row, where: str) -> Segment:
    ends = row.get("segment")
    if not isinstance(ends, list) or len(ends) != 2:
        raise LayoutError(f"{where}.segment must be two [x, z] points, got {ends!r:.60}")
    start, end = (read_point2(point, f"{where}.segment[{index}]") for index, point in enumerate(ends))
    return start, end


def _opening(row: Row, where: str) -> Opening:
    bottom = read_number(row.get("bottom", 0.0), f"{where}.bottom", 0.0, 30.0)
    return Opening(_segment(row, where), bottom, read_number(row.get("top", 2.1), f"{where}.top", bottom, 30.0))
