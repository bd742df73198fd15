"""Short and long scripts over HTTP: the library, searched by meaning, and planning alone.

Long scripts: planning alone, a theme in and keyframes out.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Final

from fastapi import APIRouter, Depends, Header, Path, Query, Request, Response
from fastapi.responses import StreamingResponse
from pydantic import Field

from motion_backend.motion import Emotion
from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Conflict, Fault, NotFound, Problem, Unavailable, Unprocessable
from planner_service.api.scripts.schemas import (
    LongScriptAsk,
    RoomName,
    ShortScriptPage,
    ShortScriptsFound,
    ShortScriptShown,
    ShortScriptVersions,
)
from planner_service.api.web_page import Cursor, Limit, page_of, unchanging
from planner_service.components import Parts
from planner_service.library.library import AbsentError, ChangedError, FixedError, FullError, TakenError, UnfitError
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.script import MAX_PIECES, MAX_VERSIONS, LongScript, ShortScript, Source
from planner_service.scripts.script_library import UNKNOWN, Choice, unknown_licences, unlicensed
from planner_service.themes.beats import MAX_THEME_LENGTH, clean
from scene_graphs.json_fields import Json

short_scripts_router = APIRouter(prefix="/v1/short-scripts", tags=["short scripts"])
ScriptId = Annotated[str, Path(max_length=200, description="The id of a short script.")]
Version = Annotated[int | None, Query(ge=1, le=MAX_VERSIONS, description="As it was then; left out: as it is.")]
REVALIDATED: Final = {"Cache-Control": "private, no-cache"}
"""Kept, but asked for again each time: another version of the service may bring another text."""
LINES: Final = "application/jsonl"
SAVED: Final = {"Content-Disposition": 'attachment; filename="short-scripts.jsonl"', "Cache-Control": "no-store"}
UNLICENSED: Final = "Sims-Licence-Unknown"


def chosen(
    emotion: Annotated[Emotion | None, Query(description="Only scripts of this emotion.")] = None,
    room: Annotated[RoomName | None, Query(description="Only scripts that play in this type of room.")] = None,
    furniture: Annotated[
        list[Annotated[str, Field(min_length=1, max_length=60)]] | None,
        Query(max_length=MAX_PIECES, description="Only scripts that use this; given again, all of these."),
    ] = None,
    source: Annotated[Source | None, Query(description="Only scripts that came to be written like this.")] = None,
    licence: Annotated[
        str | None, Query(min_length=1, max_length=200, description="Only scripts under exactly this licence.")
    ] = None,
) -> Choice:
    """The short scripts that a call is about."""
    return Choice(emotion, room, tuple(furniture or ()), source, licence)


ChoiceDep = Annotated[Choice, Depends(chosen)]


@short_scripts_router.get("", response_model=ShortScriptPage)
def list_short_scripts(parts: PartsDep, choice: ChoiceDep, limit: Limit = 20, cursor: Cursor = None) -> Json:
    """The short scripts there are, in the order of their ids."""
    wanted = {script.id: script for script in choice.of(parts.shelves.scripts())}
    shown, following = page_of(wanted, limit, cursor)
    return {"items": [_shown(parts, script) for script in shown], "next": following}


@short_scripts_router.get("/search", response_model=ShortScriptsFound)
def search_short_scripts(
    parts: PartsDep,
    choice: ChoiceDep,
    q: Annotated[str, Query(min_length=1, max_length=MAX_THEME_LENGTH, description="What happens, in your own words.")],
    k: Annotated[int, Query(ge=1, le=100, description="How many.")] = 5,
) -> Json:
    """The short scripts nearest in meaning. The first search after a start loads the sentence encoder."""
    library = parts.shelves.scripts()
    items = [{"score": one.score, "short_script": _shown(parts, one.script)} for one in choice.search(library, q, k)]
    return {"items": items, "encoder": library.encoder.name}


@short_scripts_router.get(
    "/export",
    response_class=StreamingResponse,
    responses={
        200: {
            "content": {LINES: {"schema": {"type": "string"}}},
            "headers": {
                UNLICENSED: {
                    "description": "How many of them have the licence unknown: nobody says they may be passed on.",
                    "schema": {"type": "integer"},
                },
            },
        },
    },
)
def export(
    parts: PartsDep,
    choice: ChoiceDep,
    own: Annotated[bool, Query(description="Leave out those that are shipped with the service.")] = False,
) -> Response:
    """The short scripts as JSON lines, with origin, licence and version; `sims scripts add` reads them again."""
    scripts = [one for one in choice.of(parts.shelves.scripts()) if not (own and parts.shelves.is_fixed_script(one))]
    lines = (f"{script.model_dump_json(exclude_none=True)}\n" for script in scripts)
    return StreamingResponse(lines, headers=SAVED | {UNLICENSED: str(len(unknown_licences(scripts)))}, media_type=LINES)


@short_scripts_router.post(
    "", status_code=201, response_model=ShortScriptShown, responses={409: {"description": "The id is taken."}}
)
def create(script: ShortScript, response: Response, parts: PartsDep) -> Json:
    """Add a short script to the library; it is there for every story from now on."""
    _refuse_unlicensed(script)
    try:
        parts.shelves.add_scripts(script)
    except (TakenError, FullError) as error:
        raise Conflict(str(error)) from error
    except UnfitError as error:
        raise _unfit(error) from error
    response.headers["Location"] = f"/v1/short-scripts/{script.id}"
    return _shown(parts, script)


@short_scripts_router.get("/{script_id}", response_model=ShortScriptShown)
def show(script_id: ScriptId, request: Request, parts: PartsDep, version: Version = None) -> Response:
    """One short script."""
    script = parts.shelves.scripts().find(script_id)
    if script is None:
        raise _absent()
    if version is not None:
        try:
            script = parts.shelves.script_version(script_id, version)
        except AbsentError as error:
            raise NotFound(str(error)) from error
    body = _body(parts, script)
    return unchanging(request, _etag(body), lambda: body, "application/json", REVALIDATED)


@short_scripts_router.get("/{script_id}/versions", response_model=ShortScriptVersions)
def versions(script_id: ScriptId, parts: PartsDep) -> Json:
    """A short script as it was and is, the oldest version that is kept first."""
    try:
        return {"items": [_shown(parts, script) for script in parts.shelves.script_versions(script_id)]}
    except AbsentError as error:
        raise _absent() from error


@short_scripts_router.put(
    "/{script_id}",
    response_model=ShortScriptShown,
    responses={409: {"description": "Somebody else changed it meanwhile, or it is shipped with the service."}},
)
def replace(
    script_id: ScriptId,
    script: ShortScript,
    parts: PartsDep,
    if_match: Annotated[str | None, Header(max_length=200, description="The ETag of what you change.")] = None,
) -> Json:
    """Change a short script that a user added: send it whole, with the `version` that you read.

    It is kept as the version after that one; the older ones can still be read.
    """
    if script.id != script_id:
        raise Unprocessable("/id", f"it must be the id of the path, {script_id!r}; a copy is added by POST")
    _refuse_unlicensed(script)
    now = parts.shelves.scripts().find(script_id)
    if now is not None and if_match not in (None, "*", f'"{_etag(_body(parts, now))}"'):
        raise Conflict("header:If-Match: the short script has been changed since; read it again")
    try:
        return _shown(parts, parts.shelves.change_script(script))
    except AbsentError as error:
        raise _absent() from error
    except (ChangedError, FixedError, FullError) as error:
        raise Conflict(str(error)) from error
    except UnfitError as error:
        raise _unfit(error) from error


@short_scripts_router.delete(
    "/{script_id}", status_code=204, responses={409: {"description": "It is shipped with the service."}}
)
def delete(script_id: ScriptId, parts: PartsDep) -> None:
    """Remove a short script that a user added, with all its versions; stories that were made of it stay as they are."""
    try:
        parts.shelves.remove_script(script_id)
    except AbsentError as error:
        raise _absent() from error
    except FixedError as error:
        raise Conflict("this short script is shipped with the service and cannot be deleted") from error


def _absent() -> NotFound:
    return NotFound("there is no such short script; GET /v1/short-scripts lists them")


def _refuse_unlicensed(script: ShortScript) -> None:
    if unlicensed(script):
        said = f'say under which licence what comes from a {script.source} may be passed on, or write "{UNKNOWN}"'
        raise Unprocessable("/licence", said)


def _body(parts: Parts, script: ShortScript) -> bytes:
    return ShortScriptShown.model_validate(_shown(parts, script)).model_dump_json().encode()


def _etag(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()[:32]


def _shown(parts: Parts, script: ShortScript) -> Json:
    return script.model_dump() | {"built_in": parts.shelves.is_fixed_script(script)}


def _unfit(error: UnfitError) -> Problem:
    faults = [Fault(pointer=f"/keyframes/{one.keyframe}/{one.field}", detail=one.fault) for one in error.problems]
    problem = Unprocessable(faults[0].pointer, faults[0].detail)
    problem.errors = tuple(faults)
    return problem


long_scripts_router = APIRouter(prefix="/v1/long-scripts", tags=["long scripts"])


@long_scripts_router.post("", response_model=LongScript)
def compose(ask: LongScriptAsk, parts: PartsDep) -> LongScript:
    """Plan a theme: its beats, the short scripts that serve them, and every keyframe. Nothing is stored."""
    pipeline = Pipeline(parts.shelves, parts.model, parts.settings.llm_on_failure == "error")
    request = StoryRequest(
        theme=clean(ask.theme),
        rooms=tuple(ask.rooms),
        short_scripts=ask.short_scripts,
        method=ask.method,
        seed=ask.seed,
    )
    with waiting_for_model(parts):
        return pipeline.for_story(request.seed).script(request)


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
