"""`sims scripts search|add|remove|check`: the library of short scripts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import ValidationError
from rich.console import Console
from rich.table import Table

from planner_service.commands.errors import writing_database
from planner_service.llm.answers import problems_of
from planner_service.scripts.checking import check as find_problems
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import LibraryError
from planner_service.settings import read_settings
from planner_service.shelves import TakenError, UnfitError, open_shelves

app = typer.Typer(no_args_is_help=True, help="Search, check and extend the library of short scripts.")
LARGEST = 2_000_000
"""Bytes of a script file."""


@app.command()
def search(
    query: Annotated[str, typer.Argument(help="What happens, in your own words.")],
    k: Annotated[int, typer.Option(min=1, max=100, help="How many to show.")] = 5,
    emotion: Annotated[str | None, typer.Option(help="Only scripts of this emotion.")] = None,
    room: Annotated[str | None, typer.Option(help="Only scripts of this room type.")] = None,
) -> None:
    """Show the short scripts whose summary is nearest in meaning."""
    library = open_shelves(read_settings()).scripts()
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("score", "id", "emotion", "room", "summary"):
        table.add_column(column)
    for found in library.search(query, k, emotion, room):
        script = found.script
        table.add_row(f"{found.score:.3f}", script.id, script.emotion, script.room, script.summary)
    console = Console(markup=False)
    console.print(table)
    console.print(f"{len(library)} scripts, encoder {library.encoder.name}", highlight=False)


@app.command()
def add(file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")]) -> None:
    """Check short scripts and add them to your own library; one that does not fit adds none."""
    scripts = read_scripts(file)
    shelves = open_shelves(read_settings(), writes=True)
    try:
        with writing_database():
            shelves.add_scripts(*scripts)
    except TakenError as error:
        raise LibraryError(f"{file.name}: {error}") from error
    except UnfitError as error:
        raise LibraryError(f"{file.name}: {error.script.id}: {error.problems[0]}") from error
    console = Console(markup=False)
    console.print(f"added {len(scripts)}; the library has {len(shelves.scripts())} scripts", highlight=False)


@app.command()
def remove(script_id: Annotated[str, typer.Argument(help="The id of a script you added.")]) -> None:
    """Remove a short script from your own library."""
    shelves = open_shelves(read_settings())
    with writing_database():
        shelves.remove_script(script_id)
    console = Console(markup=False)
    console.print(f"removed {script_id}; the library has {len(shelves.scripts())} scripts", highlight=False)


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")],
) -> None:
    """Say whether short scripts can be acted out, and what would be repaired."""
    console = Console(markup=False)
    problems = 0
    for script in read_scripts(file):
        found = find_problems(script)
        problems += len(found)
        console.print(f"{script.id}: {'executable' if not found else f'{len(found)} problems'}", highlight=False)
        for problem in found:
            console.print(f"  {problem}", highlight=False)
    if problems:
        raise typer.Exit(1)


def read_scripts(file: Path) -> list[ShortScript]:
    """Short scripts of a JSON or JSON-lines file. Raises LibraryError naming file, line and what is wrong."""
    try:
        with file.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        raise LibraryError(f"FILE: {file} cannot be read: {error.strerror}") from error
    if len(data) > LARGEST:
        raise LibraryError(f"{file.name}: larger than {LARGEST // 1_000_000} MB; split it")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LibraryError(
            f"{file.name}: not UTF-8 text ({error.reason} at byte {error.start}); save it as UTF-8"
        ) from error
    rows = _rows(text, file.name)
    if not rows:
        raise LibraryError(f"{file.name}: no short script in it; one is an object with id, summary and keyframes")
    return [_script(row, f"{file.name} [{number}]") for number, row in enumerate(rows)]


def _script(row: Any, where: str) -> ShortScript:
    try:
        return ShortScript.model_validate(row)
    except ValidationError as error:
        raise LibraryError(f"{where}: {'; '.join(problems_of(error))}") from error


def _rows(text: str, name: str) -> list[Any]:
    try:
        whole = json.loads(text)
        return whole if isinstance(whole, list) else [whole]
    except RecursionError as error:
        raise LibraryError(f"{name}: not a script: brackets within brackets without end") from error
    except ValueError as error:
        lines = [line for line in text.splitlines() if line.strip()]
        rows = []
        for number, line in enumerate(lines, 1):
            try:
                rows.append(json.loads(line))
            except (ValueError, RecursionError) as fault:
                raise LibraryError(_not_json(name, error if _spread(lines) else fault, number)) from fault
        return rows


def _spread(lines: list[str]) -> bool:
    """Whether this is one object written over several lines, not one a line."""
    return len(lines) == 1 or not lines[0].rstrip().endswith("}")


def _not_json(name: str, error: Exception, number: int) -> str:
    if isinstance(error, json.JSONDecodeError):
        line = error.lineno if error.lineno > 1 else number
        return f"{name}:{line}: not JSON: {error.msg} at column {error.colno}"
    return f"{name}:{number}: not JSON: {error}"
