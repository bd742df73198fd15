"""What happens to a story, as server-sent events that can be taken up again where they broke off."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Final

from fastapi import APIRouter, Depends, Header
from fastapi.sse import EventSourceResponse, ServerSentEvent
from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException

from planner_service.api.dependencies import PartsDep
from planner_service.api.stories.endpoints import RecordDep
from planner_service.api.stories.views import StoryEvent, events_of
from planner_service.components import Parts
from planner_service.store.story_store import Record, Stories, StoryGone
from planner_service.store.tables import State, state_of

LastEvent = Annotated[
    int | None, Header(alias="Last-Event-ID", ge=0, le=10**9, description="The last event that was received.")
]
events_router = APIRouter(prefix="/v1/stories", tags=["stories"])
POLL: Final = 0.1
"""Seconds between two looks at a story in the making."""
QUEUED_POLL: Final = 0.25
"""Seconds between two looks at one that waits."""
SHARE: Final = 10
"""A look that took long, since many follow, is not repeated before so many times as long: others have their turn."""


@dataclass
class Watch:
    """Somebody who follows a story, and the last event they have."""

    parts: Parts
    record: Record
    last: int
    events_of: Callable[[Record], Iterator[StoryEvent]] = events_of
    state_of: Callable[[Record], State] = lambda record: state_of(record.status)

    def news(self) -> list[StoryEvent]:
        """Events they do not have yet."""
        found = [event for event in self.events_of(self.record) if event.id > self.last]
        self.last = found[-1].id if found else self.last
        return found

    @property
    def ended(self) -> bool:
        """Whether there will be no more."""
        return self.state_of(self.record) not in ("queued", "running")

    def opened(self) -> Watch:
        """This watch; HTTPException 204 where there will be nothing to see any more."""
        if self.ended and all(event.id <= self.last for event in self.events_of(self.record)):
            raise HTTPException(204)
        return self

    def look(self) -> None:
        """See what was made since. StoryGone."""
        known = self.record.artifacts
        after = known[-1].position if known else -1
        fresh = Stories(self.parts.engine).get(self.record.id, after)
        self.record = replace(fresh, artifacts=(*known, *fresh.artifacts))


def watching(
    record: RecordDep,
    parts: PartsDep,
    last_event_id: LastEvent = None,
) -> Watch:
    """Who follows; one who has the last event of a story that ended gets 204, which tells a browser to stop asking."""
    return Watch(parts, record, last_event_id or 0).opened()


@events_router.get(
    "/{story_id}/events",
    response_class=EventSourceResponse,
    responses={204: {"description": "The story has ended, and Last-Event-ID is its last event."}},
)
async def events(watch: Annotated[Watch, Depends(watching)]) -> AsyncIterator[ServerSentEvent]:
    """`stage`, `progress` and `segment` as they happen; at the end `done`, `failed` or `cancelled`, once."""
    async for event in followed(watch):
        yield event


async def followed(watch: Watch) -> AsyncIterator[ServerSentEvent]:
    """What happens, until there will be no more or the service stops."""
    took = 0.0
    while True:
        for event in watch.news():
            yield ServerSentEvent(data=event.data, event=event.name, id=str(event.id), retry=1000)
        if watch.ended or watch.parts.stopping.is_set():
            return
        await asyncio.sleep(max(POLL if watch.record.stage else QUEUED_POLL, SHARE * took))
        begun = time.monotonic()
        try:
            await run_in_threadpool(watch.look)
        except (StoryGone, SQLAlchemyError):
            # Deleted, or the database is away: the client comes back with Last-Event-ID and is told which.
            return
        took = time.monotonic() - begun
