"""Takes in the database: stories that are derived from another one, of which the first stages are known already."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import Connection, Engine, select

from planner_service.pipeline import StoryRequest
from planner_service.store.story_store import Made, Stories, put_made
from planner_service.store.tables import takes


def add_take(
    connection: Connection,
    stories: Stories,
    caller: str,
    request: StoryRequest,
    derived_from: str,
    known: Sequence[Made],
) -> str:
    """A new story that derives from another one, inside the caller's transaction; its id. `known` is made already."""
    take_id = stories.add(connection, caller, request)
    connection.execute(takes.insert().values(story_id=take_id, derived_from=derived_from))
    put_made(connection, take_id, known)
    return take_id


def origin_of(engine: Engine, story_id: str) -> str | None:
    """The story that one derives from; None where it is no take."""
    with engine.connect() as connection:
        return connection.execute(select(takes.c.derived_from).where(takes.c.story_id == story_id)).scalar()


def take_number(engine: Engine, story_id: str) -> int:
    """Which take a story is: the takes of one story, and theirs, are counted from 1 as they were asked for; 0: none."""
    with engine.connect() as connection:
        root = story_id
        while above := connection.execute(select(takes.c.derived_from).where(takes.c.story_id == root)).scalar():
            root = above
        family, found = [root], set[str]()
        while family:
            family = list(
                connection.execute(select(takes.c.story_id).where(takes.c.derived_from.in_(family))).scalars()
            )
            found.update(family)
    # Ids sort by the time they were made.
    return sum(one <= story_id for one in found) if story_id in found else 0
