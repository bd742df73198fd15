"""What commands share: options, tables (no lines, bold headings, figures on the right), a bar, a database that
refuses."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from planner_service.settings import SettingsError

ModelOption = Annotated[
    str | None,
    typer.Option(
        "--model",
        help='The language model (SIMS_LLM_MODEL), such as "ollama:qwen3"; "rules" for none. A model needs the '
        'extra llm: pip install "sims-stories[llm]"; one in a file of yours llamacpp.',
    ),
]

JsonOption = Annotated[bool, typer.Option("--json", help="One JSON object instead of tables.")]
LayoutOption = Annotated[
    list[str] | None,
    typer.Option("--layout", help="A layout file, or the id of a built-in layout; may be given up to 4 times."),
]
BackendOption = Annotated[str | None, typer.Option("--backend", help="What moves the body (SIMS_BACKEND; procedural).")]
NameOption = Annotated[
    str, typer.Option("--name", help="The character's name; left out: as the story or its theme calls them, else Sam.")
]
PronounsOption = Annotated[
    str, typer.Option("--pronouns", help="he, she or they; left out: as in the story or its theme.")
]
HeightOption = Annotated[
    float, typer.Option("--height", help="Metres, 1.1 to 2.2; left at 1.7, a child is as tall as children are.")
]
FilmOption = Annotated[
    bool,
    typer.Option(
        "--film",
        help="Write film.mp4 too; a minute of it takes about twenty seconds. Needs the extra video: "
        'pip install "sims-stories[video]" (make demo brings it).',
    ),
]
UsdOption = Annotated[
    bool,
    typer.Option(
        "--usd",
        help='Write film.usd too, for engines that read USD. Needs the extra usd: pip install "sims-stories[usd]".',
    ),
]


@contextmanager
def progress(what: str) -> Iterator[Callable[[int, int], None]]:
    """A bar beside what is printed, on a terminal alone; it is told how many are done, of how many."""
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def writing_database() -> Iterator[None]:
    """Turns what a database refuses (no space left, locked for long) into a SettingsError."""
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except SQLAlchemyError as error:
        reason = str(getattr(error, "orig", error)).splitlines()[0]
        raise SettingsError(f"the database cannot be written: {reason}", "see SIMS_DATA_DIR") from error


def plain_table(*columns: str, right: Collection[str] = (), fold: bool = False) -> Table:
    """An empty table with these columns; to `fold` breaks long words instead of cutting them."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in columns:
        table.add_column(
            column, justify="right" if column in right else "left", overflow="fold" if fold else "ellipsis"
        )
    return table
