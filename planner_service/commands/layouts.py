"""`sims layouts list|draw|import|remove|generate`: the library of rooms."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from planner_service.commands.errors import writing_database
from planner_service.commands.rooms import LARGEST_FILE, chosen_layouts
from planner_service.settings import read_settings
from planner_service.shelves import open_shelves
from planner_service.stories import RequestError
from planner_service.surveying import survey
from scene_graphs.furniture import ROOM_TYPES
from scene_graphs.layouts import Layout, LayoutError, read_layouts, write_layouts

app = typer.Typer(no_args_is_help=True, help="List, draw, import and generate furnished rooms.")
ENDINGS = (".json", ".jsonl", ".json.gz", ".jsonl.gz")
MOST_DRAWN = 400
"""Pictures of one command."""


@app.command("list")
def list_layouts(room: Annotated[str | None, typer.Option(help="Only rooms of this type.")] = None) -> None:
    """Show the rooms a story can play in."""
    if room is not None and room not in ROOM_TYPES:
        raise RequestError(f"--room: {room!r} is none of {', '.join(ROOM_TYPES)}")
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("id", "room type", "objects"):
        table.add_column(column)
    rooms = open_shelves(read_settings()).rooms()
    chosen = [layout for layout in rooms.values() if room is None or layout.room_type == room]
    for layout in chosen:
        counts = Counter(placed.category for placed in layout.objects)
        words = [f"{count} {category}" if count > 1 else category for category, count in counts.items()]
        table.add_row(layout.id, layout.room_type, ", ".join(words))
    console = Console(markup=False)
    console.print(table)
    console.print(f"{len(chosen)} rooms", highlight=False)


@app.command("import")
def import_layouts(file: Annotated[Path, typer.Argument(help="Rooms: .json, .jsonl, either with .gz behind.")]) -> None:
    """Check rooms and add them to your library; one that cannot be read adds none."""
    layouts = read_layouts(file, LARGEST_FILE)
    if not layouts:
        raise LayoutError(f"{file.name} holds no room; `sims layouts generate` writes such files")
    shelves = open_shelves(read_settings(), writes=True)
    with writing_database():
        shelves.add_layouts(*layouts)
    console = Console(markup=False)
    for layout in layouts:
        problems = survey(layout).problems
        console.print(f"{layout.id}: {f'{len(problems)} problems' if problems else 'all can be used'}", highlight=False)
        for problem in problems:
            console.print(f"  {problem}", highlight=False)
    console.print(f"added {len(layouts)}; the library has {len(shelves.rooms())} rooms", highlight=False)


@app.command()
def remove(layout_id: Annotated[str, typer.Argument(help="The id of a room you added.")]) -> None:
    """Remove a room from your library; stories that play there keep their own copy."""
    shelves = open_shelves(read_settings())
    with writing_database():
        shelves.remove_layout(layout_id)
    console = Console(markup=False)
    console.print(f"removed {layout_id}; the library has {len(shelves.rooms())} rooms", highlight=False)


@app.command()
def draw(
    names: Annotated[list[str], typer.Argument(help="Layout files or ids.")],
    out: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path("out/layouts"),
) -> None:
    """Draw rooms from above."""
    from planner_service.filing import Writer, check_writable, write_files
    from scene_graphs.drawing import draw_layout

    layouts = chosen_layouts(names, open_shelves(read_settings()), "NAMES", most=MOST_DRAWN)
    drawings: dict[str, Writer] = {}
    for layout in layouts:
        name = _file_name(layout.id)
        name += f"-{len(drawings)}" if f"{name}.png" in drawings else ""
        drawings[f"{name}.png"] = partial(_draw_to, draw_layout, layout)
    check_writable(out, drawings)
    for path in write_files(out, drawings):
        Console(markup=False).print(str(path), highlight=False)


def _draw_to(draw_layout: Callable[..., object], layout: Layout, path: Path) -> None:
    draw_layout(layout, path=path)


def _file_name(layout_id: str) -> str:
    """A room's id as the name of a file, whatever is in it."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", layout_id).lstrip(".")[:80] or "room"


@app.command()
def generate(
    count: Annotated[int, typer.Option(min=1, max=100_000, help="How many rooms.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same rooms.")] = 0,
    out: Annotated[Path, typer.Option(help="File to write: .json, .jsonl or .jsonl.gz.")] = Path("out/rooms.jsonl"),
) -> None:
    """Generate furnished rooms, the four types in turn."""
    from planner_service.filing import check_writable, write_files
    from scene_graphs.generating import generate_library

    if not out.name.endswith(ENDINGS):
        raise RequestError(f"--out: {out} must end in one of {', '.join(ENDINGS)}, or no reader knows what it is")
    check_writable(out.parent, [out.name])
    layouts = generate_library(count, seed)
    write_files(out.parent, {out.name: lambda path: write_layouts(path, layouts)})
    Console(markup=False).print(f"{len(layouts)} rooms written to {out}", highlight=False)
