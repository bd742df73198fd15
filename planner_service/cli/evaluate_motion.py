"""`sims evaluate motion`: what the learned body would be without what it is told, and backends side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console
from rich.table import Table

from planner_service.cli.console import plain_table
from planner_service.pipeline import RequestError

if TYPE_CHECKING:
    from motion_backend.director import Director
    from planner_service.evaluation.motion_ablation import Ablated

SHOWN: Final = {
    "own": (100, "own, %"), "off": (100, "off, cm"), "off_most": (100, "at most"), "in_furniture": (100, "in, %"),
    "auc whole body": (1, "whole"), "auc legs": (1, "legs"), "auc arms": (1, "arms"), "spread": (1, "spread"),
    "goal_error": (100, "goal, cm"), "slip": (1, "slip, cm/s"), "core_seconds": (1, "core s"),
}  # fmt: skip
"""By what each figure is multiplied to be shown, and its name with its unit."""


def motion(
    clips: Annotated[
        Path | None, typer.Option(help="Collection of `sims clips build`: its people judge walks, and walk in sheets.")
    ] = None,
    ablate: Annotated[bool, typer.Option("--ablate", help="The learned body without each thing it is told.")] = False,
    parts: Annotated[int, typer.Option(min=1, max=1000, help="Parts of each skill, in rooms not learned from.")] = 6,
    people: Annotated[int, typer.Option(min=8, max=1000, help="Bodies that walk.")] = 24,
    weights: Annotated[
        list[Path] | None,
        typer.Option(help="Walking weights of your own without their suffix, judged likewise; repeatable."),
    ] = None,
    sheets: Annotated[Path | None, typer.Option(help="Draw the same actions by all backends into this folder.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of what is drawn.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of tables.")] = False,
) -> None:
    """Ablate the learned body, and draw it beside the others.

    `--ablate` leaves text, scene or frame numbers out of sampling and varies its steps: the same weights, without
    training. What needs training is compared by `--weights`: train with and without it for the same number of steps.
    """
    if not ablate and not weights and sheets is None:
        raise RequestError("there is nothing to do", "give --ablate, --weights or --sheets FOLDER")
    if weights and clips is None:
        raise RequestError("weights are judged by people", "give --clips FILE too", at="--weights")
    console, found = Console(markup=False, highlight=False), dict[str, "Sequence[Ablated]"]()
    if ablate:
        found["parts at furniture"] = _parts(parts)
    if clips is not None and (ablate or weights):
        found["walks"] = _walks(clips, people, ablate, weights or [])
    if as_json:
        console.print_json(json.dumps({name: [one.to_dict() for one in rows] for name, rows in found.items()}))
    else:
        for name, rows in found.items():
            console.print(_table(name, rows))
            console.print()
    if sheets is not None:
        _draw(sheets, clips, seed, Console(markup=False, highlight=False, stderr=as_json))


def _parts(count: int) -> Sequence[Ablated]:
    from motion_backend.diffusion.backend import acting
    from planner_service.evaluation.motion_ablation import ablate_parts, unseen_parts

    return list(ablate_parts(acting(), unseen_parts(count)))


def _walks(clips: Path, people: int, ablate: bool, weights: Sequence[Path]) -> Sequence[Ablated]:
    from motion_backend.diffusion.backend import walking, walking_by
    from motion_backend.mocap.dataset_file import read_dataset
    from planner_service.evaluation.motion_ablation import ABLATIONS, Ablated, ablate_walks

    dataset = read_dataset(clips)
    rows = list(ablate_walks(walking(), dataset, people, ABLATIONS if ablate else ABLATIONS[:1]))
    for path in weights:
        judged = ablate_walks(walking_by(path), dataset, people, ABLATIONS[:1])
        rows += [Ablated(str(path), one.figures) for one in judged]
    return rows


def _draw(folder: Path, clips: Path | None, seed: int, console: Console) -> None:
    from motion_backend.backends import DEFAULT_BACKEND, DIFFUSION, load_backend
    from motion_backend.director import Director
    from planner_service.output.backend_sheets import draw_backends

    directors: list[tuple[str, Director]] = [(name, Director.of(name)) for name in (DEFAULT_BACKEND, DIFFUSION)]
    if clips is not None:
        from motion_backend.matching.backend import matching_backend

        directors.insert(1, ("matching", Director(matching_backend(clips), load_backend(DEFAULT_BACKEND))))
    for path in draw_backends(directors, folder, seed):
        console.print(f"drawn: {path}", soft_wrap=True)


def _table(name: str, rows: Sequence[Ablated]) -> Table:
    shown = [key for key in SHOWN if any(key in one.figures for one in rows)]
    columns = [SHOWN[key][1] for key in shown]
    table = plain_table(name, *columns, right=tuple(columns))
    for one in rows:
        cells = [f"{SHOWN[key][0] * one.figures[key]:.2f}" if key in one.figures else "" for key in shown]
        table.add_row(one.name, *cells)
    return table
