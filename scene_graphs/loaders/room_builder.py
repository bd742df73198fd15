"""What comes in from a scene file: rooms built piece by piece, and a report of what was kept, dropped and guessed."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Final

import shapely

from scene_graphs.errors import FieldPath
from scene_graphs.furniture import canonical, canonical_room
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError
from scene_graphs.layout import (
    MAX_OBJECTS,
    MAX_SIZE,
    MIN_ROOM_HEIGHT,
    MIN_SIZE,
    Layout,
    Opening,
    Placed,
    Point2,
    Segment,
    layout_from_dict,
    layout_to_dict,
    placed_from_row,
    placed_to_row,
)
from scene_graphs.loaders.doors_and_windows import Gap
from scene_graphs.loaders.floor_polygon import floor_around, on_outline
from scene_graphs.loaders.scene_source import Options

EXAMPLES: Final = 3
"""Things that are named for one reason."""


@dataclass
class Report:
    """What was kept, dropped and why; `lines` for a person, `to_dict` for a program."""

    rooms: int = 0
    kept: Counter[str] = field(default_factory=Counter)
    """Objects by category."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Things by the reason they were dropped for."""
    examples: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """For every reason the first few things."""
    guessed: Counter[str] = field(default_factory=Counter)
    """How often a size, front or floor that the file does not give was estimated."""

    def drop(self, why: str, what: str = "") -> None:
        """Count something that is left out; `what` names it."""
        self.dropped[why] += 1
        examples, shown = self.examples[why], printable(what)
        if shown and len(examples) < EXAMPLES and shown not in examples:
            examples.append(shown)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "rooms": self.rooms,
            "objects": dict(sorted(self.kept.items())),
            "dropped": [
                {"why": why, "count": count, "examples": self.examples[why]} for why, count in _ranked(self.dropped)
            ],
            "estimated": dict(sorted(self.guessed.items())),
        }

    def lines(self) -> list[str]:
        """A few sentences."""
        kinds = ", ".join(f"{count} {category}" for category, count in _ranked(self.kept))
        rooms = "1 room" if self.rooms == 1 else f"{self.rooms} rooms"
        lines = [f"kept {rooms} with {self.kept.total()} objects" + (f": {kinds}" if kinds else "")]
        for why, count in _ranked(self.dropped):
            examples = self.examples[why]
            lines.append(f"dropped {count}: {why}" + (f" ({', '.join(examples)})" if examples else ""))
        lines += [f"estimated {count}: {what}" for what, count in _ranked(self.guessed)]
        return lines


def printable(text: str) -> str:
    """A name of somebody else's, short and on one line."""
    return "".join(letter if letter.isprintable() else " " for letter in text[:160]).strip()


def _ranked(counts: Counter[str]) -> list[tuple[str, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))


MAX_DOORS: Final = 100
MAX_ADDED: Final = 2 * MAX_OBJECTS
"""Objects of one room that are looked at; of these the largest stay."""
OUTSIDE: Final = 0.3
"""What stands with its centre farther outside its room, in metres, is dropped."""
STRUCTURE: Final = frozenset(
    (
        *("wall", "walls", "wall_inner", "wall_outer", "baseboard", "floor", "ceiling", "room", "stairs", "railing"),
        *("door", "doors", "doorframe", "doorjamb", "doorway", "window", "windows", "windowsill"),
        *("pillar", "column", "beam"),
    )
)
"""Words for what a room is made of; it is no furniture."""
_CROWDED: Final = f"a room holds at most {MAX_OBJECTS} objects, the smallest go"
_FELL: Final = "what it stands on was dropped"
_MAX_WORD_LENGTH: Final = 60


class Intake:
    """One file being read: hands out rooms to be filled and keeps the report."""

    def __init__(self, options: Options | None = None) -> None:
        self.options = options or Options()
        self.report = Report()
        self._rooms = 0

    def count_rooms(self, more: int, name: str) -> None:
        """LayoutError when a file has more rooms than may be read."""
        self._rooms += more
        if self._rooms > self.options.most_rooms:
            raise LayoutError(
                f"{name} holds more than {self.options.most_rooms} rooms",
                "split it, or of ProcTHOR's houses name some by their numbers (scan 0-99)",
            )

    def drop(self, why: str, what: str = "") -> None:
        """Count something that is left out; `what` names it."""
        self.report.drop(why, what)

    def guess(self, what: str) -> None:
        """Count something that was estimated: "size", "front", "floor", "height"."""
        self.report.guessed[what] += 1

    def room(
        self,
        room_id: str,
        room_type: str,
        floor: Sequence[Point2] | None,
        *,
        source: str,
        licence: str = "unknown",
        height: float | None = None,
        tags: Iterable[str] = (),
    ) -> RoomIntake:
        """A room to fill. `floor` is its outline in [x, z], either winding; None to put it around its objects."""
        tag_words = tuple(dict.fromkeys(canonical_room(word) for word in (room_type, *tags)))
        return RoomIntake(self, slug_id(room_id), tag_words, floor, source, licence, height)


