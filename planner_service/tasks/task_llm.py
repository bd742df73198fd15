"""An instruction broken into steps by a language model, and what is checked of its answer (LINGO appendix C)."""

from __future__ import annotations

import re
from typing import Final, get_args

from pydantic import BaseModel

import prompts
from motion_backend.planners.markov_planner import Category, Hand
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask
from planner_service.tasks.instruction import Kind, misleading, order_of
from planner_service.tasks.surroundings import Surroundings
from planner_service.tasks.task_plan import MAX_STEP_LENGTH, MAX_STEPS, SubTask

CATEGORIES: Final = get_args(Category)
HANDS: Final = get_args(Hand)
_BY_HAND: Final[tuple[Kind, ...]] = ("take", "put", "operate")
_SHOWN: Final = 80
"""Kinds of furniture that the model is told of."""


class TaskStep(BaseModel):
    """One step as a model writes it."""

    step: str
    step_id: int
    category: str
    hand: str | None = None
    object: str | None = None


class TaskSteps(BaseModel):
    """The answer to `prompts/plan_task.md`."""

    steps: list[TaskStep]


def plan_with_model(action: str, room: Surroundings, model: LanguageModel) -> tuple[SubTask, ...]:
    """The steps a model breaks an instruction into. Raises ModelError."""
    prompt = prompts.render(
        "plan_task", action=action, furniture=", ".join(room.names[:_SHOWN]) or "none", most=str(MAX_STEPS)
    )
    answer = ask(model, prompt, TaskSteps, problems_in)
    return tuple(
        SubTask(_tidy(step.step), step.category, _word(step.hand), _tidy(step.object or "") or None)  # type: ignore[arg-type]
        for step in answer.steps
    )


def problems_in(answer: TaskSteps) -> list[str]:
    """What is wrong with an answer, in words for the model."""
    if not 1 <= len(answer.steps) <= MAX_STEPS:
        return [f"steps: {len(answer.steps)} of them, wanted 1 to {MAX_STEPS}"]
    found = []
    for index, step in enumerate(answer.steps):
        where = f"steps.{index}"
        if step.step_id != index + 1:
            found.append(f"{where}.step_id: {step.step_id}, wanted {index + 1}: ids count from 1 in order")
        if step.category not in CATEGORIES:
            found.append(f"{where}.category: {step.category[:40]!r} is none of {', '.join(CATEGORIES)}")
        found += [f"{where}.{fault}" for fault in (*_faults_of_text(step), *_faults_of_hand(step))]
    return found


def _faults_of_text(step: TaskStep) -> list[str]:
    found = []
    for name, text, least in (("step", step.step, 1), ("object", step.object or "", 0)):
        tidy = _tidy(text)
        if not least <= len(tidy) <= MAX_STEP_LENGTH:
            found.append(f"{name}: must have {least} to {MAX_STEP_LENGTH} letters")
        elif not tidy.isprintable() or re.search(r"[,;<>{}]", tidy):
            found.append(f"{name}: plain words without commas, semicolons or brackets, one thing a step")
        elif name == "step" and (fault := misleading(tidy)):
            found.append(f"step: {fault}")
    return found


def _faults_of_hand(step: TaskStep) -> list[str]:
    hand = _word(step.hand)
    if hand is not None and hand not in HANDS:
        return [f"hand: {step.hand!r:.40} is none of {', '.join(HANDS)}, null"]
    order = order_of(_tidy(step.step))
    moves = step.category == "grasp" or (
        step.category == "interaction" and order is not None and order.kind in _BY_HAND
    )
    if moves and hand is None:
        return [f"hand: missing; a hand moves in this step, say which: {', '.join(HANDS)}"]
    named = order.hand if order is not None else None
    return [f"hand: {hand!r}, but the step names the {named} hand"] if named and hand and named != hand else []


def _word(text: str | None) -> str | None:
    word = (text or "").strip().lower()
    return None if word in ("", "null", "none") else word


def _tidy(text: str) -> str:
    return " ".join(text.split())
