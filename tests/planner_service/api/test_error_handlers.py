"""Every error is a problem with the right status and pointer, and nothing that was sent comes back at length."""

from __future__ import annotations

import errno
import json
import sqlite3
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Annotated, Any

import httpx
import pytest
from anyio import BrokenResourceError, ClosedResourceError
from examples import tries
from fastapi import FastAPI, Header, Query
from for_each import for_each
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field
from service_app import app_on, calling, check_problem, running
from sqlalchemy import create_engine, text
from sqlalchemy.exc import DataError, IntegrityError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from motion_backend.backends import BrokenBackendError
from planner_service.api import errors
from planner_service.api.error_handlers import database_problem, engine_problem, is_hang_up
from planner_service.api.errors import Problem
from planner_service.api.rate_limit import MAX_BYTES
from planner_service.llm.protocol import ModelError
from planner_service.pipeline import RequestError
from planner_service.settings import SettingsError
from planner_service.themes.beats import ThemeError
from scene_graphs.errors import FieldPath, UserError
from scene_graphs.json_fields import LayoutError

pytestmark = pytest.mark.anyio
JSON = {"Content-Type": "application/json"}
SECRET = "swordfish"


class Character(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str = "Ann"
    height: float = Field(1.7, ge=1.2, le=2.2)


class Wish(BaseModel):
    model_config = ConfigDict(extra="forbid")
    theme: str = Field(max_length=100)
    rooms: list[str] | int = []
    character: Character = Character()


RAISED: dict[str, Exception] = {}
"""What the test's own route raises, by name."""


def add_routes(app: FastAPI) -> None:
    @app.post("/v1/wishes/{number}")
    def wish(
        number: int, wish: Wish, limit: Annotated[int, Query(ge=1)] = 1, tag: Annotated[int, Header()] = 1
    ) -> dict[str, Any]:
        return {"number": number, "limit": limit, "tag": tag, **wish.model_dump()}

    @app.get("/v1/raise/{name}")
    def raising(name: str) -> None:
        raise RAISED[name]

    @app.get("/v1/begun")
    async def begun() -> Any:
        from starlette.responses import StreamingResponse

        async def parts() -> AsyncIterator[bytes]:
            yield b"a beginning"
            raise RuntimeError(SECRET)

        return StreamingResponse(parts())


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with app_on(tmp_path_factory.mktemp("errors"), add_routes, rate="1000000/minute") as app:
        yield app


async def ask(app: FastAPI, method: str, path: str, **options: Any) -> httpx.Response:
    async with calling(app) as client:
        return await client.request(method, path, **options)


async def raised(app: FastAPI, error: Exception) -> httpx.Response:
    RAISED["it"] = error
    return await ask(app, "GET", "/v1/raise/it")


@for_each("method", ["GET", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "BREW"])
@for_each("path", ["/nope", "/v1", "/v1/nope/1", "/v1/wishes/", "/healthz/", "/assets/no.js"])
async def test_unknown_paths_are_not_found_whatever_the_method(app: FastAPI, method: str, path: str) -> None:
    answer = await ask(app, method, path)
    check_problem(answer, 405 if path.startswith("/assets") and method != "GET" else 404)


@for_each(
    ("method", "path", "allowed"),
    [
        ("PUT", "/session", {"GET", "HEAD", "POST", "DELETE"}),
        ("GET", "/v1/wishes/1", {"POST"}),
        ("BREW", "/healthz", {"GET", "HEAD"}),
        ("OPTIONS", "/v1/wishes/1", {"POST"}),
        ("POST", "/assets/a.js", {"GET", "HEAD"}),
        ("OPTIONS", "/v1/stories", {"GET", "HEAD", "POST"}),
        ("PUT", "/v1/stories/abc", {"GET", "HEAD", "DELETE"}),
        ("POST", "/v1/short-scripts/search", {"GET", "HEAD"}),
        ("PATCH", "/v1/short-scripts/abc", {"GET", "HEAD", "PUT", "DELETE"}),
    ],
)
async def test_a_method_that_is_not_there_is_told_with_all_that_are(
    app: FastAPI, method: str, path: str, allowed: set[str]
) -> None:
    answer = await ask(app, method, path)
    check_problem(answer, 405)
    assert set(answer.headers["allow"].split(", ")) == allowed


@for_each(
    ("body", "pointer"),
    [
        ({}, "/theme"),
        ({"theme": 5}, "/theme"),
        ({"theme": "a" * 101}, "/theme"),
        ({"theme": "a", "mood": "b"}, "/mood"),
        ({"theme": "a", "character": {"height": 9}}, "/character/height"),
        ({"theme": "a", "character": {"height": 2, "a/b~c": 1}}, "/character/a~1b~0c"),
        ({"theme": "a", "character": []}, "/character"),
        ({"theme": "a", "rooms": ["x", 5]}, "/rooms/1"),
        ([], ""),
        (None, ""),
        ("a", ""),
    ],
)
async def test_a_fault_of_the_body_is_pointed_at(app: FastAPI, body: Any, pointer: str) -> None:
    answer = await ask(app, "POST", "/v1/wishes/1", content=json.dumps(body), headers=JSON)
    problem = check_problem(answer, 422)
    assert problem["errors"][0]["pointer"] == pointer


@for_each(
    ("path", "headers", "pointer"),
    [
        ("/v1/wishes/x", {}, "path:number"),
        ("/v1/wishes/1?limit=0", {}, "?limit"),
        ("/v1/wishes/1?limit=many", {}, "?limit"),
        ("/v1/wishes/1", {"tag": "x"}, "header:tag"),
    ],
)
async def test_a_fault_elsewhere_is_pointed_at_too(
    app: FastAPI, path: str, headers: dict[str, str], pointer: str
) -> None:
    answer = await ask(app, "POST", path, json={"theme": "a"}, headers=headers)
    assert [fault["pointer"] for fault in check_problem(answer, 422)["errors"]] == [pointer]


@for_each(
    ("content", "place"),
    [
        (b"{", "line 1, column 2"),
        (b'{\n "theme": }', "line 2, column 11"),
        (b"{'theme': 1}", "line 1, column 2"),
        (b'{"theme": "a"} x', "line 1, column 16"),
        (b'{"theme": "\xff"}', "UTF-8"),
        (b"[" * 100_000, "nested"),
        (b'{"theme": ' + b"1" * 5000 + b"}", ""),
    ],
)
async def test_what_is_not_json_is_a_400_that_says_where(app: FastAPI, content: bytes, place: str) -> None:
    answer = await ask(app, "POST", "/v1/wishes/1", content=content, headers=JSON)
    assert place in check_problem(answer, 400)["detail"]


@for_each("media", [None, "text/plain", "application/x-www-form-urlencoded", "nonsense", "image/png"])
async def test_other_content_types_are_refused_by_name(app: FastAPI, media: str | None) -> None:
    headers = {"Content-Type": media} if media else {}
    answer = await ask(app, "POST", "/v1/wishes/1", content=b'{"theme": "a"}', headers=headers)
    detail = check_problem(answer, 415)["detail"]
    assert "application/json" in detail
    assert (media or "missing") in detail


@pytest.mark.parametrize(
    "media", ["application/json", "application/json; charset=utf-8", "application/merge-patch+json"]
)
async def test_json_by_any_of_its_names_is_read(app: FastAPI, media: str) -> None:
    answer = await ask(app, "POST", "/v1/wishes/1", content=b'{"theme": "a"}', headers={"Content-Type": media})
    assert answer.status_code == 200


async def test_huge_input_is_not_repeated(app: FastAPI) -> None:
    body = {"theme": "a" * 1_000_000, "b" * 1_000_000: 1, **{f"extra{number}": 1 for number in range(5000)}}
    answer = await ask(app, "POST", "/v1/wishes/1", json=body)
    problem = check_problem(answer, 422)
    assert len(problem["errors"]) == errors.MAX_FAULTS
    assert "more)" in problem["detail"]


async def test_broken_letters_in_names_can_still_be_told(app: FastAPI) -> None:
    answer = await ask(app, "POST", "/v1/wishes/1", content=rb'{"theme": "a", "\u0000\u202e\n": 1}', headers=JSON)
    assert check_problem(answer, 422)["errors"][0]["pointer"] == r"/\x00\u202e"
    answer = await ask(app, "POST", "/v1/wishes/1", content=rb'{"theme": "\ud800", "\ud800": 1}', headers=JSON)
    check_problem(answer, 422)


async def test_a_declared_body_that_is_too_long_is_refused_unread(app: FastAPI) -> None:
    assert (
        "4194304"
        in check_problem(await ask(app, "POST", "/v1/wishes/1", content=b"x" * (MAX_BYTES + 1)), 413)["detail"]
    )
    fits = b'{"theme": "' + b"x" * (MAX_BYTES - 13) + b'"}'
    assert len(fits) == MAX_BYTES
    check_problem(await ask(app, "POST", "/v1/wishes/1", content=fits, headers=JSON), 422)


async def test_a_body_in_chunks_that_grows_too_long_is_refused(app: FastAPI) -> None:
    async def chunks() -> AsyncIterator[bytes]:
        for _ in range(MAX_BYTES // 65536 + 1):
            yield b"x" * 65536

    check_problem(await ask(app, "POST", "/v1/wishes/1", content=chunks(), headers=JSON), 413)


@pytest.mark.parametrize("chunked", [False, True])
def test_over_a_real_connection_too_long_a_body_gets_its_answer(app: FastAPI, chunked: bool) -> None:
    size = MAX_BYTES + 1_000_000
    content = (b"x" * 65536 for _ in range(size // 65536)) if chunked else b"x" * size
    with running(app) as url, httpx.Client() as client:
        check_problem(client.post(f"{url}/v1/wishes/1", content=content, headers=JSON), 413)
        assert client.get(f"{url}/healthz").status_code == 200


@for_each(
    "problem",
    [
        errors.Malformed("a"),
        errors.Unauthorised("a"),
        errors.Forbidden("a"),
        errors.NotFound("a"),
        errors.NotReady("a"),
        errors.TooSlow("a"),
        errors.Conflict("a"),
        errors.TooLarge("a"),
        errors.WrongMedia("a"),
        errors.Unprocessable("/a/b", "c"),
        errors.TooMany("a", 7),
        errors.ModelFailed("a"),
        errors.Unavailable("a", 7),
        errors.StorageFull("a"),
        Problem("a"),
    ],
)
async def test_every_problem_can_be_raised_in_a_route(app: FastAPI, problem: Problem) -> None:
    answer = await raised(app, problem)
    told = check_problem(answer, problem.status)
    assert told["instance"] == "/v1/raise/it"
    for name, value in problem.headers.items():
        assert answer.headers[name] == value
    if isinstance(problem, errors.TooMany | errors.Unavailable):
        assert answer.headers["retry-after"] == "7"
    if problem.errors:
        assert told["errors"] == [{"pointer": "/a/b", "detail": "c"}]


@for_each(
    ("error", "status", "pointer"),
    [
        (RequestError("a home has one to 4 rooms", at="rooms"), 422, "/rooms"),
        (RequestError("must be 1.2 to 2.2", at="height"), 422, "/character/height"),
        (RequestError("two rooms are called 'a'", "rename one", at="layout"), 422, "/layouts"),
        (ThemeError("it is empty."), 422, "/theme"),
        (RequestError("nothing here can be walked to; choose another room (--rooms)"), 422, ""),
        (LayoutError("must be a number", at=FieldPath(("rooms.json line 3", "size"))), 422, ""),
        (RequestError("rooms: are named in the text alone"), 422, ""),
        (BrokenBackendError("it cannot be loaded", at="backend"), 503, None),
        (ModelError("no answer"), 502, None),
        (SettingsError("SIMS_DATA_DIR: secret place"), 500, None),
    ],
)
def test_what_the_engine_says_is_pointed_at_its_field(error: UserError, status: int, pointer: str | None) -> None:
    problem = engine_problem(error)
    assert problem.status == status
    assert [fault.pointer for fault in problem.errors] == ([] if pointer is None else [pointer])
    assert "--" not in problem.detail
    assert "secret" not in problem.detail


def test_in_a_get_call_a_field_of_the_engine_is_a_query_parameter() -> None:
    assert engine_problem(RequestError("'x' is none of happy", at="emotion"), "GET").errors[0].pointer == "?emotion"


async def test_what_nobody_foresaw_is_a_500_without_its_reasons(app: FastAPI) -> None:
    answer = await raised(app, RuntimeError(SECRET))
    problem = check_problem(answer, 500)
    assert SECRET not in answer.text
    assert answer.headers["x-request-id"] in problem["detail"]


def test_an_answer_that_breaks_in_the_middle_is_broken_off(app: FastAPI) -> None:
    with running(app) as url, httpx.Client() as client:
        with pytest.raises(httpx.RemoteProtocolError):
            client.get(f"{url}/v1/begun")
        assert client.get(f"{url}/healthz").status_code == 200


def wrapped(kind: type[Exception], cause: Exception) -> Exception:
    return kind("SELECT 1", {}, cause)


@for_each(
    ("error", "status"),
    [
        (wrapped(OperationalError, sqlite3.OperationalError("database is locked")), 503),
        (wrapped(OperationalError, sqlite3.OperationalError("database or disk is full")), 507),
        (wrapped(OperationalError, Exception("connection to server failed: No such file or directory")), 503),
        (wrapped(OperationalError, Exception("could not extend file: No space left on device")), 507),
        (wrapped(InterfaceError, Exception("the connection is closed")), 503),
        (wrapped(DataError, Exception("PostgreSQL text fields cannot contain NUL (0x00) bytes")), 422),
        (wrapped(OperationalError, sqlite3.OperationalError("no such table: stories")), 500),
        (wrapped(IntegrityError, sqlite3.IntegrityError("UNIQUE constraint failed")), 500),
        (sqlite3.OperationalError("database is locked"), 503),
        (PoolTimeout("QueuePool limit"), 503),
        (OSError(errno.ENOSPC, "No space left on device"), 507),
        (FileNotFoundError(errno.ENOENT, SECRET), 500),
    ],
)
async def test_a_database_in_trouble_is_told_as_such(app: FastAPI, error: Exception, status: int) -> None:
    answer = await raised(app, error)
    check_problem(answer, status)
    assert SECRET not in answer.text
    assert "SELECT" not in answer.text
    assert ("retry-after" in answer.headers) == (status == 503)


def test_a_really_locked_and_a_really_full_database_are_known(tmp_path: Path) -> None:
    file = tmp_path / "a.db"
    engine = create_engine(f"sqlite:///{file}", connect_args={"timeout": 0.05})
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE t (x TEXT)"))
    holder = sqlite3.connect(file, isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    with pytest.raises(OperationalError) as locked, engine.begin() as connection:
        connection.execute(text("INSERT INTO t VALUES ('a')"))
    problem = database_problem(locked.value)
    assert problem is not None
    assert problem.status == 503
    holder.execute("ROLLBACK")
    holder.close()
    with engine.begin() as connection:
        connection.execute(text("PRAGMA max_page_count = 3"))
        with pytest.raises(OperationalError) as full:
            connection.execute(text("INSERT INTO t VALUES (:x)"), {"x": "a" * 400_000})
    problem = database_problem(full.value)
    assert problem is not None
    assert problem.status == 507
    engine.dispose()


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=10,
)


@tries(60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(body=ANYTHING)
async def test_whatever_json_is_sent_the_answer_is_a_wish_or_a_problem(app: FastAPI, body: Any) -> None:
    answer = await ask(app, "POST", "/v1/wishes/1", content=json.dumps(body), headers=JSON)
    if answer.status_code != 200:
        check_problem(answer, 422)


def test_only_a_stream_that_was_left_counts_as_hung_up() -> None:
    left = BrokenResourceError()
    assert is_hang_up(left)
    assert is_hang_up(ExceptionGroup("tasks", [left, ExceptionGroup("inner", [ClosedResourceError()])]))
    assert not is_hang_up(ExceptionGroup("tasks", [left, ValueError("ours")]))
    assert not is_hang_up(OSError("disk"))
