"""`sims captions WORDS`: what the body can do, as a list in words under each skill."""

from __future__ import annotations

import json
from dataclasses import asdict
from itertools import groupby
from typing import Annotated

import typer
from rich.console import Console

from motion_backend.motion import skills_named
from planner_service.cli.console import JsonOption, plain_table
from planner_service.composition.caption_meanings import CaptionWords, find_captions
from planner_service.pipeline import RequestError
from planner_service.scripts.script import skill_of


def captions_command(
    words: Annotated[
        list[str] | None, typer.Argument(help="Only those that have all these words, or mean them.")
    ] = None,
    skill: Annotated[str | None, typer.Option(help=f"Only those of this skill: {skills_named()}.")] = None,
    as_json: JsonOption = False,
) -> None:
    """List the captions that a script can ask for, each with the deeds that are seen in it."""
    asked = " ".join(words or [])
    try:
        found = find_captions(asked, skill_of(skill) if skill is not None else None)
    except ValueError as error:
        raise RequestError(f"{skill!r:.60} is no skill; there is {skills_named()}", at="--skill") from error
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps({"items": [asdict(one) for one in found]}))
        return
    for one, some in groupby(found, key=lambda caption: caption.skill):
        _show(list(some), f"{one} ({one.words})", console)
    if not found:
        console.print(f"none has {asked!r:.80}; leave words out, or say it in other words", soft_wrap=True)


def _show(found: list[CaptionWords], skill: str, console: Console) -> None:
    """A skill's captions as a table."""
    table = plain_table(f"{skill}: {len(found)}", "seen as", "also said", fold=True)
    for one in found:
        table.add_row(one.caption, ", ".join(one.shows), one.others[0] if one.others else "")
    console.print(table)
    console.print()
