"""Extractions over HTTP: a film, subtitles or a text goes in, short scripts and notes on them come out."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, ConfigDict, Field
from pydantic import BaseModel as Model

from planner_service.api.stories.schemas import Ask, Failure, State
from planner_service.extraction.text_files import MAX_TEXT_LENGTH
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_library import UNKNOWN

ExtractionStage = Literal["listen", "cut", "read", "gather"]


def _printable(text: str) -> str:
    tidy = " ".join(text.split())
    if not tidy or not tidy.isprintable():
        raise ValueError("give 1 to 200 printable letters")
    return tidy


Words = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_printable)]


class ExtractFields(Ask):
    """What may be said beside the film or text."""

    name: Words | None = Field(None, description="Its title; left out: the name of the file, or what it is.")
    licence: Words = Field(
        UNKNOWN, description=f"Under which the scripts may be passed on; {UNKNOWN!r} unless you say."
    )
    add: bool = Field(False, description="Whether the scripts are kept in the library, all or none.")


class ExtractAsk(ExtractFields):
    """A text: a narrative, a screenplay, or subtitles."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"text": "Anna comes home. She slumps onto the sofa and stares at the wall.", "name": "Anna"}]
        }
    )

    text: str = Field(min_length=1, max_length=MAX_TEXT_LENGTH, description="It is told apart by what it holds.")


class SceneExtracted(Model):
    """What came of one scene."""

    number: int
    start: float | None = Field(description="Seconds, of a film or subtitles.")
    end: float | None
    room: str = Field(description="Where it plays; empty where nothing says so.")
    scripts: list[str] = Field(description="Ids.")
    unused: list[str] = Field(description="What was told and no keyframe shows, each with the reason.")
    reason: str = Field(description="Why there is no script; empty where there is one.")
    by: str = Field(description='Who read it: "rules" or "llm:<model>".')


class ScriptExtracted(Model):
    """A short script that was made of a scene."""

    short_script: ShortScript = Field(description="As POST /v1/short-scripts takes it; `origin` says where it is from.")
    repairs: list[str] = Field(description="What was changed so that a body can act it out, and why.")
    like: str | None = Field(description="The id of a script of the library that is nearly the same.")


class ExtractionLinks(Model):
    """Where the rest is."""

    self_: str = Field(alias="self")
    events: str
    cancel: str


class ExtractionSummary(Model):
    """An extraction in a list."""

    id: str
    name: str = Field(description="The title of what is read.")
    of: Literal["film", "text"] = Field(description="What is read; subtitles alone are a text.")
    state: State
    stage: ExtractionStage | None = Field(description="What is being done, or where it ended.")
    progress: float = Field(ge=0, le=1)
    created: datetime
    error: Failure | None
    links: ExtractionLinks


class ExtractionShown(ExtractionSummary):
    """An extraction, as far as it is made."""

    scene_count: int | None = Field(description="Scenes there are; null before it was cut.")
    scenes: list[SceneExtracted] = Field(description="Those that were read.")
    scripts: list[ScriptExtracted]
    by: str | None = Field(description='Who read it: "rules", "llm:<model>", or both.')
    notes: list[str] = Field(description="What was guessed, left out or done without.")
    added: list[str] = Field(description="Ids of the scripts that were put into the library.")


class ExtractionPage(Model):
    """Extractions, newest first."""

    items: list[ExtractionSummary]
    next: str | None = Field(description="The cursor of the next page; null on the last.")
