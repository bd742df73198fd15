"""A server that is busy is asked again, later every time, and not after the end of patience."""

from __future__ import annotations

import time

import anyio
import httpx2
import pytest

from planner_service.llm.http_transport import ATTEMPTS, FIRST_WAIT, Carrier, ServerError


def asked(monkeypatch: pytest.MonkeyPatch, statuses: list[int], patience: float = 60.0) -> tuple[list[float], str]:
    """The waits between attempts that are answered with these statuses, and the error or the answer's text."""
    waits: list[float] = []

    async def sleep(seconds: float) -> None:
        waits.append(seconds)

    left = iter(statuses)
    inner = httpx2.MockTransport(lambda _: httpx2.Response(next(left), json={"said": "yes"}))
    monkeypatch.setattr("asyncio.sleep", sleep)

    async def ask() -> str:
        carrier = Carrier(inner, "the server", "secret", time.monotonic() + patience)
        try:
            return (await carrier.handle_async_request(httpx2.Request("POST", "http://there/"))).text
        except ServerError as error:
            return str(error)

    return waits, anyio.run(ask)


def test_every_wait_is_twice_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    waits, told = asked(monkeypatch, [503] * ATTEMPTS)
    assert waits == [FIRST_WAIT, 2 * FIRST_WAIT, 4 * FIRST_WAIT]
    assert f"tried {ATTEMPTS} times" in told
    assert "secret" not in told


def test_an_answer_ends_the_asking_and_so_does_a_refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    waits, told = asked(monkeypatch, [429, 200])
    assert (waits, "yes" in told) == ([FIRST_WAIT], True)
    assert asked(monkeypatch, [401])[0] == []


def test_nobody_waits_beyond_the_end_of_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    waits, told = asked(monkeypatch, [503] * ATTEMPTS, patience=FIRST_WAIT / 2)
    assert waits == []
    assert "SIMS_LLM_TIMEOUT ends before" in told
