"""Every request leaves one line with an id in it, and figures that Prometheus can read."""

from __future__ import annotations

import io
import json
import logging
import re
import socket
import time
import warnings
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import structlog
from fastapi import FastAPI
from fastapi.sse import EventSourceResponse
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.parser import text_string_to_metric_families
from prometheus_client.registry import Collector
from service_app import KEY, app_on, calling, running

from planner_service.api.authentication import fingerprint
from planner_service.api.telemetry import LIBRARIES, configure_logging

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def lines() -> Iterator[Lines]:
    """Logging as in the service, into memory; as it was before, afterwards."""
    loggers = [logging.getLogger(name) for name in ("", *LIBRARIES)]
    before = [(logger.handlers[:], logger.level, logger.propagate) for logger in loggers]
    as_it_was = structlog.get_config()
    stream = io.StringIO()
    with warnings.catch_warnings():
        configure_logging("info", stream)
        yield Lines(stream)
        logging.captureWarnings(False)
    for logger, (handlers, level, propagate) in zip(loggers, before, strict=True):
        logger.handlers, logger.propagate = handlers, propagate
        logger.setLevel(level)
    logging.getLogger("uvicorn.access").disabled = False
    structlog.configure(**as_it_was)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.usefixtures("lines")  # which leaves logging as it was
def test_on_a_terminal_lines_are_words_without_a_servers_news_of_itself() -> None:
    terminal = Terminal()
    configure_logging("info", terminal)
    logging.getLogger("uvicorn.error").info("Started server process [1]")
    structlog.get_logger("sims.http").info(
        "request", method="GET", path="/v1/skills", status=200, ms=12.3, request_id="abc", story_id=None
    )
    logging.getLogger("uvicorn.error").error("it broke")
    told = re.sub(r"\x1b\[[0-9;]*m", "", terminal.getvalue()).splitlines()
    assert [line.split("] ")[1].strip() for line in told] == ["GET /v1/skills 200 in 12 ms", "it broke"]


class Lines:
    def __init__(self, stream: io.StringIO) -> None:
        self.stream = stream

    def all(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.stream.getvalue().splitlines()]

    def of(self, event: str) -> list[dict[str, Any]]:
        return [line for line in self.all() if line["event"] == event]


def add_routes(app: FastAPI) -> None:
    @app.get("/v1/stories/{story_id}/test")
    def story(story_id: str, secret: str = "") -> dict[str, str]:
        structlog.get_logger("sims.test").info("looked", story_id=story_id)
        assert not secret or secret == "1"
        return {}

    @app.get("/v1/broken")
    def broken() -> None:
        raise RuntimeError("a secret reason")

    @app.get("/v1/stream", response_class=EventSourceResponse)
    async def stream() -> AsyncIterator[dict[str, int]]:
        import anyio

        for number in range(10_000):
            yield {"number": number}
            await anyio.sleep(0.01)


@pytest.fixture
def app(tmp_path: Path) -> Iterator[FastAPI]:
    with app_on(tmp_path, add_routes) as app:
        yield app


async def test_a_request_leaves_one_line_that_says_who_asked_for_what(app: FastAPI, lines: Lines) -> None:
    async with calling(app) as client:
        answer = await client.get("/v1/stories/abc/test?secret=1", headers={"X-Request-ID": "mine-1"})
    assert answer.headers["x-request-id"] == "mine-1"
    (line,) = lines.of("request")
    assert line.pop("ms") >= 0
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d+Z", line.pop("time"))
    assert line == {
        "level": "info", "event": "request", "request_id": "mine-1", "caller": "local", "method": "GET",
        "path": "/v1/stories/{story_id}/test", "status": 200, "story_id": "abc",
    }  # fmt: skip
    (inner,) = lines.of("looked")
    assert inner["request_id"] == "mine-1", "lines written on the way carry the id too"
    assert inner["caller"] == "local"


async def test_a_storys_id_is_cut_before_it_is_written_down(app: FastAPI, lines: Lines) -> None:
    async with calling(app) as client:
        await client.get(f"/v1/stories/{'a' * 5000}")
    (line,) = lines.of("request")
    assert line["story_id"] == "a" * 64


@pytest.mark.parametrize("sent", ["", "two words", 'x"}{"level": "forged', "a" * 65, "né"])
async def test_an_id_that_could_forge_a_line_is_replaced(app: FastAPI, lines: Lines, sent: str) -> None:
    async with calling(app) as client:
        answer = await client.get("/healthz", headers={b"X-Request-ID": sent.encode()})
    (line,) = lines.of("request")
    assert line["request_id"] == answer.headers["x-request-id"] != sent
    assert re.fullmatch("[0-9a-f]{32}", line["request_id"])


