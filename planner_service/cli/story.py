"""`sims story THEME`: theme to film, with a progress bar and a closing table of what was reached and how well."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import chain, count
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar
from rich.text import Text

from motion_backend.metrics.figure_limits import held_against
from motion_backend.metrics.figure_words import told_limits
from motion_backend.motion import Character
from planner_service.cast_choice import told_look
from planner_service.cli.cast_command import CharacterOption, character_given
from planner_service.cli.console import (
    BackendOption,
    FilmOption,
    HeightOption,
    LayoutOption,
    ModelOption,
    NameOption,
    PronounsOption,
    UsdOption,
    plain_table,
)
from planner_service.library.library import open_shelves
from planner_service.llm.factory import load_model
from planner_service.llm.ollama_server import ollama_models
from planner_service.narration.told import UNSEEN, Told
from planner_service.pipeline import STAGES, Pipeline, Progress, RequestError, Story, StoryRequest
from planner_service.settings import give_backends, read_settings
from planner_service.themes.beats import clean
from scene_graphs.furniture import ROOM_TYPES

SHARES = {
    "plan": 0.30,
    "furnish": 0.05,
    "narrate": 0.02,
    "act": 0.06,
    "move": 0.12,
    "judge": 0.20,
    "write": 0.25,
    "film": 1.0,
}
"""About how much of the time each stage takes, for the bar."""
MAX_FILE_LINES = 100_000
"""Bytes of a theme's file that are read."""
OUT = Path("out")
"""Where stories go that nobody gave a folder."""
READ_MORE = "Every figure is in report.json; docs/metrics.md says what each means."
MAX_NAME = 60
"""Letters of a folder's name."""
TOLD = {
    "plan": "finding what is done, and how",
    "furnish": "finding rooms that fit",
    "narrate": "telling the story",
    "act": "finding where to sit, lie, touch and walk",
    "move": "moving the body",
    "judge": "measuring the motion",
    "write": "writing the files",
    "film": "filming",
}