class RoomIntake:
    """A room being filled. Nothing that is added can spoil it: what is not valid is dropped and counted."""

    def __init__(
        self,
        intake: Intake,
        room_id: str,
        tags: tuple[str, ...],
        floor: Sequence[Point2] | None,
        source: str,
        licence: str,
        height: float | None,
    ) -> None:
        self.intake, self.id, self.tags, self.floor = intake, room_id, tags, floor
        self.source, self.licence, self.height = source, licence, height
        self.objects: list[Placed] = []
        self.doors: list[Opening] = []
        self.windows: list[Opening] = []
        self._ids: set[str] = set()
        self._again: Counter[str] = Counter()

    def add(
        self,
        object_id: str,
        word: str,
        position: Sequence[float],
        size: Sequence[float],
        yaw: float = 0.0,
        parent: str | None = None,
        **more: Any,
    ) -> Placed | None:
        """Add an object by the source's own word for it; `more` are further fields of `Placed`, such as its shape.

        None if it was dropped: structure, no word, a size that is zero, negative, too large or not a number, a place
        that is none. A taken id gets a number; a parent must have been added before.
        """
        category = self._category(word)
        if category is None:
            return None
        if (fault := _fault(position, size, yaw)) is not None:
            self.intake.drop(fault, f"{object_id}")
            return None
        if len(self.objects) >= MAX_ADDED:
            self.intake.drop(_CROWDED, f"{object_id}")
            return None
        x, y, z, w, h, d = (float(value) for value in (*position, *size))
        name = self._new_id(object_id)
        known = parent if parent in self._ids and parent != name else None
        placed = Placed(name, category, (x, y, z), (w, h, d), float(yaw), known, **more)
        self.objects.append(placed)
        self._ids.add(name)
        return placed

    def door(self, segment: Segment, bottom: float = 0.0, top: float = 2.05) -> None:
        """Add a doorway; its ends are moved onto the outline when the room is finished."""
        self.doors.append(Opening(segment, bottom, top))

    def window(self, segment: Segment, bottom: float = 0.9, top: float = 2.1) -> None:
        """Add a window, likewise."""
        self.windows.append(Opening(segment, bottom, top))

    def open(self, gaps: Iterable[Gap], level: float = 0.0) -> None:
        """Add the doors and windows of a house or scan whose floor lies at `level`."""
        for gap in gaps:
            add = self.door if gap.is_door else self.window
            add(gap.segment, max(0.0, gap.bottom - level), gap.top - level)

    def finish(self) -> Layout | None:
        """The room, if it is one; counted in the report. None, with the reason there, if it cannot be used."""
        floor = self._floor()
        if floor is None:
            return None
        objects = self._bounded(self._valid(self._inside(floor)))
        if not objects:
            self._room_dropped("a room without furniture")
            return None
        height = self.height
        if height is None or not _is_number(height) or not MIN_ROOM_HEIGHT <= height <= MAX_SIZE:
            self.intake.guess("height of the room")
            height = 2.6
        layout = Layout(
            id=self.id,
            room_type=self.tags[0],
            floor_polygon=tuple(floor),
            height=float(height),
            doors=self._openings(self.doors, floor, "door"),
            windows=self._openings(self.windows, floor, "window"),
            objects=tuple(objects),
            tags=self.tags,
            source=self.source,
            licence=self.licence,
        )
        try:
            layout = layout_from_dict(layout_to_dict(layout), FieldPath((self.id,)))
        except LayoutError as error:
            self._room_dropped("a room that is not valid", f"{error}")
            return None
        self.intake.report.rooms += 1
        self.intake.report.kept.update(placed.category for placed in layout.objects)
        return layout

    def _category(self, word: str) -> str | None:
        text = word.strip() if isinstance(word, str) else ""
        if not text or len(text) > _MAX_WORD_LENGTH or not text.isprintable():
            self.intake.drop("it has no name that says what it is", text[:_MAX_WORD_LENGTH])
            return None
        category = canonical(text)
        if category in STRUCTURE or not category:
            self.intake.drop("it is part of the building, not furniture", text)
            return None
        return category

    def _room_dropped(self, why: str, what: str | None = None) -> None:
        self.intake.drop(why, what or self.id)

    def _new_id(self, object_id: str) -> str:
        name = printable(str(object_id))[:100] or "object"
        unique = name
        while unique in self._ids:
            self._again[name] += 1
            unique = f"{name}#{1 + self._again[name]}"
        return unique

    def _floor(self) -> list[Point2] | None:
        """The outline given, if it is one; else one around the objects."""
        if self.floor is not None:
            corners = [(float(x), float(z)) for x, z in self.floor if _is_number(x) and _is_number(z)]
            polygon = shapely.Polygon(corners) if len(corners) >= 3 else None
            if polygon is not None and polygon.is_valid and polygon.area >= 0.5:
                return corners
        if not self.objects:
            self._room_dropped("a room without floor and furniture")
            return None
        self.intake.guess("floor")
        return floor_around(self.objects)

    def _inside(self, floor: Sequence[Point2]) -> list[Placed]:
        """The objects whose centre is on the floor or nearly; what stood on those that go, goes too."""
        polygon = shapely.Polygon(floor)
        shapely.prepare(polygon)
        kept: list[Placed] = []
        names: set[str] = set()
        for placed in self.objects:
            away = polygon.distance(shapely.Point(placed.position[0], placed.position[2]))
            if away > OUTSIDE or (placed.parent is not None and placed.parent not in names):
                self.intake.drop("it stands outside its room", placed.id)
                continue
            kept.append(placed)
            names.add(placed.id)
        return kept

    def _valid(self, objects: list[Placed]) -> list[Placed]:
        """The objects without those that no file of rooms could hold, such as one whose shape leaves its box."""
        kept: dict[str, Placed] = {}
        for placed in objects:
            try:
                placed_from_row(placed_to_row(placed), FieldPath((placed.id,)))
            except LayoutError as error:
                self.intake.drop("it is no valid object", str(error))
                continue
            if placed.parent is not None and placed.parent not in kept:
                self.intake.drop(_FELL, placed.id)
                continue
            kept[placed.id] = placed
        return list(kept.values())

    def _bounded(self, objects: list[Placed]) -> list[Placed]:
        """At most as many as a room can hold: small things go first."""
        if len(objects) <= MAX_OBJECTS:
            return objects
        by_size = sorted(objects, key=lambda o: (o.parent is None, o.size[0] * o.size[1] * o.size[2]), reverse=True)
        names = {placed.id for placed in by_size[:MAX_OBJECTS]}
        for placed in by_size[MAX_OBJECTS:]:
            self.intake.drop(_CROWDED, placed.id)
        kept = []
        for placed in (one for one in objects if one.id in names):
            if placed.parent is None or placed.parent in names:
                kept.append(placed)
            else:
                self.intake.drop(_FELL, placed.id)
        return kept

    def _openings(self, openings: Sequence[Opening], floor: Sequence[Point2], what: str) -> tuple[Opening, ...]:
        found = []
        for _ in openings[MAX_DOORS:]:
            self.intake.drop(f"a room has at most {MAX_DOORS} doors and as many windows")
        for opening in openings[:MAX_DOORS]:
            segment = on_outline(opening.segment, floor)
            if segment is None or not (0.0 <= opening.bottom < opening.top <= MAX_SIZE):
                self.intake.drop(f"a {what} that is not in a wall of the room")
                continue
            found.append(Opening(segment, float(opening.bottom), float(opening.top)))
        return tuple(dict.fromkeys(found))


def _fault(position: Sequence[float], size: Sequence[float], yaw: float) -> str | None:
    """Why no object can be there and so large; None if one can."""
    if len(position) != 3 or len(size) != 3 or not all(_is_number(value) for value in (*position, *size, yaw)):
        return "its place or size is not a number"
    if min(size) < MIN_SIZE:
        return "its size is zero or negative"
    if max(size) > MAX_SIZE:
        return f"it is larger than {MAX_SIZE:g} m; is it metres?"
    if max(map(abs, position)) > MAX_COORDINATE or abs(yaw) > 100.0:
        return f"it is farther than {MAX_COORDINATE:g} m away; is it metres?"
    return None


def slug_id(room_id: str) -> str:
    """A room's id in the letters ids may have, at most 120 of them."""
    parts = [re.sub(r"[^A-Za-z0-9_.:-]+", "-", part).strip(".:-") for part in room_id.split("/")]
    return "/".join(part for part in parts if part)[:120].rstrip("/.:-") or "room"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e12 and isfinite(value)
