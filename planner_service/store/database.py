"""Opening the database: the same tables on SQLite and PostgreSQL, with what each needs to be safe under load."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url, select
from sqlalchemy.exc import ArgumentError, SQLAlchemyError

from planner_service.settings import Settings, SettingsError
from planner_service.store.tables import SCHEMA, SCHEMA_VERSION, metadata, schema_version

BUSY_MS = 4_000
"""How long a writer waits for a lock on SQLite before the database counts as busy; workers then try again."""
STARTING_LOCK = 7_041_500_021
"""PostgreSQL's advisory lock while tables are made."""


def database_url(settings: Settings) -> str:
    """Where the database is, as SQLAlchemy and DBOS both read it. SettingsError for an address that is neither kind."""
    if not settings.database_url:
        return _sqlite_url(settings.database_file)
    try:
        url = make_url(settings.database_url)
    except (ArgumentError, ValueError) as error:
        raise SettingsError("write postgresql://user:password@host:5432/name", at="SIMS_DATABASE_URL") from error
    if url.get_backend_name() == "sqlite" and url.database:
        return _sqlite_url(Path(url.database).absolute())
    if url.get_backend_name() != "postgresql":
        raise SettingsError(
            f"{url.drivername} is not read here",
            "write postgresql://user:password@host:5432/name, or leave it empty for a file in SIMS_DATA_DIR",
            at="SIMS_DATABASE_URL",
        )
    return url.set(drivername="postgresql+psycopg").render_as_string(hide_password=False)


def _sqlite_url(file: Path) -> str:
    """The address of a file, whatever its name: in a plain one what follows a question mark would be lost."""
    return URL.create("sqlite", database=str(file)).render_as_string()


def open_engine(url: str, pool_size: int = 8) -> Engine:
    """The database at `database_url`, its tables made if they are missing.

    SettingsError when it cannot be reached or was written by a newer version. Writers on SQLite ask for
    `engine.execution_options(writes=True)`, so that they wait for the lock rather than fail on it.
    """
    try:
        if url.startswith("sqlite"):
            Path(make_url(url).database or "").parent.mkdir(parents=True, exist_ok=True)
            plain_names = {"schema_translate_map": {SCHEMA: None}}
            engine = create_engine(
                url, pool_size=pool_size, max_overflow=pool_size, execution_options=plain_names, hide_parameters=True
            )
            _tune_sqlite(engine)
        else:
            engine = create_engine(
                url, pool_size=pool_size, max_overflow=pool_size, pool_pre_ping=True, pool_timeout=10,
                connect_args={"connect_timeout": 5}, hide_parameters=True,
            )  # fmt: skip
        _make_tables(engine)
    except (OSError, SQLAlchemyError) as error:
        raise unopened(url, error) from error
    return engine


def unopened(url: str, error: Exception) -> SettingsError:
    """What to say of a database that cannot be opened, without its password."""
    shown = make_url(url).render_as_string(hide_password=True)
    reason = str(getattr(error, "orig", error)).splitlines()[0]
    return SettingsError(
        f"{shown} cannot be opened: {reason}", "see SIMS_DATA_DIR and SIMS_DATABASE_URL", at="SIMS_DATABASE_URL"
    )


def _tune_sqlite(engine: Engine) -> None:
    """Readers beside one writer, foreign keys, and transactions that begin where we say."""

    @event.listens_for(engine, "connect")
    def connect(connection: Any, _record: object) -> None:
        connection.isolation_level = None
        for pragma in (
            f"busy_timeout={BUSY_MS}", "journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON",
        ):  # fmt: skip
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        writes = connection.get_execution_options().get("writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def _make_tables(engine: Engine) -> None:
    """All tables, once, though several processes start together."""
    with engine.execution_options(writes=True).begin() as connection:
        if engine.dialect.name == "postgresql":
            connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({STARTING_LOCK})")
        metadata.create_all(connection)
        found = connection.execute(select(schema_version.c.version)).scalar()
        if found is None:
            connection.execute(schema_version.insert().values(version=SCHEMA_VERSION))
        elif found != SCHEMA_VERSION:
            raise SettingsError(
                f"the database has tables of version {found}, this program reads {SCHEMA_VERSION}",
                "use another database or the program that wrote it",
                at="SIMS_DATABASE_URL",
            )
