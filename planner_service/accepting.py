"""A request becomes a story in the queue: what is answered 202 is made, and one idempotency key makes one story."""

from __future__ import annotations

import hashlib
from typing import Final

from sqlalchemy import Connection, func, select
from sqlalchemy.exc import IntegrityError

from planner_service.errors import TooMany, Unprocessable
from planner_service.parts import Parts
from planner_service.schemas.stories import Kind
from planner_service.store.jobs import WAITING, workflow_status
from planner_service.store.stories import Record, Stories, now
from planner_service.store.tables import idempotency_keys, stories
from planner_service.stories import StoryRequest

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
    """Store and queue in one transaction. Unprocessable where the key came with another body, TooMany at the limit."""
    body_hash = _hash("motion" if wanted.keyframes else "story", body)
    table = Stories(parts.engine)
    try:
        story_id = _accepted(parts, table, caller, wanted, key, body_hash)
    except IntegrityError:
        # The same key at the same moment: the other one was first, and is there now.
        story_id = _accepted(parts, table, caller, wanted, key, body_hash)
    return table.get(story_id)


def _accepted(parts: Parts, table: Stories, caller: str, wanted: StoryRequest, key: str | None, body_hash: str) -> str:
    with table.writing.begin() as connection:
        known = _known(connection, caller, key, body_hash) if key else None
        if known is not None:
            return known
        most = parts.settings.most_stories
        if _waiting(connection, caller) >= most:
            detail = f"{most} of your stories are waiting or being made; wait until one has ended, or cancel one"
            raise TooMany(detail, FULL_QUEUE)
        story_id = table.add(connection, caller, wanted)
        if key:
            row = {"caller": caller, "key": key, "story_id": story_id, "body_hash": body_hash, "created": now()}
            connection.execute(idempotency_keys.insert().values(**row))
        parts.jobs.enqueue(connection, story_id)
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


def _waiting(connection: Connection, caller: str) -> int:
    """How many stories of a caller have not ended."""
    joined = stories.join(workflow_status, workflow_status.c.workflow_uuid == stories.c.id)
    mine = (stories.c.caller == caller) & workflow_status.c.status.in_(WAITING)
    return int(connection.execute(select(func.count()).select_from(joined).where(mine)).scalar_one())
