"""`sims clips sheet`: contact sheets of a collection's clips, of one caption, or of all that our body can do."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console

from motion_backend.motion import Skill
from planner_service.commands.tables import shown
from planner_service.filing import check_writable, write_files
from planner_service.stories import RequestError

if TYPE_CHECKING:
    from motion_backend.rendering import Image

MAX_SHOWN: Final = 40
"""Clips of a collection on one sheet."""


def sheet(
    file: Annotated[Path | None, typer.Argument(help="A collection that `sims clips build` wrote.")] = None,
    out: Annotated[Path | None, typer.Option(help="Write the picture here, as PNG.")] = None,
    clip: Annotated[
        list[str] | None, typer.Option(help="A clip's name, as often as wanted; left out: one clip of every skill.")
    ] = None,
    caption: Annotated[str | None, typer.Option(help="Instead of clips: our own body acting this caption.")] = None,
    every: Annotated[
        Path | None, typer.Option("--all", help="Instead of clips: a folder for sheets of all captions we know.")
    ] = None,
    skill: Annotated[Skill | None, typer.Option(help="The caption's skill; with --all, only this one.")] = None,
    room: Annotated[
        str | None, typer.Option(help="A room of the library; left out: the first that has what a caption needs.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Where it begins, and small differences.")] = 0,
) -> None:
    """Draw motion: poses over time from two sides, where feet stood, and the way from above."""
    from motion_backend.pictures import save_png

    if sum(one is not None for one in (file, caption, every)) != 1:
        raise RequestError("sheet: give one of FILE, --caption and --all; it says what to draw")
    if every is not None:
        _draw_all(every, skill, room, seed)
        return
    if out is None:
        raise RequestError("--out: say where the picture goes, such as --out sheet.png")
    check_writable(out.parent, [out.name])
    picture = _of_clips(file, clip) if file is not None else _of_caption(str(caption), skill, room, seed)
    write_files(out.parent, {out.name: lambda path: save_png(picture, path)})
    Console(markup=False, highlight=False).print(f"drawn in {out}", soft_wrap=True)


def _of_clips(file: Path, names: list[str] | None) -> Image:
    from motion_backend.clips.clip import ClipError
    from motion_backend.clips.dataset import read_dataset
    from motion_backend.sheets import sheet as drawn

    dataset = read_dataset(file)
    chosen = [dataset.named(name) for name in names] if names else dataset.of_every_skill()
    if len(chosen) > MAX_SHOWN:
        raise ClipError(f"--clip: a sheet shows at most {MAX_SHOWN} clips, these are {len(chosen)}; name fewer")
    return drawn([(shown(f"{entry.name}: {entry.captions[0]}"), entry.motion) for entry in chosen])


def _of_caption(caption: str, skill: Skill | None, room: str | None, seed: int) -> Image:
    from planner_service.caption_sheets import caption_sheet

    return caption_sheet(caption, skill, room, seed)


def _draw_all(folder: Path, skill: Skill | None, room: str | None, seed: int) -> None:
    from motion_backend.pictures import save_png
    from planner_service.caption_sheets import vocabulary_sheets

    console = Console(markup=False, highlight=False)
    check_writable(folder, ())
    for name, picture in vocabulary_sheets([skill] if skill else list(Skill), room, seed):

        def write(path: Path, picture: Image = picture) -> None:
            save_png(picture, path)

        write_files(folder, {name: write})
        console.print(f"{folder / name}", soft_wrap=True)
