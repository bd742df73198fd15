"""`sims layouts list|find|check|draw|import|remove|generate`: the library of rooms.

`sims layouts find`: the rooms that have what a few words, or a graph in a file, ask for, and why.

`sims layouts check`: what of the furniture of rooms a body can sit and lie on, and why not the rest.

Rooms named on the command line: files of the user's or ids of the library.

`sims layouts draw`: rooms from above with their graph, where a body sits, lies and touches, and a way it walks.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer
from rich.console import Console

from planner_service.cli.console import plain_table, progress, writing_database
from planner_service.library.library import Shelves, open_shelves
from planner_service.output.room_pictures import Shown, picture
from planner_service.output.story_export import Writer, check_writable, write_files
from planner_service.pipeline import RequestError
from planner_service.settings import read_settings
from scene_graphs.affordances.usable_furniture import count_uses
from scene_graphs.furniture import AFFORDANCES, ROOM_TYPES, Furniture
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_parts
from scene_graphs.home import MAX_ROOMS
from scene_graphs.layout import Layout, LayoutError, read_layouts, write_layouts
from scene_graphs.loaders import FORMATS, Options, Source
from scene_graphs.loaders.scene_source import MAX_BYTES

if TYPE_CHECKING:
    from pydantic import ValidationError

    from planner_service.api.layouts.views import Retrieved
    from scene_graphs.retrieval.layout_index import LayoutIndex


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
                raise LayoutError(f"{field}: {name} holds no room", "`sims layouts generate` writes such files")
            found.extend(rooms)
            continue
        if (known := shelves.rooms().get(name)) is None:
            raise LayoutError(
                f"{field}: {name!r:.200} is neither a file nor the id of a room", "see `sims layouts list`"
            )
        found.append(known)
    if len(found) > most:
        raise LayoutError(f"{field}: at most {most} rooms, {len(found)} were given", "leave some out")
    return tuple(found)


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # longer than any path, or not one
        return False


MAX_CHECKED = 10_000
"""Rooms of one command."""


def check(names: Annotated[list[str], typer.Argument(help="Layout files or ids.")]) -> None:
    """Count which furniture can be sat and lain on, as placed or pulled out, and what keeps a body from the rest."""
    layouts = chosen_layouts(names, open_shelves(read_settings()), "NAMES", most=MAX_CHECKED)
    counted = ("pieces", "surface", "as placed", "pulled out")
    table = plain_table("furniture", "to", *counted, "the rest", right=counted)
    for (category, affordance), counts in sorted(count_uses(layouts).items()):
        table.add_row(category, affordance, *_figures(counts))
    console = Console(markup=False, highlight=False)
    console.print(table)
    console.print(f"{len(layouts)} room{'s' * (len(layouts) > 1)}; shares of the pieces; pulled out includes as placed")


def _figures(counts: Counter[str]) -> list[str]:
    """Pieces, the shares with a surface, usable as placed and usable at all, and how often each other verdict fell."""
    pieces = counts.total()
    placed = counts["as placed"]
    shares = (pieces - counts["no surface"], placed, placed + counts["pulled out"])
    rest = [f"{said} {count}" for said, count in counts.most_common() if said not in ("as placed", "pulled out")]
    return [str(pieces), *(f"{share / pieces:.1%}" for share in shares), ", ".join(rest)]


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
        raise RequestError(f"{formats!r:.40} must be png, svg or png,svg", at="--format")
    layouts = chosen_layouts(names, open_shelves(read_settings()), "NAMES", most=MAX_DRAWN)
    drawings: dict[str, Writer] = {}
    for layout in layouts:
        if to is not None and all(placed.id != to for placed in layout.objects):
            known = ", ".join(placed.id for placed in layout.objects)
            raise RequestError(f"{layout.id} has no object {to!r:.80}", f"it has {known}", at="--to")
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


MAX_FOUND: Final = 50
MAX_GRAPH_BYTES: Final = 1 << 20
"""Bytes of a file that holds a graph."""
_WORD: Final = re.compile(r"(?P<word>[^\W\d][^\d:]*?)(?P<number>\d{1,2})?(?::(?P<needs>[a-z]+(?:\+[a-z]+)*))?")


def find(
    words: Annotated[
        list[str],
        typer.Argument(
            help="Furniture such as `sofa:sit chair chair2 table, bed:lie`, or a graph in a .json file. What stands "
            "side by side is to be near each other; a comma parts it. Behind a colon is what a body must be able to "
            "do there: sit, lie, touch. The same word is the same piece, chair2 is another."
        ),
    ],
    rooms: Annotated[int, typer.Option("--rooms", min=1, max=4, help="How many rooms a home may have.")] = 1,
    k: Annotated[int, typer.Option("-k", min=1, max=MAX_FOUND, help="How many rooms, or homes, to show.")] = 5,
    room: Annotated[list[str] | None, typer.Option(help="Only rooms of this type; may be given again.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for pictures: the graph beside the rooms.")] = None,
) -> None:
    """Find the rooms whose furniture is nearest to what is asked for, and say why."""
    from planner_service.api.layouts.views import retrieved

    path = Path(words[0]) if len(words) == 1 and words[0].endswith(".json") else None
    query = graph_of_words(words) if path is None else graph_of_file(path)
    index = open_shelves(read_settings()).layouts()
    found = retrieved(index, query, k, room or (), rooms)
    console = Console(markup=False)
    for one in found:
        console.print(" + ".join(one.layout_ids), highlight=False, soft_wrap=True)
        for line in one.told.lines():
            console.print(f"  {line}", highlight=False, soft_wrap=True)
    if out is not None:
        drawings: dict[str, Writer] = {
            f"{number}-{file_name('+'.join(one.layout_ids))}.png": partial(_draw, index, query, one)
            for number, one in enumerate(found, start=1)
        }
        check_writable(out, drawings)
        for written in write_files(out, drawings):
            console.print(str(written), highlight=False, soft_wrap=True)


def _draw(index: LayoutIndex, query: FurnitureGraph, one: Retrieved, path: Path) -> None:
    from scene_graphs.plots.match_plot import draw_match

    draw_match(query, [index.layout(name) for name in one.layout_ids], one.match, path, one.told.lines())


def graph_of_words(words: list[str]) -> FurnitureGraph:
    """The graph that words on the command line stand for; RequestError names the word that is none."""
    places: dict[Furniture, int] = {}
    needs: dict[Furniture, set[str]] = {}
    edges: list[tuple[int, int]] = []
    for chain in " ".join(words).split(","):
        before: int | None = None
        for word in chain.split():
            piece, wanted = _piece(word)
            place = places.setdefault(piece, len(places))
            needs.setdefault(piece, set()).update(wanted)
            if before is not None and before != place:
                edges.append((before, place))
            before = place
    if not places:
        raise RequestError("WORDS: no furniture is named", "try `sims layouts find sofa:sit coffee-table, bed:lie`")
    return graph_from_parts(list(places), edges, list(needs.values()))


def graph_of_file(path: Path) -> FurnitureGraph:
    """The graph in a JSON file, as POST /v1/layouts/retrieve takes it; RequestError names what is wrong."""
    from pydantic import ValidationError

    from planner_service.api.errors import Unprocessable
    from planner_service.api.layouts.graph_endpoints import graph_of
    from planner_service.api.layouts.schemas import GraphAsk

    try:
        return graph_of(GraphAsk.model_validate(_json(path)), "")
    except ValidationError as error:
        raise RequestError(f"{path.name}: {_first(error)}") from error
    except Unprocessable as error:
        raise RequestError(f"{path.name}: {error}") from error


def _piece(word: str) -> tuple[Furniture, set[str]]:
    match = _WORD.fullmatch(word)
    if match is None or int(match["number"] or 1) < 1:
        raise RequestError(f"WORDS: {word!r:.60} is no piece of furniture", "write such as chair, chair2 or chair:sit")
    needs = set((match["needs"] or "").split("+")) - {""}
    if not needs <= set(AFFORDANCES):
        raise RequestError(f"WORDS: {word!r:.60} needs what no body does", f"choose of {', '.join(AFFORDANCES)}")
    return Furniture(match["word"].strip("_- "), int(match["number"] or 1)), needs


def _json(path: Path) -> Any:
    try:
        if not path.is_file():
            raise RequestError(f"{path}: cannot be read: there is no such file")
        with path.open("rb") as file:
            data = file.read(MAX_GRAPH_BYTES + 1)
        if len(data) > MAX_GRAPH_BYTES:
            raise RequestError(f"{path.name}: a graph has at most {MAX_GRAPH_BYTES >> 20} MB")
        row = json.loads(data)
    except OSError as error:
        raise RequestError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise RequestError(f"{path.name}: is not JSON: {error}") from error
    return row["graph"] if isinstance(row, dict) and "graph" in row else row


def _first(error: ValidationError) -> str:
    first = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, first['loc'])) or 'the graph'}: {first['msg']}"


app = typer.Typer(no_args_is_help=True, help="List, draw, check, import and generate furnished rooms.")
for command in (find, check, draw):
    app.command()(command)
UPS, FRONTS = ("y", "z"), ("+z", "-z", "+x", "-x")
ENDINGS = (".json", ".jsonl", ".json.gz", ".jsonl.gz")


@app.command("list")
def list_layouts(room: Annotated[str | None, typer.Option(help="Only rooms of this type.")] = None) -> None:
    """Show the rooms a story can play in."""
    if room is not None and room not in ROOM_TYPES:
        raise RequestError(f"{room!r} is none of {', '.join(ROOM_TYPES)}", at="--room")
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
    from planner_service.library.import_layouts import take_in

    if up not in UPS or front not in FRONTS or not 0 < unit <= 1000:
        raise RequestError(
            f"--up must be {' or '.join(UPS)}, --front one of {', '.join(FRONTS)}, --unit above 0 and at most 1000"
        )
    sizes = None if assets is None else Source.of_path(assets)
    options = Options(assets=sizes, scan=scan, room_type=room, up=up, front=front, unit=unit)
    source = Source.of_path(path, MAX_FILE_BYTES if format_name == "native" else MAX_BYTES)
    console = Console(markup=False, highlight=False)
    shelves = None if dry_run else open_shelves(read_settings(), writes=True)
    with writing_database(), progress("looking over") as seen:
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

    from planner_service.output.story_export import check_writable, write_files
    from scene_graphs.generation.generate_room import CHUNK, generate_rooms

    if not out.name.endswith(ENDINGS):
        raise RequestError(f"{out} must end in one of {', '.join(ENDINGS)}, or no reader knows what it is", at="--out")
    check_writable(out.parent, [out.name])
    processes = min(cpu_count() or 1, -(-count // CHUNK))
    rooms = track(
        generate_rooms(count, seed, processes), "Furnishing", count, console=Console(stderr=True), transient=True
    )
    write_files(out.parent, {out.name: lambda path: write_layouts(path, rooms)})
    Console(markup=False).print(f"{count} rooms written to {out}", highlight=False)
