"""The short scripts and rooms there are: ours, shipped with the package, and the users', in the database."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Final

from planner_service.grounding.room_report import survey
from planner_service.library.script_versions import Added, body_of, changing, replacing
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_library import Features, LibraryError, ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.scripts.script_words import Problem
from planner_service.store.library_store import (
    AbsentError,
    ChangedError,
    FixedError,
    FullError,
    Kept,
    ShelfError,
    TakenError,
)
from scene_graphs.errors import FieldPath
from scene_graphs.graph.script_objects import Offers
from scene_graphs.layout import Layout, LayoutError, layout_from_dict, layout_to_dict, read_layouts
from scene_graphs.layout_library import built_in_index, built_in_layouts
from scene_graphs.retrieval.layout_index import LayoutIndex

if TYPE_CHECKING:
    from sqlalchemy import Connection, Engine

    from planner_service.settings import Settings

__all__ = [
    "AbsentError", "Added", "ChangedError", "FixedError", "FullError", "ShelfError", "Shelves", "TakenError",
    "UnfitError", "open_shelves",
]  # fmt: skip

MAX_ID_LENGTH: Final = 120
_TAKEN_ENDINGS: Final = ("/scene.glb", "/drawing.svg", "/drawing.png")
"""What follows the id of a room in an address."""
_ROOM_ID: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.:-]*(?:/[A-Za-z0-9_][A-Za-z0-9_.:-]*)*")
"""What is the end of an address as it stands."""
MAX_SCRIPTS: Final = 100_000
"""Short scripts of the users': all are compared with every query."""
RESERVED: Final = frozenset({"search", "export", "extract"})
"""Paths of their own beside /v1/short-scripts/{id}, so no script can be called that."""
MAX_LAYOUTS: Final = 5_000
"""Rooms of the users': all are kept in memory, and a graph is made of each."""


class UnfitError(LibraryError):
    """A short script cannot be acted out, whatever is repaired; `problems` name its fields."""

    def __init__(self, script: ShortScript, problems: tuple[Problem, ...]) -> None:
        first = problems[0]
        super().__init__(f"{script.id}: keyframes.{first.keyframe}.{first.field}: {first.fault}")
        self.script, self.problems = script, problems


@dataclass(frozen=True)
class _Room:
    """A room, and what its objects can really be used for where that was found out."""

    layout: Layout
    usable: Offers = field(default_factory=dict)


@dataclass
class _Floor:
    """All rooms at one moment, and their index once it was asked for."""

    rooms: Mapping[str, _Room]
    layouts: Mapping[str, Layout]
    index: LayoutIndex | None = None


