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
