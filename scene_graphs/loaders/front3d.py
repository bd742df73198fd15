"""3D-FRONT: one house a file, its rooms, their floors from meshes, furniture from 3D-FUTURE, doors and windows.

Its frame is ours: right-handed, Y up, metres, front +Z.

What one 3D-FRONT house file lists: rooms with their floors and furniture, doors and windows; nothing is trusted.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, count
from typing import Any, Final

import numpy as np
import shapely

from scene_graphs.boxes import Part
from scene_graphs.furniture import canonical, class_of
from scene_graphs.json_fields import LayoutError, Row
from scene_graphs.layout import Array, Layout, Point2
from scene_graphs.loaders.doors_and_windows import MAX_GAPS, Gap, distinct, gap_around, gaps_of_rooms
from scene_graphs.loaders.floor_polygon import floor_from_triangles
from scene_graphs.loaders.frames import coordinates, corners_of, read_pose
from scene_graphs.loaders.furniture_names import exact_category, likely_room, rooms_served
from scene_graphs.loaders.future3d import Model, Models
from scene_graphs.loaders.plan_boxes import UprightBox
from scene_graphs.loaders.room_builder import Intake, RoomIntake, slug_id
from scene_graphs.loaders.scene_source import Source

MAX_ENTRIES: Final = 200_000
"""Models, meshes or placed things of one house; 340 things a house is usual."""
MAX_ITEMS: Final = 10_000
"""Pieces of furniture of one house."""
MAX_POINTS: Final = 4_000_000
"""Of all meshes placed that a room is read from: floors, walls, doors, windows."""
MAX_TRIANGLES: Final = 10_000
"""Of all floors of one house; a real room has some tens."""
NOT_A_HOUSE: Final = "is not a 3D-FRONT house: it needs furniture, mesh and scene.room; give one <house uid>.json"
_FLOOR, _CEILING = "Floor", ("WallInner", "Ceiling")
_GAPS: Final = {"Door": True, "Window": False, "BayWindow": False, "Hole": None, "Pocket": None}
"""Mesh types that fill a gap in a wall, in the order in which they are believed: is it a door?"""


@dataclass
class Item:
    """A piece of furniture with its place in the house."""

    name: str
    model: Model
    box: UprightBox
    shape: tuple[Part, ...]


@dataclass
class HouseRoom:
    """One room as the house lists it, in the house's frame."""

    name: str
    """Its `instanceid`, unique in the house."""
    type: str
    """In the house's own word."""
    triangles: list[Array] = field(default_factory=list)
    """Of the floor, each (N, 3, 3)."""
    ceiling: float | None = None
    items: list[Item] = field(default_factory=list)

    @property
    def level(self) -> float:
        """The height of the floor."""
        return float(np.median(np.concatenate(self.triangles)[..., 1])) if self.triangles else 0.0

    @property
    def plans(self) -> Array:
        """The floor's triangles seen from above. (N, 3, 2)."""
        return np.concatenate(self.triangles)[:, :, [0, 2]] if self.triangles else np.zeros((0, 3, 2))


