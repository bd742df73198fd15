"""Long scripts: planning alone, a theme in and keyframes out."""

from __future__ import annotations

from fastapi import APIRouter

from planner_service.llm.choosing import load_model
from planner_service.parts import PartsDep
from planner_service.schemas.long_scripts import LongScriptAsk
from planner_service.scripts.events import clean
from planner_service.scripts.keyframe import LongScript
from planner_service.stories import StoryRequest, Studio

router = APIRouter(prefix="/v1/long-scripts", tags=["long scripts"])


@router.post("", response_model=LongScript)
def compose(ask: LongScriptAsk, parts: PartsDep) -> LongScript:
    """Plan a theme: its events, the short scripts chosen for them, and every keyframe. Nothing is stored."""
    studio = Studio(parts.shelves, load_model(parts.settings.llm_model))
    request = StoryRequest(
        theme=clean(ask.theme),
        rooms=tuple(ask.rooms),
        short_scripts=ask.short_scripts,
        method=ask.method,
        seed=ask.seed,
    )
    return studio.script(request)
