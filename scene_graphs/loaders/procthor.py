"""ProcTHOR and AI2-THOR houses (schema 1.0.0), and what is written like them.

What a ProcTHOR model id stands for: its type and box from an asset file, or what its name lets one guess.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
import shapely

from scene_graphs.boxes import Point3
from scene_graphs.errors import FieldPath
from scene_graphs.furniture import is_known, typical_size
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError, Row, read_number, read_point3, read_rows, read_text
from scene_graphs.layout import MAX_CORNERS, MAX_SIZE, MIN_SIZE, Layout, Point2, Segment
from scene_graphs.loaders.frames import box_from_unity, plan_from_unity, point_from_unity
from scene_graphs.loaders.furniture_names import MAX_NAME_LENGTH, exact_category, meaning, rooms_served, words_of
from scene_graphs.loaders.room_builder import Intake, RoomIntake
from scene_graphs.loaders.scene_source import MAX_ROWS, Source

MAX_ASSETS: Final = 200_000
ASSET_FILES: Final = (
    "procthor_asset_boxes.json.gz",
    "procthor_asset_boxes.json",
    "asset_boxes.json.gz",
    "asset_boxes.json",
    "asset-database.json",
)
"""Names under which an asset file is found beside the houses."""
NIGHTSTAND: Final = 0.75
"""A side table of a bedroom that is not wider is a nightstand, in metres."""
_AXES: Final = ("x", "y", "z")


class Asset(NamedTuple):
    """What the asset database says of a model."""

    type: str
    size: Point3
    """Width x, height y, depth z at rotation 0, in metres."""


def read_assets(source: Source) -> dict[str, Asset]:
    """Types and boxes by model id, from {"Bed_13": ["Bed", [x, y, z]]} or ProcTHOR's own asset-database.json.

    LayoutError if it is neither; a single entry without a usable box is left out.
    """
    table = source.json()
    if not isinstance(table, dict) or len(table) > MAX_ASSETS:
        raise LayoutError(f'{source.name} must be an object {{"Bed_13": ["Bed", [x, y, z]]}} or asset-database.json')
    assets = {}
    for name, type_, size in _entries(table):
        try:
            if isinstance(name, str) and isinstance(type_, str):
                assets[name] = Asset(type_, read_point3(size, FieldPath((name[:60],)), MIN_SIZE, MAX_SIZE))
        except LayoutError:
            continue
    if table and not assets:
        raise LayoutError(f"{source.name} has no box that can be used", 'an entry is "Bed_13": ["Bed", [x, y, z]]')
    return assets


def describe(asset_id: str, asset: Asset | None, room_type: str, middle: float) -> tuple[str, Point3]:
    """Our word for a model and its box, by its type and what box and room say.

    Of a model that no asset file knows, the word is the longest beginning of its id that names furniture and the box
    is estimated; `middle` is the height of its box's centre above the floor.
    """
    word = _type_by_name(asset_id) if asset is None else meaning(asset.type)
    size = _estimated_size(word, middle) if asset is None else asset.size
    return _exact_word(word, asset_id, size, room_type), size


def _exact_word(word: str, asset_id: str, size: Point3, room_type: str) -> str:
    """ProcTHOR has no office chairs and no nightstands, only some that are called so or stand in a bedroom."""
    if word == "chair" and "office" in asset_id.lower():
        return "office_chair"
    if word == "side_table" and room_type == "bedroom" and max(size[0], size[2]) <= NIGHTSTAND:
        return "nightstand"
    return exact_category(word, size)


def _estimated_size(word: str, middle: float) -> Point3:
    """What stands on the floor is twice as high as its middle; of what hangs or lies on something it is typical."""
    w, h, d = typical_size(word)
    return (w, 2 * middle if 0.5 * h <= 2 * middle <= 2 * h else h, d)


def _entries(table: dict[Any, Any]) -> Iterator[tuple[Any, Any, Any]]:
    """(model id, type, [x, y, z]) of either form of asset file, unchecked."""
    for key, value in table.items():
        if isinstance(value, list) and len(value) == 2 and isinstance(value[0], str):
            yield key, value[0], value[1]
            continue
        for entry in value if isinstance(value, list) else [value]:
            if isinstance(entry, dict) and isinstance(box := entry.get("boundingBox"), dict):
                yield entry.get("assetId", key), entry.get("objectType", key), [box.get(axis) for axis in _AXES]


def _type_by_name(asset_id: str) -> str:
    """The longest beginning of a model id that names furniture: "RoboTHOR_sofa_vreta" is a sofa."""
    words = [word for word in words_of(asset_id.removeprefix("RoboTHOR")).split("_") if word]
    for end in range(len(words), 0, -1):
        if is_known(word := meaning("_".join(words[:end]))):
            return word
    return "_".join(words)


MAX_ROOMS_PER_HOUSE: Final = 100
MAX_WALLS: Final = 2_000
MAX_THINGS: Final = 5_000
"""Objects of one house, with the small things on them."""
_T = TypeVar("_T")


def read_procthor(source: Source, intake: Intake) -> list[Layout]:
    """Every room of the houses in a JSON file, a list, or one house a line.

    The option `scan` names some of many houses by their number in the file, from 0: "17", "0-99".
    Houses name models and not their sizes: those are joined from an asset file (`read_assets`), given as an option or
    lying beside; without it they are estimated from the model's name, and the report counts them.
    """
    given = intake.options.assets or source.beside(*ASSET_FILES)
    assets = read_assets(given) if given else {}
    wanted = _wanted(intake.options.scan)
    layouts: list[Layout] = []
    for number, (where, row) in enumerate(islice(source.rows(), wanted.stop)):
        if number not in wanted:
            continue
        house_id = f"{source.name.split('.')[0]}/{number}"
        try:
            rooms = _House(row, where, assets, intake).rooms(house_id)
        except LayoutError as error:
            intake.drop("a house that cannot be read", str(error))
            continue
        intake.count_rooms(len(rooms), source.name)
        layouts += [layout for room in rooms if (layout := room.finish()) is not None]
    if wanted.start and not layouts:
        raise LayoutError(f"{source.name} has no house with a room among {intake.options.scan} (scan)")
    return layouts


def _wanted(scan: str | None) -> range:
    """The houses of a file to read, counted from 0: "17", "0-99", or all."""
    if scan is None:
        return range(MAX_ROWS)
    match = re.fullmatch(r"(\d{1,6})(?:-(\d{1,6}))?", scan, re.ASCII)
    if match is None:
        raise LayoutError(f"scan must number houses of the file from 0, such as 17 or 0-99, got {scan!r:.60}")
    return range(int(match[1]), int(match[2] or match[1]) + 1)


class _Hole(NamedTuple):
    """A door or window: where the wall is open, and the rooms on its sides."""

    segment: Segment
    bottom: float
    top: float
    rooms: frozenset[str]


@dataclass
class _House:
    """One house being read."""

    row: Any
    where: FieldPath
    assets: Mapping[str, Asset]
    intake: Intake
    _rooms: dict[str, RoomIntake] = field(default_factory=dict)
    """By the house's own ids."""
    _things: int = 0
    """Objects added so far."""

    def rooms(self, house_id: str) -> list[RoomIntake]:
        """Its rooms with everything in them, not finished yet. LayoutError if it is no house."""
        if not isinstance(self.row, dict) or not {"rooms", "objects"} <= self.row.keys():
            raise LayoutError("must be a house with rooms, walls, doors, windows and objects", at=self.where)
        walls = dict(self._each("walls", _wall, MAX_WALLS))
        for room_id, type_, corners in self._each("rooms", _room, MAX_ROOMS_PER_HOUSE):
            if room_id in self._rooms:
                self.intake.drop("a room whose id occurs before", room_id)
                continue
            height = max((_highest(ends) for owner, ends in walls.values() if owner == room_id), default=None)
            name = f"{house_id}/{room_id.rpartition('|')[2]}"
            self._rooms[room_id] = self.intake.room(name, type_, corners, source="procthor", height=height)
        self._furnish()
        ends_of = {wall_id: ends for wall_id, (_, ends) in walls.items()}
        for key, add in (("doors", RoomIntake.door), ("windows", RoomIntake.window)):
            for hole in self._each(key, lambda item, place: _hole(item, place, ends_of), MAX_WALLS):
                for room_id in sorted(hole.rooms & self._rooms.keys()):
                    add(self._rooms[room_id], hole.segment, hole.bottom, hole.top)
        for room in self._rooms.values():
            room.tags = rooms_served(room.tags[0], [p.category for p in room.objects if p.parent is None])
        return list(self._rooms.values())

    def _each(self, key: str, read: Callable[[Row, FieldPath], _T], most: int) -> Iterator[_T]:
        """The items of a list as `read` reads them; those it cannot read are counted."""
        for item, place in read_rows(self.row, key, self.where, most):
            try:
                yield read(item, place)
            except LayoutError as error:
                self.intake.drop(f"one of the {key} that cannot be read", str(error))

    def _furnish(self) -> None:
        """Put the objects of the house into the rooms they stand in."""
        objects = list(self._each("objects", lambda item, place: (item, place, *_pose(item, place)), MAX_THINGS))
        plan = np.array([plan_from_unity(middle[0], middle[2]) for _, _, middle, _ in objects]).reshape(-1, 2)
        homes = self._homes(plan)
        for home, (item, place, middle, turn) in zip(homes, objects, strict=True):
            room = home or self._named_room(item)
            if room is None:
                self.intake.drop("it stands in no room of its house", str(place))
                continue
            self._add(room, item, place, middle, turn)

    def _homes(self, plan: np.ndarray[Any, Any]) -> list[RoomIntake | None]:
        """For every [x, z] the room on whose floor it lies, if any."""
        homes: list[RoomIntake | None] = [None] * len(plan)
        for room in self._rooms.values():
            inside = shapely.contains_xy(shapely.make_valid(shapely.Polygon(room.floor)), plan[:, 0], plan[:, 1])
            for index in np.flatnonzero(inside):
                homes[index] = homes[index] or room
        return homes

    def _named_room(self, item: Row) -> RoomIntake | None:
        """The room an object says it is in, by `roomId` or by the number its id begins with."""
        number = str(item.get("id", "")).partition("|")[0]
        return next(
            (room for name, room in self._rooms.items() if name == item.get("roomId") or name == f"room|{number}"), None
        )

    def _add(self, room: RoomIntake, item: Row, place: FieldPath, middle: Point3, turn: Point3) -> None:
        """Add an object and, with it as parent, everything on it: poses of children are the house's too."""
        waiting: list[tuple[Row, FieldPath, Point3, Point3, str | None]] = [(item, place, middle, turn, None)]
        while waiting:
            item, place, middle, turn, parent = waiting.pop()
            self._things += 1
            if self._things > MAX_THINGS:
                self.intake.drop(f"a house holds at most {MAX_THINGS} objects", str(place))
                return
            placed = self._add_one(room, item, place, middle, turn, parent)
            children = read_rows(item, "children", place, MAX_THINGS) if item.get("children") else ()
            for child, child_place in children:
                if placed is None:
                    self.intake.drop("what it stands on was dropped", str(child_place))
                    continue
                try:
                    waiting.append((child, child_place, *_pose(child, child_place), placed))
                except LayoutError as error:
                    self.intake.drop("one of the objects that cannot be read", str(error))

    def _add_one(
        self, room: RoomIntake, item: Row, place: FieldPath, middle: Point3, turn: Point3, parent: str | None
    ) -> str | None:
        asset_id = str(item.get("assetId", ""))[:MAX_NAME_LENGTH]
        asset = self.assets.get(asset_id)
        if asset is None and item.get("object_name"):
            asset_id = str(item["object_name"])[:MAX_NAME_LENGTH]
        if asset is None:
            self.intake.guess("size")
        category, box = describe(asset_id, asset, room.tags[0], middle[1])
        size, yaw = box_from_unity(box, turn)
        x, y, z = point_from_unity(middle)
        placed = room.add(str(item.get("id") or place), category, (x, y - size[1] / 2, z), size, yaw, parent)
        return placed.id if placed else None


