"""An instruction to steps to keyframes: the whole way of a task plan (LINGO appendix C), and routines.

Instructions without end in a furnished home, as a task plan that a body can act (LINGO B.1.3).
"""

from __future__ import annotations

from typing import Final, Literal

from motion_backend.planners.markov_planner import PlanError, Planner
from motion_backend.planners.motion_candidates import candidates_from_home
from planner_service.grounding.object_assignment import usable_offers
from planner_service.llm.client import for_story
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.tasks.instruction import tidy
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.task_actions import act_out
from planner_service.tasks.task_llm import plan_with_model
from planner_service.tasks.task_plan import SubTask, TaskError, TaskPlan
from planner_service.tasks.task_rules import plan_by_rules
from scene_graphs.home import Home

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
        raise TaskError("there is no language model", 'set SIMS_LLM_MODEL, or ask for "rules"', at="method")
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


MAX_INSTRUCTIONS: Final = 200


def plan_routine(home: Home, count: int, seed: int = 0) -> TaskPlan:
    """So many instructions of the motion planner in a home, each with its keyframes; the seed chooses among all plans.

    Raises TaskError for a number that is out of bounds or a home where nothing can be done over and over.
    """
    if not 1 <= count <= MAX_INSTRUCTIONS:
        raise TaskError(f"must be a whole number from 1 to {MAX_INSTRUCTIONS}, got {count}", at="count")
    try:
        planner = Planner(candidates_from_home(home, usable_offers(home)), seed)
    except PlanError as error:
        raise TaskError(f"no plan without end can be made of it: {error}", at="layout") from error
    asked = planner.sequence(count)
    tasks = [
        SubTask(c.name, c.category, c.hand, c.takes or c.lays or c.uses or c.place or None, c.place or None)
        for c in asked
    ]
    steps, keyframes = act_out(tasks, Surroundings(home), seed, most=5 * count)
    return TaskPlan(
        action=f"{count} instructions of the motion planner", planner="markov", seed=seed, steps=steps,
        keyframes=keyframes, notes=[],
    )  # fmt: skip
