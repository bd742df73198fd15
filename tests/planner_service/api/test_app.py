"""The app's shell: what every service answers, the page or how to build it, and an OpenAPI document that is true."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from databases import bring_back
from fastapi import FastAPI
from for_each import for_each
from service_app import KEY, app_on, calling, check_problem, running

from planner_service.api import web_page

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with app_on(tmp_path_factory.mktemp("shell")) as app:
        yield app


async def ask(app: FastAPI, path: str, method: str = "GET", **options: Any) -> httpx.Response:
    async with calling(app) as client:
        return await client.request(method, path, **options)


async def test_it_is_alive_and_ready_and_says_what_it_found(app: FastAPI) -> None:
    assert (await ask(app, "/healthz")).json() == {"status": "ok"}
    answer = await ask(app, "/readyz")
    assert answer.status_code == 200
    checks = {check["name"]: check for check in answer.json()["checks"]}
    assert checks["database"]["detail"] == "sqlite"
    assert "short scripts" in checks["library"]["detail"]


async def test_without_its_database_it_is_alive_but_not_ready(tmp_path: Path) -> None:
    with app_on(tmp_path) as app:
        (tmp_path / "sims.db").rename(tmp_path / "gone.db")
        (tmp_path / "sims.db").mkdir()
        app.state.parts.engine.dispose()
        assert (await ask(app, "/healthz")).status_code == 200
        answer = await ask(app, "/readyz")
    assert answer.status_code == 503
    assert answer.json()["status"] == "not ready"
    (database,) = (check for check in answer.json()["checks"] if check["name"] == "database")
    assert not database["ok"]
    assert "busy or away" in database["detail"]


@for_each("path", ["/healthz", "/readyz", "/session", "/metrics", "/", "/openapi.json", "/nope"])
async def test_head_is_get_without_its_body(app: FastAPI, path: str) -> None:
    got, headed = await ask(app, path), await ask(app, path, "HEAD")
    assert headed.status_code == got.status_code
    assert headed.content == b""
    assert headed.headers["content-type"] == got.headers["content-type"]


def test_over_a_real_connection_head_leaves_it_usable(app: FastAPI) -> None:
    with running(app) as url, httpx.Client() as client:
        for _ in range(3):
            assert client.head(f"{url}/readyz").content == b""
            assert client.get(f"{url}/healthz").json() == {"status": "ok"}


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FastAPI]:
    """An app whose page was built, though of two small files."""
    folder = tmp_path / "page"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>stories</title>", encoding="utf-8")
    (folder / "assets" / "index-1a2b3c.js").write_text("let a = 1;\n" * 1000, encoding="utf-8")
    (tmp_path / "secret.txt").write_text("a secret", encoding="utf-8")
    monkeypatch.setattr(web_page, "PAGE", folder)
    with app_on(tmp_path / "data") as app:
        yield app


async def test_the_page_is_never_stale_and_its_parts_are_kept_for_ever(built: FastAPI) -> None:
    answer = await ask(built, "/")
    assert "stories" in answer.text
    assert answer.headers["content-type"].startswith("text/html")
    assert answer.headers["cache-control"] == "no-cache"
    part = await ask(built, "/assets/index-1a2b3c.js")
    assert part.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert part.headers["content-encoding"] == "gzip"
    assert "javascript" in part.headers["content-type"]
    assert part.text.startswith("let a")
    again = await ask(built, "/assets/index-1a2b3c.js", headers={"If-None-Match": part.headers["etag"]})
    assert again.status_code == 304
    assert {check["name"]: check["ok"] for check in (await ask(built, "/readyz")).json()["checks"]}["page"]


@for_each(
    "path", ["/assets/../secret.txt", "/assets/..%2f..%2fsecret.txt", "/assets/%2e%2e/%2e%2e/secret.txt", "/assets/"]
)
async def test_nothing_but_the_pages_files_is_served(built: FastAPI, path: str) -> None:
    answer = await ask(built, path)
    assert answer.status_code == 404
    assert "a secret" not in answer.text


async def test_without_a_page_it_says_how_to_build_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_page, "PAGE", tmp_path / "none")
    with app_on(tmp_path / "data") as app:
        answer = await ask(app, "/")
        assert answer.status_code == 200
        assert "make page" in answer.text
        assert "Node 20" in answer.text
        check_problem(await ask(app, "/assets/index.js"), 404)
        icon = await ask(app, "/favicon.ico")
        assert icon.headers["content-type"] == "image/svg+xml"


async def test_browsers_are_told_to_be_strict(app: FastAPI) -> None:
    answer = await ask(app, "/")
    policy = dict(rule.split(" ", 1) for rule in answer.headers["content-security-policy"].split("; "))
    assert policy["default-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert "unsafe" not in policy.get("script-src", policy["default-src"])
    for path in ("/", "/healthz", "/nope"):
        answer = await ask(app, path)
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "no-referrer"


async def test_every_call_documents_its_problems_as_problems(app: FastAPI) -> None:
    document = (await ask(app, "/openapi.json")).json()
    assert document["openapi"].startswith("3.1")
    assert "servers" not in document
    assert "HTTPValidationError" not in str(document)
    for path, methods in document["paths"].items():
        for operation in methods.values():
            answers = operation["responses"]
            assert {"403", "429", "500", "503", "default"} <= set(answers), path
            assert ("requestBody" in operation) <= ({"400", "413", "415", "422"} <= set(answers)), path
            assert ("{" in path) <= ("404" in answers), path
            assert operation["summary"]
            assert operation["tags"]
            for status, answer in answers.items():
                if status.startswith("4"):
                    assert list(answer["content"]) == ["application/problem+json"], (path, status)


@pytest.mark.parametrize("keys", [(), (KEY,)])
async def test_the_document_says_truly_where_a_key_is_needed(tmp_path: Path, keys: tuple[str, ...]) -> None:
    with app_on(tmp_path, api_keys=keys) as app:
        document = (await ask(app, "/openapi.json")).json()
        assert set(document["components"]["securitySchemes"]) == {"bearer", "cookie"}
        for path, methods in document["paths"].items():
            if "get" in methods and "{" not in path and "parameters" not in methods["get"]:
                needed = {} not in methods["get"].get("security", document["security"])
                assert ((await ask(app, path)).status_code == 401) == needed, path


def test_shutting_down_closes_the_parts(tmp_path: Path) -> None:
    with app_on(tmp_path) as app:
        with running(app) as url:
            assert httpx.get(f"{url}/readyz").status_code == 200
            assert app.state.parts.engine.pool.checkedin() == 1
        assert app.state.parts.engine.pool.checkedin() == 0


@pytest.mark.service
async def test_postgresql_may_go_away_and_come_back(tmp_path: Path, postgres_server: Any, postgres_url: str) -> None:
    with app_on(tmp_path, database_url=postgres_url) as app:
        assert (await ask(app, "/v1/stories")).json()["items"] == []
        postgres_server.stop()
        try:
            for path in ("/v1/stories", "/v1/stories/01a1fdd1-85c6-75fb-9e21-7b8be7295912"):
                answer = await ask(app, path)
                check_problem(answer, 503)
                assert int(answer.headers["retry-after"]) >= 1
            answer = await ask(app, "/v1/stories", "POST", json={"theme": "She reads a book."})
            check_problem(answer, 503)
            assert (await ask(app, "/readyz")).json()["status"] == "not ready"
            assert (await ask(app, "/healthz")).status_code == 200
        finally:
            bring_back(postgres_server)
        assert (await ask(app, "/readyz")).json()["status"] == "ready"
        assert (await ask(app, "/v1/stories", "POST", json={"theme": "She reads a book."})).status_code == 202
