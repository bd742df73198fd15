"""Stories in the database: what was asked, what each stage made of it, and how far it is."""

from __future__ import annotations

import hashlib
import json
import secrets
import time
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

from pydantic_core import from_json
from sqlalchemy import Connection, Engine, Row, Select, bindparam, delete, func, select, update
from sqlalchemy.exc import IntegrityError

from motion_backend.backend_protocol import Unwanted
from planner_service.llm.budget import Spent
from planner_service.pipeline import StoryRequest, request_from_dict, request_to_dict
from planner_service.store.tables import (
    CANCELLED,
    artifacts,
    idempotency_keys,
    stage_times,
    stories,
    takes,
    workflow_status,
)
from scene_graphs.json_fields import Json

STORIES: Final = ("story", "motion")
EXTRACTION: Final = "extraction"
"""The other kind of row: short scripts out of a film or text."""
_LISTED: Final = (
    stories.c.id,
    stories.c.kind,
    stories.c.created,
    stories.c.theme,
    stories.c.title,
    stories.c.seed,
    stories.c.backend,
    stories.c.stage,
    stories.c.progress,
    stories.c.method,
    stories.c.character,
    stories.c.error,
    takes.c.derived_from,
    workflow_status.c.status,
    workflow_status.c.recovery_attempts,
)

_SHOWN: Final = (
    artifacts.c.position,
    artifacts.c.kind,
    artifacts.c.summary,
    artifacts.c.etag,
    artifacts.c.following,
    artifacts.c.progress,
)


class StoryGone(Unwanted, LookupError):  # noqa: N818
    """A story that is not there, or no longer wanted."""


@dataclass(frozen=True)
class Made:
    """What one stage made, about to be stored."""

    kind: str
    """script, home, told, actions, segment, report or film; of an extraction words, scenes, piece or gathered."""
    position: int
    """In the order of making; a story has one artifact at each."""
    data: bytes
    summary: Json
    """What lists and events show of it, small."""
    following: str | None
    """The stage that begins now, if another one does."""
    progress: float
    seconds: float
    state: Json | None = None
    """The BodyState a segment left."""
    title: str | None = None


@dataclass(frozen=True)
class Artifact:
    """What one stage made, without its data."""

    position: int
    kind: str
    summary: Json
    etag: str
    following: str | None
    progress: float


@dataclass(frozen=True)
class Record:
    """A story as the database knows it; `status` is the job engine's word for it."""

    id: str
    kind: str
    created: int
    theme: str
    title: str | None
    seed: int
    backend: str
    stage: str | None
    progress: float
    error: Json | None
    status: str | None
    attempts: int
    method: str
    character: Json
    artifacts: tuple[Artifact, ...] = ()
    derived_from: str | None = None
    """The story that it is a take of."""


def new_id(milliseconds: int) -> str:
    """A UUIDv7: 48 bits of time, then chance, so that ids sort by the time they were made."""
    number = (milliseconds << 80) | secrets.randbits(80)
    number = number & ~(0xF << 76) | 0x7 << 76
    number = number & ~(0x3 << 62) | 0x2 << 62
    text = f"{number:032x}"
    return f"{text[:8]}-{text[8:12]}-{text[12:16]}-{text[16:20]}-{text[20:]}"


def now() -> int:
    """Milliseconds since 1970."""
    return time.time_ns() // 1_000_000


def artifact_row(story_id: str, made: Made) -> Json:
    """What a stage made as a row of its table."""
    return {
        "story_id": story_id,
        "position": made.position,
        "kind": made.kind,
        "summary": json.dumps(made.summary, separators=(",", ":"), allow_nan=False),
        "data": made.data,
        "state": None if made.state is None else json.dumps(made.state, separators=(",", ":")),
        "etag": hashlib.sha256(made.data).hexdigest()[:32],
        "following": made.following,
        "progress": made.progress,
        "seconds": made.seconds,
        "made": now(),
    }


def put_made(connection: Connection, story_id: str, made: Sequence[Made]) -> None:
    """What was made of a story at once, or before it began, inside the caller's transaction."""
    if made:
        connection.execute(artifacts.insert(), [artifact_row(story_id, one) for one in made])


