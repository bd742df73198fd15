"""Tables as commands print them: no lines, bold headings, figures on the right; and a database that refuses."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer
from rich.table import Table

from planner_service.settings import SettingsError

ModelOption = Annotated[
    str | None,
    typer.Option("--model", help='The language model (SIMS_LLM_MODEL), such as "ollama:qwen3"; "rules" for none.'),
]


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
