"""Rooms named on the command line: files of the user's or ids of the library."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from planner_service.shelves import Shelves
from scene_graphs.homes import MAX_ROOMS
from scene_graphs.layouts import Layout, LayoutError, read_layouts

MAX_FILE_BYTES = 64 << 20
"""Bytes of a user's file of rooms, after unpacking."""


def chosen_layouts(
    names: Sequence[str], shelves: Shelves, field: str = "--layout", most: int = MAX_ROOMS
) -> tuple[Layout, ...]:
    """The layouts that paths and ids stand for, in order, at most `most`; LayoutError names field and remedy."""
    found: list[Layout] = []
    for name in names:
        if _is_file(name):
            rooms = read_layouts(name, MAX_FILE_BYTES)
            if not rooms:
                raise LayoutError(f"{field}: {name} holds no room; `sims layouts generate` writes such files")
            found.extend(rooms)
            continue
        if (known := shelves.rooms().get(name)) is None:
            raise LayoutError(f"{field}: {name!r:.200} is neither a file nor the id of a room; see `sims layouts list`")
        found.append(known)
    if len(found) > most:
        raise LayoutError(f"{field}: at most {most} rooms, {len(found)} were given; leave some out")
    return tuple(found)


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # longer than any path, or not one
        return False
