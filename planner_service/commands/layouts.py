"""`sims layouts list|find|check|draw|import|remove|generate`: the library of rooms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.commands.checking import check
from planner_service.commands.errors import writing_database
from planner_service.commands.finding import find
from planner_service.commands.picturing import draw
from planner_service.commands.rooms import MAX_FILE_BYTES
from planner_service.commands.tables import plain_table
from planner_service.settings import read_settings
from planner_service.shelves import open_shelves
from planner_service.stories import RequestError
from scene_graphs.furniture import ROOM_TYPES
from scene_graphs.layouts import write_layouts
from scene_graphs.loaders import FORMATS, Options, Source
from scene_graphs.loaders.source import MAX_BYTES

app = typer.Typer(no_args_is_help=True, help="List, draw, check, import and generate furnished rooms.")
for command in (find, check, draw):
    app.command()(command)
UPS, FRONTS = ("y", "z"), ("+z", "-z", "+x", "-x")
ENDINGS = (".json", ".jsonl", ".json.gz", ".jsonl.gz")


@app.command("list")
def list_layouts(room: Annotated[str | None, typer.Option(help="Only rooms of this type.")] = None) -> None:
    """Show the rooms a story can play in."""
    if room is not None and room not in ROOM_TYPES:
        raise RequestError(f"--room: {room!r} is none of {', '.join(ROOM_TYPES)}")
    table = plain_table("id", "room type", "objects")
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
def import_layouts(
    path: Annotated[Path, typer.Argument(help="A scene file, or a folder of files that belong together.")],
    format_name: Annotated[str, typer.Option("--format", help=f"One of {', '.join(FORMATS)}.")] = "native",
    assets: Annotated[
        Path | None, typer.Option(help="procthor: sizes of its models; 3d-front: model_info.json, if not beside it.")
    ] = None,
    scan: Annotated[
        str | None, typer.Option(help="The one house or scan to take of many; of ProcTHOR's also some, 0-99.")
    ] = None,
    room: Annotated[str | None, typer.Option(help="The room type, where the file does not say.")] = None,
    up: Annotated[str, typer.Option(help="glb, obj: the axis that points up, y or z.")] = "y",
    front: Annotated[str, typer.Option(help="glb, obj: where the front of furniture points, +z, -z, +x or -x.")] = "+z",
    unit: Annotated[float, typer.Option(help="glb, obj: metres a unit; 0.01 for centimetres.")] = 1.0,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only report; add nothing.")] = False,
) -> None:
    """Read other people's rooms and add them to your library, with a report of what was kept, dropped and why."""
    from planner_service.importing import take_in

    if up not in UPS or front not in FRONTS or not 0 < unit <= 1000:
        raise RequestError(
            f"--up must be {' or '.join(UPS)}, --front one of {', '.join(FRONTS)}, --unit above 0 and at most 1000"
        )
    sizes = None if assets is None else Source.of_path(assets)
    options = Options(assets=sizes, scan=scan, room_type=room, up=up, front=front, unit=unit)
    source = Source.of_path(path, MAX_FILE_BYTES if format_name == "native" else MAX_BYTES)
    console = Console(markup=False, highlight=False)
    shelves = None if dry_run else open_shelves(read_settings(), writes=True)
    with writing_database(), _progress("looking over", console) as seen:
        taken = take_in(shelves, source, format_name, options, seen)
    layouts = taken.imported.layouts
    for layout in layouts:
        problems = taken.problems[layout.id]
        console.print(f"{layout.id}: {f'{len(problems)} problems' if problems else 'all can be used'}")
        for problem in problems:
            console.print(f"  {problem}")
    for line in taken.imported.report.lines():
        console.print(line, soft_wrap=True)
    if shelves is None:
        console.print(f"nothing was added; without --dry-run these {len(layouts)} rooms would be")
    else:
        console.print(f"added {len(layouts)}; the library has {len(shelves.rooms())} rooms")


@contextmanager
def _progress(what: str, console: Console) -> Iterator[Callable[[int, int], None]]:
    """A bar on a terminal, nothing in a file."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@app.command()
def remove(layout_id: Annotated[str, typer.Argument(help="The id of a room you added.")]) -> None:
    """Remove a room from your library; stories that play there keep their own copy."""
    shelves = open_shelves(read_settings())
    with writing_database():
        shelves.remove_layout(layout_id)
    console = Console(markup=False)
    console.print(f"removed {layout_id}; the library has {len(shelves.rooms())} rooms", highlight=False)


@app.command()
def generate(
    count: Annotated[int, typer.Option(min=1, max=100_000, help="How many rooms.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same rooms.")] = 0,
    out: Annotated[Path, typer.Option(help="File to write: .json, .jsonl or .jsonl.gz.")] = Path("out/rooms.jsonl"),
) -> None:
    """Generate furnished rooms, the four types in turn."""
    from os import cpu_count

    from rich.progress import track

    from planner_service.filing import check_writable, write_files
    from scene_graphs.generating import CHUNK, generate_rooms

    if not out.name.endswith(ENDINGS):
        raise RequestError(f"--out: {out} must end in one of {', '.join(ENDINGS)}, or no reader knows what it is")
    check_writable(out.parent, [out.name])
    processes = min(cpu_count() or 1, -(-count // CHUNK))
    rooms = track(
        generate_rooms(count, seed, processes), "Furnishing", count, console=Console(stderr=True), transient=True
    )
    write_files(out.parent, {out.name: lambda path: write_layouts(path, rooms)})
    Console(markup=False).print(f"{count} rooms written to {out}", highlight=False)
