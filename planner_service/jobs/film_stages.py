"""A story's film.mp4 made by a worker: one step, told how far it is, and left where nobody wants it any more."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from sqlalchemy.exc import InterfaceError, OperationalError

from planner_service.jobs.story_stages import OpenStory, read_segments
from planner_service.output.film import Filmed, write_film
from planner_service.pipeline import Pipeline, judge
from planner_service.store.film_store import filmed_by
from planner_service.store.story_store import Made, Stories

STAGE: Final = "film"
KIND: Final = "mp4"
TOLD_EVERY: Final = 1.0
"""Seconds between two looks whether it is still wanted, which also tell how far it is."""


@dataclass(frozen=True)
class Filmer:
    """One worker's desk for films."""

    store: Stories
    pipeline: Pipeline
    worker: str

    def film(self, film_id: str) -> None:
        """The film, stored whole. FilmUnavailableError, StoryGone."""
        if self.store.has(film_id, 0):
            return
        started = time.perf_counter()
        self.store.begin(film_id, STAGE)
        filmed = self.filmed(filmed_by(self.store.engine, film_id))
        with TemporaryDirectory(prefix="sims-film-") as folder:
            path = write_film(filmed, Path(folder) / "film.mp4", show=self._telling(film_id))
            data = path.read_bytes()
        summary = {"frames": len(filmed.edit), "bytes": len(data)}
        made = Made(KIND, 0, data, summary, None, 1.0, time.perf_counter() - started)
        self.store.record(film_id, made, self.worker)

    def filmed(self, story_id: str) -> Filmed:
        """What there is of a story to film. StoryGone."""
        story = OpenStory(self.store, story_id, self.pipeline)
        motions = read_segments(self.store, story_id, range(len(story.actions)))
        return Filmed.of(judge(story.planned, story.actions, motions, lambda _stage, _share: None))

    def _telling(self, film_id: str) -> Callable[[float], None]:
        told = time.monotonic()

        def tell(share: float) -> None:
            nonlocal told
            if time.monotonic() - told >= TOLD_EVERY:
                told = time.monotonic()
                # How far it is can be told later; what is made will be stored when the database is back.
                with suppress(OperationalError, InterfaceError):
                    self.store.go_on(film_id, round(share, 4))

        return tell
