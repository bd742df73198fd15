"""Nobody may ask for more than their share, and whoever does is told when to come back."""

from __future__ import annotations

import gc
import time
from pathlib import Path

import pytest
from fastapi import FastAPI
from service_app import KEY, OTHER_KEY, app_on, calling, check_problem

from planner_service.api.errors import TooMany
from planner_service.api.rate_limit import Rate

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def add_routes(app: FastAPI) -> None:
    @app.get("/v1/thing")
    def thing() -> None:
        return None


async def test_after_so_many_requests_the_answer_is_429_with_the_seconds_to_wait(tmp_path: Path) -> None:
    with app_on(tmp_path, add_routes, rate="5/minute") as app:
        async with calling(app) as client:
            assert [(await client.get("/v1/thing")).status_code for _ in range(5)] == [200] * 5
            answer = await client.get("/v1/thing")
            assert "5 a minute" in check_problem(answer, 429)["detail"]
            assert 55 <= int(answer.headers["retry-after"]) <= 60
            for path in ("/healthz", "/readyz", "/metrics", "/assets/a.js"):
                assert (await client.get(path)).status_code != 429


async def test_every_key_has_a_share_of_its_own(tmp_path: Path) -> None:
    with app_on(tmp_path, add_routes, rate="3/minute", api_keys=(KEY, OTHER_KEY)) as app:
        async with calling(app) as client:
            for key in (KEY, OTHER_KEY):
                asked = [await client.get("/v1/thing", headers={"Authorization": f"Bearer {key}"}) for _ in range(4)]
                assert [answer.status_code for answer in asked] == [200, 200, 200, 429]
            page = [(await client.get("/session")).status_code for _ in range(4)]
            assert page == [200, 200, 200, 429], "those without a key are counted by address"


async def test_the_window_moves_on(tmp_path: Path) -> None:
    with app_on(tmp_path, add_routes, rate="2/second") as app:
        async with calling(app) as client:
            assert [(await client.get("/v1/thing")).status_code for _ in range(3)] == [200, 200, 429]
            time.sleep(1.05)
            assert (await client.get("/v1/thing")).status_code == 200


def test_counts_outlive_a_collection_of_garbage() -> None:
    rate = Rate("2/minute")
    rate.take("a", "too many")
    gc.collect()
    rate.take("a", "too many")
    with pytest.raises(TooMany, match="2 a minute"):
        rate.take("a", "too many")
    rate.take("b", "too many")


def test_counting_a_request_costs_little() -> None:
    rate = Rate("100000/minute")
    begun = time.process_time()
    for _ in range(2000):
        rate.take("a", "too many")
    assert (time.process_time() - begun) / 2000 < 0.001
