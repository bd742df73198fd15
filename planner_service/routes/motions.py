"""Motions: keyframes of one's own, acted out in a room of the library or a home of one's own, without planning."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from planner_service.accepting import accept, repeated
from planner_service.errors import Unprocessable
from planner_service.parts import Parts, PartsDep
from planner_service.presenting import story_shown
from planner_service.routes.stories import Key, character_of, home_given, layout_named
from planner_service.schemas.stories import Json, MotionAsk, StoryShown
from planner_service.stories import StoryRequest, given_script

motions_router = APIRouter(prefix="/v1/motions", tags=["motions"])


@motions_router.post("", name="create", status_code=202, response_model=StoryShown)
def create_motion(ask: MotionAsk, request: Request, response: Response, parts: PartsDep, key: Key = None) -> Json:
    """Act keyframes out. The answer is a story of kind "motion": the same resource, without a planned or told part."""
    if (ask.layout_id is None) == (ask.home is None):
        raise Unprocessable("/layout_id", "give either layout_id or home")
    caller, body = request.state.caller, ask.model_dump_json()
    record = repeated(parts, caller, "motion", body, key) or accept(
        parts, caller, _wanted_motion(ask, parts), body, key
    )
    response.headers["Location"] = f"/v1/stories/{record.id}"
    return story_shown(record)


def _wanted_motion(ask: MotionAsk, parts: Parts) -> StoryRequest:
    layouts = () if ask.layout_id is None else (layout_named(parts, ask.layout_id, "/layout_id"),)
    wanted = StoryRequest(
        theme="",
        layouts=layouts,
        home=home_given(ask.home),
        keyframes=tuple(ask.keyframes),
        backend=ask.backend or parts.settings.backend,
        seed=ask.seed,
        character=character_of(ask.character),
    )
    given_script(wanted)
    return wanted
