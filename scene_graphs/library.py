"""The rooms that are shipped with the package."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import as_file, files

from scene_graphs.layouts import Layout, read_layouts

COUNT, SEED = 400, 0
"""What `generate_library` was asked for to make the shipped file."""


@lru_cache(maxsize=1)
def built_in_layouts() -> tuple[Layout, ...]:
    """The 400 procedural rooms of `scene_graphs/data/rooms.jsonl.gz`, a hundred of every room type in turn."""
    with as_file(files("scene_graphs") / "data" / "rooms.jsonl.gz") as path:
        return tuple(read_layouts(path))