class Stories:
    """The table of stories with what hangs on it."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine

    @cached_property
    def writing(self) -> Engine:
        """The same database for transactions that write."""
        return self.engine.execution_options(writes=True)

    def add(self, connection: Connection, caller: str, request: StoryRequest) -> str:
        """A new story inside the caller's transaction; its id."""
        created = now()
        story_id = new_id(created)
        connection.execute(
            stories.insert().values(
                id=story_id,
                kind="motion" if request.keyframes else "story",
                caller=caller,
                created=created,
                theme=request.theme,
                seed=request.seed,
                backend=request.backend,
                method=request.method,
                character=json.dumps(vars(request.acted_by)),
                request=json.dumps(request_to_dict(request), separators=(",", ":")),
                progress=0.0,
            )
        )
        return story_id

    def request(self, story_id: str) -> StoryRequest:
        """What was asked for. StoryGone."""
        with self.engine.connect() as connection:
            text = connection.execute(select(stories.c.request).where(stories.c.id == story_id)).scalar()
        if text is None:
            raise StoryGone(story_id)
        return request_from_dict(json.loads(text))

    def record(
        self, story_id: str, made: Made, worker: str, also: Callable[[Connection], None] = lambda _connection: None
    ) -> None:
        """Store what a stage made, once: a stage that was made again after a crash changes nothing.

        `also` writes what goes with it in the same transaction. StoryGone when the story was deleted or cancelled
        meanwhile: nothing is added to what clients saw as its end.
        """
        with self.writing.begin() as connection:
            # Shared, so that no cancelling slips in between: what is stored was made before it.
            mine = workflow_status.c.workflow_uuid == story_id
            shared = select(workflow_status.c.status).where(mine).with_for_update(read=True)
            if connection.execute(shared).scalar() == CANCELLED:
                raise StoryGone(story_id)
            here = (artifacts.c.story_id == story_id) & (artifacts.c.position == made.position)
            if connection.execute(select(artifacts.c.position).where(here)).first():
                return
            also(connection)
            try:
                connection.execute(artifacts.insert().values(**artifact_row(story_id, made)))
            except IntegrityError as error:
                raise StoryGone(story_id) from error
            after: Json = {"progress": made.progress}
            after |= {"stage": made.following} if made.following else {}
            after |= {"title": made.title} if made.title else {}
            connection.execute(update(stories).where(stories.c.id == story_id).values(**after))
            _count(connection, worker, made.kind, made.seconds)

    def has(self, story_id: str, position: int) -> bool:
        """Whether something is stored at a position."""
        here = (artifacts.c.story_id == story_id) & (artifacts.c.position == position)
        with self.engine.connect() as connection:
            return connection.execute(select(artifacts.c.position).where(here)).first() is not None

    def go_on(self, story_id: str, progress: float) -> None:
        """A stage that takes long is so far. StoryGone when the story was deleted or cancelled meanwhile."""
        with self.writing.begin() as connection:
            mine = select(workflow_status.c.status).where(workflow_status.c.workflow_uuid == story_id)
            here = update(stories).where(stories.c.id == story_id).values(progress=progress)
            if connection.execute(mine).scalar() == CANCELLED or connection.execute(here).rowcount == 0:
                raise StoryGone(story_id)

    def begin(self, story_id: str, stage: str) -> None:
        """A story leaves the queue; nothing changes if it has begun already."""
        with self.writing.begin() as connection:
            fresh = (stories.c.id == story_id) & stories.c.stage.is_(None)
            connection.execute(update(stories).where(fresh).values(stage=stage))

    def fail(self, story_id: str, title: str, detail: str) -> None:
        """Keep why a story could not be made."""
        with self.writing.begin() as connection:
            error = json.dumps({"title": title, "detail": detail})
            connection.execute(update(stories).where(stories.c.id == story_id).values(error=error))

    def made(self, story_id: str, positions: Sequence[int]) -> list[Made]:
        """What the stages at these positions made, whole and in order; those that are not there are left out."""
        here = (artifacts.c.story_id == story_id) & artifacts.c.position.in_(positions)
        with self.engine.connect() as connection:
            rows = connection.execute(select(artifacts).where(here).order_by(artifacts.c.position)).all()
        return [
            Made(
                row.kind, row.position, row.data, json.loads(row.summary), row.following, row.progress, row.seconds,
                json.loads(row.state) if row.state else None,
            )
            for row in rows
        ]  # fmt: skip

    def data(self, story_id: str, position: int) -> bytes:
        """What the stage at a position made. StoryGone if it is not there."""
        return self.segment(story_id, position)[0]

    def segment(self, story_id: str, position: int) -> tuple[bytes, Json]:
        """What the stage at a position made and, of a segment, the BodyState it left. StoryGone."""
        here = (artifacts.c.story_id == story_id) & (artifacts.c.position == position)
        with self.engine.connect() as connection:
            row = connection.execute(select(artifacts.c.data, artifacts.c.state).where(here)).one_or_none()
        if row is None:
            raise StoryGone(f"{story_id}: nothing at {position}")
        return row.data, json.loads(row.state) if row.state else {}

    def parts(self, story_id: str, positions: Iterable[int]) -> list[bytes]:
        """The data at several positions, in order. StoryGone where one is not there."""
        wanted = list(positions)
        here = (artifacts.c.story_id == story_id) & artifacts.c.position.in_(wanted)
        with self.engine.connect() as connection:
            rows = connection.execute(select(artifacts.c.data).where(here).order_by(artifacts.c.position))
            found = [row.data for row in rows]
        if len(found) < len(wanted):
            raise StoryGone(f"{story_id}: something is missing at {wanted}")
        return found

    def get(self, story_id: str, after: int = -1) -> Record:
        """A story with what was made of it beyond the position `after`, data left out. StoryGone."""
        with self.engine.connect() as connection:
            row = connection.execute(_ONE, {"id": story_id}).one_or_none()
            if row is None:
                raise StoryGone(story_id)
            found = connection.execute(_MADE, {"id": story_id, "after": after}).all()
        summaries = from_json(f"[{','.join(one.summary for one in found)}]")
        made = tuple(
            Artifact(one.position, one.kind, summary, one.etag, one.following, one.progress)
            for one, summary in zip(found, summaries, strict=True)
        )
        return _record(row, made)

    def page(self, limit: int, before: str | None = None, kinds: Collection[str] = STORIES) -> list[Record]:
        """Those of some kinds from newest to oldest, after the id `before` in that order; artifacts left out."""
        query = _listed().where(stories.c.kind.in_(kinds)).order_by(stories.c.id.desc()).limit(limit)
        if before is not None:
            query = query.where(stories.c.id < before)
        with self.engine.connect() as connection:
            return [_record(row) for row in connection.execute(query)]

    def durations(self, story_ids: Iterable[str]) -> dict[str, int]:
        """Frames that are ready, by story."""
        wanted = artifacts.c.story_id.in_(list(story_ids)) & (artifacts.c.kind == "segment")
        last = select(artifacts.c.story_id, func.max(artifacts.c.position).label("position"))
        last_of = last.where(wanted).group_by(artifacts.c.story_id).subquery()
        both = (artifacts.c.story_id == last_of.c.story_id) & (artifacts.c.position == last_of.c.position)
        query = select(artifacts.c.story_id, artifacts.c.summary).join(last_of, both)
        with self.engine.connect() as connection:
            return {row.story_id: int(json.loads(row.summary)["end"]) for row in connection.execute(query)}

    def delete(self, story_id: str) -> None:
        """Forget a story and all that was made of it. StoryGone."""
        with self.writing.begin() as connection:
            connection.execute(delete(idempotency_keys).where(idempotency_keys.c.story_id == story_id))
            if connection.execute(delete(stories).where(stories.c.id == story_id)).rowcount == 0:
                raise StoryGone(story_id)


