"""`sims evaluate walks`: made walks beside recorded ones, by a classifier, feature by feature and as one distance."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from planner_service.cli.console import JsonOption, plain_table

if TYPE_CHECKING:
    from motion_backend.metrics.kernel_mmd import Distance
    from motion_backend.metrics.walk_classifier import Told
    from motion_backend.mocap.dataset_file import Dataset
    from planner_service.evaluation.walk_evaluation import WalkReport, Walks

SHOWN = {"m": (100.0, "cm"), "rad": (180 / np.pi, "°"), "m/s": (1.0, "m/s"), "1/s": (1.0, "1/s"), "": (1.0, "")}
"""By what a figure in our units is multiplied to be shown, and in what unit."""
FAR = 1.0
"""Features farther apart than this many standard deviations are marked."""
MAX_GIVE_AWAYS = 20
COMPARED = ("whole body", "legs", "knees", "arms", "trunk and head")
"""Limbs by which backends are compared."""
TELLS = 0.65
"""Area under the curve from which a trait by itself gives a body away."""


def walks(
    clips: Annotated[Path, typer.Option(help="Collection that `sims clips build` made, with recorded walks.")],
    style: Annotated[str, typer.Option(help="Recorded walks whose style has this word; left out: plain ones.")] = "",
    caption: Annotated[str, typer.Option(help="How ours walk.")] = "steadily walking forward",
    rooms: Annotated[int, typer.Option(min=1, max=100, help="Rooms of the library that ours walk in.")] = 6,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Seeds in each room and mood.")] = 3,
    backend: Annotated[
        list[str] | None,
        typer.Option(help="Instead: backends beside each other, judged by people none is made of; repeatable."),
    ] = None,
    places: Annotated[
        int, typer.Option(min=1, max=100, help="With --backend: places that are walked to in each room.")
    ] = 4,
    as_json: JsonOption = False,
) -> None:
    """Compare our walks with recorded ones: the baseline that a learned motion is to beat.

    A classifier of one second of steady, straight walking says how surely ours are told from people that it has not
    seen, and a list of single traits by what. Windows of 2 s are described by 16 features and compared by a kernel
    distance (MMD²). Recorded people against each other are what both are read against.
    """
    from motion_backend.mocap.dataset_file import read_dataset
    from planner_service.evaluation.walk_evaluation import evaluate_walks

    if backend:
        _compare(read_dataset(clips), backend, caption, (rooms, seeds, places), as_json)
        return
    report = evaluate_walks(read_dataset(clips), style, caption, rooms, seeds)
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps(report.to_dict()))
        return
    people = len(set(report.recorded.groups))
    console.print(_classified(report))
    console.print(
        "AUC: 0.5 where nothing is told apart, 1 where all is; people apart, each asked about once; 95 % over people, "
        f"halves and persons; speeds are means; ! beyond the limit\n{_alone(report)}\n",
        soft_wrap=True,
    )
    console.print(_give_aways(report))
    console.print(_features(report))
    console.print(f"apart: standard deviations of the recorded ones; ! beyond 1; {_spread(report)}\n", soft_wrap=True)
    console.print(_distances(report))
    console.print(
        f"{len(report.recorded)} recorded windows of {people} people, at most 12 of one; {seeds} seeds, {rooms} rooms; "
        f"physics_mode none, backend {report.backend}, “{report.caption}”; 95 % over people, seeds and rooms\n",
        soft_wrap=True,
    )
    console.print(_jerk(report))


def _compare(dataset: Dataset, names: list[str], caption: str, size: tuple[int, int, int], as_json: bool) -> None:
    from motion_backend.backends import require_backend
    from planner_service.evaluation.walk_comparison import MAX_SECONDS, compare_walks

    for name in names:
        require_backend(name)
    found = compare_walks(dataset, names, caption, *size)
    console = Console(markup=False, highlight=False)
    if as_json:
        console.print_json(json.dumps([one.to_dict() for one in found]))
        return
    columns = ("whole", "legs", "knees", "arms", "trunk", "windows", "MMD²", "spread", "slip", "own", "reached")
    table = plain_table("told from strangers", *columns, right=columns)
    for one in found:
        told = [_interval(one.told[limb]) if one.told else "–" for limb in COMPARED]
        far = "–" if one.distance is None else f"{one.distance.value:.3f}"
        own = f"{one.made_by.get(one.name, 0):.0%}" if one.made_by else "–"
        table.add_row(
            f"{one.name}, {one.place}",
            *told,
            str(one.seconds),
            far,
            f"{one.spread:.2f}",
            f"{one.slip:.1f}",
            own,
            f"{one.reached:.0%}",
        )
    console.print(table)
    console.print(
        f"AUC of a classifier that has seen none of the people it is asked about, on the test side of the collection, "
        f"with 95 % over them, by at most {MAX_SECONDS} of a body's windows; "
        f"slip of the best supported point, cm/s; own: frames that no other backend made; {size[1]} walks in the hall, "
        f"{size[0]} rooms of {size[2]} walks; physics_mode none, “{caption}”",
        soft_wrap=True,
    )


def _interval(told: Told) -> str:
    return f"{told.auc:.2f} ({told.low:.2f}–{told.high:.2f})"


def _classified(report: WalkReport) -> Table:
    from planner_service.evaluation.walk_evaluation import AUC_MOST, PEOPLE_AUC

    columns = ("AUC", "95 %", "seconds", "m/s", "limit")
    table = plain_table("told from people by a classifier", *columns, right=columns)
    recorded, yardstick = report.recorded, report.yardstick
    low, high = PEOPLE_AUC
    table.add_row(
        "half of the people, from the others",
        f"{yardstick.teams:.2f}{'' if low <= yardstick.teams <= high else ' !'}",
        f"{yardstick.low:.2f} to {yardstick.high:.2f}",
        *_paces(recorded),
        f"{low:.2f} to {high:.2f}",
    )
    for one in report.compared:
        if one.told is None:
            continue
        table.add_row(one.walks.name, *_told(one.told, AUC_MOST if one is report.compared[0] else None, one.walks))
        if one is report.compared[0]:
            for limb, told in report.limbs.items():
                table.add_row(f"  by {limb}", *_told(told))
    return table


def _told(told: Told, most: float | None = None, walks: Walks | None = None) -> tuple[str, ...]:
    mark = " !" if most is not None and told.auc > most else ""
    paces, limit = _paces(walks) if walks else ("", ""), "" if most is None else f"≤ {most:.2f}"
    return f"{told.auc:.2f}{mark}", f"{told.low:.2f} to {told.high:.2f}", *paces, limit


def _paces(walks: Walks) -> tuple[str, str]:
    return str(len(walks.seconds)), f"{walks.of('speed').mean():.2f}"


def _alone(report: WalkReport) -> str:
    alone = sorted(report.yardstick.alone.values())
    if not alone:
        return "no person has windows enough to be told from all others"
    return f"one person from all others: {np.mean(alone):.2f}, {alone[0]:.2f} to {alone[-1]:.2f}"


def _give_aways(report: WalkReport) -> Table:
    columns = ("AUC", "recorded", "ours")
    table = plain_table("what gives ours away", *columns, right=columns)
    for one in report.give_aways[:MAX_GIVE_AWAYS]:
        if one.auc > TELLS:
            cells = (f"{mean:.2f} ± {deviation:.2f}" for mean, deviation in (one.people, one.ours))
            table.add_row(one.name, f"{one.auc:.2f}", *cells)
    return table


def _spread(report: WalkReport) -> str:
    from planner_service.evaluation.walk_evaluation import SPREAD_LEAST

    mark = " !" if report.spread < SPREAD_LEAST else ""
    return f"spread: ours over theirs, mean (none counts for more than 1) {report.spread:.2f}{mark}, ≥ {SPREAD_LEAST}"


def _features(report: WalkReport) -> Table:
    from motion_backend.metrics.gait_features import UNITS
    from planner_service.evaluation.walk_evaluation import apart, spread

    recorded, matched = report.recorded, report.compared[0].walks
    columns = ("recorded", "ours", "apart", "spread")
    table = plain_table("feature", *columns, "", right=columns)
    gaps, spreads = apart(recorded, matched).tolist(), spread(recorded, matched).tolist()
    for (name, unit), gap, wide in zip(UNITS.items(), gaps, spreads, strict=True):
        factor, sign = SHOWN[unit]
        cells = [f"{factor * of.of(name).mean():.2f} ± {factor * of.of(name).std():.2f}" for of in (recorded, matched)]
        mark = "!" if abs(gap) > FAR else ""
        table.add_row(f"{name}{', ' if sign else ''}{sign}", *cells, f"{gap:+.1f}", f"{wide:.2f}", mark)
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
