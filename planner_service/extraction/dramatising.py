"""A scene's outline to short scripts: a model writes them in known words, and they are checked and mended."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from pydantic import BaseModel, ConfigDict

import prompts
from motion_backend.motion import Skill
from planner_service.extraction.by_model import FoundScript, draft_of, faults_of
from planner_service.extraction.making import Draft, Maker
from planner_service.extraction.outline import LEEWAY, SceneOutline, inside
from planner_service.llm.asking import ask
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.keyframe import EMOTIONS, MAX_PIECES
from planner_service.scripts.offering import captions_offered, furniture_offered
from scene_graphs.furniture import ROOM_TYPES

_MAX_SCRIPTS: Final = 4
"""Of one scene."""


class FilmedScript(FoundScript):
    """A short script as a model writes it, and the seconds of the film that it is taken from."""

    start: float
    end: float


class FilmedScripts(BaseModel):
    """The answer to `prompts/write_scripts.md`."""

    model_config = ConfigDict(extra="ignore")

    scripts: list[FilmedScript]


def scripts_of(model: LanguageModel, outline: SceneOutline, maker: Maker) -> tuple[Draft, ...]:
    """The short scripts that the model makes of a scene, mended so that a body can act them out. Raises ModelError.

    A scene in which nobody does anything is not asked about.
    """
    if not outline.moments and not outline.contacts:
        return ()
    prompt = prompts.render(
        "write_scripts",
        number=str(outline.number),
        most=str(_MAX_SCRIPTS),
        keyframes=str(MAX_PIECES // 2),
        skills=", ".join(Skill),
        emotions=", ".join(EMOTIONS),
        rooms=", ".join(ROOM_TYPES),
        furniture=furniture_offered(),
        captions=captions_offered(),
        outline=outline.model_dump_json(exclude={"notes", "number"}, indent=1),
    )
    answer = ask(model, prompt, FilmedScripts, lambda found: list(_problems(found, outline)))
    return tuple(
        draft_of(script, (inside(script.start, outline), inside(script.end, outline)), maker, model.name)
        for script in answer.scripts
    )


def _problems(answer: FilmedScripts, outline: SceneOutline) -> Iterator[str]:
    if len(answer.scripts) > _MAX_SCRIPTS:
        yield f"scripts: {len(answer.scripts)} of them, at most {_MAX_SCRIPTS}"
    for index, script in enumerate(answer.scripts[:_MAX_SCRIPTS]):
        for fault in faults_of(script, (outline.number,)):
            yield f"scripts.{index}.{fault}"
        if not outline.start - LEEWAY <= script.start < script.end <= outline.end + LEEWAY:
            span = f"{outline.start:g} to {outline.end:g} s"
            yield f"scripts.{index}: {script.start:g} to {script.end:g} is no span of the scene, {span}"
