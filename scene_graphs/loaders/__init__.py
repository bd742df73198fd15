"""Readers of other people's scenes: each turns one format into layouts and says what it kept, dropped and guessed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Final

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Layout
from scene_graphs.loaders.room_builder import Intake, Report
from scene_graphs.loaders.scene_source import Options, Source

__all__ = ["FORMATS", "Imported", "Options", "Report", "Source", "read_scene"]

Reader = Callable[[Source, Intake], list[Layout]]
_READERS: Final = {
    "native": "layout_json:read_native",
    "3d-front": "front3d:read_front3d",
    "procthor": "procthor:read_procthor",
    "virtualhome": "virtualhome:read_virtualhome",
    "3dssg": "threedssg:read_3dssg",
    "scannet": "scannet:read_scannet",
    "glb": "mesh_scene:read_glb",
    "obj": "mesh_scene:read_obj",
}
FORMATS: Final = tuple(_READERS)


@dataclass(frozen=True)
class Imported:
    """The rooms of a file, and the report."""

    layouts: tuple[Layout, ...]
    report: Report


def read_scene(source: Source | str | Path, format_name: str, options: Options | None = None) -> Imported:
    """Read all rooms of a file or folder that is written in one of `FORMATS`.

    LayoutError if it cannot be read at all, is of another format, or holds no usable room: the text says why.
    """
    if format_name not in _READERS:
        raise LayoutError(f"format must be one of {', '.join(FORMATS)}, got {format_name!r:.60}")
    opened = source if isinstance(source, Source) else Source.of_path(source)
    intake = Intake(options)
    layouts = _reader(format_name)(opened, intake)
    if not layouts:
        told = "; ".join(intake.report.lines()[1:]) or f"nothing in it is a room in the format {format_name}"
        other = "; if it is of another format, say so (--format)" if format_name == "native" else ""
        raise LayoutError(f"{opened.name} holds no room that can be used: {told}{other}")
    return Imported(tuple(_apart(layouts)), intake.report)


def _apart(layouts: list[Layout]) -> Iterator[Layout]:
    """The rooms with an id each: those that share one in their file get a number."""
    taken: set[str] = set()
    for layout in layouts:
        name, number = layout.id, 2
        while name in taken:
            name, number = f"{layout.id}-{number}", number + 1
        taken.add(name)
        yield layout if name == layout.id else replace(layout, id=name)


def _reader(format_name: str) -> Reader:
    module, _, name = _READERS[format_name].partition(":")
    reader: Reader = getattr(import_module(f"scene_graphs.loaders.{module}"), name)
    return reader
