"""Takes: a story derived from a story, with another script, home, seed, backend or character; the rest stays."""

from __future__ import annotations

import json
from dataclasses import replace

from fastapi import APIRouter, Request, Response
from fastapi.exceptions import RequestValidationError

from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Conflict, Unprocessable
from planner_service.api.idempotent_submission import accept_take, repeated
from planner_service.api.stories.endpoints import (
    Key,
    StoriesDep,
    StoryId,
    character_of,
    home_given,
    layouts_named,
    record_of,
)
from planner_service.api.stories.schemas import StoryShown, TakeAsk
from planner_service.api.stories.views import story_shown
from planner_service.components import Parts
from planner_service.grounding.furnish import Furnished
from planner_service.grounding.script_revision import RevisionError, revised, rewritten
from planner_service.jobs.serialization import furnished_from_dict
from planner_service.jobs.story_stages import HOME, SCRIPT, known_before
from planner_service.pipeline import StoryRequest
from planner_service.scripts.script import Keyframe, LongScript
from planner_service.store.story_store import Made, Record, Stories
from planner_service.store.tables import state_of
from scene_graphs.home import Home, HomeError, home_from_layouts
from scene_graphs.json_fields import Json

take_router = APIRouter(prefix="/v1/stories", tags=["stories"])


@take_router.post("/{story_id}/takes", status_code=202, response_model=StoryShown, responses={409: {}})
def take(
    story_id: StoryId,
    ask: TakeAsk,
    request: Request,
    response: Response,
    parts: PartsDep,
    stories: StoriesDep,
    key: Key = None,
) -> Json:
    """Derive a story: what is asked for is different, all else as it was.

    The motion of the keyframes before the first change is taken over, but for the last of them, which looks ahead to
    what follows; `reused` says how many these are.
    """
    caller, body = request.state.caller, f"{story_id}\n{ask.model_dump_json()}"
    record = repeated(parts, caller, "take", body, key)
    if record is None:
        origin = record_of(story_id, stories)
        wanted, known = _derived(origin, ask, stories, _home_of(ask, stories.request(origin.id), parts))
        record = accept_take(parts, caller, wanted, origin.id, known, body, key)
    response.headers["Location"] = f"/v1/stories/{record.id}"
    return story_shown(record)


def _home_of(ask: TakeAsk, asked: StoryRequest, parts: Parts) -> Home | None:
    """The home that is another; None for that of the story. Unprocessable where rooms cannot be one home."""
    if ask.home is not None and ask.layouts:
        raise Unprocessable("/home", "give a whole home or layouts to join to one, not both")
    layouts = layouts_named(parts, ask.layouts)
    try:
        return home_from_layouts(layouts, asked.seed) if layouts else home_given(ask.home)
    except HomeError as error:
        raise Unprocessable("/layouts", str(error)) from error


def _derived(origin: Record, ask: TakeAsk, stories: Stories, home: Home | None) -> tuple[StoryRequest, list[Made]]:
    """What a take asks for, and what of it is known before it begins."""
    asked = stories.request(origin.id)
    script, stage = _so_far(origin, stories, needs_home=home is None)
    try:
        if home is not None:
            script, stage = _elsewhere(script, ask, home), None
        elif stage is not None and ask.keyframes is not None:
            stage = revised(stage, ask.keyframes)
    except RevisionError as error:
        raise _refused(error, ask) from error
    script = script if stage is None else stage.script
    wanted = replace(
        asked,
        home=home or asked.home,
        layouts=() if home else asked.layouts,
        rooms=() if home else asked.rooms,
        keyframes=tuple(map(_plain, script.keyframes)) if asked.keyframes else (),
        seed=asked.seed if ask.seed is None else ask.seed,
        backend=ask.backend or asked.backend,
        character=character_of(ask.character) if ask.character else asked.character,
    )
    return wanted, known_before(wanted, script, stage)


def _so_far(origin: Record, stories: Stories, needs_home: bool) -> tuple[LongScript, Furnished | None]:
    """The script of a story, and its home where that is found. Conflict before they are there."""
    made = {artifact.kind for artifact in origin.artifacts}
    if "home" in made:
        stage = furnished_from_dict(json.loads(stories.data(origin.id, HOME)))
        return stage.script, stage
    if "script" in made and not needs_home:
        return LongScript.model_validate_json(stories.data(origin.id, SCRIPT)), None
    state, lacks = state_of(origin.status), "home" if "script" in made else "script"
    if state in ("queued", "running"):
        raise Conflict(f"this story has no {lacks} yet; follow links.events, and ask again after stage furnish")
    raise Conflict(f"this story was {state} before it had a {lacks}; there is nothing to derive from")


def _elsewhere(script: LongScript, ask: TakeAsk, home: Home) -> LongScript:
    """The script for another home: which objects are meant is found anew where none is named."""
    if ask.keyframes is not None:
        return rewritten(script, ask.keyframes, home)
    keyframes = tuple(keyframe.model_copy(update={"object_id": None}) for keyframe in script.keyframes)
    return script.model_copy(update={"keyframes": keyframes})


def _refused(error: RevisionError, ask: TakeAsk) -> RequestValidationError:
    """Every fault at its place in the body."""
    faults = [
        {"type": "value_error", "loc": ("body", "keyframes", fault.keyframe, fault.field), "msg": fault.said}
        for fault in error.faults
    ]
    return RequestValidationError(faults, body=ask.model_dump(mode="json"))


def _plain(keyframe: Keyframe) -> Keyframe:
    """A keyframe without where it came from."""
    return Keyframe.model_validate(keyframe.model_dump(include=set(Keyframe.model_fields)))
