"""Long scripts: planning alone, a theme in and keyframes out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import APIRouter

from planner_service.errors import Unavailable
from planner_service.parts import Parts, PartsDep
from planner_service.schemas.long_scripts import LongScriptAsk
from planner_service.scripts.events import clean
from planner_service.scripts.keyframe import LongScript
from planner_service.stories import StoryRequest, Studio

long_scripts_router = APIRouter(prefix="/v1/long-scripts", tags=["long scripts"])


@long_scripts_router.post("", response_model=LongScript)
def compose(ask: LongScriptAsk, parts: PartsDep) -> LongScript:
    """Plan a theme: its events, the short scripts chosen for them, and every keyframe. Nothing is stored."""
    studio = Studio(parts.shelves, parts.model, parts.settings.llm_on_failure == "error")
    request = StoryRequest(
        theme=clean(ask.theme),
        rooms=tuple(ask.rooms),
        short_scripts=ask.short_scripts,
        method=ask.method,
        seed=ask.seed,
    )
    with waiting_for_model(parts):
        return studio.for_story(request.seed).script(request)


@contextmanager
def waiting_for_model(parts: Parts) -> Iterator[None]:
    """One of the few places of those who wait for a language model. Unavailable when all are taken."""
    if parts.model is None:
        yield
        return
    if not parts.planning.acquire(blocking=False):
        raise Unavailable("the language model is busy with other requests; ask again", retry_after=5)
    try:
        yield
    finally:
        parts.planning.release()
