"""Extractions in the database: rows of the same table as stories, made by the same workers in a queue of their own."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from sqlalchemy import Connection, Engine, select

from planner_service.store.story_store import EXTRACTION, StoryGone, new_id, now
from planner_service.store.tables import stories


@dataclass(frozen=True)
class ExtractionRequest:
    """What short scripts are to be extracted from."""

    name: str
    """The title, for people."""
    licence: str
    add: bool
    """Whether the scripts are kept in the library."""
    film: bool
    """Whether it is a film; else a text, or subtitles alone."""
    file: str
    """The content id of the film or text."""
    subtitles: str | None = None
    """The content id of what lies beside a film."""

    def to_json(self) -> str:
        """One text for equal requests."""
        return json.dumps(asdict(self), separators=(",", ":"))


def add_extraction(connection: Connection, caller: str, request: ExtractionRequest, stage: str | None = None) -> str:
    """A new extraction inside the caller's transaction; its id. One that was made at once is in its last stage."""
    created = now()
    extraction_id = new_id(created)
    connection.execute(
        stories.insert().values(
            id=extraction_id,
            kind=EXTRACTION,
            caller=caller,
            created=created,
            theme=request.name,
            seed=0,
            backend="",
            method="film" if request.film else "text",
            character="{}",
            request=request.to_json(),
            stage=stage,
            progress=0.0 if stage is None else 1.0,
        )
    )
    return extraction_id


def extraction_request(engine: Engine, extraction_id: str) -> ExtractionRequest:
    """What was asked for. StoryGone."""
    with engine.connect() as connection:
        text = connection.execute(select(stories.c.request).where(stories.c.id == extraction_id)).scalar()
    if text is None:
        raise StoryGone(extraction_id)
    return ExtractionRequest(**json.loads(text))
