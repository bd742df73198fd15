"""What routes are handed: the service's parts, parameters that are known, and bodies read as JSON.

Query parameters that a call does not know are refused: `frm=0` must not quietly mean everything.

The JSON body of a call that also takes other kinds of bodies: read and refused as FastAPI does it for all others.
"""

from __future__ import annotations

import json
import threading
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Final, TypeVar

from anyio import CapacityLimiter
from fastapi import Depends, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError
from sqlalchemy import Engine
from sqlalchemy.exc import SQLAlchemyError
from starlette.requests import HTTPConnection

from planner_service.api.errors import Unprocessable, WrongMedia
from planner_service.extraction.transcription import Transcriber, load_transcriber
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


async def parts_of(connection: HTTPConnection) -> Parts:
    """The parts of the app that a request came to; async, since a thread for it would cost more than it does."""
    parts: Parts = connection.app.state.parts
    return parts


PartsDep = Annotated[Parts, Depends(parts_of)]


async def only_known_parameters(request: Request) -> None:
    """Unprocessable names the parameter that the call lacks, and those it has; async, since it waits for nothing."""
    if not request.query_params:
        return
    operation = request.app.openapi()["paths"].get(request.scope["route"].path, {}).get(request.method.lower())
    if operation is None:
        return
    known = [parameter["name"] for parameter in operation.get("parameters", ()) if parameter["in"] == "query"]
    for name in request.query_params:
        if name not in known:
            raise Unprocessable(f"?{name}", f"there is no such parameter here; there are {', '.join(known) or 'none'}")


T = TypeVar("T", bound=BaseModel)


def parsed(model: type[T], request: Request, body: bytes) -> T:
    """The body as a model. WrongMedia where it is not sent as JSON, RequestValidationError where it is wrong."""
    media = request.headers.get("content-type", "").split(";")[0].strip().lower()
    if media != "application/json" and not media.endswith("+json"):
        raise WrongMedia(f"Content-Type is {media or 'missing'!r:.80}; send JSON as application/json")
    try:
        row = json.loads(body)
    except json.JSONDecodeError as error:
        fault = {"type": "json_invalid", "loc": ("body", error.pos), "msg": error.msg, "ctx": {"error": error.msg}}
        raise RequestValidationError([fault], body=error.doc) from error
    except (ValueError, RecursionError) as error:  # not UTF-8, a number of thousands of digits, brackets without end
        fault = {"type": "json_invalid", "loc": ("body", 0), "msg": str(error), "ctx": {"error": str(error)}}
        raise RequestValidationError([fault], body="") from error
    try:
        return model.model_validate(row)
    except ValidationError as error:
        faults = [{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors(include_url=False)]
        raise RequestValidationError(faults, body=row) from error
