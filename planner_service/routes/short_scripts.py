"""Short scripts: the library, searched by meaning, and the users' own in it."""

from __future__ import annotations

import hashlib
from typing import Annotated, Final

from fastapi import APIRouter, Path, Query, Request, Response

from planner_service.errors import Conflict, NotFound, Problem, Unprocessable
from planner_service.parts import Parts, PartsDep
from planner_service.routes.caching import unchanging
from planner_service.schemas.pages import Cursor, Limit, page_of
from planner_service.schemas.problems import Fault
from planner_service.schemas.short_scripts import (
    EmotionName,
    RoomName,
    ShortScriptPage,
    ShortScriptsFound,
    ShortScriptShown,
)
from planner_service.schemas.stories import Json
from planner_service.scripts.events import LONGEST
from planner_service.scripts.keyframe import ShortScript
from planner_service.shelves import AbsentError, FixedError, FullError, TakenError, UnfitError

router = APIRouter(prefix="/v1/short-scripts", tags=["short scripts"])
ScriptId = Annotated[str, Path(max_length=200, description="The id of a short script.")]
EmotionDep = Annotated[EmotionName | None, Query(description="Only scripts of this emotion.")]
RoomDep = Annotated[RoomName | None, Query(description="Only scripts that play in this type of room.")]
REVALIDATED: Final = {"Cache-Control": "private, no-cache"}
"""Kept, but asked for again each time: another version of the service may bring another text."""
SEARCH: Final = "search"
"""A path of its own, so no script can be called that."""


@router.get("", response_model=ShortScriptPage)
def list_short_scripts(
    parts: PartsDep, limit: Limit = 20, cursor: Cursor = None, emotion: EmotionDep = None, room: RoomDep = None
) -> Json:
    """The short scripts there are, in the order of their ids."""
    wanted = {
        script.id: script
        for script in parts.shelves.scripts().scripts
        if (emotion is None or script.emotion == emotion) and (room is None or script.room == room)
    }
    shown, following = page_of(wanted, limit, cursor)
    return {"items": [_shown(parts, script) for script in shown], "next": following}


@router.get("/search", response_model=ShortScriptsFound)
def search_short_scripts(
    parts: PartsDep,
    q: Annotated[str, Query(min_length=1, max_length=LONGEST, description="What happens, in your own words.")],
    k: Annotated[int, Query(ge=1, le=100, description="How many.")] = 5,
    emotion: EmotionDep = None,
    room: RoomDep = None,
) -> Json:
    """The short scripts nearest in meaning. The first search after a start loads the sentence encoder."""
    library = parts.shelves.scripts()
    found = library.search(q, k, emotion, room)
    items = [{"score": one.score, "short_script": _shown(parts, one.script)} for one in found]
    return {"items": items, "encoder": library.encoder.name}


@router.post("", status_code=201, response_model=ShortScriptShown, responses={409: {"description": "The id is taken."}})
def create(script: ShortScript, response: Response, parts: PartsDep) -> Json:
    """Add a short script to the library; it is there for every story from now on."""
    if script.id == SEARCH:
        raise Unprocessable("/id", f"{SEARCH!r} is a path of its own; choose another id")
    try:
        parts.shelves.add_scripts(script)
    except (TakenError, FullError) as error:
        raise Conflict(str(error)) from error
    except UnfitError as error:
        raise _unfit(error) from error
    response.headers["Location"] = f"/v1/short-scripts/{script.id}"
    return _shown(parts, script)


@router.get("/{script_id}", response_model=ShortScriptShown)
def show(script_id: ScriptId, request: Request, parts: PartsDep) -> Response:
    """One short script."""
    script = parts.shelves.scripts().find(script_id)
    if script is None:
        raise NotFound("there is no such short script; GET /v1/short-scripts lists them")
    body = ShortScriptShown.model_validate(_shown(parts, script)).model_dump_json().encode()
    etag = hashlib.sha256(body).hexdigest()[:32]
    return unchanging(request, etag, lambda: body, "application/json", REVALIDATED)


@router.delete("/{script_id}", status_code=204, responses={409: {"description": "It is shipped with the service."}})
def delete(script_id: ScriptId, parts: PartsDep) -> None:
    """Remove a short script that a user added; stories that were made of it stay as they are."""
    try:
        parts.shelves.remove_script(script_id)
    except AbsentError as error:
        raise NotFound("there is no such short script; GET /v1/short-scripts lists them") from error
    except FixedError as error:
        raise Conflict("this short script is shipped with the service and cannot be deleted") from error


def _shown(parts: Parts, script: ShortScript) -> Json:
    return script.model_dump() | {"built_in": parts.shelves.is_fixed_script(script)}


def _unfit(error: UnfitError) -> Problem:
    faults = [Fault(pointer=f"/keyframes/{one.keyframe}/{one.field}", detail=one.fault) for one in error.problems]
    problem = Unprocessable(faults[0].pointer, faults[0].detail)
    problem.errors = tuple(faults)
    return problem
