"""`sims scripts search|list|show|add|export|remove|check|imitate|rephrase-captions`: the library of short scripts.

Short scripts in files: JSON with one or a list of them, or JSON lines; and kept where a command is told to.

`sims scripts imitate|rephrase-captions`: what only a language model can add to the library.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, get_args

import typer
from pydantic import ValidationError
from rich.console import Console

from planner_service.cli.console import ModelOption, plain_table, writing_database
from planner_service.cli.layouts import chosen_layouts
from planner_service.composition.script_imitation import MAX_WANTED, Wish
from planner_service.library.library import FixedError, Shelves, TakenError, UnfitError, open_shelves
from planner_service.llm.client import for_story
from planner_service.llm.factory import KINDS, load_model
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import problems_of
from planner_service.output.story_export import check_writable, write_files
from planner_service.scripts.captions import Vocabulary, captions
from planner_service.scripts.script import ShortScript, Source
from planner_service.scripts.script_library import UNKNOWN, Choice, LibraryError, unknown_licences, unlicensed
from planner_service.scripts.script_repair import check as find_problems
from planner_service.settings import Settings, SettingsError, read_settings
from scene_graphs.furniture import canonical_room, is_known

MAX_SCRIPT_FILE_BYTES: Final = 64_000_000
"""Bytes of a script file."""


def read_scripts(file: Path) -> list[ShortScript]:
    """Short scripts of a JSON or JSON-lines file. Raises LibraryError naming file, line and what is wrong."""
    try:
        with file.open("rb") as stream:
            data = stream.read(MAX_SCRIPT_FILE_BYTES + 1)
    except OSError as error:
        raise LibraryError(f"FILE: {file} cannot be read: {error.strerror}") from error
    if len(data) > MAX_SCRIPT_FILE_BYTES:
        raise LibraryError(f"{file.name}: larger than {MAX_SCRIPT_FILE_BYTES // 1000000} MB", "split it")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LibraryError(
            f"{file.name}: not UTF-8 text ({error.reason} at byte {error.start})", "save it as UTF-8"
        ) from error
    rows = _rows(text, file.name)
    if not rows:
        raise LibraryError(f"{file.name}: no short script in it", "one is an object with id, summary and keyframes")
    return [_script(row, f"{file.name} [{number}]") for number, row in enumerate(rows)]


def lines_of(scripts: Iterable[ShortScript]) -> str:
    """Short scripts as JSON lines; `read_scripts` reads them again."""
    return "".join(f"{script.model_dump_json(exclude_none=True)}\n" for script in scripts)


def write_scripts(scripts: Sequence[ShortScript], out: Path) -> None:
    """Write them to a file, whole or not at all. OutputError."""
    lines = lines_of(scripts)
    write_files(out.parent, {out.name: lambda path: path.write_text(lines, encoding="utf-8")})


def keep_scripts(scripts: Sequence[ShortScript], out: Path | None, shelves: Shelves | None, console: Console) -> None:
    """Write what was made to a file, put it on shelves, or both, where these are given; and say so."""
    if out is not None:
        write_scripts(scripts, out)
        console.print(f"wrote {len(scripts)} to {out}", soft_wrap=True)
    if shelves is not None:
        if scripts:
            with writing_database():
                shelves.add_scripts(*scripts)
        console.print(f"added {len(scripts)}; the library has {len(shelves.scripts())} scripts")
    if scripts and out is None and shelves is None:
        console.print("none is kept; --add keeps them in your library, --out writes them to a file")


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
        lines = [line for line in text.split("\n") if line.strip()]
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


MAX_SYNONYMS = 20


def imitate(
    emotion: Annotated[str, typer.Option(help="What the new scripts are to feel like, such as sad.")],
    room: Annotated[str, typer.Option(help="The room type they are to play in.")],
    count: Annotated[int, typer.Option(min=1, max=MAX_WANTED, help="How many.")] = 5,
    furniture: Annotated[
        str, typer.Option(help="What they may use, such as bed,desk; left out: all that stands in such rooms.")
    ] = "",
    seed: Annotated[int, typer.Option(min=0, help="Another seed shows the model other examples.")] = 0,
    add: Annotated[bool, typer.Option("--add", help="Keep them in your library.")] = False,
    out: Annotated[Path | None, typer.Option(help="Write them to this file, as JSON lines.")] = None,
    model: ModelOption = None,
) -> None:
    """Have the language model write new short scripts in the manner of those in the library."""
    from planner_service.composition.script_imitation import imitate as imitated
    from planner_service.scripts.caption_paraphrases import FILE, all_synonyms

    settings = read_settings(llm_model=model)
    writer = _model(settings, seed, "imitating")
    if out is not None:
        check_writable(out.parent, [out.name])
    shelves = open_shelves(settings, writes=add)
    room = canonical_room(room)
    wish = Wish(emotion, room, count, words_of(furniture) or _furniture_of(shelves, room))
    said = all_synonyms(settings.data_dir / FILE)
    known = {skill: {one: said.get(skill, {}).get(one, []) for one in some} for skill, some in captions().items()}
    made = imitated(writer, shelves.scripts(), wish, known, seed)
    console = Console(markup=False, highlight=False, soft_wrap=True)
    for script in made.scripts:
        console.print(f"{script.id}: {script.summary}")
    for refused in made.refused:
        console.print(f"refused: {refused.why}: {refused.summary}")
    for note in made.notes:
        console.print(note)
    keep_scripts(made.scripts, out, shelves if add else None, console)


def rephrase_captions(
    skill: Annotated[str | None, typer.Option(help="Only captions of this skill.")] = None,
    count: Annotated[int, typer.Option(min=1, max=MAX_SYNONYMS, help="How many other ways to say each.")] = 5,
    again: Annotated[bool, typer.Option("--again", help="Also those for which you have some.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Another seed asks the model anew.")] = 0,
) -> None:
    """Have the language model say the captions that the body knows in other words; kept in SIMS_DATA_DIR."""
    from planner_service.scripts.caption_paraphrases import FILE, read_synonyms, rephrase, write_synonyms

    settings = read_settings()
    model = _model(settings, seed, "rephrasing")
    known = captions()
    if skill is not None and skill not in known:
        raise SettingsError(f"{skill!r:.80} is none of {', '.join(known)}", at="--skill")
    file = settings.data_dir / FILE
    check_writable(file.parent, [file.name])
    console = Console(markup=False, highlight=False, soft_wrap=True)
    kept = read_synonyms(file)
    for name in known if skill is None else (skill,):
        wanted = [caption for caption in known[name] if again or caption not in kept.get(name, {})]
        taken = [caption for some in known.values() for caption in some]
        said = [phrase for some in kept.values() for one in some if one not in wanted for phrase in some[one]]
        made = rephrase(model, {name: wanted}, [*taken, *said], count)
        kept = write_synonyms(file, made.synonyms)
        console.print(f"{name}: {len(made.synonyms.get(name, {}))} of {len(wanted)} captions")
        for caption in made.missing:
            console.print(f"  not enough for: {caption}")
        for note in made.notes:
            console.print(f"  {note}")
    console.print(f"kept in {file}")


def words_of(listed: str) -> tuple[str, ...]:
    """The words between commas, each once."""
    return tuple(dict.fromkeys(word for part in listed.split(",") if (word := part.strip())))


def _model(settings: Settings, seed: int, deed: str) -> LanguageModel:
    model = for_story(load_model(settings), seed)
    if model is None:
        raise SettingsError(
            f"{deed} needs a language model, rules do not imagine",
            f"set it, or --model, to {KINDS}",
            at="SIMS_LLM_MODEL",
        )
    return model


def _furniture_of(shelves: Shelves, room: str) -> tuple[str, ...]:
    """What stands in rooms of a type."""
    there = {one.category for layout in shelves.rooms().values() if layout.room_type == room for one in layout.objects}
    return tuple(sorted(word for word in there if is_known(word)))


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
        raise LibraryError(f"{source!r:.80} is none of {', '.join(get_args(Source))}", at="--source")
    return Choice(emotion, room, words_of(furniture), source, licence)


def _chosen(choice: Choice, own: bool) -> list[ShortScript]:
    shelves = open_shelves(read_settings())
    return [one for one in choice.of(shelves.scripts()) if not (own and shelves.is_fixed_script(one))]


def _warn_of_licences(scripts: list[ShortScript]) -> None:
    """Say of which scripts nobody knows whether they may be passed on."""
    if found := unknown_licences(scripts):
        more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        typer.echo(f"warning: licence unknown, do not pass on: {', '.join(found[:SHOWN])}{more}", err=True)