class Shelves:
    """Scripts and rooms, loaded on first use and read again when another process or thread has changed them.

    What it hands out never changes, so that a request sees one library from its beginning to its end. Without a
    database there are only ours and the rooms of `layouts_file`.
    """

    def __init__(
        self, engine: Engine | None = None, cache: Path | None = None, layouts_file: Path | None = None
    ) -> None:
        self.engine = engine
        self.layouts_file = layouts_file
        self._features = Features(cache=cache)
        self._scripts = Kept(engine, "short_scripts", _read_script, lambda: {one.id: one for one in built_in()})
        self._rooms = Kept(engine, "layouts", _read_room, self._fixed_rooms)
        self._library: tuple[Mapping[str, ShortScript], ScriptLibrary] | None = None
        self._floor: _Floor | None = None
        self._known: LayoutIndex | None = None
        self._lock = RLock()

    def scripts(self) -> ScriptLibrary:
        """The short scripts as they are now, ours first."""
        scripts = self._scripts.now()
        with self._lock:
            if self._library is None or self._library[0] is not scripts:
                self._library = scripts, ScriptLibrary(scripts.values(), self._features)
            return self._library[1]

    def rooms(self) -> Mapping[str, Layout]:
        """The rooms as they are now, by id; quicker than `layouts`, where none is to be searched for."""
        return self._floor_now().layouts

    def layouts(self) -> LayoutIndex:
        """The rooms as they are now, ready to be searched."""
        floor = self._floor_now()
        with self._lock:
            if floor.index is None:
                usable = {name: room.usable for name, room in floor.rooms.items() if room.usable}
                known = self._known or built_in_index()
                floor.index = LayoutIndex(tuple(floor.layouts.values()), known=known, usable=usable)
                self._known = floor.index
            return floor.index

    def _floor_now(self) -> _Floor:
        rooms = self._rooms.now()
        with self._lock:
            if self._floor is None or self._floor.rooms is not rooms:
                self._floor = _Floor(rooms, {name: room.layout for name, room in rooms.items()})
            return self._floor

    def add_scripts(self, *scripts: ShortScript, replace: bool = False, within: Connection | None = None) -> Added:
        """Keep scripts, all or none of them; they are in the database before this returns.

        UnfitError when a furniture word or emotion is not known, TakenError when an id is taken, FullError. To
        `replace` keeps a user's script of that id as the next version; FixedError for one of ours. New ones may be
        written `within` a transaction, and are there when it ends well.
        """
        added = Added()
        _fit(scripts)
        if replace:
            ours = self._scripts.fixed
            renewals = {one.id: replacing(one, ours, partial(_read_script, one.id), added) for one in scripts}
            self._scripts.renew(renewals, MAX_SCRIPTS, "short script")
            return added
        for script in scripts:
            if script.id in self._scripts.fixed:
                raise _taken(script.id)
        self._scripts.put({one.id: {"body": body_of(one)} for one in scripts}, MAX_SCRIPTS, "short script", within)
        added.new.extend(script.id for script in scripts)
        return added

    def change_script(self, script: ShortScript) -> ShortScript:
        """Keep a user's script again, as the version after the one it names. Gives it with its new version.

        UnfitError, AbsentError, FixedError for one of ours, ChangedError when somebody else changed it meanwhile.
        """
        _fit((script,))
        renewal = changing(script, self._scripts.fixed, partial(_read_script, script.id))
        self._scripts.renew({script.id: renewal}, MAX_SCRIPTS, "short script")
        return self.scripts().get(script.id)

    def script_versions(self, script_id: str) -> tuple[ShortScript, ...]:
        """A script as it was and is, the oldest version that is kept first. AbsentError."""
        script = self.scripts().find(script_id)
        if script is None:
            raise AbsentError(f"there is no short script {script_id!r}")
        if self.engine is None:
            return (script,)
        from planner_service.store.library_store import versions_of

        older = [_read_script(script_id, body) for body in versions_of(self.engine, script_id)]
        return (*(one for one in older if one.version < script.version), script)

    def script_version(self, script_id: str, version: int) -> ShortScript:
        """A script as it was at that version. AbsentError names the versions that can be read."""
        versions = {script.version: script for script in self.script_versions(script_id)}
        if version not in versions:
            told = ", ".join(map(str, versions))
            raise AbsentError(f"there is no version {version} of {script_id!r}", f"there are {told}", at="version")
        return versions[version]

    def remove_script(self, script_id: str) -> None:
        """Remove a script of the users' and all its versions. FixedError for one of ours, AbsentError if there is none
        of that id."""
        self._scripts.take(script_id, "short script")

    def add_layouts(self, *layouts: Layout) -> None:
        """Keep rooms, all or none of them. TakenError when an id is taken, ShelfError for one that is no path,
        FullError."""
        rows: dict[str, dict[str, str]] = {}
        for layout in layouts:
            if (
                not _ROOM_ID.fullmatch(layout.id)
                or len(layout.id) > MAX_ID_LENGTH
                or layout.id.endswith(_TAKEN_ENDINGS)
            ):
                like = "letters, digits and _.:- between slashes, such as my-house/kitchen"
                raise ShelfError(
                    f"{layout.id!r:.80} is no id of a room", f"use at most {MAX_ID_LENGTH} {like}", at="id"
                )
            if layout.id in self._rooms.fixed or layout.id in rows:
                raise TakenError(f"there is a room {layout.id!r} already", "choose another id", at="id")
            usable = {name: sorted(found) for name, found in survey(layout).usable.items()}
            whole = {"layout": layout_to_dict(layout), "usable": usable}
            body = json.dumps(whole, separators=(",", ":"), allow_nan=False)
            rows[layout.id] = {"body": body, "room_type": layout.room_type}
        self._rooms.put(rows, MAX_LAYOUTS, "room")

    def remove_layout(self, layout_id: str) -> None:
        """Remove a room of the users'; stories keep their own copy. FixedError for one of ours, AbsentError."""
        self._rooms.take(layout_id, "room")

    def is_fixed_script(self, script: ShortScript) -> bool:
        """Whether a script is ours."""
        return self._scripts.fixed.get(script.id) is script

    def is_fixed_room(self, layout: Layout) -> bool:
        """Whether a room is ours."""
        return self._ours.get(layout.id) is layout

    @cached_property
    def _ours(self) -> Mapping[str, Layout]:
        return {layout.id: layout for layout in built_in_layouts()}

    def _fixed_rooms(self) -> dict[str, _Room]:
        fixed = dict(self._ours)
        for layout in read_layouts(self.layouts_file) if self.layouts_file else ():
            if layout.id in fixed:
                raise LayoutError(
                    f"{self.layouts_file}: {layout.id!r} is the id of a built-in room", "choose another id"
                )
            fixed[layout.id] = layout
        return {name: _Room(layout) for name, layout in fixed.items()}


def open_shelves(settings: Settings, *, writes: bool = False) -> Shelves:
    """The shelves of a command, on the database that the service has. SettingsError when it cannot be opened.

    Where there is no database yet it is made only if the command `writes`: a story can be told from our library
    though nothing can be written beside it.
    """
    engine = None
    if writes or settings.database_url or settings.database_file.exists():
        from planner_service.store.database import database_url, open_engine

        engine = open_engine(database_url(settings))
    return Shelves(engine, settings.cache_dir, settings.layouts)


def _fit(scripts: Iterable[ShortScript]) -> None:
    """UnfitError for what cannot be acted out; ids that are used twice or that are paths are refused."""
    ids: set[str] = set()
    for script in scripts:
        if script.id in RESERVED:
            raise ShelfError(f"{script.id!r} is a path of its own", "choose another id", at="id")
        if script.id in ids:
            raise _taken(script.id)
        ids.add(script.id)
        # Missing walks and risings are put in when a story is composed.
        if problems := tuple(problem for problem in check(script) if problem.field != "skill"):
            raise UnfitError(script, problems)


def _taken(script_id: str) -> TakenError:
    return TakenError(f"there is a short script {script_id!r} already", "choose another id", at="id")


def _read_script(script_id: str, body: str) -> ShortScript:
    try:
        return ShortScript.model_validate_json(body)
    except ValueError as error:
        raise LibraryError(f"short script {script_id!r} cannot be read: {error}", at="database") from error


def _read_room(layout_id: str, body: str) -> _Room:
    row = json.loads(body)
    usable = {name: frozenset(found) for name, found in row["usable"].items()}
    return _Room(layout_from_dict(row["layout"], FieldPath((f"database: room {layout_id!r}",))), usable)
