"""A story's film.mp4: asked for, watched being made, fetched, stopped and forgotten. It is made once and kept."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Conflict, NotFound, NotProvided, NotReady
from planner_service.api.idempotent_submission import accept_film
from planner_service.api.stories.endpoints import RecordDep, StoriesDep, drop, file_name
from planner_service.api.stories.schemas import Failure, State
from planner_service.api.stories.views import failure_of
from planner_service.api.web_page import unchanging
from planner_service.components import Parts
from planner_service.output.film import FilmUnavailableError, check_film
from planner_service.store.film_store import film_of
from planner_service.store.story_store import Record, Stories
from planner_service.store.tables import state_of
from planner_service.user_errors import explain
from scene_graphs.json_fields import Json

film_router = APIRouter(prefix="/v1/stories", tags=["stories"])
MP4: Literal["video/mp4"] = "video/mp4"
UNDER_WAY = ("queued", "running")


class FilmLinks(BaseModel):
    """Where the rest is."""

    model_config = ConfigDict(populate_by_name=True)

    self_: str = Field(alias="self")
    story: str
    mp4: str = Field(description="The film, once it has succeeded.")


class FilmShown(BaseModel):
    """A story's film, as far as it is made."""

    id: str | None
    state: State | Literal["absent"] = Field(description="absent: nobody has asked for it.")
    progress: float = Field(ge=0, le=1, description="The share of its frames that are drawn.")
    frames: int | None = Field(description="30 a second; null until it is made.")
    bytes: int | None
    error: Failure | None
    links: FilmLinks


@film_router.post("/{story_id}/film", status_code=202, response_model=FilmShown, responses={409: {}, 501: {}})
def begin(story: RecordDep, request: Request, response: Response, parts: PartsDep) -> Json:
    """Film a story that has succeeded, as H.264. One that is there or under way stays; one that failed is made anew."""
    state = state_of(story.status)
    if state in UNDER_WAY:
        raise Conflict("this story is still being made; follow links.events, and film it when it is done")
    if state != "succeeded":
        raise Conflict(f"this story has {state}; only one that has succeeded can be filmed")
    try:
        check_film()
    except FilmUnavailableError as error:
        raise NotProvided(explain(error)) from error
    film = accept_film(parts, request.state.caller, story.id)
    response.headers["Location"] = f"/v1/stories/{story.id}/film"
    return film_shown(story.id, film)


@film_router.get("/{story_id}/film", response_model=FilmShown)
def look(story: RecordDep, parts: PartsDep, stories: StoriesDep) -> Json:
    """How far the film is."""
    return film_shown(story.id, _found(parts, stories, story.id))


@film_router.delete("/{story_id}/film", status_code=204)
def forget_film(story: RecordDep, parts: PartsDep, stories: StoriesDep) -> None:
    """Stop a film that is being made, and delete it."""
    drop(_film(parts, stories, story.id), parts, stories)


@film_router.get("/{story_id}/film.mp4", response_class=Response, responses={200: {"content": {MP4: {}}}, 404: {}})
def film_file(story: RecordDep, request: Request, parts: PartsDep, stories: StoriesDep) -> Response:
    """The story filmed, with cuts, its title and its told words: H.264, 1280 × 720, 30 frames a second, no sound."""
    film = _film(parts, stories, story.id)
    state = state_of(film.status)
    if state in UNDER_WAY:
        raise NotReady(
            f"not ready yet: {film.progress:.0%} of its frames are drawn; look at /v1/stories/{story.id}/film"
        )
    if not film.artifacts:
        raise NotFound(f"filming has {state}; POST /v1/stories/{story.id}/film begins anew")
    named = {"Content-Disposition": f'inline; filename="{file_name(story)}.mp4"'}
    return unchanging(request, film.artifacts[0].etag, lambda: stories.data(film.id, 0), MP4, named)


def film_shown(story_id: str, film: Record | None) -> Json:
    """A film as clients see it; None where nobody has asked for one."""
    here = f"/v1/stories/{story_id}"
    made = film.artifacts[0].summary if film and film.artifacts else {}
    return {
        "id": film.id if film else None,
        "state": state_of(film.status) if film else "absent",
        "progress": film.progress if film else 0.0,
        "frames": made.get("frames"),
        "bytes": made.get("bytes"),
        "error": failure_of(film) if film else None,
        "links": {"self": f"{here}/film", "story": here, "mp4": f"{here}/film.mp4"},
    }


def _found(parts: Parts, stories: Stories, story_id: str) -> Record | None:
    with parts.engine.connect() as connection:
        film_id = film_of(connection, story_id)
    return None if film_id is None else stories.get(film_id)


def _film(parts: Parts, stories: Stories, story_id: str) -> Record:
    found = _found(parts, stories, story_id)
    if found is None:
        raise NotFound(f"nobody has asked for this film; POST /v1/stories/{story_id}/film begins it")
    return found
