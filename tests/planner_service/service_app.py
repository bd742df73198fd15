"""The service for tests: on a database of its own, called in this process or by a real server on a free port."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import uvicorn
from encoded import lend
from fastapi import FastAPI

from planner_service.api.app import create_app
from planner_service.components import Parts, open_parts
from planner_service.settings import Settings

KEY = "0123456789abcdef-first-key"
OTHER_KEY = "fedcba9876543210-other-key"
Adding = Callable[[FastAPI], None]


@cache
def _empty_database() -> bytes:
    """A SQLite file with all tables; to make them takes longer than many a test."""
    with TemporaryDirectory() as folder:
        settings = Settings(_env_file=None, data_dir=folder)
        open_parts(settings).close()
        return settings.database_file.read_bytes()


@contextmanager
def parts_on(folder: Path, **given: Any) -> Iterator[Parts]:
    """Real parts on a SQLite file in a folder."""
    settings = Settings(_env_file=None, **{"data_dir": folder, **given})
    if not settings.database_url and not settings.database_file.exists():
        settings.database_file.parent.mkdir(parents=True, exist_ok=True)
        settings.database_file.write_bytes(_empty_database())
    parts = open_parts(settings)
    try:
        yield parts
    finally:
        parts.close()


@contextmanager
def app_on(folder: Path, add: Adding = lambda _app: None, **settings: Any) -> Iterator[FastAPI]:
    """The app on such parts; `add` puts routes of a test's own into it."""
    with parts_on(folder, **settings) as parts:
        app = create_app(parts)
        add(app)
        yield app


def warm_app_on(folder: Path, **settings: Any) -> AbstractContextManager[FastAPI]:
    """The app, with the sentences of our library encoded already."""
    lend(folder)
    return app_on(folder, **settings)


def calling(app: FastAPI, base_url: str = "http://localhost", **options: Any) -> httpx.AsyncClient:
    """A client that calls the app in this process."""
    return httpx.AsyncClient(transport=httpx.ASGITransport(app=app), base_url=base_url, **options)


@contextmanager
def running(app: FastAPI) -> Iterator[str]:
    """The app behind a real server on a free port; gives its address."""
    config = uvicorn.Config(app, host="127.0.0.1", port=0, log_config=None, access_log=False)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    port = server.servers[0].sockets[0].getsockname()[1]
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join(10)


def check_problem(answer: httpx.Response, status: int) -> dict[str, Any]:
    """Assert that an answer is a problem of that status, whole and readable; returns it."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = answer.json()
    assert {"type", "title", "status", "detail", "instance"} <= set(problem) <= {
        "type", "title", "status", "detail", "instance", "errors",
    }  # fmt: skip
    assert problem["status"] == status
    assert problem["title"]
    assert problem["detail"]
    assert len(answer.content) < 20_000
    for fault in problem.get("errors", []):
        assert set(fault) == {"pointer", "detail"}
    return problem
