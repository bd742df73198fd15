"""Short scripts that are kept again under their ids, and what they were before."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Final

from sqlalchemy import Connection, Engine, delete, insert, select, update

from planner_service.store.shelving import bodies_in, raised, refuse_more
from planner_service.store.tables import script_versions, short_scripts

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
