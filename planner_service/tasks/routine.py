"""Instructions without end in a furnished home, as a task plan that a body can act (LINGO B.1.3)."""

from __future__ import annotations

from typing import Final

from motion_backend.candidates import candidates_from_home
from motion_backend.markov import PlanError, Planner
from planner_service.placing import usable_offers
from planner_service.tasks.acting_out import act_out
from planner_service.tasks.plan import SubTask, TaskError, TaskPlan
from planner_service.tasks.surroundings import Surroundings
from scene_graphs.homes import Home

MAX_INSTRUCTIONS: Final = 200


def plan_routine(home: Home, count: int, seed: int = 0) -> TaskPlan:
    """So many instructions of the motion planner in a home, each with its keyframes; the seed chooses among all plans.

    Raises TaskError for a number that is out of bounds or a home where nothing can be done over and over.
    """
    if not 1 <= count <= MAX_INSTRUCTIONS:
        raise TaskError(f"count: must be a whole number from 1 to {MAX_INSTRUCTIONS}, got {count}")
    try:
        planner = Planner(candidates_from_home(home, usable_offers(home)), seed)
    except PlanError as error:
        raise TaskError(f"layout: no plan without end can be made of it: {error}") from error
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
