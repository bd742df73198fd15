"""`sims layouts check`: what of the furniture of rooms a body can sit and lie on, and why not the rest."""

from __future__ import annotations

from collections import Counter
from typing import Annotated

import typer
from rich.console import Console

from planner_service.commands.rooms import chosen_layouts
from planner_service.commands.tables import plain_table
from planner_service.settings import read_settings
from planner_service.shelves import open_shelves
from scene_graphs.usability import count_uses

MAX_CHECKED = 10_000
"""Rooms of one command."""


def check(names: Annotated[list[str], typer.Argument(help="Layout files or ids.")]) -> None:
    """Count which furniture can be sat and lain on, as placed or pulled out, and what keeps a body from the rest."""
    layouts = chosen_layouts(names, open_shelves(read_settings()), "NAMES", most=MAX_CHECKED)
    counted = ("pieces", "surface", "as placed", "pulled out")
    table = plain_table("furniture", "to", *counted, "the rest", right=counted)
    for (category, affordance), counts in sorted(count_uses(layouts).items()):
        table.add_row(category, affordance, *_figures(counts))
    console = Console(markup=False, highlight=False)
    console.print(table)
    console.print(f"{len(layouts)} room{'s' * (len(layouts) > 1)}; shares of the pieces; pulled out includes as placed")


def _figures(counts: Counter[str]) -> list[str]:
    """Pieces, the shares with a surface, usable as placed and usable at all, and how often each other verdict fell."""
    pieces = counts.total()
    placed = counts["as placed"]
    shares = (pieces - counts["no surface"], placed, placed + counts["pulled out"])
    rest = [f"{said} {count}" for said, count in counts.most_common() if said not in ("as placed", "pulled out")]
    return [str(pieces), *(f"{share / pieces:.1%}" for share in shares), ", ".join(rest)]
