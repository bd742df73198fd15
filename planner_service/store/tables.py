"""The tables, the same on SQLite and PostgreSQL. Those of the job engine (DBOS) lie beside them and are only read.

The job engine's own table as far as we read it: what became of every story's workflow.
"""

from __future__ import annotations

from typing import Final, Literal

from sqlalchemy import BigInteger, Column, Float, ForeignKey, Integer, LargeBinary, MetaData, Table, Text

SCHEMA_VERSION: Final = 1
metadata = MetaData()

schema_version = Table("sims_schema", metadata, Column("version", Integer, primary_key=True))

stories = Table(
    "stories",
    metadata,
    Column("id", Text, primary_key=True),  # UUIDv7, so that ids sort by time
    Column("kind", Text, nullable=False),  # story, motion or extraction
    Column("caller", Text, nullable=False),
    Column("created", BigInteger, nullable=False),  # milliseconds since 1970
    Column("theme", Text, nullable=False),  # of an extraction the title of what is read
    Column("seed", BigInteger, nullable=False),
    Column("backend", Text, nullable=False),
    Column("method", Text, nullable=False),  # of an extraction what is read: film or text
    Column("character", Text, nullable=False),  # JSON
    Column("request", Text, nullable=False),  # JSON: all that was asked for, own rooms included
    Column("stage", Text),  # what is being made
    Column("progress", Float, nullable=False, default=0.0),
    Column("title", Text),
    Column("error", Text),  # JSON {title, detail}: why it could not be made
)
"""What was asked for, and how far it is. Whether it still runs is for the job engine alone to say."""

artifacts = Table(
    "artifacts",
    metadata,
    Column("story_id", Text, ForeignKey("stories.id", ondelete="CASCADE"), primary_key=True),
    Column("position", Integer, primary_key=True),  # in the order of making
    Column("kind", Text, nullable=False),  # see Made.kind
    Column("summary", Text, nullable=False),  # small JSON: what lists and events show of it
    Column("state", Text),  # JSON of the BodyState a segment left
    Column("etag", Text, nullable=False),  # SHA-256 of data, shortened
    Column("following", Text),  # the stage that began then, if another one did
    Column("progress", Float, nullable=False),  # of the whole story
    Column("seconds", Float, nullable=False),
    Column("made", BigInteger, nullable=False),
    # Last: SQLite reads through what comes before a column, and this is long.
    Column("data", LargeBinary, nullable=False),  # JSON, npz or GLB
)
"""What every recorded stage and segment made. Written once and never changed."""

takes = Table(
    "takes",
    metadata,
    Column("story_id", Text, ForeignKey("stories.id", ondelete="CASCADE"), primary_key=True),
    Column("derived_from", Text, nullable=False),  # which may be deleted by now
)
"""Stories that were derived from another one, and from which."""

idempotency_keys = Table(
    "idempotency_keys",
    metadata,
    Column("caller", Text, primary_key=True),
    Column("key", Text, primary_key=True),
    Column("story_id", Text, nullable=False),
    Column("body_hash", Text, nullable=False),
    Column("created", BigInteger, nullable=False),
)

stage_times = Table(
    "stage_times",
    metadata,
    Column("worker", Text, primary_key=True),
    Column("stage", Text, primary_key=True),
    Column("count", BigInteger, nullable=False),
    Column("seconds", Float, nullable=False),
)
"""How often each worker made each stage, and how long it took in all."""

short_scripts = Table(
    "short_scripts",
    metadata,
    Column("id", Text, primary_key=True),
    Column("body", Text, nullable=False),  # JSON of a ShortScript
    Column("created", BigInteger, nullable=False),
)
"""The users' own short scripts; ours are in the package."""

script_versions = Table(
    "script_versions",
    metadata,
    Column("script_id", Text, ForeignKey("short_scripts.id", ondelete="CASCADE"), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("body", Text, nullable=False),  # JSON of a ShortScript
)
"""What users' short scripts were before they were replaced."""

layouts = Table(
    "layouts",
    metadata,
    Column("id", Text, primary_key=True),
    Column("room_type", Text, nullable=False),
    Column("body", Text, nullable=False),  # native JSON of a Layout
    Column("created", BigInteger, nullable=False),
)
"""The users' own rooms; ours are in the package."""

revisions = Table(
    "revisions",
    metadata,
    Column("shelf", Text, primary_key=True),  # short_scripts or layouts
    Column("revision", BigInteger, nullable=False),
)
"""Raised with every change of a shelf, so that other processes read it again."""


SCHEMA: Final = "dbos"
"""Where DBOS keeps its tables on PostgreSQL; on SQLite they have plain names (database.py translates)."""
State = Literal["queued", "running", "succeeded", "failed", "cancelled"]
STATES: Final[dict[str, State]] = {
    "ENQUEUED": "queued",
    "DELAYED": "queued",
    "PENDING": "running",
    "SUCCESS": "succeeded",
    "ERROR": "failed",
    "MAX_RECOVERY_ATTEMPTS_EXCEEDED": "failed",
    "CANCELLED": "cancelled",
}
WAITING: Final = ("ENQUEUED", "DELAYED", "PENDING")
CANCELLED: Final = "CANCELLED"
GIVEN_UP: Final = "MAX_RECOVERY_ATTEMPTS_EXCEEDED"

workflow_status = Table(
    "workflow_status",
    MetaData(schema=SCHEMA),
    Column("workflow_uuid", Text, primary_key=True),
    Column("name", Text),
    Column("status", Text),
    Column("executor_id", Text),
    Column("recovery_attempts", BigInteger),
    Column("created_at", BigInteger),
)


def state_of(status: str | None) -> State:
    """The state of a story whose workflow has this status; one without a workflow will never be made."""
    return STATES.get(status or "", "failed")