def _listed() -> Select[Any]:
    """Stories beside what the job engine says of them."""
    joined = stories.outerjoin(workflow_status, workflow_status.c.workflow_uuid == stories.c.id)
    return select(*_LISTED).select_from(joined.outerjoin(takes, takes.c.story_id == stories.c.id))


_ONE: Final = _listed().where(stories.c.id == bindparam("id"))
_MADE: Final = (
    select(*_SHOWN)
    .where(artifacts.c.story_id == bindparam("id"), artifacts.c.position > bindparam("after"))
    .order_by(artifacts.c.position)
)
"""What every look at a story asks: putting a query together takes longer than SQLite does to answer it."""


def _record(row: Row[Any], made: tuple[Artifact, ...] = ()) -> Record:
    return Record(
        id=row.id,
        kind=row.kind,
        created=row.created,
        theme=row.theme,
        title=row.title,
        seed=row.seed,
        backend=row.backend,
        stage=row.stage,
        progress=row.progress,
        error=json.loads(row.error) if row.error else None,
        status=row.status,
        attempts=row.recovery_attempts or 0,
        method=row.method,
        character=json.loads(row.character),
        artifacts=made,
        derived_from=row.derived_from,
    )


MODEL_CALLS: Final = "model calls"
MODEL_TOKENS: Final = "model tokens"
"""Rows of `stage_times` that are no stages: calls with the seconds they took, and tokens with their dollars."""


def count_spent(connection: Connection, worker: str, spent: Spent) -> None:
    """What a stage took of the language model."""
    if spent.calls:
        _count(connection, worker, MODEL_CALLS, spent.seconds, spent.calls)
        _count(connection, worker, MODEL_TOKENS, spent.dollars or 0.0, spent.tokens)


def _count(connection: Connection, worker: str, stage: str, seconds: float, count: int = 1) -> None:
    """One more stage made by a worker, or so many of what is counted beside them."""
    mine = (stage_times.c.worker == worker) & (stage_times.c.stage == stage)
    more = {"count": stage_times.c.count + count, "seconds": stage_times.c.seconds + seconds}
    if connection.execute(update(stage_times).where(mine).values(**more)).rowcount == 0:
        connection.execute(stage_times.insert().values(worker=worker, stage=stage, count=count, seconds=seconds))