def _room(row: Row, where: FieldPath) -> tuple[str, str, list[Point2]]:
    """Id, type and outline of a room."""
    corners = row.get("floorPolygon")
    if not isinstance(corners, list) or not 3 <= len(corners) <= MAX_CORNERS:
        raise LayoutError(f"must be a list of 3 to {MAX_CORNERS} corners", at=where / "floorPolygon")
    points = [_vector(corner, where / "floorPolygon" / index) for index, corner in enumerate(corners)]
    type_ = words_of(read_text(row, "roomType", where, "room")) or "room"
    return read_text(row, "id", where), type_, [plan_from_unity(x, z) for x, _, z in points]


def _wall(row: Row, where: FieldPath) -> tuple[str, tuple[str, list[Point3]]]:
    """Id of a wall, the room it belongs to, and its corners, in the house's frame."""
    corners = row.get("polygon")
    if not isinstance(corners, list) or not 2 <= len(corners) <= MAX_CORNERS:
        raise LayoutError("must be a list of corners", at=where / "polygon")
    points = [_vector(corner, where / "polygon" / index) for index, corner in enumerate(corners)]
    return read_text(row, "id", where), (str(row.get("roomId", "")), points)


def _highest(corners: list[Point3]) -> float:
    return max(y for _, y, _ in corners)


