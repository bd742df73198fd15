"""Tables as commands print them: no lines, bold headings, figures on the right."""

from __future__ import annotations

from collections.abc import Collection

from rich.table import Table


def plain_table(*columns: str, right: Collection[str] = (), fold: bool = False) -> Table:
    """An empty table with these columns; to `fold` breaks long words instead of cutting them."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in columns:
        table.add_column(
            column, justify="right" if column in right else "left", overflow="fold" if fold else "ellipsis"
        )
    return table
