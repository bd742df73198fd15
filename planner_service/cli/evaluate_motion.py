"""`sims evaluate motion`: what the learned body would be without what it is told, and backends side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console
from rich.table import Table

from planner_service.cli.console import JsonOption, plain_table
from planner_service.pipeline import RequestError

if TYPE_CHECKING:
    from motion_backend.director import Director
    from planner_service.evaluation.backend_stories import Acted
    from planner_service.evaluation.motion_ablation import Ablated

SHOWN: Final = {
    "own": (100, "own, %"), "off": (100, "off, cm"), "off_most": (100, "at most"), "in_furniture": (100, "in, %"),
    "right": (100, "right window, %"), "within_one": (100, "within one, %"), "early": (100, "too early, %"),
    "passages": (1, "passages"),
    "auc whole body": (1, "whole"), "auc legs": (1, "legs"), "auc arms": (1, "arms"), "spread": (1, "spread"),
    "goal_error": (100, "goal, cm"), "slip": (1, "slip, cm/s"), "core_seconds": (1, "core s"),
}  # fmt: skip
"""By what each figure is multiplied to be shown, and its name with its unit."""
OF_STORIES: Final = {
    "own": (100, "frames of its own, %"), "laid_over": (100, "of all, those with the rules' arms or carriage, %"),
    "keyframes": (1, "keyframes"), "reached": (1, "reached"), "contact_error": (100, "contact error, mean, cm"),
    "in_furniture": (100, "frames over 2 cm in furniture, %"), "deepest": (100, "deepest, cm"),
    "slip": (1, "slip, cm/s"), "slip_most": (1, "slip of the worst story, cm/s"),
    "seam": (1, "change of speed at seams, median, m/s"), "seam_most": (1, "at most, m/s"),
    "inside": (1, "99 % of those inside are below, m/s"), "seams_beyond": (100, "seams above that, %"),
    "disobeyed": (1, "captions not obeyed"), "seconds": (1, "seconds"), "core_seconds": (1, "core seconds"),
}  # fmt: skip
"""The same of stories; distances before clean-up come with the names of parts."""


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
    stories: Annotated[
        bool, typer.Option("--stories", help="The paper's seven themes acted by the rules and the learned body.")
    ] = False,
    theme: Annotated[list[str] | None, typer.Option(help="Of the seven only this one, by name; repeatable.")] = None,
    ends: Annotated[
        float | None,
        typer.Option(min=1, max=600, help="Judge the scheduler by so many minutes of motion in unseen rooms."),
    ] = None,
    sheets: Annotated[Path | None, typer.Option(help="Draw the same actions by all backends into this folder.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of what is drawn, and of stories.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Ablate the learned body, and hold it and draw it beside the others.

    `--ablate` leaves text, scene or frame numbers out of sampling and varies its steps: the same weights, without
    training. What needs training is compared by `--weights`: train with and without it for the same number of steps.
    """
    if not ablate and not weights and not stories and ends is None and sheets is None:
        raise RequestError("there is nothing to do", "give --stories, --ends, --ablate, --weights or --sheets FOLDER")
    if weights and clips is None:
        raise RequestError("weights are judged by people", "give --clips FILE too", at="--weights")
    from planner_service.evaluation.motion_ablation import Ablated

    console, found = Console(markup=False, highlight=False), dict[str, "Sequence[Ablated]"]()
    if ablate:
        found["parts at furniture"] = _parts(parts)
    if clips is not None and (ablate or weights):
        found["walks"] = _walks(clips, people, ablate, weights or [])
    if stories:
        acted = _stories(theme or [], seed, None if as_json else console)
        found["stories"] = [Ablated(name, figures) for name, figures in acted.items()]
    if ends is not None:
        found["ends"] = [Ablated(name, figures) for name, figures in _ends(ends, seed).items()]
    if as_json:
        console.print_json(json.dumps({name: [one.to_dict() for one in rows] for name, rows in found.items()}))
    else:
        for name, rows in found.items():
            console.print(_stories_table(rows) if name == "stories" else _table(name, rows))
            console.print()
    if sheets is not None:
        _draw(sheets, clips, seed, Console(markup=False, highlight=False, stderr=as_json))


def _stories(names: Sequence[str], seed: int, console: Console | None) -> dict[str, dict[str, float]]:
    """Figures of the stories by backend; who made what is printed as they are acted, where there is a console."""
    from motion_backend.backends import DEFAULT_BACKEND, DIFFUSION
    from planner_service.evaluation.backend_stories import act_stories, left_to_others, seven_themes, summed
    from planner_service.pipeline import Pipeline

    if unknown := [name for name in names if name not in seven_themes()]:
        raise RequestError(f"{unknown[0]!r:.40} is none of {', '.join(seven_themes())}", at="--theme")
    acted: dict[str, list[Acted]] = {DEFAULT_BACKEND: [], DIFFUSION: []}
    for backend, one in act_stories(names or list(seven_themes()), list(acted), Pipeline(), seed):
        acted[backend].append(one)
        if console is not None and backend == DIFFUSION:
            share = one.story.report["made_by"].get(backend, 0.0)
            console.print(f"{one.name}: {share:.0%} {backend} of {one.story.motion.duration:.0f} s")
            for why, seconds in left_to_others(one, backend).items():
                console.print(f"  {seconds:.1f} s {why}", soft_wrap=True)
    return {backend: summed(stories, backend) for backend, stories in acted.items()}


def _ends(minutes: float, seed: int) -> dict[str, dict[str, float]]:
    from motion_backend.diffusion.backend import acting
    from motion_backend.language.sentence_encoder import load_encoder
    from planner_service.evaluation.acted_motion import act_for_training, ends, summed_ends

    follower, stretches = acting(), list(act_for_training(minutes, seed, unseen=True))
    return summed_ends(list(ends(follower.scheduler, follower.seen_as, stretches, load_encoder().encode)))


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


def _stories_table(columns: Sequence[Ablated]) -> Table:
    names = [one.name for one in columns]
    table = plain_table("stories", *names, right=tuple(names))
    off = sorted({key for one in columns for key in one.figures if key.startswith("off")}, key=lambda key: key[::-1])
    told = {key: (100, key.replace("off_most", "at most:").replace("off", "off before clean-up, cm:")) for key in off}
    for key, (factor, words) in {**OF_STORIES, **told}.items():
        cells = [f"{factor * one.figures[key]:.2f}" if key in one.figures else "" for one in columns]
        table.add_row(words, *cells)
    return table
