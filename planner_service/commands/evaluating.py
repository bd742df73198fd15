"""`sims evaluate`: how well our short scripts are found and woven, and how well the body acts, beside the limits."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from planner_service.commands.evaluating_body import body
from planner_service.commands.evaluating_scripts import scripts
from planner_service.commands.evaluating_walks import walks
from planner_service.commands.tables import plain_table
from planner_service.settings import read_settings

if TYPE_CHECKING:
    from planner_service.evaluating.figures import Figure

app = typer.Typer(no_args_is_help=True, help="Measure the planner against written labels, and the body in many rooms.")
app.command()(body)
app.command()(walks)
app.command()(scripts)


@app.callback()
def evaluate() -> None:
    """Measure the planner against written labels, and the body in many rooms."""


@app.command()
def planning(
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of a table.")] = False,
    held_out: Annotated[
        bool, typer.Option("--all", help="List what is missed of the held-out half too; never tune on it.")
    ] = False,
) -> None:
    """Find and weave our short scripts for labelled queries and themes, without a language model.

    Your own scripts have no part in it, since nobody has labelled them. Exit code 1 when a limit is missed.
    """
    from planner_service.evaluating.likeness import RememberingEncoder
    from planner_service.evaluating.planning import evaluate_planning
    from planner_service.scripts.by_heart import load_by_heart
    from planner_service.scripts.library import Features, ScriptLibrary, built_in
    from scene_graphs.packed_library import built_in_index

    cache = read_settings().cache_dir
    library = ScriptLibrary(built_in(), Features(RememberingEncoder(load_by_heart(cache)), cache))
    found = evaluate_planning(library, built_in_index())
    misses = [miss for miss in found.misses if held_out or miss.split == "tune"]
    console = Console(markup=False, highlight=False)
    if as_json:
        figures = [{**asdict(figure), "missed": figure.missed} for figure in found.figures]
        told = {"figures": figures, "misses": list(map(asdict, misses))}
        console.print_json(json.dumps({**told, "encoder": found.encoder, "scripts": found.scripts}))
    else:
        console.print(_planning_table(found.figures))
        console.print(f"{found.scripts} scripts, encoder {found.encoder}; a limit is for the column marked *")
        for miss in misses:
            console.print(f"{miss.split} {miss.id}: {miss.text}", soft_wrap=True)
        if len(misses) < len(found.misses):
            console.print(f"and {len(found.misses) - len(misses)} in the held-out half (--all)")
    if any(figure.missed for figure in found.figures):
        raise typer.Exit(1)


def _planning_table(figures: Sequence[Figure]) -> Table:
    numbers = ("all", "tune", "held out", "limit")
    table = plain_table("figure", *numbers, "", right=numbers)
    for figure in figures:
        parts = {"all": figure.all, "tune": figure.tune, "held_out": figure.held_out}
        judged = figure.judged if figure.limit is not None else ""
        cells = [f"{'*' if part == judged else ''}{value:.1%}" for part, value in parts.items()]
        sense = {"least": "≥", "below": "<", "most": "≤"}[figure.sense]
        limit = "" if figure.limit is None else f"{sense} {figure.limit:.1%}"
        table.add_row(figure.name, *cells, limit, "missed" if figure.missed else "")
    return table
