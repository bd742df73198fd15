"""`sims scripts search|add|check`: the library of short scripts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from planner_service.scripts.checking import check as find_problems
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import LibraryError, ScriptLibrary
from planner_service.settings import Settings

app = typer.Typer(no_args_is_help=True, help="Search, check and extend the library of short scripts.")
LARGEST = 2_000_000
"""Bytes of a script file."""


def _library() -> ScriptLibrary:
    settings = Settings()
    return ScriptLibrary.read(settings.scripts_file, cache=settings.cache_dir)


@app.command()
def search(
    query: Annotated[str, typer.Argument(help="What happens, in your own words.")],
    k: Annotated[int, typer.Option(min=1, max=100, help="How many to show.")] = 5,
    emotion: Annotated[str | None, typer.Option(help="Only scripts of this emotion.")] = None,
    room: Annotated[str | None, typer.Option(help="Only scripts of this room type.")] = None,
) -> None:
    """Show the short scripts whose summary is nearest in meaning."""
    library = _library()
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("score", "id", "emotion", "room", "summary"):
        table.add_column(column)
    for found in library.search(query, k, emotion, room):
        script = found.script
        table.add_row(f"{found.score:.3f}", script.id, script.emotion, script.room, script.summary)
    console = Console()
    console.print(table)
    console.print(f"{len(library)} scripts, encoder {library.encoder.name}", highlight=False)


@app.command()
def add(file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")]) -> None:
    """Check short scripts and add them to your own library; one that does not fit adds none."""
    scripts = read_scripts(file)
    library = _library()
    for script in scripts:
        if any(other.id == script.id for other in library.scripts):
            raise LibraryError(f"{file.name}: {script.id!r} is in the library already; choose another id")
        # A walk or a rising that is missing is put in when a story is composed; anything else must be right.
        faults = [problem for problem in find_problems(script) if problem.field != "skill"]
        if faults:
            raise LibraryError(f"{file.name}: {script.id}: {faults[0]}")
    for script in scripts:
        library = library.add(script)
    Console().print(f"added {len(scripts)}; the library has {len(library)} scripts", highlight=False)


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")],
) -> None:
    """Say whether short scripts can be acted out, and what would be repaired."""
    console = Console()
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
    if file.stat().st_size > LARGEST:
        raise LibraryError(f"{file.name}: larger than {LARGEST // 1_000_000} MB; split it")
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise LibraryError(f"{file.name}: not UTF-8 text ({error.reason} at byte {error.start})") from error
    rows = _rows(text, file.name)
    if not rows:
        raise LibraryError(f"{file.name}: no short script in it")
    return [ShortScript.model_validate(row) for row in rows]


def _rows(text: str, name: str) -> list[Any]:
    try:
        whole = json.loads(text)
        return whole if isinstance(whole, list) else [whole]
    except json.JSONDecodeError as error:
        lines = [line for line in text.splitlines() if line.strip()]
        rows = []
        for number, line in enumerate(lines, 1):
            try:
                rows.append(json.loads(line))
            except json.JSONDecodeError:
                raise LibraryError(
                    f"{name}:{error.lineno if len(lines) == 1 else number}: not JSON: {error.msg}"
                ) from error
        return rows
