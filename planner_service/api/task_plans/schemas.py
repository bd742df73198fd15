"""Task plans over HTTP: an instruction, and where it is to be done."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from planner_service.api.stories.schemas import Ask, LayoutId, Seed
from planner_service.tasks.task_plan import MAX_ACTION_LENGTH
from scene_graphs.json_fields import Json


class TaskAsk(Ask):
    """An instruction to be broken into steps; nothing is moved, and nothing is stored."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"action": "watch TV on the sofa", "layout_id": "living-room-0016"},
                {"action": "make a cup of tea and drink it at the table", "seed": 2, "method": "rules"},
            ]
        }
    )

    action: str = Field(min_length=1, max_length=MAX_ACTION_LENGTH, description="What is to be done, in plain English.")
    layout_id: LayoutId | None = Field(None, description="A room of the library to do it in, or give `home`, or none.")
    home: Json | None = Field(None, description="A whole home, as GET /v1/stories/{id}/home gives it; or `layout_id`.")
    seed: Seed = 0
    method: Literal["rules", "model"] | None = Field(
        None, description="Who plans; null: the language model where the service has one, else the rules."
    )
