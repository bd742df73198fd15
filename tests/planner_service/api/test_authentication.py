"""Who gets in: loopback by Host and Origin, keys beyond, the page by a cookie that cannot be forged or misused."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from fastapi import FastAPI, Request
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from service_app import KEY, OTHER_KEY, app_on, calling, check_problem

from planner_service.api.authentication import (
    COOKIE,
    COOKIE_SECONDS,
    LOCAL,
    Gate,
    check_exposure,
    fingerprint,
    is_loopback,
)
from planner_service.settings import Settings, SettingsError

pytestmark = pytest.mark.anyio
STUDIO = "https://studio.example"


def add_routes(app: FastAPI) -> None:
    def who(request: Request) -> dict[str, str]:
        return {"caller": request.state.caller}

    for method in ("GET", "POST", "DELETE"):
        app.add_api_route("/v1/who", who, methods=[method], name=f"who_{method}")


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def local(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    """No keys, one other origin let in."""
    with app_on(tmp_path_factory.mktemp("local"), add_routes, cors_origins=(STUDIO,)) as app:
        yield app


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    """Two keys, one other origin let in."""
    folder = tmp_path_factory.mktemp("locked")
    with app_on(folder, add_routes, api_keys=(KEY, OTHER_KEY), cors_origins=(STUDIO,), host="0.0.0.0") as app:
        yield app


@pytest.fixture
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    """Keys, and counts of wrong ones that start at nothing."""
    with app_on(tmp_path_factory.mktemp("guarded"), add_routes, api_keys=(KEY,)) as app:
        yield app


async def ask(app: FastAPI, method: str = "GET", path: str = "/v1/who", **options: Any) -> httpx.Response:
    base = options.pop("base_url", "http://localhost:8000")
    async with calling(app, base) as client:
        return await client.request(method, path, **options)


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


@for_each("path", ["/", "/healthz", "/metrics", "/v1/who", "/session", "/assets/a.js", "/nope"])
@for_each(
    ("host", "let_in"),
    [
        ("localhost", True),
        ("LocalHost:8000", True),
        ("127.0.0.1", True),
        ("127.0.0.1:1", True),
        ("[::1]", True),
        ("[::1]:8000", True),
        ("evil.example", False),
        ("evil.example:8000", False),
        ("localhost.evil.example", False),
        ("127.0.0.1.evil.example", False),
        ("localhost@evil.example", False),
        ("evil.example/localhost", False),
        ("localhost:8000:80", False),
        ("192.168.1.7", False),
        ("0.0.0.0", False),
        ("[::]", False),
        ("::1", False),
        ("", False),
    ],
)
async def test_without_keys_only_names_of_this_machine_are_served(
    local: FastAPI, path: str, host: str, let_in: bool
) -> None:
    answer = await ask(local, path=path, headers={"Host": host})
    if let_in:
        assert answer.status_code != 403
    else:
        assert "SIMS_API_KEYS" in check_problem(answer, 403)["detail"]


@for_each("method", ["GET", "POST"])
@for_each(
    ("headers", "let_in"),
    [
        ({}, True),
        ({"Origin": "http://localhost:8000"}, True),
        ({"Origin": "https://localhost:8000"}, True),
        ({"Origin": STUDIO}, True),
        ({"Origin": "http://localhost:5173"}, False),
        ({"Origin": "http://127.0.0.1:8000"}, False),
        ({"Origin": "https://evil.example"}, False),
        ({"Origin": "null"}, False),
        ({"Origin": "file://localhost:8000"}, False),
        ({"Origin": f"{STUDIO}.evil.example"}, False),
        ({"Origin": ""}, False),
    ],
)
async def test_without_keys_only_our_page_and_origins_let_in_may_ask(
    local: FastAPI, method: str, headers: dict[str, str], let_in: bool
) -> None:
    answer = await ask(local, method, headers=headers)
    if let_in:
        assert answer.json() == {"caller": LOCAL}
    else:
        assert "SIMS_CORS_ORIGINS" in check_problem(answer, 403)["detail"]


@for_each(("site", "status"), [("cross-site", 403), ("same-site", 403), ("same-origin", 200), ("none", 200)])
async def test_a_browser_that_hides_the_origin_still_tells_the_site(local: FastAPI, site: str, status: int) -> None:
    assert (await ask(local, "POST", headers={"Sec-Fetch-Site": site})).status_code == status
    assert (await ask(local, "GET", headers={"Sec-Fetch-Site": site})).status_code == 200


@for_each(
    ("headers", "caller"),
    [
        (bearer(KEY), fingerprint(KEY)),
        (bearer(OTHER_KEY), fingerprint(OTHER_KEY)),
        ({"Authorization": f"bearer  {KEY} "}, fingerprint(KEY)),
        ({**bearer(KEY), "Host": "anything.example", "Origin": STUDIO}, fingerprint(KEY)),
    ],
)
async def test_a_right_key_gets_in_and_is_known_by_its_fingerprint(
    locked: FastAPI, headers: dict[str, str], caller: str
) -> None:
    answer = await ask(locked, "POST", headers=headers)
    assert answer.json() == {"caller": caller}
    assert len(caller) == 12
    assert caller not in KEY


@for_each("method", ["GET", "POST", "DELETE", "HEAD"])
@for_each("path", ["/v1/who", "/v1/nope", "/metrics", "/assetsx", "/healthz/x", "//v1/who"])
async def test_without_a_key_all_but_the_open_paths_are_closed(locked: FastAPI, method: str, path: str) -> None:
    answer = await ask(locked, method, path)
    assert answer.status_code == 401
    assert answer.headers["www-authenticate"] == 'Bearer realm="sims"'


@for_each("path", ["/", "/healthz", "/readyz", "/session", "/openapi.json", "/favicon.ico"])
async def test_open_paths_need_no_key(locked: FastAPI, path: str) -> None:
    assert (await ask(locked, path=path)).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        bearer(KEY[:-1]),
        bearer(KEY + "x"),
        bearer(KEY.upper()),
        bearer(""),
        bearer(fingerprint(KEY)),
        {"Authorization": "Bearer"},
        {"Authorization": b"Bearer \xff\xfe"},
        {"Authorization": f"Basic {KEY}"},
        {"Authorization": KEY},
        {"Cookie": f"{COOKIE}={KEY}"},
    ],
)
async def test_wrong_keys_do_not_get_in(guarded: FastAPI, headers: dict[str, Any]) -> None:
    check_problem(await ask(guarded, headers=headers), 401)


async def test_after_too_many_wrong_logins_an_address_waits_whatever_it_sends(guarded: FastAPI) -> None:
    async with calling(guarded) as client:
        statuses = [(await client.post("/session", json={"key": f"guess {n}"})).status_code for n in range(11)]
        assert statuses == [401] * 10 + [429]
        answer = await client.post("/session", json={"key": KEY})
        check_problem(answer, 429)
        assert 1 <= int(answer.headers["retry-after"]) <= 60
        assert (await client.get("/v1/who", headers=bearer(KEY))).status_code == 200, "nobody else is kept out"


async def test_strangers_cannot_keep_the_service_busy_nor_keep_others_out(guarded: FastAPI) -> None:
    async with calling(guarded) as client:
        statuses = [(await client.get("/v1/who", headers=bearer("a guess"))).status_code for _ in range(601)]
        assert set(statuses[:600]) == {401}
        assert statuses[600] == 429
        assert (await client.get("/v1/who")).status_code == 429
        assert (await client.get("/v1/who", headers=bearer(KEY))).status_code == 200


async def test_a_login_gives_a_cookie_that_opens_everything_until_logging_out(locked: FastAPI) -> None:
    async with calling(locked, "http://sims.example", headers={"Origin": "http://sims.example"}) as client:
        assert (await client.get("/session")).json() == {"required": True, "authenticated": False}
        answer = await client.post("/session", json={"key": KEY})
        assert answer.status_code == 204
        cookie = answer.headers["set-cookie"]
        for rule in ("HttpOnly", "SameSite=strict", "Path=/", f"Max-Age={COOKIE_SECONDS}"):
            assert rule in cookie
        assert "Secure" not in cookie
        assert KEY not in cookie
        assert (await client.get("/session")).json() == {"required": True, "authenticated": True}
        assert (await client.post("/v1/who")).json() == {"caller": fingerprint(KEY)}
        assert (await client.delete("/session")).status_code == 204
        assert (await client.get("/v1/who")).status_code == 401


async def test_over_https_the_cookie_travels_only_there(locked: FastAPI) -> None:
    answer = await ask(locked, "POST", "/session", base_url="https://sims.example", json={"key": KEY})
    assert "Secure" in answer.headers["set-cookie"]


async def test_without_keys_there_is_nothing_to_log_in_to(local: FastAPI) -> None:
    assert (await ask(local, path="/session")).json() == {"required": False, "authenticated": True}
    answer = await ask(local, "POST", "/session", json={"key": "whatever"})
    assert answer.status_code == 204
    assert "set-cookie" not in answer.headers


@for_each(
    ("headers", "let_in"),
    [
        ({"Origin": "http://localhost:8000"}, True),
        ({"Sec-Fetch-Site": "same-origin"}, True),
        ({"Sec-Fetch-Site": "same-origin", "Origin": "http://localhost:8000"}, True),
        ({"Sec-Fetch-Site": "cross-site", "Origin": "http://localhost:8000"}, False),
        ({"Sec-Fetch-Site": "same-site"}, False),
        ({"Origin": "http://localhost:8001"}, False),
        ({"Origin": STUDIO}, False),
        ({"Origin": "null"}, False),
        ({}, False),
    ],
)
async def test_with_the_cookie_only_our_own_page_may_change_things(
    locked: FastAPI, headers: dict[str, str], let_in: bool
) -> None:
    cookie = {"Cookie": f"{COOKIE}={Gate((KEY,)).cookie(KEY, int(time.time()) + 60)}"}
    assert (await ask(locked, "GET", headers=cookie | headers)).status_code == 200
    for method in ("POST", "DELETE"):
        answer = await ask(locked, method, headers=cookie | headers)
        assert answer.status_code == (200 if let_in else 403)
    assert (await ask(locked, "POST", headers=cookie | headers | bearer(KEY))).status_code == 200


async def test_another_page_cannot_log_a_visitor_in(locked: FastAPI) -> None:
    answer = await ask(locked, "POST", "/session", json={"key": KEY}, headers={"Origin": "https://evil.example"})
    check_problem(answer, 403)


async def test_only_origins_let_in_may_read_answers_elsewhere(locked: FastAPI) -> None:
    asking = {"Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "authorization,content-type"}
    answer = await ask(locked, "OPTIONS", headers={"Origin": STUDIO, **asking})
    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == STUDIO
    assert "access-control-allow-credentials" not in answer.headers
    check_problem(await ask(locked, "OPTIONS", headers={"Origin": "https://evil.example", **asking}), 400)
    answer = await ask(locked, headers={"Origin": STUDIO, **bearer(KEY)})
    assert answer.headers["access-control-allow-origin"] == STUDIO
    assert "Sims-Frames" in answer.headers["access-control-expose-headers"]
    refused = await ask(locked, headers={"Origin": STUDIO})
    assert refused.headers["access-control-allow-origin"] == STUDIO, "a page must be able to read why"
    check_problem(refused, 401)
    answer = await ask(locked, headers={"Origin": "https://evil.example", **bearer(KEY)})
    assert "access-control-allow-origin" not in answer.headers


def test_a_cookie_is_good_for_its_key_until_it_expires() -> None:
    gate = Gate((KEY, OTHER_KEY))
    now = int(time.time())
    assert gate.cookie_owner(gate.cookie(OTHER_KEY, now + 60)) == fingerprint(OTHER_KEY)
    assert gate.cookie_owner(gate.cookie(OTHER_KEY, now - 1)) is None
    assert Gate((KEY,)).cookie_owner(gate.cookie(OTHER_KEY, now + 60)) is None, "a key that was taken away"


@given(st.data())
def test_a_cookie_that_was_touched_is_worth_nothing(data: st.DataObject) -> None:
    gate = Gate((KEY,))
    good = gate.cookie(KEY, int(time.time()) + 60)
    place = data.draw(st.integers(0, len(good) - 1))
    bad = good[:place] + data.draw(st.text(max_size=3)) + good[place + 1 :]
    assert bad == good or gate.cookie_owner(bad) is None


@given(st.text() | st.from_regex(r"\d{1,14}\.[0-9a-f]{64}"))
def test_what_was_never_signed_is_no_cookie(value: str) -> None:
    assert Gate((KEY,)).cookie_owner(value) is None


@given(st.text())
def test_no_text_but_a_key_is_a_key(text: str) -> None:
    assert Gate((KEY,)).owner(text) is None
    assert Gate(()).owner(text) is None


@for_each("host", ["127.0.0.1", "localhost", "::1", "[::1]", "127.8.8.8"])
def test_on_loopback_no_key_is_needed(host: str) -> None:
    assert is_loopback(host)
    check_exposure(settings(host=host))


@for_each("host", ["0.0.0.0", "::", "192.168.0.1", "sims.example", "", "localhost.example"])
def test_beyond_loopback_a_key_is_needed(host: str) -> None:
    with pytest.raises(SettingsError, match="SIMS_API_KEYS"):
        check_exposure(settings(host=host))
    check_exposure(settings(host=host, api_keys=(KEY,)))


@for_each(
    ("wrong", "field"),
    [
        ({"api_keys": ("short",)}, "SIMS_API_KEYS"),
        ({"api_keys": ("a" * 40,)}, "SIMS_API_KEYS"),
        ({"api_keys": (KEY + " with spaces",)}, "SIMS_API_KEYS"),
        ({"api_keys": (KEY + "é",)}, "SIMS_API_KEYS"),
        ({"cors_origins": ("*",)}, "SIMS_CORS_ORIGINS"),
        ({"cors_origins": ("studio.example",)}, "SIMS_CORS_ORIGINS"),
        ({"cors_origins": (STUDIO + "/",)}, "SIMS_CORS_ORIGINS"),
    ],
)
def test_weak_keys_and_origins_that_are_none_are_refused_at_the_start(wrong: dict[str, Any], field: str) -> None:
    with pytest.raises(SettingsError, match=field):
        check_exposure(settings(**wrong))


def settings(**given: Any) -> Settings:
    return Settings.model_construct(**{**Settings(_env_file=None).model_dump(), **given})
