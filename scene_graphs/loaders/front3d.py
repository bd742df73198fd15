"""3D-FRONT: one house a file, its rooms, their floors from meshes, furniture from 3D-FUTURE, doors and windows.

Its frame is ours: right-handed, Y up, metres, front +Z.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from scene_graphs.fields import LayoutError
from scene_graphs.furniture import canonical, class_of
from scene_graphs.layouts import Layout, Point2
from scene_graphs.loaders.floors import floor_from_triangles
from scene_graphs.loaders.front3d_house import House, HouseRoom, Item
from scene_graphs.loaders.future3d import Models
from scene_graphs.loaders.gaps import Gap, gaps_of_rooms
from scene_graphs.loaders.intake import Intake, RoomIntake
from scene_graphs.loaders.naming import rooms_served
from scene_graphs.loaders.sizing import exact_category
from scene_graphs.loaders.source import Source

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
    types = named or [slug if slug not in ("", "none") else intake.options.room_type or "other_room"]
    categories = {canonical(item.model.word) for item in room.items}
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
