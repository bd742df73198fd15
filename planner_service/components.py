"""What the service is made of: settings, database, scripts and rooms, the door to the workers, the models."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from anyio import CapacityLimiter
from sqlalchemy import Engine
from sqlalchemy.exc import SQLAlchemyError

from planner_service.extraction.speech_to_text import Transcriber, load_transcriber
from planner_service.jobs.queue import Jobs
from planner_service.jobs.uploads import Uploads
from planner_service.library.library import Shelves
from planner_service.llm.client import ServedModel
from planner_service.llm.factory import load_model
from planner_service.llm.protocol import LanguageModel
from planner_service.settings import Settings
from planner_service.store.database import database_url, open_engine, unopened

MAX_PLANNED: Final = 8
"""Requests that may wait for a language model at once: each holds a thread, and the others need some too."""
MAX_UPLOADS: Final = 8
"""Films that may come in at once: each may fill some gigabytes of the disk."""


@dataclass(frozen=True)
class Parts:
    """One service: its settings, its database, the scripts and rooms there are, and the door to the workers."""

    settings: Settings
    engine: Engine
    shelves: Shelves
    jobs: Jobs
    model: LanguageModel | None = None
    """What plans; None for the rules."""
    importing: CapacityLimiter = field(default_factory=partial(CapacityLimiter, 2))
    """Scene files that are read at once: each may take a second and some hundred megabytes."""
    planning: threading.BoundedSemaphore = field(default_factory=lambda: threading.BoundedSemaphore(MAX_PLANNED))
    """Taken by every request that waits for the model."""
    transcriber: Transcriber | None = None
    """What hears the speech of films; here only because a film that nobody can hear or watch is refused at once."""
    uploading: threading.BoundedSemaphore = field(default_factory=lambda: threading.BoundedSemaphore(MAX_UPLOADS))
    """Taken by every film that is coming in."""
    stopping: threading.Event = field(default_factory=threading.Event)
    """Set when the service is about to end, so that streams end too."""

    @property
    def uploads(self) -> Uploads:
        """Where films lie until they have been read."""
        return Uploads(self.settings.uploads_dir)

    def hang_up(self) -> None:
        """Let no request wait for the model any longer: what it has not said is left to the rules, or fails."""
        if isinstance(self.model, ServedModel):
            self.model.close()

    def close(self) -> None:
        """Let go of the database."""
        self.jobs.close()
        self.engine.dispose()


def open_parts(settings: Settings) -> Parts:
    """Open the database and everything on it. SettingsError says what cannot be used."""
    model, transcriber = load_model(settings), load_transcriber(settings)
    url = database_url(settings)
    engine = open_engine(url)
    try:
        jobs = Jobs(engine, url)
    except SQLAlchemyError as error:
        engine.dispose()
        raise unopened(url, error) from error
    shelves = Shelves(engine, settings.cache_dir, settings.layouts)
    return Parts(settings, engine, shelves, jobs, model, transcriber=transcriber)
