"""`sims evaluate planning|methods|scripts|physics`: how well scripts are found, planned and acted, beside the limits.

`sims evaluate scripts`: whole scripts acted in the largest rooms, beside the paper's Table 2.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from motion_backend.backends import DEFAULT_BACKEND, check_backend
from planner_service.cli.console import JsonOption, plain_table, progress
from planner_service.cli.evaluate_body import body
from planner_service.cli.evaluate_embedding import embedding
from planner_service.cli.evaluate_motion import motion
from planner_service.cli.evaluate_physics import physics
from planner_service.cli.evaluate_walks import walks
from planner_service.llm.factory import load_model
from planner_service.settings import Settings, give_backends, read_settings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner_service.evaluation.method_comparison import Compared
    from planner_service.evaluation.planning_evaluation import Figure
    from planner_service.evaluation.script_evaluation import ScriptFigure
    from planner_service.library.library import Shelves


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
PHYSICS = "physics"
MOVED_BY = {DEFAULT_BACKEND: "kinematic", PHYSICS: "simulated"}
"""What the bodies of a table's rows are."""
MIN_CELLS = 64
"""Rooms × seeds below which it is only a sample."""


def scripts(
    rooms: Annotated[int, typer.Option(min=1, max=100, help="How many of the largest rooms of each type.")] = 10,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Scripts of each level in each room.")] = 2,
    backend: Annotated[
        str, typer.Option(help="Who moves the body: procedural, or physics as in the paper.")
    ] = DEFAULT_BACKEND,
    results: Annotated[Path | None, typer.Option(help="A file of JSON lines: what it has is not acted again.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Act scripts of 2 (simple), 3-4 (mid) and 4-6 (hard) interactions in library rooms, beside the paper's figures.

    The procedural body is kinematic and reaches its goals by construction; theirs are simulated, as is `physics` here.
    """
    check_backend(backend)
    give_backends(read_settings())
    from planner_service.evaluation.script_evaluation import plan_script_trials, run_script_trials, sum_up_scripts

    trials = plan_script_trials(rooms, seeds)
    with progress("acting") as seen:
        acted = run_script_trials(trials, seen, backend, results)
    figures, faults = sum_up_scripts(acted), [one for one in acted if one.fault]
    label = MOVED_BY.get(backend, backend)
    cells = len({(trial.room, trial.seed) for trial in trials})
    console = Console(markup=False, highlight=False)
    if as_json:
        value: dict[str, Any] = {
            "scripts": len(trials), "rooms_and_seeds": cells, "backend": backend, "label": label,
            "physics_mode": "mpc" if backend == PHYSICS else "none",
            "resets": sum(one.resets for one in acted), "rewinds": sum(one.rewinds for one in acted),
            "seconds": round(sum(one.seconds for one in acted), 1),
            "figures": [asdict(figure) for figure in figures], "paper": PAPER,
            "failed": [asdict(one.trial) | {"steps": one.steps, "why": one.fault} for one in faults],
        }  # fmt: skip
        console.print_json(json.dumps(value))
        return
    console.print(_script_table(figures, label))
    console.print(
        f"{len(trials)} scripts, {cells} rooms × seeds; 95 % over these; backend {backend}: {label}",
        soft_wrap=True,
    )
    if backend == PHYSICS:
        resets, rewinds, seconds = (
            sum(getattr(one, name) for one in acted) for name in ("resets", "rewinds", "seconds")
        )
        console.print(f"{resets} resets and {rewinds} rewinds in {seconds / 60:.0f} minutes, no force on the pelvis")
    if cells < MIN_CELLS:
        console.print(f"a sample; figures to be quoted need {MIN_CELLS} rooms × seeds")
    for one in faults:
        console.print(f"{one.trial.level}, {one.trial.room}, seed {one.trial.seed}: {one.fault}", soft_wrap=True)


def _script_table(figures: Sequence[ScriptFigure], label: str) -> Table:
    levels = ("simple", "mid", "hard")
    table = plain_table("figure", "of", *levels, right=levels)
    for name in dict.fromkeys(figure.name for figure in figures):
        times, unit = UNITS.get(name, (1, ""))
        ours = [
            f"{times * one.value:.1f} [{times * one.low:.1f}, {times * one.high:.1f}]"
            for one in figures
            if one.name == name
        ]
        table.add_row(f"{NAMES.get(name, name)} {unit}".strip(), f"ours, {label}", *ours)
        for of, rows in PAPER.items():
            # The paper does not say which of the two rules its steps follow; its code counts as UniHSI's.
            theirs = rows.get({"success_steps_unihsi": "steps"}.get(name, name))
            if theirs:
                table.add_row("", of, *(f"{value}" for value in theirs))
    return table


app = typer.Typer(no_args_is_help=True, help="Measure the planner against written labels, and the body in many rooms.")
app.command()(body)
app.command()(walks)
app.command()(embedding)
app.command()(motion)
app.command()(physics)
app.command()(scripts)


@app.command()
def planning(
    as_json: JsonOption = False,
    held_out: Annotated[
        bool, typer.Option("--show-held-out", help="List what is missed of the held-out half too; never tune on it.")
    ] = False,
    labels: Annotated[
        Path | None, typer.Option(help="Labelled themes of your own instead of ours, held out: one JSON object a line.")
    ] = None,
) -> None:
    """Find scripts for labelled queries and plan labelled themes, without a language model: how much of what was asked
    is found and acted, and how much is acted that was not.

    Your own scripts have no part in it, since nobody has labelled them. Exit code 1 when a limit is missed.
    """
    from planner_service.evaluation.labels import read_labels
    from planner_service.evaluation.planning_evaluation import evaluate_planning

    shelves = _as_shipped(read_settings())
    found = evaluate_planning(shelves.scripts(), shelves.layouts(), read_labels(labels) if labels else None)
    misses = [miss for miss in found.misses if held_out or miss.split == "tune"]
    console = Console(markup=False, highlight=False)
    if as_json:
        figures = [{**asdict(figure), "missed": figure.missed} for figure in found.figures]
        told = {"figures": figures, "misses": list(map(asdict, misses))}
        console.print_json(json.dumps({**told, "encoder": found.encoder, "scripts": found.scripts}))
    else:
        console.print(_planning_table(found.figures, ("all",) if labels else ("all", "tune", "held_out")))
        console.print(f"{found.scripts} scripts, encoder {found.encoder}; a limit is for the column marked *")
        for miss in misses:
            console.print(f"{miss.split} {miss.id}: {miss.text}", soft_wrap=True)
        if len(misses) < len(found.misses):
            console.print(f"and {len(found.misses) - len(misses)} in the held-out half (--show-held-out)")
    if any(figure.missed for figure in found.figures):
        raise typer.Exit(1)


def _as_shipped(settings: Settings) -> Shelves:
    """The library without anybody's own scripts and rooms: nobody has labelled those."""
    from planner_service.library.library import Shelves

    return Shelves(cache=settings.cache_dir)


def _planning_table(figures: Sequence[Figure], shown: Sequence[str]) -> Table:
    numbers = (*(part.replace("_", " ") for part in shown), "limit")
    table = plain_table("figure", *numbers, "", right=numbers)
    for figure in figures:
        parts = {part: getattr(figure, part) for part in shown}
        judged = figure.judged if figure.limit is not None else ""
        cells = [f"{'*' if part == judged else ''}{_measured(value, figure)}" for part, value in parts.items()]
        sense = {"least": "≥", "below": "<", "most": "≤"}[figure.sense]
        limit = "" if figure.limit is None else f"{sense} {_measured(figure.limit, figure)}"
        table.add_row(figure.name, *cells, limit, "missed" if figure.missed else "")
    return table


def _measured(value: float, figure: Figure) -> str:
    return f"{value:.1%}" if figure.unit == "%" else f"{value:.3g}"


@app.command()
def methods(
    half: Annotated[str, typer.Option(help="Which labelled themes: tune, held_out or all.")] = "tune",
    seed: Annotated[int, typer.Option(min=0, help="The same seed plans the same.")] = 0,
    films: Annotated[int, typer.Option(min=0, max=100, help="Write pairs of films of so many themes.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the films, their marking sheet and its key.")] = Path(
        "out/pairs"
    ),
    between: Annotated[str, typer.Option(help="The two methods that are filmed, as the table names them.")] = "",
    as_json: JsonOption = False,
) -> None:
    """Plan the labelled themes by every method side by side, by rules and, where one is set, by a language model.

    With --films, themes are also filmed by two of them under neutral names, for people to mark: sheet.csv asks five
    questions of each film, and only key.csv says which method made it.
    """
    from planner_service.evaluation.labels import SPLITS, labelled_themes
    from planner_service.evaluation.method_comparison import compare, methods_of, write_pairs
    from planner_service.pipeline import Pipeline, RequestError

    if half not in (*SPLITS, "all"):
        raise RequestError(f"{half!r:.40} is none of tune, held_out, all", at="--half")
    settings = read_settings()
    pipeline = Pipeline(_as_shipped(settings), load_model(settings))
    known = {method.title: method for method in methods_of(pipeline)}
    pair = [title.strip() for title in between.split(",")] if between else list(known)[:2]
    if len(pair) != 2 or not set(pair) <= set(known):
        raise RequestError(f"{between!r:.80} is not two of {', '.join(known)}, parted by a comma", at="--between")
    labels = [label for label in labelled_themes() if half in (label.split, "all")]
    compared = []
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("planning", total=len(known) + films)
        for method in known.values():
            compared.append(compare(method, labels, pipeline.shelves.scripts().encoder, seed))
            bar.advance(task)
        if films:
            for done in write_pairs((known[pair[0]], known[pair[1]]), labels, films, out, seed):
                bar.update(task, advance=1, description=f"filmed {done}")
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps({"themes": len(labels), "half": half, "methods": list(map(asdict, compared))}))
        return
    console.print(_methods_table(compared))
    console.print(f"{len(labels)} themes ({half}), seed {seed}, encoder {pipeline.shelves.scripts().encoder.name}")
    if films:
        console.print(f"{' and '.join(pair)} filmed in {out}/: mark sheet.csv before you open key.csv", soft_wrap=True)


def _methods_table(compared: Sequence[Compared]) -> Table:
    titles = [one.method for one in compared]
    table = plain_table("", *titles, right=titles)
    rows: dict[str, list[str]] = {
        "beats acted in order": [f"{one.acted:.1%}" for one in compared],
        "not acted, and named": [f"{one.named:.1%}" for one in compared],
        "forbidden keyframes": [f"{one.forbidden}" for one in compared],
        "screen time unasked": [f"{one.unasked:.1%}" for one in compared],
        "keyframes a beat": [f"{one.deeds:.2f}" for one in compared],
        "stories alike": [f"{one.alike:.1%}" for one in compared],
        "wrongly played or refused": [f"{one.wrong}" for one in compared],
        "calls a theme": [f"{one.calls:.2f}" for one in compared],
        "tokens a theme": [f"{one.tokens:.0f}" for one in compared],
        "seconds a theme": [f"{one.seconds:.3f}" for one in compared],
    }
    for name, cells in rows.items():
        table.add_row(name, *cells)
    return table