class House:
    """One parsed house file. LayoutError if it is none, or far larger than any."""

    def __init__(self, row: Any, name: str, models: Models, intake: Intake) -> None:
        scene = row.get("scene") if isinstance(row, dict) else None
        if not isinstance(scene, dict) or not isinstance(scene.get("room"), list):
            raise LayoutError(f"{name} {NOT_A_HOUSE}")
        self._intake, self._models, self._room_rows = intake, models, scene["room"]
        intake.count_rooms(len(self._room_rows), name)
        self.uid = slug_id(uid if isinstance(uid := row.get("uid"), str) else name.removesuffix(".json"))[:50]
        self._entries = _by_uid(row, "furniture", name)
        self._meshes = _by_uid(row, "mesh", name)
        self._known: dict[str, Model | None] = {}
        self._door_refs = frozenset(_door_refs(row))
        self._points: dict[str, Array | None] = {}
        self._gaps: list[tuple[int, Gap]] = []
        self._read: Counter[str] = Counter()

    def rooms(self) -> Iterator[HouseRoom]:
        """The rooms with their floors and furniture; doors and windows are put aside for `gaps`."""
        names: set[str] = set()
        for number, row in enumerate(self._room_rows):
            if not isinstance(row, dict):
                self._intake.drop("an entry of scene.room that is no object")
                continue
            name = slug_id(told if isinstance(told := row.get("instanceid"), str) else f"room-{number}")[:50]
            unique = next(n for n in chain([name], (f"{name}-{again}" for again in count(2))) if n not in names)
            names.add(unique)
            yield self._room(row, unique)

    def gaps(self) -> list[Gap]:
        """The doors and windows of the house, each once."""
        return distinct([gap for _, gap in sorted(self._gaps, key=lambda ranked: ranked[0])])

    def _room(self, row: Row, name: str) -> HouseRoom:
        room = HouseRoom(name, kind if isinstance(kind := row.get("type"), str) else "")
        children = row.get("children", [])
        if not isinstance(children, list):
            self._intake.drop("a room whose children are no list", name)
            return room
        self._count("things placed", len(children), MAX_ENTRIES)
        for child in children:
            self._place(room, child)
        return room

    def _count(self, what: str, more: int, most: int) -> None:
        """Refuse a house that would take minutes to read."""
        self._read[what] += more
        if self._read[what] > most:
            raise LayoutError(f"scene.room: more than {most} {what} in one house", "split it")

    def _place(self, room: HouseRoom, child: Any) -> None:
        ref = child.get("ref") if isinstance(child, dict) else None
        if not isinstance(ref, str):
            self._intake.drop("a thing placed in a room that names no model")
        elif ref in self._entries:
            self._place_furniture(room, child, ref)
        elif ref in self._meshes:
            self._place_mesh(room, child, ref)
        else:
            self._intake.drop("it points at a model the house does not have", ref)

    def _place_furniture(self, room: HouseRoom, child: Row, ref: str) -> None:
        entry = self._entries[ref]
        title = entry.get("title")
        gap_rank = self._gap_rank(ref, self._models.word(entry), title if isinstance(title, str) else "")
        if gap_rank is None and entry.get("valid") is not True:
            self._intake.drop("it has no public model (valid is not true)", self._models.word(entry))
            return
        pose = read_pose(child)
        if isinstance(pose, str):
            self._intake.drop(pose, ref)
            return
        if ref not in self._known:
            self._known[ref] = self._models.model(entry)
        model = self._known[ref]
        if model is None:
            self._intake.drop("neither its entry nor a mesh gives its size", self._models.word(entry))
        elif gap_rank is not None:
            self._put_aside(gap_rank, pose.to_world(UprightBox(model.bottom, model.size).corners))
        else:
            if not pose.is_upright:
                self._intake.guess("turn of a tilted piece")
            self._count("pieces of furniture", 1, MAX_ITEMS)
            name = told if isinstance(told := child.get("instanceid"), str) and told.strip() else ref
            room.items.append(Item(name, model, *model.placed(pose)))

    def _place_mesh(self, room: HouseRoom, child: Row, ref: str) -> None:
        mesh = self._meshes[ref]
        kind = mesh.get("type")
        gap_rank = self._gap_rank(ref, kind if isinstance(kind, str) else "", "")
        if kind != _FLOOR and kind not in _CEILING and gap_rank is None:
            return
        if ref not in self._points:
            self._points[ref] = coordinates(mesh.get("xyz"))
        pose, points = read_pose(child), self._points[ref]
        if isinstance(pose, str) or points is None:
            self._intake.drop("a mesh of the building whose xyz or place is no list of numbers", ref)
            return
        self._count("points of meshes", len(points), MAX_POINTS)
        points = pose.to_world(points)
        if kind == _FLOOR:
            corners = corners_of(mesh.get("faces"), len(points))
            if corners is None:
                self._intake.drop("a floor whose faces are no list of its points", ref)
                return
            self._count("triangles of floors", len(corners), MAX_TRIANGLES)
            room.triangles.append(points[corners])
        elif gap_rank is not None:
            self._put_aside(gap_rank, points)
        else:
            top = float(points[:, 1].max())
            room.ceiling = top if room.ceiling is None else max(room.ceiling, top)

    def _gap_rank(self, ref: str, kind: str, title: str) -> int | None:
        """How far down the list of believed gaps a thing stands; None if it is none. Doors that are told come first."""
        word = title.split("/")[0].strip().capitalize() or kind
        kinds = list(_GAPS)
        if ref in self._door_refs:
            return 0
        return next((kinds.index(name) for name in (word, kind) if name in _GAPS), None)

    def _put_aside(self, rank: int, points: Array) -> None:
        gap = gap_around(points, list(_GAPS.values())[rank])
        if gap is not None:
            self._count("doors and windows", 1, MAX_GAPS)
            self._gaps.append((rank, gap))


def _by_uid(row: Row, key: str, name: str) -> Mapping[str, Row]:
    """The rows of a list by their uid, the first of each."""
    rows = row.get(key, [])
    if not isinstance(rows, list) or len(rows) > MAX_ENTRIES:
        raise LayoutError(f"{name}.{key} must be a list of at most {MAX_ENTRIES} objects; {name} {NOT_A_HOUSE}")
    found: dict[str, Row] = {}
    for entry in rows:
        if isinstance(entry, dict) and isinstance(uid := entry.get("uid"), str):
            found.setdefault(uid, entry)
    return found


