"""Films in the database: rows of the same table as stories, each naming the story it films.

They are made by the same workers in a queue of their own, and forgotten with their story.
"""

from __future__ import annotations

import json
from typing import Final

from sqlalchemy import Connection, Engine, select

from planner_service.store.story_store import StoryGone, new_id, now
from planner_service.store.tables import stories

FILM: Final = "film"
"""The kind of such rows; their theme is the id of the story."""


def add_film(connection: Connection, caller: str, story_id: str) -> str:
    """A new film of a story inside the caller's transaction; its id."""
    created = now()
    film_id = new_id(created)
    connection.execute(
        stories.insert().values(
            id=film_id,
            kind=FILM,
            caller=caller,
            created=created,
            theme=story_id,
            seed=0,
            backend="",
            method="mp4",
            character="{}",
            request=json.dumps({"story": story_id}),
            progress=0.0,
        )
    )
    return film_id


def film_of(connection: Connection, story_id: str) -> str | None:
    """The newest film of a story."""
    mine = (stories.c.kind == FILM) & (stories.c.theme == story_id)
    return connection.execute(select(stories.c.id).where(mine).order_by(stories.c.id.desc()).limit(1)).scalar()


def hold_story(connection: Connection, story_id: str) -> None:
    """Until the transaction ends nobody else begins a film of a story. StoryGone."""
    held = select(stories.c.id).where(stories.c.id == story_id).with_for_update()
    if connection.execute(held).scalar() is None:
        raise StoryGone(story_id)


def filmed_by(engine: Engine, film_id: str) -> str:
    """The story that a film is of. StoryGone."""
    mine = (stories.c.kind == FILM) & (stories.c.id == film_id)
    with engine.connect() as connection:
        story_id = connection.execute(select(stories.c.theme).where(mine)).scalar()
    if story_id is None:
        raise StoryGone(film_id)
    return str(story_id)
