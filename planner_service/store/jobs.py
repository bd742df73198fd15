"""The job engine's own table as far as we read it: what became of every story's workflow."""

from __future__ import annotations

from typing import Final, Literal

from sqlalchemy import BigInteger, Column, MetaData, Table, Text

SCHEMA: Final = "dbos"
"""Where DBOS keeps its tables on PostgreSQL; on SQLite they have plain names (engine.py translates)."""
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
