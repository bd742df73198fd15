"""The scripts of an extraction put into the library together with what is stored of it: both happen, or neither."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from sqlalchemy import Connection

from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.naming import slug_of
from planner_service.shelves import RESERVED, Shelves, TakenError

_TRIES: Final = 5
"""How often ids that somebody else took meanwhile are chosen anew."""


@dataclass(frozen=True)
class Gathered:
    """What of an extraction is kept in the library."""

    added: tuple[str, ...] = ()
    """Ids."""
    renamed: Mapping[str, str] = field(default_factory=dict)
    """Ids that somebody else took since the script was made, to those it has now."""


def keep_all(
    shelves: Shelves,
    scripts: Sequence[ShortScript],
    name: str,
    store: Callable[[Gathered, Callable[[Connection], None]], None],
) -> None:
    """Let `store` store what was gathered, in a transaction in which it calls what adds the scripts, all or none.

    A script whose id is taken by then gets another one. ShelfError, LibraryError.
    """
    for attempt in range(_TRIES):
        named, gathered = _named(shelves, scripts, name)

        def add(connection: Connection, named: Sequence[ShortScript] = named) -> None:
            if named:
                shelves.add_scripts(*named, within=connection)

        try:
            store(gathered, add)
        except TakenError:
            if attempt + 1 == _TRIES:
                raise
        else:
            return


def _named(shelves: Shelves, scripts: Sequence[ShortScript], name: str) -> tuple[list[ShortScript], Gathered]:
    """The scripts under ids that are free now."""
    taken = {script.id for script in shelves.scripts().scripts} | RESERVED
    named: list[ShortScript] = []
    for script in scripts:
        chosen = slug_of(script.summary, name, taken) if script.id in taken else script.id
        taken.add(chosen)
        named.append(script.model_copy(update={"id": chosen}))
    ids = tuple(script.id for script in named)
    changed = {before.id: after for before, after in zip(scripts, ids, strict=True) if before.id != after}
    return named, Gathered(ids, changed)
