"""Planning over HTTP: a theme, and what may be said about how it is planned."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from planner_service.schemas.stories import Ask, RoomType, Seed
from planner_service.scripts.composing import MAX_SHORT_SCRIPTS
from planner_service.scripts.events import MAX_THEME_LENGTH
from scene_graphs.homes import MAX_ROOMS


class LongScriptAsk(Ask):
    """A theme to be planned; nothing is furnished, told or moved, and nothing is stored."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"theme": "A woman comes home tired, reads a book on the sofa and falls asleep.", "seed": 3},
                {"theme": "He is happy and dances, then he writes a letter.", "short_scripts": 2, "rooms": ["study"]},
            ]
        }
    )

    theme: str = Field(
        min_length=1, max_length=MAX_THEME_LENGTH, description="What happens, in a few English sentences."
    )
    method: Literal["matching", "direct"] = Field(
        "matching", description="Woven from the library's short scripts, or written at once (SIMS 10's baseline)."
    )
    short_scripts: int | None = Field(None, ge=1, le=MAX_SHORT_SCRIPTS, description="How many are woven; null: choose.")
    rooms: list[RoomType] = Field([], max_length=MAX_ROOMS, description="Room types to play in; empty: choose.")
    seed: Seed = 0
