"""Task plans: an instruction broken into steps, and the keyframes by which a body acts them (LINGO appendix C)."""

from __future__ import annotations

from contextlib import nullcontext

from fastapi import APIRouter

from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Unprocessable
from planner_service.api.scripts.endpoints import waiting_for_model
from planner_service.api.stories.endpoints import home_given, layout_named
from planner_service.api.task_plans.schemas import TaskAsk
from planner_service.components import Parts
from planner_service.tasks.task_plan import TaskPlan
from planner_service.tasks.task_planner import plan_task
from scene_graphs.home import Home, home_from_layouts

task_plans_router = APIRouter(prefix="/v1/task-plans", tags=["task plans"])


@task_plans_router.post("", response_model=TaskPlan)
def plan(ask: TaskAsk, parts: PartsDep) -> TaskPlan:
    """Break an instruction into locomotion, grasp and interaction; `keyframes` can be sent to POST /v1/motions."""
    if ask.layout_id is not None and ask.home is not None:
        raise Unprocessable("/layout_id", "give either layout_id or home, not both")
    home = _home(ask, parts)
    with nullcontext() if ask.method == "rules" else waiting_for_model(parts):
        return plan_task(
            ask.action, home, parts.model, ask.seed, ask.method, insist=parts.settings.llm_on_failure == "error"
        )


def _home(ask: TaskAsk, parts: Parts) -> Home | None:
    if ask.layout_id is not None:
        return home_from_layouts([layout_named(parts, ask.layout_id, "/layout_id")], 0)
    return home_given(ask.home)