def story(
    theme: Annotated[str, typer.Argument(help="What happens, in your own words; @FILE reads it from a file.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for the story's files; left out: a new one in out/, named after the title."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same story.")] = 0,
    rooms: Annotated[
        str | None,
        typer.Option(help="Room types to play in, separated by commas: bedroom, living_room, dining_room, study."),
    ] = None,
    layout: LayoutOption = None,
    backend: BackendOption = None,
    clips: Annotated[
        Path | None, typer.Option(help="Collection whose walks the backend matching is made of (SIMS_CLIPS).")
    ] = None,
    name: NameOption = "Sam",
    pronouns: PronounsOption = "they",
    height: HeightOption = 1.70,
    character: CharacterOption = "",
    film: FilmOption = False,
    usd: UsdOption = False,
    model: ModelOption = None,
) -> None:
    """Turn a story theme into a script, a home, a told story and an animated film."""
    from planner_service.cli.layouts import chosen_layouts

    settings = read_settings(llm_model=model, clips=clips)
    give_backends(settings)
    extra = Extra(film, usd)
    check_output(out, extra)
    pipeline = Pipeline(open_shelves(settings), load_model(settings), settings.llm_on_failure == "error")
    request = StoryRequest(
        theme=clean(read_theme(theme)),
        rooms=() if rooms is None else read_rooms(rooms),
        layouts=chosen_layouts(layout or [], pipeline.shelves),
        seed=seed,
        backend=backend or settings.backend,
        character=character_given(character, Character(name, pronouns, height)),
    )
    console = Console(markup=False)
    if not settings.llm_model and (line := hint(ollama_models(settings.ollama_url))):
        console.print(line, highlight=False, soft_wrap=True)
    produce(lambda show: pipeline.make(request, show), out, extra, console)


class Extra(NamedTuple):
    """Files that are written where they are asked for."""

    film: bool
    usd: bool


def check_output(out: Path | None, extra: Extra) -> None:
    """Fail before the work, not after it. OutputError, FilmUnavailableError, UsdUnavailableError."""
    from motion_backend.formats.usd_film import check_usd
    from planner_service.output.film import check_film
    from planner_service.output.story_export import FILES, FILM, USD, check_writable

    if extra.film:
        check_film()
    if extra.usd:
        check_usd()
    check_writable(out or OUT, [*FILES, *extra.film * (FILM,), *extra.usd * (USD,)])


def produce(make: Callable[[Progress], Story], out: Path | None, extra: Extra, console: Console) -> None:
    """Make a story, write its files and say how it went, with a bar while it takes."""
    from planner_service.output.story_export import write_story

    columns = (TextColumn("{task.description:<42}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=console) as bar:
        task = bar.add_task(TOLD["plan"], total=1.0)

        def show(stage: str, share: float) -> None:
            # A film takes as long again as all the rest.
            stages, part = [*STAGES, "write", "film"], 1 - 0.5 * extra.film
            before = sum(SHARES[s] for s in stages[: stages.index(stage)])
            bar.update(task, completed=part * (before + share * SHARES[stage]), description=TOLD[stage])

        made = make(show)
        show("write", 0.0)
        folder = out or new_folder(OUT, made.planned.told.title)
        files = write_story(made, folder, extra.film, lambda share: show("film", share), extra.usd)
        bar.update(task, completed=1.0, description="done")
    _close(console, made, files)


def new_folder(parent: Path, title: str) -> Path:
    """A folder named after a title that is not there yet, so that no other story is overwritten."""
    name = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:MAX_NAME] or "story"
    numbers = chain([""], (f"-{number}" for number in count(2)))
    return next(folder for number in numbers if not (folder := parent / f"{name}{number}").exists())


def hint(models: Sequence[str] | None) -> str:
    """What to say where a server on this machine could plan and nobody chose it; empty where there is none."""
    if not models:
        return ""
    return f"planned by rules; an Ollama server is running here, --model ollama:{models[0]} would let its model plan"


def read_theme(argument: str) -> str:
    """The theme itself, or the text of the file that `@FILE` names. RequestError for one that is not UTF-8."""
    if not argument.startswith("@"):
        return argument
    path = argument[1:]
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_FILE_LINES + 1)
    except (OSError, ValueError) as error:  # ValueError: a path with a zero byte
        why = f"{getattr(error, 'strerror', None) or error}; after @ comes the path of a file"
        raise RequestError(f"{path or '@'} cannot be read: {why}", at="theme") from error
    if len(data) > MAX_FILE_LINES:
        raise RequestError(f"{path} has more than {MAX_FILE_LINES} bytes", "a theme is a few sentences", at="theme")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        why = f"{error.reason} at byte {error.start}"
        raise RequestError(f"{path} is not UTF-8 text ({why})", "save it as UTF-8", at="theme") from error


def read_rooms(argument: str) -> tuple[str, ...]:
    """The words between commas. RequestError if there are none."""
    rooms = tuple(room.strip() for room in argument.split(",") if room.strip())
    if not rooms:
        raise RequestError(f"there is no room in {argument!r}", f"choose among {', '.join(ROOM_TYPES)}", at="rooms")
    return rooms


def _close(console: Console, made: Story, files: list[Path]) -> None:
    """The closing table: what was reached, and how well; and which beats of the theme were acted."""
    from planner_service.output.story_export import makers, told_notes

    told = made.told
    console.print(f"\n{told.title}\n", style="bold", highlight=False)
    console.print(_slanted(told, console), end="\n\n", highlight=False)
    console.print(f"played by {', '.join(told_look(made.planned.character))}\n", highlight=False)
    table = plain_table(
        "#", "moment", "at", "seconds", "reached", "off by", right=("#", "seconds", "off by"), fold=True
    )
    names, several = made.planned.stage.names, len(made.planned.home.rooms) > 1
    for action, figure in zip(made.actions, made.figures, strict=True):
        piece, room = names[action.keyframe]
        table.add_row(
            str(figure.keyframe + 1),
            action.caption,
            f"{piece}, {room}" if several else piece,
            f"{figure.seconds:.1f}",
            "yes" if figure.reached else Text(f"no {figure.reason}", style="red"),
            "" if figure.contact_error is None else _cm(figure.contact_error),
        )
    console.print(table)
    for line in made.planned.stage.explain():
        console.print(f"  {line}", highlight=False)
    console.print(f"\n{_figures(made.report)}", highlight=False)
    for line in made.beats.lines():
        console.print(line, highlight=False, soft_wrap=True)
    console.print(" ".join(makers(made.planned, made.report)), highlight=False)
    if made.planned.spent is not None:
        console.print(f"language model: {made.planned.spent}", highlight=False)
    for line in told_notes(made):
        console.print(f"done otherwise than its caption says: {line}", highlight=False)
    console.print(f"\nwritten to {files[0].parent}/: {', '.join(file.name for file in files)}", highlight=False)


def _slanted(told: Told, console: Console) -> Text:
    """The text with what is not seen slanted, or between asterisks where nothing can be; and what that means."""
    mark = "" if console.color_system else "*"
    text, end = Text(), 0
    for span in told.thoughts:
        text.append(told.text[end : span.start])
        text.append(f"{mark}{told.text[span.start : span.end]}{mark}", "italic dim")
        end = span.end
    text.append(told.text[end:])
    if told.thoughts:
        before, after = UNSEEN.split("{this}")
        text.append(f"\n\n{before}").append(f"{mark}this{mark}", "italic dim").append(after)
    return text


def _figures(report: dict[str, Any]) -> str:
    """How well it was done, in a sentence; all figures stand in report.json."""
    off = "" if report["contact_error"] is None else f" Seat, bed and hand are {_cm(report['contact_error'])} off."
    limits = "\n".join([*told_limits(held_against(report)), READ_MORE])
    return (
        f"{report['reached']} of {report['keyframes']} moments were done, in {report['seconds']:.0f} s.{off} "
        f"The body is in furniture {100 * report['pen_share']:.1f} % of the time, and a foot that stands slips "
        f"{report['slip']:.1f} cm a second.\n{limits}"
    )


def _cm(metres: float) -> str:
    return f"{100 * metres:.1f} cm"
