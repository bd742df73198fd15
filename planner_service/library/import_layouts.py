"""Other people's scenes taken into the library: read, looked over, kept whole or not at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from planner_service.grounding.room_report import survey
from planner_service.store.library_store import TakenError
from scene_graphs.layout import Layout
from scene_graphs.loaders import Imported, Options, Source, read_scene

if TYPE_CHECKING:
    from collections.abc import Callable

    from planner_service.library.library import Shelves


@dataclass(frozen=True)
class Taken:
    """The rooms that came into the library, what was found wrong with each, and what the reader said."""

    imported: Imported
    problems: dict[str, tuple[str, ...]]
    """By the ids of rooms."""


def take_in(
    shelves: Shelves | None,
    source: Source,
    format_name: str,
    options: Options | None = None,
    seen: Callable[[int, int], None] | None = None,
) -> Taken:
    """Read a scene file and add its rooms, all or none of them; without shelves nothing is added.

    `seen` is told how many of how many rooms have been looked over. LayoutError where the file cannot be read or holds
    no room, ShelfError where an id is taken or there are too many.
    """
    imported = read_scene(source, format_name, options)
    rooms: tuple[Layout, ...] = imported.layouts
    known = {} if shelves is None else shelves.rooms()
    if taken := [layout.id for layout in rooms if layout.id in known]:
        raise TakenError(
            f"{source.name}: there is a room {taken[0]!r} already",
            "remove that one first, or choose another id, or another name for a file that has none",
        )
    problems: dict[str, tuple[str, ...]] = {}
    for number, layout in enumerate(rooms, start=1):
        problems[layout.id] = survey(layout).problems
        if seen is not None:
            seen(number, len(rooms))
    if shelves is not None:
        shelves.add_layouts(*rooms)
    return Taken(imported, problems)
