"""Every exception becomes a problem: the faults of a request by pointer, a busy database, and what nobody foresaw."""

from __future__ import annotations

import errno
import sqlite3
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any, Final

import structlog
from anyio import BrokenResourceError, ClosedResourceError
from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from fastapi.routing import iter_route_contexts
from sqlalchemy.exc import DataError, DBAPIError, InterfaceError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from motion_backend.backends import BrokenBackendError
from motion_backend.body.cast import GIVEN
from motion_backend.language.minilm import WeightsError
from planner_service.api.errors import (  # fmt: skip
    MAX_FAULTS,
    Fault,
    Malformed,
    ModelFailed,
    NotFound,
    Problem,
    StorageFull,
    Unavailable,
    Unprocessable,
    WrongMedia,
)
from planner_service.llm.protocol import ModelError
from planner_service.output.story_export import OutputError
from planner_service.settings import SettingsError
from planner_service.store.story_store import StoryGone
from planner_service.user_errors import one_line
from scene_graphs.errors import UserError
from scene_graphs.json_fields import LayoutError

METHODS: Final = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
OURS: Final = (OutputError, SettingsError, WeightsError)
"""Faults of the installation, not of a request."""
NAMES: Final = {
    **{field: f"character/{field}" for field in ("name", "pronouns", "height", *GIVEN)}, "layout": "layouts",
    "query": "q",
}  # fmt: skip
"""Fields that have another place or name over HTTP."""
STATUS_TEXTS: Final = {
    404: "there is nothing at this path; GET /openapi.json lists the calls there are",
    405: "this path has no such method",
}
DISK_FULL: Final = ("database or disk is full", "no space left", "disk quota exceeded", "could not extend file")
BUSY: Final = ("locked", "busy", "disk i/o error", "unable to open database file")
"""What SQLite says when it is not the statement that is wrong."""
BROKEN: Final = 300
"""Seconds after which somebody may have mended a backend."""
log = structlog.get_logger("sims.errors")


def register_handlers(app: FastAPI) -> None:
    """Answer every exception of a route as a problem; what is left over is `Unforeseen`'s."""
    app.add_exception_handler(Problem, _problem)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(StoryGone, _gone)
    app.add_exception_handler(SQLAlchemyError, _database)
    app.add_exception_handler(OSError, _database)
    app.add_exception_handler(sqlite3.Error, _database)
    app.add_exception_handler(UserError, _engine)


