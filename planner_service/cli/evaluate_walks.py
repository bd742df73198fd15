"""`sims evaluate walks`: made walks beside recorded ones, by a classifier, feature by feature and as one distance."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from planner_service.cli.console import plain_table

if TYPE_CHECKING:
    from motion_backend.metrics.kernel_mmd import Distance
    from planner_service.evaluation.walk_evaluation import Compared, WalkReport

SHOWN = {"m": (100.0, "cm"), "rad": (180 / np.pi, "°"), "m/s": (1.0, "m/s"), "1/s": (1.0, "1/s"), "": (1.0, "")}
"""By what a figure in our units is multiplied to be shown, and in what unit."""
FAR = 1.0
"""Features farther apart than this many standard deviations are marked."""


def walks(
    clips: Annotated[Path, typer.Option(help="Collection that `sims clips build` made, with recorded walks.")],
    style: Annotated[str, typer.Option(help="Recorded walks whose style has this word; left out: plain ones.")] = "",
    caption: Annotated[str, typer.Option(help="How ours walk.")] = "steadily walking forward",
    rooms: Annotated[int, typer.Option(min=1, max=100, help="Rooms of the library that ours walk in.")] = 6,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Seeds in each room and mood.")] = 3,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of tables.")] = False,
) -> None:
    """Compare our walks with recorded ones: the baseline that a learned motion is to beat.

    Windows of 2 s of steady, straight walking are described by 16 features and compared by a kernel distance (MMD²);
    recorded people against each other are the floor it is read against.
    """
    from motion_backend.mocap.dataset_file import read_dataset
    from planner_service.evaluation.walk_evaluation import evaluate_walks

    report = evaluate_walks(read_dataset(clips), style, caption, rooms, seeds)
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps(report.to_dict()))
        return
    people = len(set(report.recorded.groups))
    console.print(_features(report))
    console.print("apart: standard deviations of the recorded ones; ! beyond 1\n")
    console.print(_distances(report))
    console.print(
        f"{len(report.recorded)} recorded windows of {people} people, at most 12 of one; {seeds} seeds, {rooms} rooms; "
        f"physics_mode none, backend {report.backend}, “{report.caption}”; 95 % over people, seeds and rooms\n",
        soft_wrap=True,
    )
    console.print(_jerk(report))


def _features(report: WalkReport) -> Table:
    from motion_backend.metrics.gait_features import UNITS
    from planner_service.evaluation.walk_evaluation import apart

    recorded, matched = report.recorded, report.compared[0].walks
    table = plain_table("feature", "recorded", "ours", "apart", "", right=("recorded", "ours", "apart"))
    for (name, unit), gap in zip(UNITS.items(), apart(recorded, matched).tolist(), strict=True):
        factor, sign = SHOWN[unit]
        cells = [f"{factor * of.of(name).mean():.2f} ± {factor * of.of(name).std():.2f}" for of in (recorded, matched)]
        table.add_row(f"{name}{', ' if sign else ''}{sign}", *cells, f"{gap:+.1f}", "!" if abs(gap) > FAR else "")
    return table


def _distances(report: WalkReport) -> Table:
    columns = ("MMD²", "95 %", "windows", "skate_ratio", "skate, cm/s")
    table = plain_table("ours, beside recorded walks", *columns, right=columns)
    recorded = report.recorded
    table.add_row(
        "people among themselves", *_cells(report.floor), *_feet(len(recorded), recorded.skates, recorded.slides)
    )
    for one in report.compared:
        table.add_row(one.walks.name, *_cells(one.distance), *_feet(len(one.walks), one.walks.skates, one.walks.slides))
    return table


def _cells(distance: Distance) -> tuple[str, str]:
    return f"{distance.value:.3f}", f"{distance.low:.3f} to {distance.high:.3f}"


def _feet(windows: int, skates: tuple[float, ...], slides: tuple[float, ...]) -> tuple[str, str, str]:
    return str(windows), f"{np.mean(skates):.1%}", f"{np.mean(slides):.1f}"


def _jerk(report: WalkReport) -> Table:
    columns = ("recorded", "ours", "ours / recorded", "windows")
    table = plain_table("jerk, m/s³, at", *columns, right=columns)
    for one in report.jerk:
        ratio = one.ours / one.recorded
        span = f"{one.slowest:.1f} to {one.fastest:.1f} m/s"
        table.add_row(span, f"{one.recorded:.0f}", f"{one.ours:.0f}", f"{ratio:.2f}", str(one.windows))
    return table
