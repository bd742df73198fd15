"""`sims evaluate scripts`: whole scripts acted in the largest rooms, beside the paper's Table 2."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from planner_service.commands.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner_service.evaluating.script_trials import ScriptFigure

PAPER = {
    "SIMS, Table 2": {
        "script_success": (74.3, 42.2, 31.5), "contact_error": (7.2, 12.8, 32.5), "steps": (1.5, 3.1, 4.2)
    },
    "UniHSI, ScanNet": {
        "script_success": (76.1, 43.5, 32.2), "contact_error": (6.7, 10.1, 31.1), "steps": (1.8, 2.9, 4.9)
    },
}  # fmt: skip
"""Simple, mid and hard; shares in percent, errors in cm. Theirs are simulated bodies."""
UNITS = {"script_success": (100, "%"), "script_success_any": (100, "%"), "contact_error": (100, "cm")}
NAMES = {"success_steps_unihsi": "success_steps (UniHSI)"}
MIN_CELLS = 64
"""Rooms × seeds below which it is only a sample."""


def scripts(
    rooms: Annotated[int, typer.Option(min=1, max=100, help="How many of the largest rooms of each type.")] = 10,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Scripts of each level in each room.")] = 2,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of a table.")] = False,
) -> None:
    """Act scripts of 2 (simple), 3-4 (mid) and 4-6 (hard) interactions in library rooms, beside the paper's figures.

    Ours is a kinematic body that reaches its goals by construction; theirs are simulated.
    """
    from planner_service.evaluating.script_trials import plan_script_trials, run_script_trials, sum_up_scripts

    trials = plan_script_trials(rooms, seeds)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("acting", total=len(trials))
        results = run_script_trials(trials, lambda done, _all: bar.update(task, completed=done))
    figures, faults = sum_up_scripts(results), [one for one in results if one.fault]
    cells = len({(trial.room, trial.seed) for trial in trials})
    console = Console(markup=False, highlight=False)
    if as_json:
        value: dict[str, Any] = {
            "scripts": len(trials), "rooms_and_seeds": cells, "physics_mode": "none", "label": "kinematic",
            "figures": [asdict(figure) for figure in figures], "paper": PAPER,
            "failed": [asdict(one.trial) | {"steps": one.steps, "why": one.fault} for one in faults],
        }  # fmt: skip
        console.print_json(json.dumps(value))
        return
    console.print(_script_table(figures))
    console.print(
        f"{len(trials)} scripts, {cells} rooms × seeds; 95 % over these; backend procedural: kinematic",
        soft_wrap=True,
    )
    if cells < MIN_CELLS:
        console.print(f"a sample; figures to be quoted need {MIN_CELLS} rooms × seeds")
    for one in faults:
        console.print(f"{one.trial.level}, {one.trial.room}, seed {one.trial.seed}: {one.fault}", soft_wrap=True)


def _script_table(figures: Sequence[ScriptFigure]) -> Table:
    levels = ("simple", "mid", "hard")
    table = plain_table("figure", "of", *levels, right=levels)
    for name in dict.fromkeys(figure.name for figure in figures):
        times, unit = UNITS.get(name, (1, ""))
        ours = [
            f"{times * one.value:.1f} [{times * one.low:.1f}, {times * one.high:.1f}]"
            for one in figures
            if one.name == name
        ]
        table.add_row(f"{NAMES.get(name, name)} {unit}".strip(), "ours, kinematic", *ours)
        for of, rows in PAPER.items():
            # The paper does not say which of the two rules its steps follow; its code counts as UniHSI's.
            theirs = rows.get({"success_steps_unihsi": "steps"}.get(name, name))
            if theirs:
                table.add_row("", of, *(f"{value}" for value in theirs))
    return table
