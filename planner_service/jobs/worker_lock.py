"""The name of a worker, held by one process at a time: two of one name would make the same stories at once."""

from __future__ import annotations

import time
from pathlib import Path
from typing import IO, Any, Final, Protocol

from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import SQLAlchemyError

from planner_service.settings import Settings, SettingsError

PATIENCE: Final = 8.0
"""Seconds that a worker waits for the one before it, of the same name, to be gone."""


class Hold(Protocol):
    """A lock that the system lets go of when the process ends, however it ends."""

    def take(self) -> bool:
        """Whether we have it now."""
        ...

    def keep(self) -> bool:
        """Whether we still have it, or have it again; False when somebody else does."""
        ...


def hold_name(engine: Engine, settings: Settings) -> Hold:
    """Take the name of this worker. SettingsError if another process has it and does not let go."""
    hold: Hold = RowHold(engine, settings) if engine.dialect.name == "postgresql" else FileHold(engine, settings)
    deadline = time.monotonic() + PATIENCE
    while not hold.take():
        if time.monotonic() > deadline:
            raise SettingsError(
                f"a worker {settings.worker_id!r} is running already", "give this one another id", at="SIMS_WORKER_ID"
            )
        time.sleep(0.2)
    return hold


class FileHold:
    """On SQLite: a locked file beside the database."""

    def __init__(self, engine: Engine, settings: Settings) -> None:
        self.path = Path(engine.url.database or ".").parent / f"{settings.worker_id}.lock"
        self.file: IO[Any] | None = None

    def take(self) -> bool:
        """Lock the file."""
        try:
            import fcntl
        except ImportError:  # no such locks here; the supervisor alone keeps names apart
            return True
        self.file = self.path.open("w")
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.file.close()
            return False
        except OSError as error:
            self.file.close()
            raise SettingsError(f"{self.path} cannot be locked: {error.strerror}", "see SIMS_DATA_DIR") from error
        return True

    def keep(self) -> bool:
        """Nothing but the end of this process lets go of it."""
        return True


class RowHold:
    """On PostgreSQL: an advisory lock, which goes when its connection does."""

    def __init__(self, engine: Engine, settings: Settings) -> None:
        self.engine, self.name = engine, f"sims-worker/{settings.worker_id}"
        self.connection: Connection | None = None

    def take(self) -> bool:
        """Lock the name on a connection of its own."""
        connection = self.engine.connect().execution_options(isolation_level="AUTOCOMMIT")
        asked = text("SELECT pg_try_advisory_lock(hashtext(:name))")
        if connection.execute(asked, {"name": self.name}).scalar():
            self.connection = connection
            return True
        connection.close()
        return False

    def keep(self) -> bool:
        """A connection that broke is opened again; while the database is away nobody else can have the name either."""
        try:
            if self.connection is not None:
                self.connection.execute(text("SELECT 1"))
                return True
            return self.take()
        except SQLAlchemyError:
            if self.connection is not None:
                self.connection.invalidate()
                self.connection.close()
                self.connection = None
            return True
