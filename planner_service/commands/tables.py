"""Tables as commands print them: no lines, bold headings, figures on the right; and cells from files of others."""

from __future__ import annotations

from collections.abc import Collection

from rich.table import Table


def shown(text: str, most: int = 100) -> str:
    """What a file says, as a terminal may show it: one line of printable letters, cut after `most`."""
    line = " ".join(text[: 4 * most].split())
    safe = "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)
    return safe if len(safe) <= most else safe[: most - 1] + "…"


def plain_table(*columns: str, right: Collection[str] = (), fold: bool = False) -> Table:
    """An empty table with these columns; to `fold` breaks long words instead of cutting them."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in columns:
        table.add_column(
            column, justify="right" if column in right else "left", overflow="fold" if fold else "ellipsis"
        )
    return table
