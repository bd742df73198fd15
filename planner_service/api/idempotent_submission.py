"""A request becomes a story or an extraction in a queue: what is answered 202 is made, and one key makes one."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from typing import Final, Literal

from sqlalchemy import Connection, func, select
from sqlalchemy.exc import IntegrityError

from motion_backend.backends import check_backend
from planner_service.api.errors import TooMany, Unprocessable
from planner_service.components import Parts
from planner_service.extraction.extraction_result import Extraction
from planner_service.jobs.extraction_stages import STAGES, Gathered, keep_all, made_at_once
from planner_service.jobs.queue import EXTRACT, EXTRACTIONS, FILMS, SHOOT
from planner_service.jobs.uploads import Coming
from planner_service.pipeline import StoryRequest
from planner_service.store.extraction_store import ExtractionRequest, add_extraction
from planner_service.store.film_store import add_film, film_of, hold_story
from planner_service.store.story_store import Made, Record, Stories, now, put_made
from planner_service.store.tables import WAITING, idempotency_keys, state_of, stories, workflow_status
from planner_service.store.take_store import add_take

Kind = Literal["story", "motion", "take", "extraction"]
"""One key means another thing for each."""
FULL_QUEUE: Final = 10
"""Seconds after which a caller with too many stories may try again."""


def repeated(parts: Parts, caller: str, kind: Kind, body: str, key: str | None) -> Record | None:
    """The story that this key and body made before, though a room of it is gone meanwhile.

    Unprocessable where the key came with another body.
    """
    if key is None:
        return None
    with parts.engine.connect() as connection:
        story_id = _known(connection, caller, key, _hash(kind, body))
    return None if story_id is None else Stories(parts.engine).get(story_id)


def accept(parts: Parts, caller: str, wanted: StoryRequest, body: str, key: str | None) -> Record:
    """Store and queue in one transaction. Unprocessable where the key came with another body, TooMany at the limit.

    BrokenBackendError where nothing here can move the body as it is asked for.
    """
    check_backend(wanted.backend)
    table = Stories(parts.engine)

    def make(connection: Connection) -> str:
        return table.add(connection, caller, wanted)

    return accepted(parts, caller, "motion" if wanted.keyframes else "story", body, key, make, parts.jobs.enqueue)


def accept_take(
    parts: Parts, caller: str, wanted: StoryRequest, origin: str, known: Sequence[Made], body: str, key: str | None
) -> Record:
    """The same for a story that derives from another one, whose first stages are `known`."""
    check_backend(wanted.backend)
    table = Stories(parts.engine)

    def make(connection: Connection) -> str:
        return add_take(connection, table, caller, wanted, origin, known)

    return accepted(parts, caller, "take", body, key, make, parts.jobs.enqueue)


def accept_extraction(parts: Parts, caller: str, wanted: ExtractionRequest, coming: Coming, key: str | None) -> Record:
    """Store and queue what came in, its files kept for the worker. Unprocessable and TooMany as for stories."""
    begun: list[str] = []

    def make(connection: Connection) -> str:
        begun.append(add_extraction(connection, caller, wanted))
        return begun[-1]

    def queue(connection: Connection, extraction_id: str) -> None:
        coming.keep(extraction_id)
        parts.jobs.enqueue(connection, extraction_id, EXTRACT, EXTRACTIONS)

    try:
        return accepted(parts, caller, "extraction", wanted.to_json(), key, make, queue)
    except BaseException:
        for extraction_id in begun:
            parts.uploads.forget(extraction_id)
        raise


def accept_film(parts: Parts, caller: str, story_id: str) -> Record:
    """Store and queue a film of a story, unless one is there or under way. StoryGone, TooMany at the limit."""
    table = Stories(parts.engine)
    with parts.engine.execution_options(writes=True).begin() as connection:
        hold_story(connection, story_id)
        known = film_of(connection, story_id)
        if known is None or state_of(_status(connection, known)) in ("failed", "cancelled"):
            _check_room(parts, connection, caller)
            known = add_film(connection, caller, story_id)
            parts.jobs.enqueue(connection, known, SHOOT, FILMS)
    return table.get(known)


def keep_extraction(parts: Parts, caller: str, wanted: ExtractionRequest, made: Extraction, key: str | None) -> Record:
    """Store what was extracted at once, its scripts in the library if that was asked for. ShelfError, LibraryError."""
    kept: list[Record] = []

    def store(gathered: Gathered, add: Callable[[Connection], None]) -> None:
        def make(connection: Connection) -> str:
            add(connection)
            extraction_id = add_extraction(connection, caller, wanted, STAGES[-1])
            put_made(connection, extraction_id, made_at_once(made, gathered))
            return extraction_id

        kept.append(accepted(parts, caller, "extraction", wanted.to_json(), key, make, None))

    keep_all(parts.shelves, [draft.script for draft in made.scripts] if wanted.add else [], wanted.name, store)
    return kept[-1]


def accepted(
    parts: Parts,
    caller: str,
    kind: Kind,
    body: str,
    key: str | None,
    make: Callable[[Connection], str],
    queue: Callable[[Connection, str], None] | None,
) -> Record:
    """In one transaction `make` stores and gives an id, the key is bound to it, and it is queued where that is needed.

    Unprocessable where the key came with another body, TooMany at the limit.
    """
    mine = (caller, key, _hash(kind, body))
    try:
        story_id = _accepted(parts, mine, make, queue)
    except IntegrityError:
        # The same key at the same moment: the other one was first, and is there now.
        story_id = _accepted(parts, mine, make, queue)
    return Stories(parts.engine).get(story_id)


def _accepted(
    parts: Parts,
    mine: tuple[str, str | None, str],
    make: Callable[[Connection], str],
    queue: Callable[[Connection, str], None] | None,
) -> str:
    caller, key, body_hash = mine
    with parts.engine.execution_options(writes=True).begin() as connection:
        known = _known(connection, caller, key, body_hash) if key else None
        if known is not None:
            return known
        if queue is not None:
            _check_room(parts, connection, caller)
        story_id = make(connection)
        if key:
            row = {"caller": caller, "key": key, "story_id": story_id, "body_hash": body_hash, "created": now()}
            connection.execute(idempotency_keys.insert().values(**row))
        if queue is not None:
            queue(connection, story_id)
        return story_id


def _hash(kind: Kind, body: str) -> str:
    return hashlib.sha256(f"{kind}\n{body}".encode()).hexdigest()


def _known(connection: Connection, caller: str, key: str, body_hash: str) -> str | None:
    """The story that a key stands for. Unprocessable where it came with another body."""
    mine = (idempotency_keys.c.caller == caller) & (idempotency_keys.c.key == key)
    query = select(idempotency_keys.c.story_id, idempotency_keys.c.body_hash).where(mine)
    row = connection.execute(query).one_or_none()
    if row is not None and row.body_hash != body_hash:
        raise Unprocessable("header:Idempotency-Key", "this key came with another body before; use a new one")
    return None if row is None else str(row.story_id)


def _check_room(parts: Parts, connection: Connection, caller: str) -> None:
    """TooMany where a caller has as many stories under way as one may have."""
    most = parts.settings.most_stories
    if _waiting(connection, caller) >= most:
        detail = f"{most} of your stories are waiting or being made; wait until one has ended, or cancel one"
        raise TooMany(detail, FULL_QUEUE)


def _status(connection: Connection, story_id: str) -> str | None:
    """The job engine's word for what became of a story."""
    mine = workflow_status.c.workflow_uuid == story_id
    return connection.execute(select(workflow_status.c.status).where(mine)).scalar()


def _waiting(connection: Connection, caller: str) -> int:
    """How many stories of a caller have not ended."""
    joined = stories.join(workflow_status, workflow_status.c.workflow_uuid == stories.c.id)
    mine = (stories.c.caller == caller) & workflow_status.c.status.in_(WAITING)
    return int(connection.execute(select(func.count()).select_from(joined).where(mine)).scalar_one())
