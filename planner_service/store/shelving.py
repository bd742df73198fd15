"""Rows of the users' own short scripts and rooms: written once under an id, taken away, and read again when changed."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from sqlalchemy import Connection, Engine, Table, delete, func, insert, select, update
from sqlalchemy.dialects import postgresql, sqlite

from planner_service.store.tables import layouts, revisions, short_scripts

Shelf = Literal["short_scripts", "layouts"]
TABLES: Final[Mapping[Shelf, Table]] = {"short_scripts": short_scripts, "layouts": layouts}
MANY: Final = 500
"""Ids in one question: SQLite binds at most some thousands of values."""


class IdTaken(Exception):  # noqa: N818
    """There is a row of that id already."""

    def __init__(self, row_id: str) -> None:
        super().__init__(row_id)
        self.row_id = row_id


class ShelfFull(Exception):  # noqa: N818
    """There would be more rows than may be."""


@dataclass(frozen=True)
class Stock:
    """What lies on a shelf at one revision: each id with the revision it was put there, which tells it from a later
    row of the same id."""

    revision: int
    rows: Mapping[str, int]


def revision_of(engine: Engine, shelf: Shelf) -> int:
    """Raised with every change of the shelf; 0 before the first."""
    with engine.connect() as connection:
        return _revision(connection, shelf)


def stock_of(engine: Engine, shelf: Shelf) -> Stock:
    """The ids on the shelf."""
    table = TABLES[shelf]
    with engine.connect() as connection:
        # Asked for first: a change that comes in between is then read again, not missed.
        revision = _revision(connection, shelf)
        rows = connection.execute(select(table.c.id, table.c.created)).all()
    return Stock(revision, {str(row.id): int(row.created) for row in rows})


def bodies_of(engine: Engine, shelf: Shelf, ids: Collection[str]) -> dict[str, str]:
    """The JSON of rows, in the order they were put there; an id that is gone is left out."""
    with engine.connect() as connection:
        return bodies_in(connection, shelf, ids)


def bodies_in(connection: Connection, shelf: Shelf, ids: Collection[str]) -> dict[str, str]:
    """As `bodies_of`, within a transaction that does more."""
    table, wanted = TABLES[shelf], sorted(ids)
    found: dict[str, str] = {}
    for start in range(0, len(wanted), MANY):
        asked = select(table.c.id, table.c.body).where(table.c.id.in_(wanted[start : start + MANY]))
        found |= {str(row.id): str(row.body) for row in connection.execute(asked)}
    return found


def put(
    engine: Engine,
    shelf: Shelf,
    rows: Mapping[str, Mapping[str, str]],
    most: int,
    within: Connection | None = None,
) -> None:
    """Add rows, all or none, by id with their other columns; `within` a transaction that does more, or alone.

    IdTaken names an id that has a row already; ShelfFull if there would be more than `most`.
    """
    if within is None:
        with engine.execution_options(writes=True).begin() as connection:
            put(engine, shelf, rows, most, connection)
        return
    table, connection = TABLES[shelf], within
    revision = raised(connection, shelf)
    wanted = list(rows)
    for start in range(0, len(wanted), MANY):
        asked = select(table.c.id).where(table.c.id.in_(wanted[start : start + MANY])).order_by(table.c.id)
        if (taken := connection.execute(asked).scalars().first()) is not None:
            raise IdTaken(taken)
    refuse_more(connection, table, len(rows), most)
    values = [{"id": row_id, "created": revision, **columns} for row_id, columns in rows.items()]
    connection.execute(insert(table), values)


def take(engine: Engine, shelf: Shelf, row_id: str) -> bool:
    """Remove a row; False if there is none of that id."""
    table = TABLES[shelf]
    with engine.execution_options(writes=True).begin() as connection:
        if connection.execute(select(table.c.id).where(table.c.id == row_id)).first() is None:
            return False
        raised(connection, shelf)
        return connection.execute(delete(table).where(table.c.id == row_id)).rowcount > 0


def _revision(connection: Connection, shelf: Shelf) -> int:
    asked = select(revisions.c.revision).where(revisions.c.shelf == shelf)
    return int(connection.execute(asked).scalar() or 0)


def refuse_more(connection: Connection, table: Table, more: int, most: int) -> None:
    """ShelfFull if so many more rows would be too many."""
    count = connection.execute(select(func.count()).select_from(table)).scalar_one()
    if count + more > most:
        raise ShelfFull


def raised(connection: Connection, shelf: Shelf) -> int:
    """The next revision, which is also the time in milliseconds since 1970 unless the clock was turned back.

    Its row is held until the transaction ends, so that writers of one shelf come one after the other.
    """
    # Both dialects know the clause; each has its own insert for it.
    made = postgresql.insert(revisions) if connection.dialect.name == "postgresql" else sqlite.insert(revisions)
    connection.execute(made.values(shelf=shelf, revision=0).on_conflict_do_nothing())
    here = revisions.c.shelf == shelf
    connection.execute(update(revisions).where(here).values(revision=revisions.c.revision + 1))
    revision = max(_revision(connection, shelf), time.time_ns() // 1_000_000)
    connection.execute(update(revisions).where(here).values(revision=revision))
    return revision
