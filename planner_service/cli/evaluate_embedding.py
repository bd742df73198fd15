"""`sims evaluate embedding`: whether words find their motion, over rooms that the embedding has not learned from."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.cli.console import JsonOption
from planner_service.cli.train_embedding import recorded_clips, show


def embedding(
    rooms: Annotated[int, typer.Option(min=1, max=100, help="Rooms that every caption is acted in.")] = 2,
    clips: Annotated[
        Path | None, typer.Option(help="Recorded motion besides: a collection of `sims clips build`.")
    ] = None,
    weights: Annotated[Path | None, typer.Option(help="Of `sims train embedding`; left out: those shipped.")] = None,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes that act at once.")] = 1,
    as_json: JsonOption = False,
) -> None:
    """Act every caption in rooms that were not learned from; count the clips whose own caption is first among all.

    Captions that mean the same are one group, as in `sims evaluate body`. Recorded people are told apart from that.
    """
    from motion_backend.embedding.text_motion_embedding import TextMotionEmbedding
    from motion_backend.motion import Skill
    from planner_service.evaluation.body_evaluation import plan_trials
    from planner_service.evaluation.captioned_clips import act_clips
    from planner_service.evaluation.embedding_evaluation import acted_retrieval, recorded_retrieval
    from planner_service.scripts.captions import captions

    console = Console(markup=False, highlight=False)
    loaded = TextMotionEmbedding.load(weights)
    known = {Skill(skill): some for skill, some in captions().items()}
    acted = act_clips(plan_trials(known, rooms, 1, without=loaded.learned_from), workers).entries
    found = {"our body, other rooms": acted_retrieval(loaded, acted)}
    people = [entry for entry in recorded_clips(clips) if entry.subject not in loaded.learned_from]
    if people:
        found["other people"] = recorded_retrieval(loaded, people)
    if as_json:
        console.print_json(data={name: asdict(one) for name, one in found.items()})
        return
    for name, one in found.items():
        show(console, name, one)
