"""Several rooms as one home: "combined by an offset distance with bounding edges as walls" (SIMS 8.2).

The JSON of a home: whole layouts, where they stand, the walls around them and the doorways between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Final

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.doorways import WALL_GAP, HomeError, Pose, arrangements, span_on
from scene_graphs.errors import FieldPath
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError, Row, read_number, read_point3, read_rows
from scene_graphs.layout import (
    MAX_SIZE,
    Array,
    Layout,
    Opening,
    Placed,
    Point2,
    Point3,
    Segment,
    layout_from_dict,
    layout_to_dict,
    opening_from_row,
    opening_to_row,
    segment_from_row,
)
from scene_graphs.navigation.clearance import BODY_RADIUS, find_footing, obstacles, rectangles_of

__all__ = [
    "MAX_ROOMS",
    "Home",
    "HomeError",
    "Room",
    "Wall",
    "home_from_layouts",
    "random_home",
]

MAX_ROOMS: Final = 4
HANDLE_HEIGHT: Final = 1.0
"""Of a door's handle above the floor (metres)."""
HANDLE_IN: Final = 0.135
"""From the edge of a door to the middle of its handle (metres)."""
SILL: Final = 0.3
"""An opening that begins higher than this is a window, and no door (metres)."""
THRESHOLD: Final = 0.5
"""How far outside an outer door there is floor at least (metres)."""
HALLS: Final = ((1.5, 1.3), (1.5, 0.4), (1.0, 0.4), (THRESHOLD, 0.0))
"""How far from an outer door the hall before it goes, and how far beyond the door to either side: the first that is in
no room (metres)."""
HALL_FROM: Final = 0.1
"""How far from the line of its wall a hall begins (metres)."""
_DRAWS: Final = 12
"""Of rooms for a random home, before it is told why they cannot be joined."""


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

    def handle(self, door: Opening) -> Point2:
        """[x, z] of the handle of one of its doors: near the end of it that is farther along the wall."""
        start, end = (np.asarray(point, dtype=float) for point in self.segment)
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        farther = min(max(float((np.asarray(point) - start) @ along) for point in door.segment), length)
        x, z = start + (farther - HANDLE_IN) * along
        return float(x), float(z)


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

    @cached_property
    def floor(self) -> shapely.Geometry:
        """All rooms and the doorways between them, in [x, z]: one polygon if the doorways join all rooms."""
        reach = WALL_GAP / 2 + 0.01
        ways = [shapely.LineString(doorway.segment).buffer(reach, cap_style="flat") for doorway in self.doorways]
        return shapely.union_all([*self._outlines, *ways])

    def on_floor(self, points: Array) -> NDArray[np.bool_]:
        """Which of points [x, z] (N, 2) are in a room or a doorway between two. (N,)."""
        return np.asarray(shapely.intersects_xy(self.floor, points[:, 0], points[:, 1]))

    @cached_property
    def thresholds(self) -> shapely.Geometry:
        """Outside every outer door as much floor, in [x, z], as somebody needs who goes out of it."""
        doors = [one for wall in self.walls for one in wall.openings if one.bottom <= SILL and not self.leads_on(one)]
        steps = [shapely.LineString(one.segment).buffer(THRESHOLD, cap_style="flat") for one in doors]
        return shapely.union_all([*steps, *(self.hall(one)[0] for one in doors)])

    def hall(self, door: Opening) -> tuple[shapely.Polygon, float, float]:
        """The floor outside an outer door, in [x, z], how far out it goes, and how far beyond the door aside."""
        start, end = (np.asarray(point, dtype=float) for point in door.segment)
        along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
        out = np.array([along[1], -along[0]])
        x, z = ((start + end) / 2 + 0.1 * out).tolist()
        out = -out if self.room_at((x, z)) is not None else out
        rooms = shapely.union_all(self._outlines)
        for deep, aside in HALLS:
            corners = [start - aside * along, end + aside * along]
            found = shapely.Polygon([*corners, *(corner + deep * out for corner in corners[::-1])])
            clear = shapely.Polygon([corner + HALL_FROM * out for corner in corners] + [*found.exterior.coords][2:4])
            if not clear.intersects(rooms):
                break
        return found, deep, aside

    def leads_on(self, opening: Opening) -> bool:
        """Whether an opening of a wall is a side of a doorway to another room."""
        middle = shapely.Point(np.mean(np.asarray(opening.segment), axis=0))
        return any(shapely.LineString(doorway.segment).distance(middle) < 0.12 for doorway in self.doorways)

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
    too few or many rooms, a room has no free wall for a doorway, or one cannot be placed or walked to.
    """
    if not 1 <= len(layouts) <= MAX_ROOMS:
        raise HomeError(f"a home has 1 to {MAX_ROOMS} rooms, got {len(layouts)}")
    cut_off = None
    for plan in arrangements(layouts, seed):
        rooms = tuple(
            Room(layout, (pose.offset[0], 0.0, pose.offset[1]), pose.yaw)
            for layout, pose in zip(layouts, plan.poses, strict=True)
        )
        home = Home(rooms, _walls(rooms, plan.doorways), plan.doorways)
        cut_off = _cut_off(home)
        if cut_off is None:
            return home
    name = "" if cut_off is None else layouts[cut_off].id
    raise HomeError(f"room {name!r} cannot be walked to from the others: furniture is in the way", "take another room")


def random_home(layouts: Sequence[Layout], room_types: Sequence[str], seed: int) -> Home:
    """A home of one room of each asked type, in that order, drawn from layouts that can serve it (SIMS 8.2).

    No layout is taken twice. The same arguments give the same home. HomeError naming the type there are too few rooms
    of, or, when no draw can be joined, why the last cannot.
    """
    rng = np.random.default_rng(seed)
    for left in reversed(range(_DRAWS)):
        chosen = list[Layout]()
        for room_type in room_types:
            fitting = [one for one in layouts if room_type in (one.room_type, *one.tags) and one not in chosen]
            if not fitting:
                raise HomeError(f"there is no room of type {room_type!r} left among {len(layouts)}", "give more rooms")
            chosen.append(fitting[int(rng.integers(len(fitting)))])
        try:
            return home_from_layouts(chosen, seed)
        except HomeError:
            if not (left and room_types):
                raise
    raise AssertionError("the last draw is returned or told")


def _at_home(placed: Placed, room: Room, index: int) -> Placed:
    x, z = room.pose.to_home(np.array([placed.position[0], placed.position[2]]))
    return replace(
        placed,
        id=f"{index}/{placed.id}",
        position=(float(x), placed.position[1] + room.offset[1], float(z)),
        yaw=placed.yaw + room.yaw,
        parent=None if placed.parent is None else f"{index}/{placed.parent}",
    )


def _cut_off(home: Home) -> int | None:
    """The first room whose largest stretch of walkable floor is not joined to that of the others; None if all are."""
    if len(home.rooms) == 1:
        return None
    blocked = rectangles_of([outline for _, outline in obstacles(home.objects)])
    footing = find_footing(home.floor, blocked, BODY_RADIUS)
    cells = np.argwhere(footing.free)
    regions, (x, z) = footing.regions[footing.free], (np.asarray(footing.origin) + footing.cell * cells).T
    largest = []
    for index in range(len(home.rooms)):
        inside = shapely.contains_xy(shapely.Polygon(home.room_polygon(index)), x, z)
        largest.append(int(np.bincount(regions[inside], minlength=1).argmax()))
    main = int(np.bincount(largest).argmax())
    return next((index for index, region in enumerate(largest) if region != main or region == 0), None)


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


_HOME: Final = FieldPath(("home",))


def home_from_dict(row: Row, where: FieldPath = _HOME) -> Home:
    """Read a home. LayoutError naming the field that is missing, out of bounds or of another type."""
    rooms = tuple(_room(item, place) for item, place in read_rows(row, "rooms", where, MAX_ROOMS))
    if not rooms:
        raise LayoutError(f"must hold 1 to {MAX_ROOMS} rooms, each with layout, offset and yaw", at=where / "rooms")
    walls = tuple(
        Wall(
            segment_from_row(item, place),
            read_number(item.get("height"), place / "height", 0.0, MAX_SIZE),
            tuple(opening_from_row(inner, at) for inner, at in read_rows(item, "openings", place, MAX_OPENINGS)),
        )
        for item, place in read_rows(row, "walls", where, MAX_WALLS)
    )
    doorways = tuple(opening_from_row(item, place) for item, place in read_rows(row, "doorways", where, MAX_OPENINGS))
    return Home(rooms, walls, doorways)


def _room(row: Row, where: FieldPath) -> Room:
    layout = row.get("layout")
    if not isinstance(layout, dict):
        raise LayoutError(f"must be an object, got {type(layout).__name__}", at=where / "layout")
    return Room(
        layout_from_dict(layout, where / "layout"),
        read_point3(row.get("offset"), where / "offset", -MAX_COORDINATE, MAX_COORDINATE),
        read_number(row.get("yaw", 0.0), where / "yaw", -100.0, 100.0),
    )
