"""One shelf: what is fixed and what users added, read from the database again when somebody changed it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from threading import RLock
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from sqlalchemy import Connection, Engine

    from planner_service.store.shelving import Shelf
    from planner_service.store.versions import Renewal

T = TypeVar("T")


class ShelfError(ValueError):
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
        from planner_service.store.shelving import revision_of

        return revision_of(self.engine, self.shelf)

    def _refresh(self) -> None:
        if self.engine is None:
            self._all, self._revision = self.fixed, 0
            return
        from planner_service.store.shelving import bodies_of, stock_of

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
        from planner_service.store.shelving import IdTaken, ShelfFull, put

        try:
            put(self.engine, self.shelf, rows, most, within)
        except IdTaken as error:
            raise TakenError(f"id: there is a {name} {error.row_id!r} already; choose another id") from error
        except ShelfFull as error:
            raise _full(most, name) from error

    def renew(self, renewals: Mapping[str, Renewal], most: int, name: str) -> None:
        """Write rows of short scripts, all or none, over those that there are."""
        if self.engine is None:
            raise ShelfError(f"there is no database to keep a {name} in")
        from planner_service.store.shelving import ShelfFull
        from planner_service.store.versions import renew

        try:
            renew(self.engine, renewals, most)
        except ShelfFull as error:
            raise _full(most, name) from error

    def take(self, row_id: str, name: str) -> None:
        """Remove a row."""
        if self.engine is not None:
            from planner_service.store.shelving import take

            if take(self.engine, self.shelf, row_id):
                return
        if row_id in self.fixed:
            raise FixedError(f"{row_id!r} is a {name} that is not in the database; it cannot be removed")
        raise AbsentError(f"there is no {name} {row_id!r}")


def _full(most: int, name: str) -> FullError:
    return FullError(f"at most {most} {name}s of users' own are kept; remove some first")
