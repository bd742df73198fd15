"""`sims cast`: who plays, what there is to wear, and a picture of them all; and `--character` of other commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

import typer
from rich.console import Console

from motion_backend.body.cast import GIVEN, cast
from motion_backend.motion import Character
from planner_service.cast_choice import CharacterError
from planner_service.cli.console import plain_table

CharacterOption = Annotated[
    str,
    typer.Option(
        "--character",
        help='Who plays and how they look, such as "ruth" or "nora,outfit=nurse,hair=bun"; left out: as in the theme. '
        "`sims cast` lists them.",
    ),
]
MAX_LETTERS: Final = 400


def cast_command(
    out: Annotated[Path | None, typer.Option(help="Where a picture of all of them goes, such as cast.png.")] = None,
) -> None:
    """List who plays in stories and what there is to wear; with --out, draw them."""
    console = Console(markup=False)
    known = cast()
    table = plain_table("member", "pronouns", "age", "build", "skin", "hair", "outfit")
    for one in known.member:
        hair = f"{one.hair} {one.hair_color}"
        table.add_row(one.name, one.pronouns, one.age, one.build, one.skin, hair, one.outfit)
    console.print(table)
    console.print("\nwords for --character, each as field=word:", highlight=False)
    for name in GIVEN[1:]:
        console.print(f"  {name}: {', '.join(known.known(name))}", highlight=False)
    if out is not None:
        _draw(out)
        console.print(f"drawn in {out}", highlight=False)


def _draw(path: Path) -> None:
    from PIL import Image

    from planner_service.output.cast_sheet import cast_sheet
    from planner_service.output.story_export import write_files

    write_files(path.parent, {path.name: lambda aside: Image.fromarray(cast_sheet()).save(aside, "PNG")})


def character_given(argument: str, character: Character) -> Character:
    """A character with what `--character` says of it. CharacterError names the part that is not understood."""
    words: dict[str, str] = {}
    for part in filter(None, map(str.strip, argument[:MAX_LETTERS].split(","))):
        name, given, value = (piece.strip() for piece in part.partition("="))
        name, value = (name, value) if given else ("member", name)
        if name not in GIVEN:
            raise CharacterError(f"{name!r:.60} is none of {', '.join(GIVEN)}", at="--character")
        if name in words:
            raise CharacterError(
                f"{name} is given twice, {words[name]!r} and {value!r:.60}", "leave one out", at="--character"
            )
        words[name] = value.lower()
    return Character(**(vars(character) | words))