def _door_refs(row: Row) -> Iterator[str]:
    """The models and meshes that the house calls doors."""
    extension = row.get("extension")
    doors = extension.get("door") if isinstance(extension, dict) else None
    for door in doors if isinstance(doors, list) else ():
        refs = door.get("ref") if isinstance(door, dict) else None
        yield from (ref for ref in (refs if isinstance(refs, list) else ()) if isinstance(ref, str))


LICENCE: Final = "3D-FRONT terms of use: research only, not to be passed on"
_TYPES: Final = (("bed", "bedroom"), ("living", "living_room"), ("dining", "dining_room"), ("library", "study"))
"""SIMS's four room types by part of their name, as ATISS takes them; a LivingDiningRoom is two of them."""
_OWN_FLOOR: Final = 0.05
"""What stands this far off its own floor still belongs there, in metres."""


def read_front3d(source: Source, intake: Intake) -> list[Layout]:
    """Read every room of a house; of a folder of houses, the house named by the option `scan`.

    Furniture without a public model or a size is dropped, a piece whose centre lies on another room's floor goes to
    that room. LayoutError if the file is not a house.
    """
    file = _house_file(source, intake)
    house = House(file.json(), file.name, Models(source, intake.options.assets), intake)
    rooms = list(house.rooms())
    floors = [floor_from_triangles(room.plans) for room in rooms]
    _rehouse(rooms, floors, intake)
    gaps = gaps_of_rooms(house.gaps(), floors)
    filled = [
        _fill(room, house.uid, floor, inside, intake) for room, floor, inside in zip(rooms, floors, gaps, strict=True)
    ]
    return [layout for room in filled if (layout := room.finish()) is not None]


def _house_file(source: Source, intake: Intake) -> Source:
    if not source.is_folder:
        return source
    scan = intake.options.scan
    found = source.beside(f"{scan}.json", f"3D-FRONT/{scan}.json") if scan else None
    if found is None:
        raise LayoutError(f"{source.name} is a folder: name the house's .json in it, or its uid as scan")
    return found


def _fill(room: HouseRoom, uid: str, floor: list[Point2] | None, gaps: Sequence[Gap], intake: Intake) -> RoomIntake:
    """The room to be finished, with everything in it."""
    level = room.level
    height = None if room.ceiling is None else room.ceiling - level
    room_type, *tags = _tags(room, intake)
    room_id = f"3d-front/{uid}/{room.name}"
    filled = intake.room(room_id, room_type, floor, source="3d-front", licence=LICENCE, height=height, tags=tags)
    for item in room.items:
        (x, y, z), size, yaw = item.box
        word = exact_category(canonical(item.model.word), size, y - level)
        filled.add(item.name, word, (x, y - level, z), size, yaw, mesh=item.model.mesh, shape=item.shape)
    filled.open(gaps, level)
    return filled


def _tags(room: HouseRoom, intake: Intake) -> tuple[str, ...]:
    """The types of a room, by its own word and by what stands in it.

    SIMS's four, else the word's slug ("MasterBathroom" -> "master_bathroom"). A child's, elder's or nanny's room with a
    bed is a bedroom as well.
    """
    slug = re.sub(r"[^a-z0-9]+", "_", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", room.type).lower())[:60].strip("_")
    named = [room_type for part, room_type in _TYPES if part in room.type.lower()]
    categories = {canonical(item.model.word) for item in room.items}
    told = slug if slug not in ("", "none", "other_room") else intake.options.room_type
    types = named or [told or likely_room("", categories)]
    if slug in ("kids_room", "elderly_room", "nanny_room") and any(class_of(word) == "bed" for word in categories):
        types.append("bedroom")
    return (*types, *rooms_served(types[0], categories))


def _rehouse(rooms: Sequence[HouseRoom], floors: Sequence[Sequence[Point2] | None], intake: Intake) -> None:
    """Move what stands on another room's floor to that room; in real houses a quarter of the furniture does."""
    outlines = [shapely.Polygon(floor) if floor and len(floor) >= 3 else shapely.Polygon() for floor in floors]
    outlines = [outline if outline.is_valid else shapely.Polygon() for outline in outlines]
    tree = shapely.STRtree(outlines)
    moved: list[tuple[int, Item]] = []
    for room, outline in zip(rooms, outlines, strict=True):
        points = shapely.points([item.box.position[::2] for item in room.items]) if room.items else np.empty(0)
        strays = shapely.distance(outline, points) > _OWN_FLOOR if room.items else np.zeros(0, dtype=bool)
        hits, homes = tree.query(points, predicate="within") if strays.any() else np.zeros((2, 0), dtype=np.intp)
        found = {int(hit): int(home) for hit, home in zip(hits, homes, strict=True) if strays[hit]}
        moved += [(home, room.items[hit]) for hit, home in sorted(found.items())]
        room.items = [item for number, item in enumerate(room.items) if number not in found]
    for home, item in moved:
        intake.guess("room of a piece that is listed with another room than it stands in")
        rooms[home].items.append(item)
