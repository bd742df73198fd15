"""`sims scripts imitate|rephrase-captions`: what only a language model can add to the library."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.commands.script_files import keep_scripts
from planner_service.filing import check_writable
from planner_service.llm.choosing import KINDS, load_model
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.served import for_story
from planner_service.scripts.captions import captions
from planner_service.scripts.wishes import MAX_WANTED, Wish
from planner_service.settings import Settings, SettingsError, read_settings
from planner_service.shelves import Shelves, open_shelves
from scene_graphs.furniture import canonical_room, is_known

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
) -> None:
    """Have the language model write new short scripts in the manner of those in the library."""
    from planner_service.scripts.imitating import imitate as imitated
    from planner_service.scripts.rephrasing import FILE, all_synonyms

    settings = read_settings()
    model = _model(settings, seed, "imitating")
    if out is not None:
        check_writable(out.parent, [out.name])
    shelves = open_shelves(settings, writes=add)
    room = canonical_room(room)
    wish = Wish(emotion, room, count, words_of(furniture) or _furniture_of(shelves, room))
    said = all_synonyms(settings.data_dir / FILE)
    known = {skill: {one: said.get(skill, {}).get(one, []) for one in some} for skill, some in captions().items()}
    made = imitated(model, shelves.scripts(), wish, known, seed)
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
    from planner_service.scripts.rephrasing import FILE, read_synonyms, rephrase, write_synonyms

    settings = read_settings()
    model = _model(settings, seed, "rephrasing")
    known = captions()
    if skill is not None and skill not in known:
        raise SettingsError(f"--skill: {skill!r:.80} is none of {', '.join(known)}")
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
        raise SettingsError(f"SIMS_LLM_MODEL: {deed} needs a language model, rules do not imagine; set it to {KINDS}")
    return model


def _furniture_of(shelves: Shelves, room: str) -> tuple[str, ...]:
    """What stands in rooms of a type."""
    there = {one.category for layout in shelves.rooms().values() if layout.room_type == room for one in layout.objects}
    return tuple(sorted(word for word in there if is_known(word)))