async def test_requests_that_are_refused_are_written_down_too(tmp_path: Path, lines: Lines) -> None:
    with app_on(tmp_path, api_keys=(KEY,)) as app:
        async with calling(app) as client:
            await client.get("/v1/stories")
            await client.get("/v1/%0D%0Aforged", headers={"Authorization": f"Bearer {KEY}"})
            await client.post("/session", json={"key": KEY})
    refused, unknown, login = lines.of("request")
    assert (refused["status"], refused["path"], "caller" in refused) == (401, "/v1/stories", False)
    assert (unknown["status"], unknown["path"], unknown["caller"]) == (404, "/v1/ forged", fingerprint(KEY))
    assert login["status"] == 204
    assert KEY not in lines.stream.getvalue()


async def test_what_nobody_foresaw_is_written_down_once_with_its_traceback(app: FastAPI, lines: Lines) -> None:
    async with calling(app) as client:
        answer = await client.get("/v1/broken")
    (line,) = lines.of("unforeseen")
    assert line["level"] == "error"
    assert "a secret reason" in line["exception"]
    assert line["request_id"] == answer.headers["x-request-id"]
    assert lines.stream.getvalue().count("Traceback") == 1
    assert lines.of("request")[0]["status"] == 500


def test_a_client_that_hangs_up_leaves_a_line_but_no_traceback(app: FastAPI, lines: Lines) -> None:
    with running(app) as url:
        with httpx.Client() as client, client.stream("GET", f"{url}/v1/stream") as answer:
            assert "number" in next(answer.iter_text())
        with httpx.Client() as client:
            assert client.head(f"{url}/v1/stream").headers["content-type"].startswith("text/event-stream")
        wait_for(lambda: len(lines.of("request")) == 2)
        open_ones = httpx.get(f"{url}/metrics").text
    got, headed = (line for line in lines.of("request") if line["path"] == "/v1/stream")
    assert got["hung_up"] is True
    assert headed["method"] == "HEAD"
    assert "sims_http_open_requests 1.0" in open_ones, "none but the one that asks"
    assert "Traceback" not in lines.stream.getvalue()
    assert not [line for line in lines.all() if line["level"] in ("warning", "error")]


def test_a_client_that_hangs_up_while_sending_leaves_a_line_but_no_traceback(app: FastAPI, lines: Lines) -> None:
    with running(app) as url:
        with socket.create_connection(("127.0.0.1", int(url.rpartition(":")[2]))) as connection:
            head = ("POST /session HTTP/1.1", "Host: localhost", "Content-Type: application/json", "Content-Length: 99")
            connection.sendall("\r\n".join((*head, "", "{")).encode())
            time.sleep(0.1)
        wait_for(lambda: lines.of("request"))
    assert lines.of("request")[0]["hung_up"] is True
    assert "Traceback" not in lines.stream.getvalue()
    assert not [line for line in lines.all() if line["level"] in ("warning", "error")]


def wait_for(true: Any) -> None:
    deadline = time.monotonic() + 60
    while not true() and time.monotonic() < deadline:
        time.sleep(0.02)


def test_libraries_write_through_the_same_lines(lines: Lines) -> None:
    logging.getLogger("uvicorn.error").info("started %s", "well")
    logging.getLogger("uvicorn.access").info("GET /")
    logging.getLogger("dbos").info("chatter")
    logging.getLogger("dbos").warning("trouble", extra={"operationUUID": "abc", "executorID": "worker-0"})
    logging.getLogger("sqlalchemy.engine").info("SELECT")
    warnings.simplefilter("always")
    warnings.warn("old", UserWarning, stacklevel=1)
    events = [line["event"] for line in lines.all()]
    assert events[:2] == ["started well", "trouble"]
    assert lines.of("trouble")[0]["story_id"] == "abc"
    assert "executorID" not in lines.of("trouble")[0]
    assert "old" in events[2]
    assert all({"time", "level", "event"} <= set(line) for line in lines.all())


async def test_figures_count_answers_by_route_and_not_by_path(app: FastAPI) -> None:
    async with calling(app) as client:
        for number in range(5):
            await client.get(f"/v1/stories/{number}/test")
            await client.get(f"/nope/{number}")
            await client.request(f"VERB{number}", "/healthz")
        answer = await client.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    families = {family.name: family for family in text_string_to_metric_families(answer.text)}
    counts = {
        (sample.labels["method"], sample.labels["route"], sample.labels["status"]): sample.value
        for sample in families["sims_http_answer_seconds"].samples
        if sample.name.endswith("_count")
    }
    assert counts == {
        ("GET", "/v1/stories/{story_id}/test", "2xx"): 5,
        ("GET", "unknown", "4xx"): 5,
        ("other", "/healthz", "4xx"): 5,
    }


async def test_other_figures_can_be_added_and_each_app_has_its_own(app: FastAPI, tmp_path: Path) -> None:
    class Queue(Collector):
        def collect(self) -> Iterator[GaugeMetricFamily]:
            yield GaugeMetricFamily("sims_queue_depth", "Stories that wait.", value=3)

    app.state.figures.register(Queue())
    with app_on(tmp_path / "other") as other:
        async with calling(app) as client, calling(other) as stranger:
            assert "sims_queue_depth 3.0" in (await client.get("/metrics")).text
            assert "sims_queue_depth" not in (await stranger.get("/metrics")).text
