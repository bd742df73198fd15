"""The rooms that are shipped, and their packed graphs: a search begins without making 400 graphs.

`python -m scene_graphs.layout_library` packs them again, once the rooms have changed.

The rooms that are shipped with the package.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import lru_cache
from importlib.resources import as_file, files
from pathlib import Path

from scene_graphs.graph.furniture_graph import graph_from_layout, graph_from_uses
from scene_graphs.graph.packed_graphs import PackedRooms
from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout, read_layouts
from scene_graphs.retrieval.layout_index import LayoutIndex, pack
from scene_graphs.retrieval.packed_graphs_file import read_packed, write_packed

COUNT, SEED = 400, 0
"""What `generate_library` was asked for to make the shipped file."""


@lru_cache(maxsize=1)
def built_in_layouts() -> tuple[Layout, ...]:
    """The 400 procedural rooms of `scene_graphs/data/rooms.jsonl.gz`, a hundred of every room type in turn."""
    with as_file(files("scene_graphs") / "data" / "rooms.jsonl.gz") as path:
        return tuple(read_layouts(path))


_DATA = files("scene_graphs") / "data"


@lru_cache(maxsize=1)
def built_in_index() -> LayoutIndex:
    """The rooms of `built_in_layouts`, ready to be searched."""
    with as_file(_DATA / "rooms.graphs.npz") as path:
        return index_from(path, built_in_layouts(), _digest())


def index_from(path: Path, layouts: Sequence[Layout], source: bytes) -> LayoutIndex:
    """An index of rooms by the packed graphs in a file; if it was not made of this source, the graphs are made anew."""
    ordered = sorted(layouts, key=lambda layout: layout.id)
    try:
        return LayoutIndex.of_packed(read_packed(path, source), ordered)
    except LayoutError:
        return LayoutIndex(ordered)


def compile_search() -> None:
    """Search once, so that the search is compiled and kept on disk: some seconds on a fresh machine, else one."""
    built_in_index().search(graph_from_uses([("sofa", 1)]), 1)


def packed_library() -> PackedRooms:
    """The graphs of the shipped rooms, made from them."""
    layouts = sorted(built_in_layouts(), key=lambda layout: layout.id)
    return pack([graph_from_layout(layout) for layout in layouts], layouts)


def pack_library() -> None:
    """Make the shipped file of packed graphs again."""
    write_packed(Path(str(_DATA / "rooms.graphs.npz")), packed_library(), _digest())


def _digest() -> bytes:
    return hashlib.sha256((_DATA / "rooms.jsonl.gz").read_bytes()).digest()


if __name__ == "__main__":
    pack_library()
