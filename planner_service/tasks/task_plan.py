"""What a task plan is made of: steps as in LINGO's appendix C, and the keyframes a body acts them with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from pydantic import BaseModel, ConfigDict, Field

from motion_backend.planners.markov_planner import Category, Hand
from planner_service.scripts.script import Keyframe
from scene_graphs.errors import UserError

MAX_STEPS: Final = 24
MAX_KEYFRAMES: Final = 60
"""As many as POST /v1/motions takes."""
MAX_STEP_LENGTH: Final = 80
"""Letters of a step."""
MAX_ACTION_LENGTH: Final = 300
"""Letters of an instruction."""


class TaskError(UserError):
    """An instruction that cannot be planned; the text names the field and what would be right."""


@dataclass(frozen=True)
class SubTask:
    """One step as it was planned, before it is known what a body can do of it."""

    text: str
    category: Category
    hand: Hand | None = None
    object: str | None = None
    """The thing or furniture it is about."""
    furniture: str | None = None
    """Where it is done, if the planner said so; else it is read from the text."""


class Step(BaseModel):
    """One step of a plan, and how the body acts it."""

    model_config = ConfigDict(frozen=True)

    step: str = Field(description="What is done, as an instruction.")
    step_id: int = Field(description="1 and up, in the order of time.")
    category: Category
    hand: Hand | None = Field(description="The hand that moves, where one does.")
    object: str | None = Field(description="The thing or furniture it is about.")
    furniture: str | None = Field(description="The furniture where the body does it; null for the floor or nowhere.")
    acted: bool = Field(description="Whether the body acts it.")
    why: str = Field(description="Why it does not, or what its acting leaves out; may be empty.")
    keyframes: list[int] = Field(description="The keyframes that act it, by index; steps done in one rest share one.")


class TaskPlan(BaseModel):
    """An instruction as steps, and as keyframes that POST /v1/motions takes as they are."""

    model_config = ConfigDict(frozen=True)

    action: str
    planner: str = Field(description='"rules", or "llm:" and the name of the language model.')
    seed: int
    steps: list[Step]
    keyframes: list[Keyframe] = Field(description="Empty where the body can act nothing of it.")
    notes: list[str] = Field(description="What else is to be known, such as why rules planned it.")
