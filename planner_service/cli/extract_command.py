"""`sims extract FILE`: short scripts out of a film, subtitles or a text."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console

from planner_service.cli.console import ModelOption, plain_table
from planner_service.cli.scripts import keep_scripts
from planner_service.library.library import RESERVED, open_shelves
from planner_service.llm.client import for_story
from planner_service.llm.factory import load_model
from planner_service.output.story_export import check_writable
from planner_service.pipeline import RequestError
from planner_service.scripts.script_library import UNKNOWN
from planner_service.settings import read_settings

if TYPE_CHECKING:
    from planner_service.extraction.extraction_result import Extraction, SceneReport
    from planner_service.extraction.shot_detection import Progress

_SHOWN: Final = 20
"""Clauses without a keyframe that are listed; `--all` lists every one."""
_A_SMALL_STEP: Final = 0.05


def extract(
    file: Annotated[Path, typer.Argument(help="A text (a narrative or a screenplay), subtitles, or a film.")],
    subtitles: Annotated[Path | None, typer.Option(help="Subtitles of the film: SRT, WebVTT or ASS.")] = None,
    name: Annotated[str | None, typer.Option(help="Its title; left out: the name of the file.")] = None,
    licence: Annotated[
        str, typer.Option(help=f"Under which licence the scripts may be passed on; {UNKNOWN!r} unless you say.")
    ] = UNKNOWN,
    out: Annotated[Path | None, typer.Option(help="Write them to this file, as JSON lines.")] = None,
    add: Annotated[bool, typer.Option("--add", help="Keep them in your library, all or none.")] = False,
    every: Annotated[bool, typer.Option("--all", help="List all that no keyframe shows.")] = False,
    model: ModelOption = None,
) -> None:
    """Take short scripts out of a film, subtitles or a text: by the language model if one is set, else by rules.

    Films need the extra video, what is spoken in them the extra asr: pip install "sims-stories[video,asr]".
    """
    from planner_service.extraction.extract import extract
    from planner_service.extraction.extraction_result import Means, Source
    from planner_service.extraction.speech_to_text import load_transcriber

    title = " ".join((file.stem if name is None else name).split())
    if not 0 < len(title) <= 200 or not title.isprintable():
        raise RequestError(f"{title[:60]!r} is no title", "give 1 to 200 letters", at="--name")
    if not 0 < len(licence.strip()) <= 200 or not licence.isprintable():
        raise RequestError("give 1 to 200 letters, such as CC-BY-4.0", at="--licence")
    settings = read_settings(llm_model=model)
    reader = for_story(load_model(settings), 0)
    if out is not None:
        check_writable(out.parent, [out.name])
    shelves = open_shelves(settings, writes=add)
    console = Console(markup=False, highlight=False)
    with _progress(Console(stderr=True, markup=False, highlight=False)) as progress:
        means = Means(
            library=shelves.scripts(),
            model=reader,
            transcriber=load_transcriber(settings),
            strict=settings.llm_on_failure == "error",
            taken=RESERVED,
            progress=progress,
        )
        made = extract(Source(title, file, subtitles, licence.strip()), means)
    _show(console, made, every)
    scripts = [draft.script for draft in made.scripts]
    keep_scripts(scripts, out, shelves if add else None, console)


def _show(console: Console, made: Extraction, every: bool) -> None:
    """A table of the scripts, then what is to be known about them."""
    if made.scripts:
        table = plain_table("id", "time", "emotion", "room", "summary", "repairs", right=("repairs",), fold=True)
        for draft in made.scripts:
            script = draft.script
            start = script.origin.start if script.origin is not None else None
            end = script.origin.end if script.origin is not None else None
            repairs = str(len(draft.repairs))
            table.add_row(script.id, _span(start, end), script.emotion, script.room, script.summary, repairs)
        console.print(table)
    for draft in made.scripts:
        if draft.like:
            console.print(f"{draft.script.id}: nearly the same as {draft.like} of the library", soft_wrap=True)
        for line in draft.repairs:
            console.print(f"{draft.script.id}: {line}", soft_wrap=True)
    for scene in made.scenes:
        if scene.reason:
            console.print(f"{_scene(scene)}: nothing: {scene.reason}", soft_wrap=True)
    unused = [f"{_scene(scene)}: not shown: {clause}" for scene in made.scenes for clause in scene.unused]
    for line in unused if every else unused[:_SHOWN]:
        console.print(line, soft_wrap=True)
    if len(unused) > _SHOWN and not every:
        console.print(f"and {len(unused) - _SHOWN} more that is not shown; --all lists them")
    for note in made.notes:
        console.print(note, soft_wrap=True)
    scripts, scenes = len(made.scripts), len(made.scenes)
    console.print(f"{scripts} short script{'s' * (scripts != 1)} of {scenes} scene{'s' * (scenes != 1)}; by {made.by}")


def _scene(scene: SceneReport) -> str:
    span = _span(scene.start, scene.end)
    return f"scene {scene.number}{f' ({span})' if span else ''}"


def _span(start: float | None, end: float | None) -> str:
    """From when to when in a film: "1:02:03-1:02:41"; empty for a text."""
    return "" if start is None or end is None else f"{_clock(start)}-{_clock(end)}"


def _clock(seconds: float) -> str:
    minutes, second = divmod(int(seconds), 60)
    hour, minute = divmod(minutes, 60)
    return f"{hour}:{minute:02}:{second:02}" if hour else f"{minute}:{second:02}"


@contextmanager
def _progress(console: Console) -> Iterator[Progress]:
    """A bar on a terminal; a line every tenth elsewhere, for what takes long enough to have many steps."""
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    told: dict[str, float] = {}
    if console.is_terminal:
        columns = (TextColumn("{task.description:<12}"), BarColumn(), TimeElapsedColumn())
        with Bar(*columns, console=console, transient=True) as bar:
            task = bar.add_task("opening", total=1.0)
            yield lambda stage, share: bar.update(task, completed=share, description=stage)
        return

    def line(stage: str, share: float) -> None:
        before = told.get(stage, 0.0)
        told[stage] = share
        # Of few steps none takes long.
        if int(10 * share) > int(10 * before) and share - before < _A_SMALL_STEP:
            console.print(f"{stage}: {int(10 * share)}0 %")

    yield line
