"""The durable way of a story: every stage, and the motion of every action, is one recorded step (DBOS).

A worker that is killed goes on, when it starts again under its id, at the step it was in. A step may therefore run
twice, and what it stores is stored once. Steps are the points where a story can be cancelled.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final, TypeVar

import structlog
from dbos import DBOS
from sqlalchemy.exc import InterfaceError, OperationalError

from planner_service.jobs.extraction_stages import Reader
from planner_service.jobs.film_stages import Filmer
from planner_service.jobs.queue import EXTRACT, SHOOT, WORKFLOW
from planner_service.jobs.story_stages import Maker
from planner_service.store.story_store import Stories, StoryGone
from planner_service.user_errors import explain
from scene_graphs.errors import UserError

MAX_ATTEMPTS: Final = 10
"""How often a story may take its worker down with it before it is given up."""
MAX_WAIT_SECONDS: Final = 15.0
"""Seconds between two attempts to reach the database."""
UNUSABLE: Final = (OperationalError, InterfaceError)
"""What a locked, full or absent database raises."""
R = TypeVar("R")
log = structlog.get_logger("sims.worker")


def register(maker: Maker, reader: Reader, filmer: Filmer) -> None:
    """Tell the job engine how stories, extractions and films are made; call before DBOS.launch()."""

    @DBOS.workflow(name=WORKFLOW, max_recovery_attempts=MAX_ATTEMPTS)
    def act_out(story_id: str) -> None:
        with structlog.contextvars.bound_contextvars(story_id=story_id):
            make(maker, story_id)

    @DBOS.workflow(name=EXTRACT, max_recovery_attempts=MAX_ATTEMPTS)
    def extract(extraction_id: str) -> None:
        with structlog.contextvars.bound_contextvars(story_id=extraction_id):
            read(reader, extraction_id)

    @DBOS.workflow(name=SHOOT, max_recovery_attempts=MAX_ATTEMPTS)
    def shoot(film_id: str) -> None:
        with structlog.contextvars.bound_contextvars(story_id=film_id):
            film(filmer, film_id)

    del act_out, extract, shoot


def make(maker: Maker, story_id: str) -> None:
    """All steps of a story in order; what cannot be made is said in the story before the workflow fails."""
    with told(maker.store, story_id, "This story cannot be made"):
        step("plan", maker.plan, story_id)
        step("furnish", maker.furnish, story_id)
        if step("tells", _tells, maker, story_id):
            step("narrate", maker.narrate, story_id)
        for index in range(step("act", maker.act, story_id)):
            step(f"move {index}", maker.move, story_id, index)
        step("judge", maker.judge, story_id)
        step("film", maker.film, story_id)


def read(reader: Reader, extraction_id: str) -> None:
    """All steps of an extraction in order; what was sent is thrown away when it has ended, however."""
    try:
        with told(reader.store, extraction_id, "This cannot be extracted from"):
            if step("begin", reader.begin, extraction_id):
                step("listen", reader.listen, extraction_id)
            for index in range(step("cut", reader.cut, extraction_id)):
                step(f"read {index}", reader.read, extraction_id, index)
            step("gather", reader.gather, extraction_id)
    finally:
        reader.close(extraction_id)


def film(filmer: Filmer, film_id: str) -> None:
    """The one step of a film."""
    with told(filmer.store, film_id, "This story cannot be filmed"):
        step("film", filmer.film, film_id)


@contextmanager
def told(store: Stories, story_id: str, title: str) -> Iterator[None]:
    """Why it failed is stored before the workflow fails; one that nobody wants any more just ends."""
    try:
        yield
    except StoryGone:
        log.info("story deleted or cancelled while it was made")
    except UserError as error:
        step("fail", store.fail, story_id, title, explain(error))
        raise
    except Exception as error:
        log.exception("story failed")
        step("fail", store.fail, story_id, "Something went wrong on our side", type(error).__name__)
        raise


def _tells(maker: Maker, story_id: str) -> bool:
    """Whether there is a story to tell: there is none to keyframes that were given."""
    return not maker.store.request(story_id).keyframes


def step(name: str, run: Callable[..., R], *args: object) -> R:
    """One recorded step. A database that is away, locked or full is waited for; nothing is lost meanwhile."""

    def attempt() -> R:
        log.info("step begins", step=name)
        started, wait = time.perf_counter(), 0.5
        while True:
            try:
                done = run(*args)
            except UNUSABLE as error:
                log.warning("database not usable, trying again", step=name, reason=str(error.orig), wait=wait)
                time.sleep(wait)
                wait = min(2 * wait, MAX_WAIT_SECONDS)
            else:
                log.info("step done", step=name, ms=round(1000 * (time.perf_counter() - started), 1))
                return done

    try:
        return DBOS.run_step({"name": name}, attempt)
    except UNUSABLE as error:
        # The job engine itself could not write: only a fresh process knows what was recorded.
        log.error("step cannot be recorded, starting again", step=name, reason=str(error.orig))
        os._exit(75)
