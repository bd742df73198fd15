"""`sims task` and `sims routine`: instructions as steps, and a body acting them (LINGO appendix C and B.1.3)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from motion_backend.motion import moment
from planner_service.cli.console import plain_table
from planner_service.library.library import Shelves, open_shelves
from planner_service.llm.factory import load_model
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.settings import read_settings
from planner_service.tasks.task_plan import TaskError, TaskPlan
from planner_service.tasks.task_planner import plan_routine, plan_task
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout

Where = Annotated[str | None, typer.Option("--layout", help="A layout file, or the id of a room of the library.")]
Out = Annotated[Path | None, typer.Option(help="Act it out, and write a story's files to this folder.")]
Seed = Annotated[int, typer.Option(min=0, help="The same seed gives the same plan and motion.")]


def task(
    action: Annotated[str, typer.Argument(help='What is to be done, such as "watch TV on the sofa".')],
    layout: Where = None,
    out: Out = None,
    seed: Seed = 0,
    method: Annotated[str | None, typer.Option(help="rules or model; else the model where one is set.")] = None,
) -> None:
    """Break an instruction into steps, and act it out if a folder is given."""
    if method not in (None, "rules", "model"):
        raise TaskError(f'{method!r:.40} is neither "rules" nor "model"', at="method")
    settings = read_settings()
    shelves = open_shelves(settings)
    room = _room(layout, shelves)
    plan = plan_task(
        action, home_from_layouts([room], 0) if room else None, load_model(settings), seed,
        method, settings.llm_on_failure == "error",  # type: ignore[arg-type]
    )  # fmt: skip
    _finish(plan, room, out, shelves)


def routine(
    layout: Annotated[str, typer.Option(help="A layout file, or the id of a room of the library.")],
    count: Annotated[int, typer.Option(help="How many instructions.")] = 20,
    out: Out = None,
    seed: Seed = 0,
) -> None:
    """Plan what to do in a room without end: plausible, and every motion type as often as any other."""
    shelves = open_shelves(read_settings())
    room = _room(layout, shelves)
    assert room is not None
    _finish(plan_routine(home_from_layouts([room], 0), count, seed), room, out, shelves)


def _room(name: str | None, shelves: Shelves) -> Layout | None:
    from planner_service.cli.layouts import chosen_layouts

    return chosen_layouts([name], shelves, most=1)[0] if name is not None else None


def _finish(plan: TaskPlan, room: Layout | None, out: Path | None, shelves: Shelves) -> None:
    """Print the plan and, with a folder, act it out and write its files."""
    from planner_service.output.story_export import FILES, check_writable, write_story

    if out is not None:
        check_writable(out, FILES)
    console = Console(markup=False)
    _show(plan, console)
    if out is None:
        return
    if not plan.keyframes:
        raise TaskError("a body can act none of its steps, so nothing is written", "see why above", at="action")
    layouts = () if room is None else (room,)
    request = StoryRequest(plan.action, layouts=layouts, keyframes=tuple(plan.keyframes), seed=plan.seed)
    made = Pipeline(shelves).make(request)
    files = write_story(made, out)
    report = made.report
    console.print(
        f"\n{report['reached']} of {report['keyframes']} moments were done · {report['seconds']:.0f} s of motion\n"
        f"written to {out}/: {', '.join(file.name for file in files)}",
        highlight=False,
    )
    for note in made.motion.notes:
        console.print(f"done otherwise: {moment(note.keyframe)}: {note.words}", highlight=False)


def _show(plan: TaskPlan, console: Console) -> None:
    table = plain_table("#", "step", "category", "hand", "at", "acted", "", right=("#",))
    for step in plan.steps:
        acted = "yes" if step.acted else Text("no", style="red")
        table.add_row(
            str(step.step_id), step.step, step.category, step.hand or "", step.furniture or "", acted, step.why
        )
    console.print(table)
    console.print(f"\nplanner: {plan.planner} · {len(plan.keyframes)} keyframes", highlight=False)
    for note in plan.notes:
        console.print(note, highlight=False)
