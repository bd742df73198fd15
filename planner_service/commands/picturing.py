"""`sims layouts draw`: rooms from above with their graph, where a body sits, lies and touches, and a way it walks."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.commands.rooms import chosen_layouts
from planner_service.filing import Writer, check_writable, write_files
from planner_service.picturing import Shown, picture
from planner_service.settings import read_settings
from planner_service.shelves import open_shelves
from planner_service.stories import RequestError

MAX_DRAWN = 400
"""Rooms of one command."""
PICTURE_ENDINGS = ("png", "svg")


def draw(
    names: Annotated[list[str], typer.Argument(help="Layout files or ids.")],
    out: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path("out/layouts"),
    formats: Annotated[str, typer.Option("--format", help="png, svg, or both as png,svg.")] = "png,svg",
    graph: Annotated[bool, typer.Option(help="The room's furniture graph.")] = True,
    spots: Annotated[bool, typer.Option(help="Surfaces and standing points.")] = True,
    to: Annotated[str | None, typer.Option(help="The object a path leads to; otherwise a bed or seat.")] = None,
    path: Annotated[bool, typer.Option(help="A path from the door.")] = True,
) -> None:
    """Draw rooms from above: furniture with names, graph, surfaces, standing points and a path."""
    endings = [word.strip().lower() for word in formats.split(",")]
    if not endings or any(word not in PICTURE_ENDINGS for word in endings):
        raise RequestError(f"--format: {formats!r:.40} must be png, svg or png,svg")
    layouts = chosen_layouts(names, open_shelves(read_settings()), "NAMES", most=MAX_DRAWN)
    drawings: dict[str, Writer] = {}
    for layout in layouts:
        if to is not None and all(placed.id != to for placed in layout.objects):
            known = ", ".join(placed.id for placed in layout.objects)
            raise RequestError(f"--to: {layout.id} has no object {to!r:.80}; it has {known}")
        name = file_name(layout.id)
        name += f"-{len(drawings)}" if f"{name}.{endings[0]}" in drawings else ""
        for ending in dict.fromkeys(endings):
            drawings[f"{name}.{ending}"] = partial(picture, layout, Shown(graph, spots, path, to))
    check_writable(out, drawings)
    for written in write_files(out, drawings):
        Console(markup=False).print(str(written), highlight=False, soft_wrap=True)


def file_name(layout_id: str) -> str:
    """A room's id as the name of a file, whatever is in it."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", layout_id).lstrip(".")[:80] or "room"
