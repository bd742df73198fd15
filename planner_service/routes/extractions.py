"""Extractions: follow one, fetch what it gave, stop it, forget it; extracting.py begins them."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, Path, Query
from fastapi.sse import EventSourceResponse, ServerSentEvent

from planner_service.errors import Conflict, NotFound
from planner_service.parts import PartsDep
from planner_service.reporting import extraction_events, extraction_shown, extraction_summary, state_now
from planner_service.routes.events import LastEvent, Watch, followed
from planner_service.routes.stories import StoriesDep, check_cursor
from planner_service.schemas.extractions import ExtractionPage, ExtractionShown
from planner_service.schemas.stories import Json
from planner_service.store.stories import EXTRACTION, Record, StoryGone

extractions_router = APIRouter(prefix="/v1/extractions", tags=["extractions"])
ExtractionId = Annotated[str, Path(max_length=64, description="The id of an extraction.")]


def record_of(extraction_id: ExtractionId, stories: StoriesDep) -> Record:
    """The extraction that a path names."""
    absent = "there is no such extraction; GET /v1/extractions lists them"
    try:
        record = stories.get(extraction_id)
    except StoryGone as error:
        raise NotFound(absent) from error
    if record.kind != EXTRACTION:
        raise NotFound(absent)
    return record


RecordDep = Annotated[Record, Depends(record_of)]


@extractions_router.get("", response_model=ExtractionPage)
def list_extractions(
    stories: StoriesDep,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    cursor: Annotated[str | None, Query(max_length=64, description="`next` of the page before.")] = None,
) -> Json:
    """Extractions, newest first."""
    check_cursor(cursor)
    found = stories.page(limit + 1, cursor, (EXTRACTION,))
    shown = found[:limit]
    return {"items": list(map(extraction_summary, shown)), "next": shown[-1].id if len(found) > limit else None}


@extractions_router.get("/{extraction_id}", response_model=ExtractionShown)
def show(record: RecordDep) -> Json:
    """An extraction, as far as it is made."""
    return extraction_shown(record)


@extractions_router.post(
    "/{extraction_id}/cancel", status_code=202, response_model=ExtractionShown, responses={409: {}}
)
def cancel(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> Json:
    """Stop an extraction: the scene that is being read is the last. Scripts that were made can still be fetched."""
    if state_now(record) in ("queued", "running"):
        parts.jobs.cancel(record.id)
        record = stories.get(record.id)
    if state_now(record) != "cancelled":
        raise Conflict(f"this extraction has {state_now(record)}; there is nothing to cancel")
    parts.uploads.forget(record.id)
    return extraction_shown(record)


@extractions_router.delete("/{extraction_id}", status_code=204)
def forget(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> None:
    """Delete an extraction; scripts that it put into the library stay. One in the making is stopped."""
    running = state_now(record) in ("queued", "running")
    if running:
        parts.jobs.cancel(record.id)
    stories.delete(record.id)
    parts.uploads.forget(record.id)
    if not running and record.status is not None:
        parts.jobs.forget(record.id)


def watching(record: RecordDep, parts: PartsDep, last_event_id: LastEvent = None) -> Watch:
    """Who follows; one who has the last event of an extraction that ended gets 204."""
    return Watch(parts, record, last_event_id or 0, extraction_events, state_now).opened()


@extractions_router.get(
    "/{extraction_id}/events",
    response_class=EventSourceResponse,
    responses={204: {"description": "The extraction has ended, and Last-Event-ID is its last event."}},
)
async def events(watch: Annotated[Watch, Depends(watching)]) -> AsyncIterator[ServerSentEvent]:
    """`stage`, `progress` and `scenes` as they happen; at the end `done`, `failed` or `cancelled`, once."""
    async for event in followed(watch):
        yield event
