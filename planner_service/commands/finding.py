"""`sims layouts find`: the rooms that have what a few words, or a graph in a file, ask for, and why."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer
from rich.console import Console

from planner_service.commands.picturing import file_name
from planner_service.filing import Writer, check_writable, write_files
from planner_service.settings import read_settings
from planner_service.shelves import open_shelves
from planner_service.stories import RequestError
from scene_graphs.furniture import AFFORDANCES, Furniture
from scene_graphs.graph import FurnitureGraph, graph_from_parts

if TYPE_CHECKING:
    from pydantic import ValidationError

    from planner_service.retrieving import Retrieved
    from scene_graphs.retrieval import LayoutIndex

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
    from planner_service.retrieving import retrieved

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
    from scene_graphs.matching_view import draw_match

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
        raise RequestError("WORDS: no furniture is named; try `sims layouts find sofa:sit coffee-table, bed:lie`")
    return graph_from_parts(list(places), edges, list(needs.values()))


def graph_of_file(path: Path) -> FurnitureGraph:
    """The graph in a JSON file, as POST /v1/layouts/retrieve takes it; RequestError names what is wrong."""
    from pydantic import ValidationError

    from planner_service.errors import Unprocessable
    from planner_service.routes.layout_graphs import graph_of
    from planner_service.schemas.layout_graphs import GraphAsk

    try:
        return graph_of(GraphAsk.model_validate(_json(path)), "")
    except ValidationError as error:
        raise RequestError(f"{path.name}: {_first(error)}") from error
    except Unprocessable as error:
        raise RequestError(f"{path.name}: {error}") from error


def _piece(word: str) -> tuple[Furniture, set[str]]:
    match = _WORD.fullmatch(word)
    if match is None or int(match["number"] or 1) < 1:
        raise RequestError(f"WORDS: {word!r:.60} is no piece of furniture; write such as chair, chair2 or chair:sit")
    needs = set((match["needs"] or "").split("+")) - {""}
    if not needs <= set(AFFORDANCES):
        raise RequestError(f"WORDS: {word!r:.60} needs what no body does; choose of {', '.join(AFFORDANCES)}")
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