def _hole(row: Row, where: FieldPath, walls: Mapping[str, list[Point3]]) -> _Hole:
    """A door or window. Its polygon lies in the plane of wall0: x runs from that wall's first corner to its second.

    It does not run as the wall's id is written, which is the other way round in half of all walls.
    """
    wall = walls.get(str(row.get("wall0")))
    corners = row.get("holePolygon")
    if wall is None or not isinstance(corners, list) or len(corners) < 2:
        raise LayoutError("must have a wall0 that is one of the walls, and a holePolygon of two corners", at=where)
    start, end = np.array(wall[0])[[0, 2]], np.array(wall[1])[[0, 2]]
    length = float(np.hypot(*(end - start)))
    if length < 1e-6:
        raise LayoutError("has no length", at=where / "wall0")
    (ax, ay, _), (bx, by, _) = (_vector(corner, where / "holePolygon" / i) for i, corner in enumerate(corners[:2]))
    a, b = (start + (end - start) * (along / length) for along in (ax, bx))
    segment = (plan_from_unity(float(a[0]), float(a[1])), plan_from_unity(float(b[0]), float(b[1])))
    rooms = frozenset(str(row.get(key)) for key in ("room0", "room1"))
    return _Hole(segment, max(0.0, min(ay, by)), max(ay, by), rooms)


def _pose(row: Row, where: FieldPath) -> tuple[Point3, Point3]:
    """Where the middle of an object's box is and how it is turned (degrees), in the house's frame."""
    rotation = row.get("rotation")
    turn = (0.0, 0.0, 0.0) if rotation is None else _vector(rotation, where / "rotation", 1e6)
    return _vector(row.get("position"), where / "position"), turn


def _vector(value: Any, where: FieldPath, most: float = MAX_COORDINATE) -> Point3:
    if not isinstance(value, dict):
        raise LayoutError(f"must be {{x, y, z}}, got {value!r:.60}", at=where)
    x, y, z = (read_number(value.get(axis), where / axis, -most, most) for axis in ("x", "y", "z"))
    return (x, y, z)
