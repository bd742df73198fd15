"""One worker process: takes stories, extractions and films from their queues, one of each at a time, and makes them.

While a story waits for its language model, up to three others go on.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import suppress
from dataclasses import replace
from typing import Final

import structlog
from sqlalchemy import Engine, text
from sqlalchemy.exc import InterfaceError, OperationalError

from motion_backend.backends import DEFAULT_BACKEND
from motion_backend.director import Director
from planner_service.extraction.speech_to_text import load_transcriber
from planner_service.jobs.extraction_stages import Reader
from planner_service.jobs.film_stages import Filmer
from planner_service.jobs.queue import APPLICATION, EXTRACTIONS, FILMS, QUEUE, VERSION
from planner_service.jobs.story_stages import AT_ONCE, Maker
from planner_service.jobs.uploads import Uploads
from planner_service.jobs.worker_lock import hold_name
from planner_service.library.library import Shelves
from planner_service.llm.factory import load_model
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.settings import Settings, give_backends
from planner_service.store.database import database_url, open_engine
from planner_service.store.story_store import Stories
from scene_graphs.errors import UserError
from scene_graphs.layout_library import compile_search

POLL: Final = 0.15
"""Seconds between two looks into the queue: an idle worker costs little, and a story starts at once."""
RARELY: Final = 1.0
"""The same for films, which take longer than that to read: two queues looked into so often slowed the service."""
WARM: Final = "She comes home happy, sits down on the sofa and reads a book."
"""What is begun before anything is asked for."""
KEEP: Final = 3.0
"""Seconds between two looks at whether this worker's name is still its own."""
log = structlog.get_logger("sims.worker")


def run_worker(settings: Settings, supervised: bool = False) -> None:
    """Work until SIGTERM or SIGINT; supervised, also until the supervisor is gone (its end of our stdin closes).

    A step that is interrupted is made again when a worker of this id starts. SettingsError if a worker of this id
    lives already: both would make the same stories.
    """
    from dbos import DBOS, DBOSPortableJSONSerializer

    from planner_service.jobs.workflows import register

    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    if supervised:
        threading.Thread(target=_end_with_supervisor, daemon=True).start()
    url = database_url(settings)
    engine = open_engine(url)
    give_backends(settings)
    shelves = Shelves(engine, settings.cache_dir, settings.layouts)
    pipeline = Pipeline(shelves, load_model(settings), settings.llm_on_failure == "error")
    hold = hold_name(engine, settings)
    warm_up(pipeline)
    store, strict = Stories(engine), settings.llm_on_failure == "error"
    uploads, transcriber = Uploads(settings.uploads_dir), load_transcriber(settings)
    reader = Reader(store, shelves, uploads, settings.worker_id, pipeline.model, transcriber, strict)
    filmer = Filmer(store, pipeline, settings.worker_id)
    register(Maker(store, pipeline, settings.worker_id), reader, filmer)
    DBOS(
        config={
            "name": APPLICATION,
            "system_database_url": url,
            "executor_id": settings.worker_id,
            "application_version": VERSION,
            "serializer": DBOSPortableJSONSerializer(),
            "log_level": "CRITICAL",
        }
    )
    if not _wait_for(engine, stop):
        os._exit(0)
    DBOS.launch()
    # Without a model nobody waits, and the stories would only hold each other up.
    stories = AT_ONCE if pipeline.model is not None else 1
    for queue, poll, at_once in ((QUEUE, POLL, stories), (EXTRACTIONS, RARELY, 1), (FILMS, RARELY, 1)):
        DBOS.register_queue(queue, worker_concurrency=at_once, polling_interval_sec=poll)
    log.info("worker ready", worker=settings.worker_id, pid=os.getpid())
    while not stop.wait(KEEP):
        if not hold.keep():
            log.error("somebody else has this worker's name, leaving", worker=settings.worker_id)
            os._exit(75)
    log.info("worker stops", worker=settings.worker_id)
    # A step in the making is left: it is made again at the next start, and nothing of it was stored.
    sys.stderr.flush()
    os._exit(0)


def warm_up(pipeline: Pipeline) -> None:
    """Load scripts, rooms, the compiled search and the encoder now, and begin a story that nobody sees, so that the
    first one that somebody waits for is made as fast as those after it; no language model is asked."""
    pipeline.shelves.layouts()
    compile_search()
    pipeline.shelves.scripts().search("warm up", 1)
    request, rules = StoryRequest(WARM), replace(pipeline, model=None)
    with suppress(UserError):  # what a library of one's own lacks is said to whom it matters
        planned = rules.plan(request)
        director = Director.of(DEFAULT_BACKEND)
        for action in rules.act(request, planned.stage)[:1]:
            director.act(planned.home, action, director.begin(planned.home, planned.character, request.seed, action))


def _wait_for(engine: Engine, stop: threading.Event) -> bool:
    """Until the database can be written: a start that fails would count against the stories that are resumed.

    False if the worker is asked to end meanwhile.
    """
    wait = 0.5
    while not stop.is_set():
        try:
            with engine.execution_options(writes=True).begin() as connection:
                connection.execute(text("UPDATE stage_times SET count = count WHERE worker = ''"))
        except (OperationalError, InterfaceError) as error:
            log.warning("database not usable, trying again", reason=str(error.orig), wait=wait)
            stop.wait(wait)
            wait = min(2 * wait, 15.0)
        else:
            return True
    return False


def _end_with_supervisor() -> None:
    sys.stdin.buffer.read()
    os._exit(0)
