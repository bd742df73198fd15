"""Rooms named on the command line: files of the user's or ids of the library."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from planner_service.stories import Studio
from scene_graphs.layouts import Layout, LayoutError, read_layouts


def chosen_layouts(names: Sequence[str], studio: Studio) -> tuple[Layout, ...]:
    """The layouts that paths and ids stand for, in order. Raises LayoutError."""
    if len(names) > 4:
        raise LayoutError(f"--layout: a home has one to four rooms, {len(names)} were given")
    found: list[Layout] = []
    for name in names:
        if Path(name).is_file():
            found.extend(read_layouts(Path(name)))
            continue
        matching = [layout for layout in studio.layouts if layout.id == name]
        if not matching:
            raise LayoutError(f"--layout: {name!r} is neither a file nor the id of a layout; see `sims layouts list`")
        found.extend(matching)
    if len(found) > 4:
        raise LayoutError(f"--layout: a home has one to four rooms, the files hold {len(found)}")
    return tuple(found)
