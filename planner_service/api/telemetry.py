"""What the service tells of itself: JSON lines with a request id, and figures for Prometheus."""

from __future__ import annotations

import logging
import re
import time
import uuid
from typing import Any, Final, TextIO

import structlog
from prometheus_client import CollectorRegistry, Gauge, Histogram, ProcessCollector
from prometheus_client.registry import Collector
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bound_contextvars
from structlog.types import EventDict, WrappedLogger

from planner_service.user_errors import printable

REQUEST_ID: Final = re.compile(r"[A-Za-z0-9._:-]{1,64}\Z")
"""Ids of the caller's own that are taken over; anything else could forge log lines."""
METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
SECONDS: Final = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
UNKNOWN: Final = "unknown"
"""The route of a request that was refused before it reached one."""
MAX_PATH_LENGTH: Final = 200
MAX_ID_LENGTH: Final = 64
"""Letters of a story's id that are written down: whoever asks may send any."""
HUNG_UP: Final = 499
"""The status in log and figures where the caller left before there was an answer."""
QUIET: Final = ("dbos", "sqlalchemy", "httpx", "httpcore", "httpx2", "httpcore2", "openai", "anthropic", "matplotlib")
"""Libraries whose own news below a warning would drown ours."""
LIBRARIES: Final = ("uvicorn", *QUIET)
DBOS_STORY: Final = "operationUUID"
log = structlog.get_logger("sims.http")


def configure_logging(level: str, stream: TextIO) -> None:
    """Send structlog's and the standard library's lines to `stream`, one JSON object each; to a terminal as words,
    without a server's news of itself. Called once a process.
    """
    people = stream.isatty()
    shared: list[Any] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True, key="time"),
        structlog.processors.format_exc_info,
        _without_absent,
    ]
    structlog.configure(
        processors=[*shared, structlog.stdlib.ProcessorFormatter.wrap_for_formatter],
        wrapper_class=structlog.make_filtering_bound_logger(level),
        logger_factory=structlog.stdlib.LoggerFactory(),
        cache_logger_on_first_use=False,
    )
    as_json = structlog.processors.JSONRenderer(default=str)
    handler = logging.StreamHandler(stream)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=[structlog.stdlib.ExtraAdder(allow=[DBOS_STORY]), *shared],
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                *((_in_words, structlog.dev.ConsoleRenderer(pad_event_to=0)) if people else (as_json,)),
            ],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(level.upper())
    logging.captureWarnings(True)
    for name in LIBRARIES:
        library = logging.getLogger(name)
        # Not by propagation: DBOS prints in its own way unless its logger has a handler when it starts.
        library.handlers, library.propagate = [handler], False
        library.setLevel(max(logging.WARNING if people or name in QUIET else 0, root.level))
    logging.getLogger("uvicorn.access").disabled = True


def _in_words(_logger: WrappedLogger, _method: str, line: EventDict) -> EventDict:
    """A line for who looks on: a request in a few words, without when, by whom and under which number."""
    for name in ("time", "caller", "request_id"):
        line.pop(name, None)
    if line["event"] == "request":
        words = [str(line.pop(name, "")) for name in ("method", "path", "status")]
        line["event"] = f"{' '.join(words)} in {line.pop('ms', 0):.0f} ms"
    return line


def _without_absent(_logger: WrappedLogger, _method: str, line: EventDict) -> EventDict:
    """A line names a story or a caller only where there is one; DBOS's workflows are stories."""
    line.setdefault("story_id", line.pop(DBOS_STORY, None))
    return {name: value for name, value in line.items() if value is not None}


class Figures:
    """The figures of one app, in a registry of their own."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.answers = Histogram(
            "sims_http_answer_seconds",
            "Seconds from a request to the head of its answer.",
            ("method", "route", "status"),
            buckets=SECONDS,
            registry=self.registry,
        )
        self.open = Gauge(
            "sims_http_open_requests", "Requests being answered, streams included.", registry=self.registry
        )
        ProcessCollector(registry=self.registry)

    def register(self, collector: Collector) -> None:
        """Let `collector.collect()` add figures, such as those of the database, whenever they are read."""
        self.registry.register(collector)


class Telemetry:
    """ASGI: gives every request an id, writes one line about it and counts it."""

    def __init__(self, app: ASGIApp, figures: Figures) -> None:
        self.app = app
        self.figures = figures

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on with `request.state.request_id`; the answer carries it as X-Request-ID."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        sent = Headers(scope=scope).get("x-request-id", "")
        request_id = sent if REQUEST_ID.match(sent) else uuid.uuid4().hex
        scope.setdefault("state", {})["request_id"] = request_id
        watch = Watch(scope, receive, send, request_id)
        with bound_contextvars(request_id=request_id, caller=None), self.figures.open.track_inprogress():
            try:
                await self.app(scope, watch.receive, watch.send)
            finally:
                self._write(scope, watch)

    def _write(self, scope: Scope, watch: Watch) -> None:
        now = time.perf_counter()
        method = scope["method"] if scope["method"] in METHODS else "other"
        route = template_of(scope)
        status = watch.status or (HUNG_UP if watch.hung_up else 500)
        seconds = (watch.answered or now) - watch.begun
        self.figures.answers.labels(method, route, f"{status // 100}xx").observe(seconds)
        log.info(
            "request",
            method=method,
            path=printable(scope["path"], MAX_PATH_LENGTH) if route == UNKNOWN else route,
            status=status,
            ms=round((now - watch.begun) * 1000, 1),
            story_id=scope.get("path_params", {}).get("story_id", "")[:MAX_ID_LENGTH] or None,
            hung_up=watch.hung_up or None,
        )


class Watch:
    """One request as it passes: when its answer began, with which status, and whether the caller stayed."""

    def __init__(self, scope: Scope, receive: Receive, send: Send, request_id: str) -> None:
        self.scope = scope
        self.request_id = request_id
        self.begun = time.perf_counter()
        self.answered: float | None = None
        self.status = 0
        self.complete = False
        self.hung_up = False
        self._receive = receive
        self._send = send

    async def receive(self) -> Message:
        """As the server's, noticing that the caller has left."""
        message = await self._receive()
        if message["type"] == "http.disconnect" and not self.complete:
            self.hung_up = True
        return message

    async def send(self, message: Message) -> None:
        """As the server's, with the request's id among the headers."""
        if message["type"] == "http.response.start":
            self.answered = time.perf_counter()
            self.status = message["status"]
            MutableHeaders(scope=message)["X-Request-ID"] = self.request_id
        elif message["type"] == "http.response.body" and not message.get("more_body", False):
            self.complete = True
        await self._send(message)


def template_of(scope: Scope) -> str:
    """The path with the names of its variable parts, so that there are few of them; what is unknown is one."""
    if scope["path"].startswith("/assets/"):
        return "/assets/{file}"
    path = getattr(scope.get("route"), "path", None)
    return path if isinstance(path, str) else UNKNOWN
