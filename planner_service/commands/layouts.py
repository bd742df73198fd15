"""`sims layouts list|draw|generate`: the library of rooms."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from planner_service.commands.rooms import chosen_layouts
from planner_service.settings import Settings
from planner_service.stories import Studio
from scene_graphs.furniture import ROOM_TYPES
from scene_graphs.layouts import write_layouts

app = typer.Typer(no_args_is_help=True, help="List, draw and generate furnished rooms.")


def _studio() -> Studio:
    settings = Settings()
    return Studio(settings.scripts_file, settings.cache_dir, settings.layouts)


@app.command("list")
def list_layouts(room: Annotated[str | None, typer.Option(help="Only rooms of this type.")] = None) -> None:
    """Show the rooms a story can play in."""
    if room is not None and room not in ROOM_TYPES:
        raise ValueError(f"--room: {room!r} is none of {', '.join(ROOM_TYPES)}")
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("id", "room type", "objects"):
        table.add_column(column)
    chosen = [layout for layout in _studio().layouts if room is None or layout.room_type == room]
    for layout in chosen:
        counts = Counter(placed.category for placed in layout.objects)
        words = [f"{count} {category}" if count > 1 else category for category, count in counts.items()]
        table.add_row(layout.id, layout.room_type, ", ".join(words))
    console = Console()
    console.print(table)
    console.print(f"{len(chosen)} rooms", highlight=False)


@app.command()
def draw(
    names: Annotated[list[str], typer.Argument(help="Layout files or ids.")],
    out: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path("out/layouts"),
) -> None:
    """Draw rooms from above."""
    from planner_service.filing import check_writable
    from scene_graphs.drawing import draw_layout

    check_writable(out)
    layouts = chosen_layouts(names, _studio())
    out.mkdir(parents=True, exist_ok=True)
    for layout in layouts:
        path = out / f"{layout.id.replace('/', '_')}.png"
        draw_layout(layout, path=path)
        Console().print(str(path), highlight=False)


@app.command()
def generate(
    count: Annotated[int, typer.Option(min=1, max=100_000, help="How many rooms.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same rooms.")] = 0,
    out: Annotated[Path, typer.Option(help="File to write: .json, .jsonl or .jsonl.gz.")] = Path("out/rooms.jsonl"),
) -> None:
    """Generate furnished rooms, the four types in turn."""
    from planner_service.filing import check_writable
    from scene_graphs.generating import generate_library

    check_writable(out.parent)
    layouts = generate_library(count, seed)
    out.parent.mkdir(parents=True, exist_ok=True)
    write_layouts(out, layouts)
    Console().print(f"{len(layouts)} rooms written to {out}", highlight=False)
