"""`sims evaluate physics`: simulated bodies beside the plans they follow, in rooms that nothing was tuned on."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from motion_backend.motion import Skill
from planner_service.cli.console import JsonOption, plain_table
from planner_service.cli.evaluate_stories import read_stories
from planner_service.settings import give_backends, read_settings

if TYPE_CHECKING:
    from planner_service.evaluation.physics_evaluation import PhysicsTrial

SHOWN = {
    "reached": (100, "reached, %"), "contact_error": (100, "contact, cm"),
    "execution": (1, "execution, s"), "weight_error": (100, "off weight, %"),
    "slip": (1, "slip, cm/s"), "slip_planned": (1, "plan's, cm/s"),
    "slip_carried": (1, "carrying, cm/s"),
    "skate": (1, "skate, cm/s"), "skate_ratio": (100, "skate, %"),
    "skate_ratio_planned": (100, "plan's, %"), "floor_pen": (1000, "in floor, mm"),
    "jerk_ratio": (1, "jerk / plan's"), "away": (100, "off plan, cm"), "cpu": (1, "CPU-s / s"),
}  # fmt: skip
"""By what each figure is multiplied to be shown, and its name with its unit."""


def physics(
    trials: Annotated[int, typer.Option(min=0, max=10_000, help="Trials of each skill.")] = 4,
    skills: Annotated[list[Skill] | None, typer.Option("--skill", help="Only this skill; may be repeated.")] = None,
    drawn: Annotated[int | None, typer.Option(min=0, help="Seed of captions, rooms and seeds of the trials.")] = None,
    stories: Annotated[
        str | None, typer.Option(help="So many stories on themes of ours, or a file with a theme a line.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the stories of a file.")] = 7,
    results: Annotated[
        Path | None, typer.Option(help="A file of JSON lines: what it has is not simulated again.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write a contact sheet of every trial into this folder.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Follow plans by a body under gravity (MuJoCo, model-predictive control, no root force) and measure it.

    A trial counts as reached where the action was done at the paper's thresholds, all of it simulated, and without a
    reset onto the plan. Exit code 1 when a limit is missed.
    """
    from planner_service.evaluation.physics_evaluation import (
        DRAWN,
        by_turns,
        keep_row,
        kept_rows,
        run_story,
        run_trial,
    )

    give_backends(read_settings())
    rows = kept_rows(results)
    known = {(row.get("skill"), row.get("caption"), row.get("room"), row.get("theme"), row["seed"]) for row in rows}
    for trial in by_turns(skills or list(Skill), trials, DRAWN if drawn is None else drawn):
        if (trial.skill.value, trial.caption, trial.room, None, trial.seed) in known:
            continue
        if (done := run_trial(trial)) is not None:
            rows.append(done.row)
            keep_row(results, done.row)
            _draw(done, out)
    for story in read_stories(stories, 1) if stories else []:
        told = seed if not (stories or "").isdecimal() else story.seed
        if (None, None, None, story.theme, told) not in known:
            rows.append(run_story(story.theme, told))
            keep_row(results, rows[-1])
    _print(rows, as_json)


def _draw(done: PhysicsTrial, out: Path | None) -> None:
    if out is None:
        return
    from matplotlib.image import imsave

    from motion_backend.rendering.contact_sheet import sheet

    title = f"{done.row['skill']}: {done.row['caption']}"
    pair = [(f"plan · {title}", done.plan.motion), (f"physics · {title}", done.physics.motion)]
    out.mkdir(parents=True, exist_ok=True)
    name = "".join(letter if letter.isalnum() else "-" for letter in f"{title} {done.row['room']}")
    imsave(out / f"{name}.png", sheet(pair, done.physics.home, roles=[done.plan.role, done.physics.role]))


def _print(rows: Sequence[dict[str, Any]], as_json: bool) -> None:
    from planner_service.evaluation.physics_evaluation import LIMITS, figures_of, summed

    told = [row for row in rows if "theme" in row]
    found = [*summed(rows), *([("stories", len(told), figures_of([_as_trial(row) for row in told]))] if told else [])]
    missed = any(values[name][0] > most for _, _, values in found for name, most in LIMITS.items() if name in values)
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps({"rows": rows, "figures": {name: values for name, _, values in found}}))
    else:
        console.print(_table(found, LIMITS))
        console.print("mode mpc, root force 0 N; 95 % over trials; ! beyond the limit")
        for row in told:
            console.print(
                f"{row['reached']} of {row['keyframes']} keyframes, {row['resets']} resets, {row['rewinds']} rewinds, "
                f"{row['seconds']:.0f} s, {row['cpu']:.2f} CPU-s/s: {row['theme']}",
                soft_wrap=True,
            )
        for row in rows:
            if "skill" in row and not row["reached"]:
                why = row["reason"] or ", ".join(row["made_by"])
                console.print(f"missed {row['skill']} · {row['caption']} · {row['room']}: {why}", soft_wrap=True)
    if missed:
        raise typer.Exit(1)


def _as_trial(row: dict[str, Any]) -> dict[str, Any]:
    return row | {"reached": row["reached"] / row["keyframes"]}


def _table(found: Sequence[tuple[str, int, dict[str, Any]]], limits: dict[str, float]) -> Table:
    columns = ("n", *(name for _, name in SHOWN.values()), "resets")
    table = plain_table("skill", *columns[:-1], right=columns)
    for skill, count, values in found:
        cells = []
        for name, (scale, _) in SHOWN.items():
            if name not in values:
                cells.append("")
                continue
            mean, low, high = (scale * value for value in values[name])
            mark = " !" if name in limits and values[name][0] > limits[name] else ""
            cells.append(f"{mean:.1f}{mark} ({low:.1f} to {high:.1f})")
        table.add_row(skill, str(count), *cells)
    return table
