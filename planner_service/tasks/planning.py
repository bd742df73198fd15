"""An instruction to steps to keyframes: the whole way of a task plan (LINGO appendix C)."""

from __future__ import annotations

from typing import Literal

from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.served import for_story
from planner_service.tasks.acting_out import act_out
from planner_service.tasks.plan import TaskError, TaskPlan
from planner_service.tasks.reading import tidy
from planner_service.tasks.rules import plan_by_rules
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.with_model import plan_with_model
from scene_graphs.homes import Home

Method = Literal["rules", "model"]
RULES = "rules"


def plan_task(
    action: str,
    home: Home | None = None,
    model: LanguageModel | None = None,
    seed: int = 0,
    method: Method | None = None,
    insist: bool = False,
) -> TaskPlan:
    """The steps of an instruction and what a body acts of them, in a home or, without one, wherever it may be.

    A model plans where there is one, unless the method is "rules"; where it fails the rules take over, unless one
    insists. Raises TaskError for an instruction that is empty, too long or that the rules do not know, ModelError.
    """
    action = tidy(action)
    if method == "model" and model is None:
        raise TaskError('method: there is no language model; set SIMS_LLM_MODEL, or ask for "rules"')
    room, notes, planner = Surroundings(home), list[str](), RULES
    tasks = None
    if model is not None and method != "rules":
        try:
            tasks = plan_with_model(action, room, for_story(model, seed) or model)
            planner = f"llm:{model.name}"
        except ModelError as error:
            if insist or method == "model":
                raise
            notes.append(f"planned by rules: {error}")
    if tasks is None:
        tasks = plan_by_rules(action, room)
    steps, keyframes = act_out(tasks, room, seed)
    return TaskPlan(action=action, planner=planner, seed=seed, steps=steps, keyframes=keyframes, notes=notes)
