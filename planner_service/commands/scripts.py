"""`sims scripts search|list|show|add|export|remove|check|imitate|rephrase-captions`: the library of short scripts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, get_args

import typer
from rich.console import Console

from planner_service.commands.errors import writing_database
from planner_service.commands.imitating import imitate, rephrase_captions, words_of
from planner_service.commands.rooms import chosen_layouts
from planner_service.commands.script_files import lines_of, read_scripts, write_scripts
from planner_service.commands.tables import plain_table
from planner_service.filing import check_writable
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.checking import check as find_problems
from planner_service.scripts.keyframe import ShortScript, Source
from planner_service.scripts.library import LibraryError
from planner_service.scripts.picking import UNKNOWN, Choice, unknown_licences, unlicensed
from planner_service.settings import read_settings
from planner_service.shelves import FixedError, TakenError, UnfitError, open_shelves

app = typer.Typer(no_args_is_help=True, help="Search, check and extend the library of short scripts.")
app.command()(imitate)
app.command("rephrase-captions")(rephrase_captions)
SHOWN = 10
"""Ids that a warning names."""
Emotion = Annotated[str | None, typer.Option(help="Only scripts of this emotion.")]
Room = Annotated[str | None, typer.Option(help="Only scripts of this room type.")]
Furniture = Annotated[str, typer.Option(help="Only scripts that use all of this, such as bed,desk.")]
Written = Annotated[str | None, typer.Option(help=f"Only scripts of this source: {', '.join(get_args(Source))}.")]
Licence = Annotated[str | None, typer.Option(help="Only scripts under exactly this licence.")]
Own = Annotated[bool, typer.Option("--own", help="Only your own, without those that are shipped.")]


@app.command()
def search(
    query: Annotated[str, typer.Argument(help="What happens, in your own words.")],
    k: Annotated[int, typer.Option(min=1, max=100, help="How many to show.")] = 5,
    emotion: Emotion = None,
    room: Room = None,
    furniture: Furniture = "",
    source: Written = None,
    licence: Licence = None,
) -> None:
    """Show the short scripts whose summary is nearest in meaning."""
    library = open_shelves(read_settings()).scripts()
    table = plain_table("score", "id", "emotion", "room", "summary")
    for found in _choice(emotion, room, furniture, source, licence).search(library, query, k):
        script = found.script
        table.add_row(f"{found.score:.3f}", script.id, script.emotion, script.room, script.summary)
    console = Console(markup=False)
    console.print(table)
    console.print(f"{len(library)} scripts, encoder {library.encoder.name}", highlight=False)


@app.command("list")
def list_scripts(
    emotion: Emotion = None,
    room: Room = None,
    furniture: Furniture = "",
    source: Written = None,
    licence: Licence = None,
    own: Own = False,
) -> None:
    """Show the short scripts there are."""
    chosen = _chosen(_choice(emotion, room, furniture, source, licence), own)
    table = plain_table("id", "emotion", "room", "source", "licence", "summary")
    for script in sorted(chosen, key=lambda script: script.id):
        table.add_row(script.id, script.emotion, script.room, script.source, script.licence, script.summary)
    console = Console(markup=False)
    console.print(table)
    console.print(f"{len(chosen)} scripts", highlight=False)


@app.command()
def show(
    script_id: Annotated[str, typer.Argument(help="The id of a script.")],
    version: Annotated[int | None, typer.Option(min=1, help="As it was at that version; left out: as it is.")] = None,
) -> None:
    """Show one short script whole, as JSON."""
    shelves = open_shelves(read_settings())
    script = shelves.scripts().get(script_id)
    if version is not None:
        script = shelves.script_version(script_id, version)
    typer.echo(script.model_dump_json(indent=2, exclude_none=True))


@app.command()
def add(
    file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")],
    replace: Annotated[
        bool, typer.Option("--replace", help="Keep your script of the same id as an older version, instead of failing.")
    ] = False,
) -> None:
    """Check short scripts and add them to your own library; one that does not fit adds none."""
    scripts = read_scripts(file)
    for number, script in enumerate(scripts):
        if unlicensed(script):
            said = f'say under which licence what comes from a {script.source} may be passed on, or "{UNKNOWN}"'
            raise LibraryError(f"{file.name} [{number}]: licence: {said}")
    shelves = open_shelves(read_settings(), writes=True)
    try:
        with writing_database():
            added = shelves.add_scripts(*scripts, replace=replace)
    except (TakenError, FixedError) as error:
        raise LibraryError(f"{file.name}: {error}") from error
    except UnfitError as error:
        raise LibraryError(f"{file.name}: {error.script.id}: {error.problems[0]}") from error
    told = f"added {len(added.new)}"
    if replace:
        told += f", replaced {len(added.replaced)}, left {len(added.unchanged)} as they were"
    Console(markup=False).print(f"{told}; the library has {len(shelves.scripts())} scripts", highlight=False)
    _warn_of_licences(scripts)


@app.command()
def export(
    out: Annotated[Path | None, typer.Option(help="The file to write; left out: the terminal.")] = None,
    emotion: Emotion = None,
    room: Room = None,
    furniture: Furniture = "",
    source: Written = None,
    licence: Licence = None,
    own: Own = False,
) -> None:
    """Write short scripts as JSON lines, with origin, licence and version; `sims scripts add` reads them again."""
    if out is not None:
        check_writable(out.parent, [out.name])
    scripts = _chosen(_choice(emotion, room, furniture, source, licence), own)
    if out is None:
        typer.echo(lines_of(scripts), nl=False)
    else:
        write_scripts(scripts, out)
        Console(markup=False).print(f"wrote {len(scripts)} scripts to {out}", highlight=False, soft_wrap=True)
    _warn_of_licences(scripts)


@app.command()
def remove(script_id: Annotated[str, typer.Argument(help="The id of a script you added.")]) -> None:
    """Remove a short script from your own library, with all its versions."""
    shelves = open_shelves(read_settings())
    with writing_database():
        shelves.remove_script(script_id)
    console = Console(markup=False)
    console.print(f"removed {script_id}; the library has {len(shelves.scripts())} scripts", highlight=False)


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="JSON with one short script, or JSON lines with several.")],
    words: Annotated[
        bool, typer.Option("--captions", help="Also name captions that the body does not know, and the nearest known.")
    ] = False,
    layout: Annotated[
        str | None, typer.Option(help="A layout file, or the id of a room: also name furniture that it lacks.")
    ] = None,
) -> None:
    """Say whether short scripts can be acted out, and what would be repaired."""
    console = Console(markup=False)
    scripts, shelves = read_scripts(file), open_shelves(read_settings())
    vocabulary = Vocabulary.built_in(shelves.scripts().encoder) if words else None
    room = chosen_layouts([layout], shelves, most=1)[0] if layout is not None else None
    furniture = None if room is None else {placed.category for placed in room.objects}
    problems = 0
    for script in scripts:
        found = find_problems(script, vocabulary, furniture)
        problems += len(found)
        console.print(f"{script.id}: {'executable' if not found else f'{len(found)} problems'}", highlight=False)
        for problem in found:
            console.print(f"  {problem}", highlight=False)
    if problems:
        raise typer.Exit(1)


def _choice(emotion: str | None, room: str | None, furniture: str, source: str | None, licence: str | None) -> Choice:
    if source is not None and source not in get_args(Source):
        raise LibraryError(f"--source: {source!r:.80} is none of {', '.join(get_args(Source))}")
    return Choice(emotion, room, words_of(furniture), source, licence)


def _chosen(choice: Choice, own: bool) -> list[ShortScript]:
    shelves = open_shelves(read_settings())
    return [one for one in choice.of(shelves.scripts()) if not (own and shelves.is_fixed_script(one))]


def _warn_of_licences(scripts: list[ShortScript]) -> None:
    """Say of which scripts nobody knows whether they may be passed on."""
    if found := unknown_licences(scripts):
        more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        typer.echo(f"warning: licence unknown, do not pass on: {', '.join(found[:SHOWN])}{more}", err=True)
