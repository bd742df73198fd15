"""Rows of the users' own short scripts and rooms: written once under an id, taken away, and read again when changed.

Short scripts that are kept again under their ids, and what they were before.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from threading import RLock
from typing import TYPE_CHECKING, Final, Generic, Literal, TypeVar

from sqlalchemy import Connection, Engine, Table, delete, func, insert, select, update
from sqlalchemy.dialects import postgresql, sqlite

from planner_service.store.tables import layouts, revisions, script_versions, short_scripts
from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from sqlalchemy import Connection, Engine


T = TypeVar("T")


class ShelfError(UserError):
    """Something cannot be put on a shelf or taken from it; the text says why.

    TakenError    there is something of that id already
    FixedError    it is ours, and stays
    AbsentError   there is no such thing
    ChangedError  somebody else has changed it meanwhile
    FullError     there are too many already
    """


class TakenError(ShelfError):
    """There is something of that id already."""


class FixedError(ShelfError):
    """It is shipped with the package and can be neither removed nor replaced."""


class AbsentError(ShelfError):
    """There is nothing of that id."""


class ChangedError(ShelfError):
    """It is not what it was when it was read."""


class FullError(ShelfError):
    """There are as many as can be kept."""


class Kept(Generic[T]):
    """One shelf: what does not change, and the rows of the database, of which only new ones are read and parsed."""

    def __init__(
        self, engine: Engine | None, shelf: Shelf, read: Callable[[str, str], T], fixed: Callable[[], dict[str, T]]
    ) -> None:
        self.engine, self.shelf = engine, shelf
        self._read, self._make_fixed = read, fixed
        self._fixed: dict[str, T] | None = None
        self._rows: dict[str, tuple[int, T]] = {}
        self._revision = -1
        self._all: Mapping[str, T] = {}
        self._lock = RLock()

    @property
    def fixed(self) -> Mapping[str, T]:
        """What is not in the database."""
        with self._lock:
            if self._fixed is None:
                self._fixed = self._make_fixed()
            return self._fixed

    def now(self) -> Mapping[str, T]:
        """Everything by its id; the very same mapping as long as nothing has changed."""
        revision = self._newest()
        with self._lock:
            if revision != self._revision:
                self._refresh()
            return self._all

    def _newest(self) -> int:
        if self.engine is None:
            return 0

        return revision_of(self.engine, self.shelf)

    def _refresh(self) -> None:
        if self.engine is None:
            self._all, self._revision = self.fixed, 0
            return

        stock = stock_of(self.engine, self.shelf)
        kept = {one: row for one, row in self._rows.items() if stock.rows.get(one) == row[0]}
        bodies = bodies_of(self.engine, self.shelf, stock.rows.keys() - kept.keys())
        kept |= {one: (stock.rows[one], self._read(one, body)) for one, body in bodies.items()}
        self._rows = {one: kept[one] for one in sorted(kept, key=lambda one: (kept[one][0], one))}
        # A user's comes before one of the same id that a later version of ours brought.
        self._all = {**self.fixed, **{one: value for one, (_, value) in self._rows.items()}}
        self._revision = stock.revision

    def put(
        self, rows: Mapping[str, Mapping[str, str]], most: int, name: str, within: Connection | None = None
    ) -> None:
        """Write rows, all or none, `within` a transaction or alone."""
        if not rows:
            return
        if self.engine is None:
            raise ShelfError(f"there is no database to keep a {name} in")

        try:
            put(self.engine, self.shelf, rows, most, within)
        except IdTaken as error:
            raise TakenError(f"there is a {name} {error.row_id!r} already", "choose another id", at="id") from error
        except ShelfFull as error:
            raise _full(most, name) from error

    def renew(self, renewals: Mapping[str, Renewal], most: int, name: str) -> None:
        """Write rows of short scripts, all or none, over those that there are."""
        if self.engine is None:
            raise ShelfError(f"there is no database to keep a {name} in")

        try:
            renew(self.engine, renewals, most)
        except ShelfFull as error:
            raise _full(most, name) from error

    def take(self, row_id: str, name: str) -> None:
        """Remove a row."""
        if self.engine is not None and take(self.engine, self.shelf, row_id):
            return
        if row_id in self.fixed:
            raise FixedError(f"{row_id!r} is a {name} that is not in the database; it cannot be removed")
        raise AbsentError(f"there is no {name} {row_id!r}")


def _full(most: int, name: str) -> FullError:
    return FullError(f"at most {most} {name}s of users' own are kept", "remove some first")


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


MAX_KEPT: Final = 100
"""Older versions of one script; those before them are forgotten."""
Renewal = Callable[[str | None], str | None]
"""From the body that is kept now (None: there is none) the one to keep instead (None: it stays as it is)."""


def renew(engine: Engine, renewals: Mapping[str, Renewal], most: int) -> None:
    """Keep short scripts, all or none; what is replaced can still be read by its version.

    What a renewal raises leaves everything as it was; ShelfFull if there would be more than `most` scripts.
    """
    with engine.execution_options(writes=True).begin() as connection:
        revision = raised(connection, "short_scripts")
        kept = bodies_in(connection, "short_scripts", renewals.keys())
        made = {one: body for one, renewal in renewals.items() if (body := renewal(kept.get(one))) is not None}
        rows = [{"id": one, "body": body, "created": revision} for one, body in made.items()]
        new = [row for row in rows if row["id"] not in kept]
        refuse_more(connection, short_scripts, len(new), most)
        if new:
            connection.execute(insert(short_scripts), new)
        for one in made.keys() & kept.keys():
            _set_aside(connection, one, kept[one])
            here = short_scripts.c.id == one
            connection.execute(update(short_scripts).where(here).values(body=made[one], created=revision))


def versions_of(engine: Engine, script_id: str) -> list[str]:
    """The JSON of all older versions, the oldest first."""
    old = script_versions.c
    asked = select(old.body).where(old.script_id == script_id).order_by(old.version)
    with engine.connect() as connection:
        return list(connection.execute(asked).scalars())


def _set_aside(connection: Connection, script_id: str, body: str) -> None:
    version = int(json.loads(body).get("version", 1))
    old = script_versions.c
    connection.execute(insert(script_versions).values(script_id=script_id, version=version, body=body))
    connection.execute(delete(script_versions).where(old.script_id == script_id, old.version <= version - MAX_KEPT))
