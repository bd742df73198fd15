"""Furniture, graphs, rooms, homes and the ways through them. Imports nothing of ours.

What a program needs that works with rooms stands here by name; everything is loaded when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scene_graphs.errors import UserError
    from scene_graphs.furniture import Furniture
    from scene_graphs.generation.generate_room import generate_room
    from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
    from scene_graphs.home import Home, home_from_layouts
    from scene_graphs.layout import Layout, Placed, read_layouts, write_layouts
    from scene_graphs.layout_library import built_in_index, built_in_layouts
    from scene_graphs.loaders import read_scene
    from scene_graphs.retrieval.layout_index import LayoutIndex

__all__ = [
    "Furniture",
    "FurnitureGraph",
    "Home",
    "Layout",
    "LayoutIndex",
    "Placed",
    "UserError",
    "built_in_index",
    "built_in_layouts",
    "generate_room",
    "graph_from_layout",
    "home_from_layouts",
    "read_layouts",
    "read_scene",
    "write_layouts",
]
_ROOMS = {
    "Furniture": "furniture",
    "FurnitureGraph": "graph.furniture_graph",
    "Home": "home",
    "Layout": "layout",
    "LayoutIndex": "retrieval.layout_index",
    "Placed": "layout",
    "UserError": "errors",
    "built_in_index": "layout_library",
    "built_in_layouts": "layout_library",
    "generate_room": "generation.generate_room",
    "graph_from_layout": "graph.furniture_graph",
    "home_from_layouts": "home",
    "read_layouts": "layout",
    "read_scene": "loaders",
    "write_layouts": "layout",
}
"""Where each of them is defined, below this package."""


def __getattr__(name: str) -> object:
    """One of `__all__`, loaded with the module that defines it."""
    if name not in _ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_ROOMS[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