class Unforeseen:
    """ASGI: answers 500 to what no handler knows and writes it down once, with its traceback."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on; an answer that has begun cannot be changed, so the connection is broken off by the server."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        begun = False

        async def noticing(message: Message) -> None:
            nonlocal begun
            begun = begun or message["type"] == "http.response.start"
            await send(message)

        try:
            await self.app(scope, receive, noticing)
        except Exception as error:
            if begun and is_hang_up(error):
                return
            log.exception("unforeseen", path=scope["path"], answer_begun=begun)
            if not begun:
                known = database_problem(error) or _unforeseen(scope)
                await known.response(scope["path"])(scope, receive, send)


def is_hang_up(error: BaseException) -> bool:
    """Whether this only says that a caller left a stream in the middle of an event (FastAPI's own queue was closed)."""
    if isinstance(error, BaseExceptionGroup):
        return all(is_hang_up(one) for one in error.exceptions)
    return isinstance(error, BrokenResourceError | ClosedResourceError)


def _unforeseen(scope: Scope) -> Problem:
    request_id = scope.get("state", {}).get("request_id", "unknown")
    return Problem(f"a fault of ours, written down under the request id {request_id}; it may help to try again")


async def _problem(request: Request, error: Exception) -> Response:
    assert isinstance(error, Problem)
    return error.response(request.url.path)


async def _http(request: Request, error: Exception) -> Response:
    """Starlette's own errors: unknown paths and methods, bodies that break off."""
    assert isinstance(error, HTTPException)
    headers = dict(error.headers or {})
    if error.status_code in (204, 304):
        return Response(status_code=error.status_code, headers=headers)
    if error.status_code == 405:
        # A route names its own methods, not those of its neighbours at the same path.
        headers["Allow"] = ", ".join(allowed_methods(request)) or headers.get("Allow", "")
    phrase = HTTPStatus(error.status_code).phrase
    detail = error.detail if error.detail and error.detail != phrase else STATUS_TEXTS.get(error.status_code, phrase)
    if detail == "There was an error parsing the body":
        detail = "the body cannot be read as JSON in UTF-8, or is nested too deeply"
    problem = Problem(detail, headers=headers)
    problem.status = error.status_code
    return problem.response(request.url.path)


def allowed_methods(request: Request) -> list[str]:
    """The methods that the path has, over all routes of its template."""
    template = getattr(request.scope.get("route"), "path", None)
    routes = [route for route in iter_route_contexts(request.app.routes) if route.path == template]
    found = {method for route in routes for method in route.methods or ()}
    return [method for method in METHODS if method in found or (method == "HEAD" and "GET" in found)]


async def _engine(request: Request, error: Exception) -> Response:
    """What the engine says about a request: mostly the request's fault."""
    assert isinstance(error, UserError)
    return engine_problem(error, request.method).response(request.url.path)


def engine_problem(error: UserError, method: str = "POST") -> Problem:
    """What a user did wrong as a problem; the field that it is about becomes a pointer."""
    if isinstance(error, ModelError):
        return ModelFailed(f"the language model gave no usable answer: {error}")
    if isinstance(error, BrokenBackendError):
        return Unavailable(str(error), retry_after=BROKEN)
    if isinstance(error, OURS):
        log.error("installation", reason=str(error))
        return Problem("the service is not set up rightly; its log says what is wrong")
    if not error.at or isinstance(error, LayoutError):  # a place in a file is none in the request
        return Unprocessable("", _words(str(error)))
    field = _words(str(error.at))
    place = f"/{NAMES[field]}" if field in NAMES else f"/{field}"
    return Unprocessable(f"?{place[1:]}" if method in ("GET", "DELETE") else place, _words(error.said))


def _words(text: str) -> str:
    """One printable line; options of the command line are fields here."""
    return one_line(text).replace("--", "")


async def _gone(request: Request, _error: Exception) -> Response:
    """It was there when the request came."""
    return NotFound("there is no such story; it was deleted a moment ago").response(request.url.path)


async def _database(request: Request, error: Exception) -> Response:
    problem = database_problem(error)
    if problem is None:
        raise error
    log.warning("database", reason=str(getattr(error, "orig", error)).splitlines()[0], status=problem.status)
    return problem.response(request.url.path)


def database_problem(error: BaseException) -> Problem | None:
    """What a database or a disk in trouble is to the caller; None for what is a fault of ours."""
    cause = getattr(error, "orig", None) or error
    text = str(cause).lower()
    if getattr(cause, "errno", None) in (errno.ENOSPC, errno.EDQUOT) or any(words in text for words in DISK_FULL):
        return StorageFull("no room is left on the disk; delete stories (DELETE /v1/stories/{id}) or make room")
    away = "the database is busy or away; nothing was lost, ask again"
    if isinstance(error, PoolTimeout) or (isinstance(error, DBAPIError) and error.connection_invalidated):
        return Unavailable(away)
    if isinstance(cause, sqlite3.Error):
        return Unavailable(away) if isinstance(cause, sqlite3.OperationalError) and _has(BUSY, text) else None
    if isinstance(error, (OperationalError, InterfaceError)):
        return Unavailable(away)
    if isinstance(error, DataError):
        return Unprocessable("", "a text or number cannot be stored, such as one with NUL letters or too many digits")
    return None


def _has(words: Sequence[str], text: str) -> bool:
    return any(word in text for word in words)


async def _invalid(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    return validation_problem(error, request.headers.get("content-type", "")).response(request.url.path)


def validation_problem(error: RequestValidationError, media: str) -> Problem:
    """Faults of the input, each with its pointer; what was sent is never repeated."""
    found: Sequence[Mapping[str, Any]] = error.errors()
    first = found[0]
    if first["type"] == "json_invalid":
        return _not_json(error.body, first)
    if tuple(first["loc"]) == ("body",) and isinstance(error.body, bytes):
        name = f"{media!r:.80}" if media else "missing"
        return WrongMedia(f"Content-Type is {name}; send JSON as application/json")
    faults = [Fault(pointer=_pointer(fault, error.body), detail=str(fault["msg"])) for fault in found[:MAX_FAULTS]]
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    where = f"{faults[0].pointer}: " if faults[0].pointer else ""
    problem = Unprocessable(faults[0].pointer, faults[0].detail)
    problem.detail, problem.errors = f"{where}{faults[0].detail}{more}", tuple(faults)
    return problem


def _not_json(body: object, fault: Mapping[str, Any]) -> Problem:
    place = int(fault["loc"][1])
    text = body if isinstance(body, str) else ""
    line, column = text.count("\n", 0, place) + 1, place - text.rfind("\n", 0, place)
    what = f"not JSON: {fault['ctx']['error']} at line {line}, column {column}"
    return Malformed(what, (Fault(pointer="", detail=what),))


def _pointer(fault: Mapping[str, Any], body: object) -> str:
    """`/a/0/b` in the body, `?name` in the query, `header:name`, `path:name`."""
    place, *steps = fault["loc"]
    if place == "query":
        return f"?{steps[0] if steps else ''}"
    if place != "body":
        return f"{place}:{steps[0] if steps else ''}"
    found = ""
    for number, step in enumerate(steps):
        inside = step in body if isinstance(body, dict) else isinstance(body, list) and isinstance(step, int)
        missing = number == len(steps) - 1 and fault["type"] == "missing"
        if inside or missing:  # else the name of a union's branch or of a validator: nothing that was sent
            found += "/" + str(step).replace("~", "~0").replace("/", "~1")
        if inside and not missing:
            body = body[step]  # type: ignore[index]
    return found
