"""Stories: post a theme, follow it being made, fetch what is ready, stop it, forget it.

Motions: keyframes of one's own, acted out in a room of the library or a home of one's own, without planning.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Sequence
from typing import Annotated, Final, Literal

from fastapi import APIRouter, Depends, Header, Path, Query, Request, Response

from motion_backend.formats import FORMATS, encode
from motion_backend.formats.glb_film import body_glb, props_glb, scene_glb
from motion_backend.formats.usd_film import UsdUnavailableError, check_usd, film_usd
from motion_backend.motion import Character
from motion_backend.props import replaced
from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Conflict, NotFound, NotProvided, NotReady, Unprocessable
from planner_service.api.idempotent_submission import accept, repeated
from planner_service.api.layouts import views
from planner_service.api.stories.schemas import CharacterAsk, MotionAsk, StoryAsk, StoryPage, StoryShown
from planner_service.api.stories.views import Footage, role_in, story_shown, story_summary
from planner_service.api.web_page import unchanging
from planner_service.components import Parts
from planner_service.jobs.story_stages import HOME
from planner_service.pipeline import StoryRequest, given_script
from planner_service.store.film_store import film_of
from planner_service.store.story_store import STORIES, Record, Stories, StoryGone
from planner_service.store.tables import state_of
from planner_service.themes.beats import clean
from planner_service.user_errors import explain
from scene_graphs.home import Home, home_from_dict
from scene_graphs.json_fields import Json
from scene_graphs.layout import Layout

stories_router = APIRouter(prefix="/v1/stories", tags=["stories"])
StoryId = Annotated[str, Path(max_length=64, description="The id of a story.")]
Key = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key", min_length=1, max_length=200, pattern=r"^[\x21-\x7e]+$",
        description="The same key with the same body gives the same story, however often it is sent.",
    ),
]  # fmt: skip
GLB: Final = "model/gltf-binary"
USD: Final = "model/vnd.usd"


async def stories_of(parts: PartsDep) -> Stories:
    """The table of stories."""
    return Stories(parts.engine)


StoriesDep = Annotated[Stories, Depends(stories_of)]


def record_of(story_id: StoryId, stories: StoriesDep) -> Record:
    """The story that a path names."""
    absent = "there is no such story; GET /v1/stories lists them"
    try:
        record = stories.get(story_id)
    except StoryGone as error:
        raise NotFound(absent) from error
    if record.kind not in STORIES:
        raise NotFound(absent)
    return record


RecordDep = Annotated[Record, Depends(record_of)]


@stories_router.post("", status_code=202, response_model=StoryShown)
def create(ask: StoryAsk, request: Request, response: Response, parts: PartsDep, key: Key = None) -> Json:
    """Make a story of a theme. It is queued when this answers; follow it at `links.events`."""
    caller, body = request.state.caller, ask.model_dump_json()
    record = repeated(parts, caller, "story", body, key) or accept(parts, caller, _wanted(ask, parts), body, key)
    response.headers["Location"] = f"/v1/stories/{record.id}"
    return story_shown(record)


def _wanted(ask: StoryAsk, parts: Parts) -> StoryRequest:
    return StoryRequest(
        theme=clean(ask.theme),
        rooms=tuple(ask.rooms),
        layouts=layouts_named(parts, ask.layouts),
        home=home_given(ask.home),
        short_scripts=ask.short_scripts,
        method=ask.method,
        backend=ask.backend or parts.settings.backend,
        seed=ask.seed,
        character=character_of(ask.character),
    )


def layouts_named(parts: Parts, names: Sequence[str]) -> tuple[Layout, ...]:
    """The rooms of these ids."""
    return tuple(layout_named(parts, name, f"/layouts/{number}") for number, name in enumerate(names))


def layout_named(parts: Parts, name: str, pointer: str) -> Layout:
    """The room of that id."""
    try:
        return parts.shelves.rooms()[name]
    except KeyError as error:
        raise Unprocessable(pointer, "there is no such room; GET /v1/layouts lists them") from error


def home_given(row: Json | None) -> Home | None:
    """The home that a body holds."""
    return None if row is None else views.home_given(row, "/home")


def character_of(ask: CharacterAsk | None) -> Character:
    """Who acts."""
    return Character(**ask.model_dump()) if ask else Character()


@stories_router.get("", response_model=StoryPage)
def list_stories(
    stories: StoriesDep,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    cursor: Annotated[str | None, Query(max_length=64, description="`next` of the page before.")] = None,
) -> Json:
    """Stories, newest first."""
    check_cursor(cursor)
    found = stories.page(limit + 1, cursor)
    shown = found[:limit]
    frames = stories.durations(record.id for record in shown)
    items = [story_summary(record, frames.get(record.id, 0)) for record in shown]
    return {"items": items, "next": shown[-1].id if len(found) > limit else None}


def check_cursor(cursor: str | None) -> None:
    """Unprocessable for what is no id of a story."""
    try:
        ours = cursor is None or str(uuid.UUID(cursor)) == cursor
    except ValueError:
        ours = False
    if not ours:
        raise Unprocessable("?cursor", "not a cursor that this service gave; leave it out for the first page")


@stories_router.get("/{story_id}", response_model=StoryShown)
async def show(record: RecordDep) -> Json:
    """A story, as far as it is made."""
    return story_shown(record)


@stories_router.post("/{story_id}/cancel", status_code=202, response_model=StoryShown, responses={409: {}})
def cancel(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> Json:
    """Stop a story: the segment in the making is the last. What was made can still be fetched."""
    state = state_of(record.status)
    if state in ("queued", "running"):
        parts.jobs.cancel(record.id)
        record = stories.get(record.id)
        state = state_of(record.status)
    if state != "cancelled":
        raise Conflict(f"this story has {state}; there is nothing to cancel")
    return story_shown(record)


@stories_router.delete("/{story_id}", status_code=204)
def forget(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> None:
    """Delete a story and all that was made of it; one in the making is stopped."""
    with parts.engine.connect() as connection:
        film_id = film_of(connection, record.id)
    if film_id is not None:
        drop(stories.get(film_id), parts, stories)
    drop(record, parts, stories)


def drop(record: Record, parts: Parts, stories: Stories) -> None:
    """Delete a story or film with what the job engine knows of it; one in the making is stopped. StoryGone."""
    running = state_of(record.status) in ("queued", "running")
    if running:
        parts.jobs.cancel(record.id)
    stories.delete(record.id)
    if not running:
        parts.jobs.forget(record.id)


@stories_router.get("/{story_id}/home", response_model=Json)
def home(record: RecordDep, request: Request, stories: StoriesDep) -> Response:
    """The home whole: rooms with their furniture, walls, doorways. It can be posted again as `home`."""
    etag = _made(record, "home")

    def make() -> bytes:
        return json.dumps(_home_row(stories, record), ensure_ascii=False).encode()

    return unchanging(request, f"{etag}-home", make, "application/json")


@stories_router.get("/{story_id}/scene.glb", response_class=Response, responses={200: {"content": {GLB: {}}}})
def scene(record: RecordDep, request: Request, stories: StoriesDep) -> Response:
    """The home alone, but for doors that its story opens, which are among the props."""
    etag = _made(record, "home")
    role = role_in(record)
    tag = "-".join([etag, "scene", *(name.replace(" ", "_") for name in sorted(replaced(role)))])
    return unchanging(request, tag, lambda: scene_glb(home_from_dict(_home_row(stories, record)), role), GLB)


@stories_router.get("/{story_id}/props.glb", response_class=Response, responses={200: {"content": {GLB: {}}}, 204: {}})
def props(record: RecordDep, request: Request, stories: StoriesDep) -> Response:
    """What is in the hands, animated, in the frames that are ready; 204 where that is nothing."""
    footage = Footage(record)
    if not footage.ready:
        raise NotReady("not ready yet: nothing has moved; follow links.events")
    data = props_glb(footage.motion(stories, 0, footage.ready), role_in(record))
    if not data:
        return Response(status_code=204, headers={"Cache-Control": "no-store"})
    if footage.complete:
        return unchanging(request, f"{footage.etag(0, footage.ready)}-props", lambda: data, GLB)
    return Response(data, headers={"Cache-Control": "no-store"}, media_type=GLB)


@stories_router.get("/{story_id}/film.glb", response_class=Response, responses={200: {"content": {GLB: {}}}})
def film(record: RecordDep, request: Request, stories: StoriesDep) -> Response:
    """The home and the animated character in one file."""
    etag = _made(record, "film")
    position = record.artifacts[-1].position
    return unchanging(request, etag, lambda: stories.data(record.id, position), GLB, _named(record, ".glb"))


@stories_router.get("/{story_id}/film.usd", response_class=Response, responses={200: {"content": {USD: {}}}, 501: {}})
def film_as_usd(record: RecordDep, request: Request, stories: StoriesDep) -> Response:
    """The same as USD, where the service has usd-core: Y up, metres, 30 time codes a second."""
    _made(record, "home")
    footage = Footage(record)
    if not footage.complete:
        raise NotReady(f"not ready yet: {footage.ready} frames are; follow links.events")
    try:
        check_usd()
    except UsdUnavailableError as error:
        raise NotProvided(explain(error)) from error

    def make() -> bytes:
        moved = footage.motion(stories, 0, footage.ready)
        return film_usd(home_from_dict(_home_row(stories, record)), moved, role_in(record))

    return unchanging(request, f"{footage.etag(0, footage.ready)}-usd", make, USD, _named(record, ".usd"))


@stories_router.get(
    "/{story_id}/motion",
    response_class=Response,
    responses={
        200: {
            "content": {one.media_type.partition(";")[0]: {} for one in FORMATS.values()},
            "headers": {
                "Sims-Frames": {"description": "The frames given, first-last.", "schema": {"type": "string"}},
                "Sims-Ready": {"description": "Frames that can be had now.", "schema": {"type": "integer"}},
                "Sims-Complete": {"description": "true when no more will come.", "schema": {"type": "string"}},
            },
        },
    },
)
def motion(
    record: RecordDep,
    request: Request,
    stories: StoriesDep,
    format_: Annotated[Literal["npz", "bvh", "glb", "json", "amass", "f32"], Query(alias="format")] = "npz",
    first: Annotated[int, Query(alias="from", ge=0, le=10**9, description="First frame.")] = 0,
    last: Annotated[int | None, Query(alias="to", ge=1, le=10**9, description="Behind the last frame.")] = None,
) -> Response:
    """The body alone: the frames from `from` to `to` (exclusive) as far as they are ready, 30 a second."""
    if last is not None and last <= first:
        raise Unprocessable("?to", f"must be more than from ({first}): the frame behind the last one")
    footage = Footage(record)
    ready, complete = footage.ready, footage.complete
    if first >= ready:
        ended = state_of(record.status) not in ("queued", "running")
        if ended and not ready:
            raise NotFound(f"this story was {state_of(record.status)} before the body moved")
        if complete or ended:
            raise Unprocessable("?from", f"the motion has {ready} frames; ask for one below that")
        raise NotReady(f"not ready yet: {ready} frames are; follow links.events")
    end = min(ready, last or ready)
    headers = {"Sims-Frames": f"{first}-{end}", "Sims-Ready": str(ready), "Sims-Complete": str(complete).lower()}
    chosen = FORMATS[format_]

    def make() -> bytes:
        moved = footage.motion(stories, first, end)
        return body_glb(moved, role_in(record)) if format_ == "glb" else encode(moved, format_)

    if complete:  # until then the headers change
        headers |= _named(record, chosen.suffix)
        return unchanging(request, f"{footage.etag(first, end)}-{format_}", make, chosen.media_type, headers)
    return Response(make(), headers=headers | {"Cache-Control": "no-store"}, media_type=chosen.media_type)


def _made(record: Record, kind: str) -> str:
    """The ETag of what a stage made."""
    for artifact in record.artifacts:
        if artifact.kind == kind:
            return artifact.etag
    state = state_of(record.status)
    if state in ("queued", "running"):
        raise NotReady("not ready yet: it is still being made; follow links.events")
    raise NotFound(f"this story was {state} before that was made")


def _home_row(stories: Stories, record: Record) -> Json:
    row: Json = json.loads(stories.data(record.id, HOME))["home"]
    return row


def _named(record: Record, suffix: str) -> dict[str, str]:
    """A file name for those who save the answer."""
    return {"Content-Disposition": f'inline; filename="{file_name(record)}{suffix}"'}


def file_name(record: Record) -> str:
    """What a story's files are called, without an ending."""
    words = "".join(letter if letter.isascii() and letter.isalnum() else " " for letter in record.title or record.kind)
    return "-".join(words.lower().split()) or "story"


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
