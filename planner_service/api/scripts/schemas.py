"""Short scripts over HTTP: the words of the library with what belongs to its keeping.

Planning over HTTP: a theme, and what may be said about how it is planned.
"""

from __future__ import annotations

from typing import Any, Final

from pydantic import BaseModel, ConfigDict, Field

from motion_backend.motion import Emotion
from planner_service.api.stories.schemas import METHOD, Ask, RoomType, Seed
from planner_service.composition.request import MAX_SHORT_SCRIPTS, Method
from planner_service.scripts.script import Keyframe, Origin, Room, ScriptGraph, Source
from planner_service.themes.beats import MAX_THEME_LENGTH
from scene_graphs.home import MAX_ROOMS

RoomName = Room
EXAMPLE: dict[str, Any] = {
    "id": "water-the-plant",
    "summary": "The character waters the plant and sits down content.",
    "emotion": "relaxed",
    "room": "living_room",
    "keyframes": [
        {"skill": "loco", "emotion": "relaxed", "caption": "stroll", "furniture": "plant"},
        {"skill": "touch", "emotion": "relaxed", "caption": "right hand waters it", "furniture": "plant"},
        {"skill": "loco", "emotion": "relaxed", "caption": "stroll", "furniture": "sofa"},
        {"skill": "sitdown", "emotion": "happy", "caption": "sit content", "furniture": "sofa"},
    ],
}
SHOWN: Final = EXAMPLE | {"source": "authored", "licence": "MIT", "version": 1, "cues": []}


class ShortScriptShown(BaseModel):
    """A few keyframes with one summary: what stories are woven from."""

    model_config = ConfigDict(json_schema_extra={"examples": [SHOWN]})

    id: str = Field(description="A slug; the script is at /v1/short-scripts/{id}.")
    summary: str = Field(description="What happens, in one or a few sentences; by this it is found.")
    emotion: Emotion
    room: RoomName = Field(description="The type of room it plays in.")
    keyframes: list[Keyframe]
    cues: list[str] = Field(description="Other words for what happens, by which it is found too.")
    graph: ScriptGraph | None = Field(description="Furniture and what belongs together; null: as the keyframes use it.")
    source: Source = Field(description="How it came to be written.")
    licence: str = Field(description="Under which it may be passed on.")
    origin: Origin | None = Field(description="Film and seconds, text or scripts it was made from; null: written.")
    version: int = Field(description="Raised when the script is kept again under its id.")
    built_in: bool = Field(description="Whether it is shipped with the service; such a script cannot be deleted.")


class ShortScriptPage(BaseModel):
    """Short scripts, in the order of their ids."""

    items: list[ShortScriptShown]
    next: str | None = Field(description="The cursor of the next page; null on the last.")


class ShortScriptVersions(BaseModel):
    """A short script as it was and is."""

    items: list[ShortScriptShown] = Field(description="Oldest first, at most 100 older ones; the last is as it is.")


class ShortScriptFound(BaseModel):
    """A short script and how near it is to what was asked."""

    score: float = Field(ge=-1.001, le=1.001, description="Cosine of the angle between the two meanings.")
    short_script: ShortScriptShown


class ShortScriptsFound(BaseModel):
    """The nearest short scripts, nearest first."""

    items: list[ShortScriptFound]
    encoder: str = Field(description='What compared the texts: "all-MiniLM-L6-v2", or "hashing" where it is missing.')


class LongScriptAsk(Ask):
    """A theme to be planned; nothing is furnished, told or moved, and nothing is stored."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"theme": "A woman comes home tired, reads a book on the sofa and falls asleep.", "seed": 3},
                {"theme": "He is happy and dances, then he writes a letter.", "method": "matching", "short_scripts": 2},
            ]
        }
    )

    theme: str = Field(
        min_length=1, max_length=MAX_THEME_LENGTH, description="What happens, in a few English sentences."
    )
    method: Method = Field("auto", description=METHOD)
    short_scripts: int | None = Field(
        None, ge=1, le=MAX_SHORT_SCRIPTS, description="How many `matching` weaves; null: choose. Only with it."
    )
    rooms: list[RoomType] = Field([], max_length=MAX_ROOMS, description="Room types to play in; empty: choose.")
    seed: Seed = 0
