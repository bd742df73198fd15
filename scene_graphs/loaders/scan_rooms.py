"""Rooms out of 3D scans: labelled boxes without fronts, doors among them, floors at any height, legs not scanned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from scene_graphs.furniture import canonical, canonical_room, class_of
from scene_graphs.layout import Layout, Placed, Point2
from scene_graphs.loaders.doors_and_windows import distinct, gap_around, gaps_of_rooms
from scene_graphs.loaders.floor_polygon import floor_around
from scene_graphs.loaders.front_direction import faced
from scene_graphs.loaders.furniture_names import exact_category, likely_room, rooms_served
from scene_graphs.loaders.plan_boxes import UprightBox
from scene_graphs.loaders.room_builder import Intake, RoomIntake

MAX_THINGS: Final = 5_000
"""Labelled things of one scan; a room has some tens."""
_WORDS: Final = {
    "sidecouch": "sofa",
    "sofa chair": "armchair",
    "commode": "dresser",
    "couch table": "coffee_table",
    "loft bed": "bunk_bed",
    "bean bag chair": "lazy_sofa",
    "beanbag chair": "lazy_sofa",
    "cushion": "pillow",
    "couch cushions": "pillow",
    "stack of chairs": "stack_of_chairs",
}
"""Labels of scans whose last word says less than the whole, or that are no words of scripts."""
_DOORS, _WINDOWS = ("door", "doors", "doorframe", "door frame", "doorway"), ("window", "windows", "windowframe")
_ON_FLOOR: Final = frozenset({"seat", "sofa", "bed", "table", "closet"})
_LEGS: Final = 0.5
"""The box of a piece that stands on the floor may begin this high, in metres: thin legs are not scanned."""
_FLUSH: Final = 0.1
"""Anything else this near to the floor stands on it."""
_RAISED: Final = 0.15
"""What begins this much above another's bottom, over it and no higher than its top, rests on it."""


@dataclass(frozen=True)
class Thing:
    """One labelled thing of a scan."""

    name: str
    label: str
    box: UprightBox


@dataclass(frozen=True)
class Scan:
    """One scanned room, Y up."""

    id: str
    room_type: str | None
    """None where nobody says: it is told from the furniture."""
    things: Sequence[Thing]
    floor: Sequence[Point2] | None
    level: float
    """Height of the floor."""
    source: str
    licence: str


def category_of(label: str) -> str:
    """The category or kind a scan's label means."""
    return _WORDS.get(label.strip().lower()) or canonical(label)


def room_of_scan(scan: Scan, intake: Intake) -> Layout | None:
    """The room: legs reach the floor, small things have what they rest on as parents, fronts are guessed."""
    room = intake.room(scan.id, "room", scan.floor, source=scan.source, licence=scan.licence)
    for thing in scan.things[:MAX_THINGS]:
        _add(room, thing, scan.level)
    for thing in scan.things[MAX_THINGS:]:
        intake.drop(f"a scan has at most {MAX_THINGS} things", thing.name)
    if room.objects:
        floor = scan.floor if scan.floor is not None else floor_around(room.objects)
        room.objects = faced(_parented(room.objects), floor, {placed.id for placed in room.objects})
        for _ in room.objects:
            intake.guess("front")
        _add_gaps(room, scan, floor)
    categories = [placed.category for placed in room.objects]
    if scan.room_type is None:
        intake.guess("type of the room")
    room_type = canonical_room(scan.room_type) if scan.room_type else likely_room("", categories)
    room.tags = rooms_served(room_type, categories)
    return room.finish()


def _add(room: RoomIntake, thing: Thing, level: float) -> None:
    if thing.label.strip().lower() in (*_DOORS, *_WINDOWS):
        return
    (x, low, z), (w, h, d), yaw = thing.box
    bottom = low - level
    category = category_of(thing.label)
    if abs(bottom) < (_LEGS if class_of(category) in _ON_FLOOR else _FLUSH):
        bottom, h = 0.0, h + bottom
    room.add(thing.name, exact_category(category, (w, h, d), bottom), (x, bottom, z), (w, h, d), yaw)


def _parented(objects: Sequence[Placed]) -> list[Placed]:
    """Every object with what it rests on, the smallest such thing."""
    prints = np.array([shapely.Polygon(placed.footprint) for placed in objects], dtype=object)
    areas = shapely.area(prints)
    middles = shapely.points([(placed.position[0], placed.position[2]) for placed in objects])
    tops, bottoms = np.array([o.top for o in objects]), np.array([o.position[1] for o in objects])
    parents: dict[int, int] = {}
    for small, big in zip(*shapely.STRtree(prints).query(middles, predicate="within"), strict=True):
        rests = bottoms[big] + _RAISED < bottoms[small] <= tops[big] + _FLUSH and areas[small] < areas[big] / 2
        if rests and (small not in parents or areas[big] < areas[parents[small]]):
            parents[int(small)] = int(big)
    # Parents come first, as a smaller thing always rests on a larger one.
    order = sorted(range(len(objects)), key=lambda number: (-areas[number], number))
    return [
        replace(objects[number], parent=objects[parents[number]].id if number in parents else None) for number in order
    ]


def _add_gaps(room: RoomIntake, scan: Scan, floor: Sequence[Point2]) -> None:
    found = []
    for thing in scan.things[:MAX_THINGS]:
        label = thing.label.strip().lower()
        if label in _DOORS or label in _WINDOWS:
            gap = gap_around(thing.box.corners, label in _DOORS)
            found += [gap] if gap is not None else []
    room.open(gaps_of_rooms(distinct(found), [floor])[0], scan.level)
