"""Stories outlive what happens to the processes that make them: killed at any moment, they go on where they were.

`SIMS_TEST_KILLS` sets at how many moments: 20 before a release.
"""

from __future__ import annotations

import os
import random
import signal
import time
from datetime import datetime
from pathlib import Path

import httpx
import pytest
from running import PATIENCE, SHORT, RunningService, finished
from sqlalchemy import text

from planner_service.settings import read_settings
from planner_service.store.database import database_url, open_engine

pytestmark = pytest.mark.service
KILLS = int(os.environ.get("SIMS_TEST_KILLS", "2"))
"""Moments at which processes are killed: the whole service, then its worker."""
STORIES = 2
"""Stories that wait at the beginning; more are posted as these are made."""


@pytest.mark.parametrize("database", [pytest.param("sqlite", marks=pytest.mark.sweep), "postgresql"])
def test_a_story_that_is_killed_at_any_moment_becomes_the_same_film(
    database: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    url = request.getfixturevalue("postgres_url") if database == "postgresql" else ""
    service = RunningService(tmp_path, workers=1, database_url=url).start()
    rng = random.Random(f"{database} 5")
    try:
        with service.client() as client:
            ids = [post(client, seed) for seed in range(STORIES)]
        for number in range(KILLS):
            wait_for_work(service, number)
            with service.client() as client:
                while unfinished(client) < 2:
                    ids.append(post(client, len(ids)))
            time.sleep(rng.uniform(0.0, 1.6))
            if number % 3:
                os.kill(service.worker_pids()[0], signal.SIGKILL)
            else:
                service.kill()
                service.start()
        with service.client() as client:
            ids.append(post(client, 0))  # one that nothing disturbs, to compare with
            made = [finished(client, story_id) for story_id in ids]
            assert [story["state"] for story in made] == ["succeeded"] * len(ids)
            films = [client.get(story["links"]["film"]).content for story in made]
    finally:
        if service.process:
            service.stop()
    assert films[0] == films[-1]
    assert len(set(films)) == len(ids) - 1
    assert_nothing_recorded_ran_again(service, url)


def post(client: httpx.Client, seed: int) -> str:
    story: dict[str, str] = client.post("/v1/stories", json={"theme": SHORT, "seed": seed}).raise_for_status().json()
    return story["id"]


def unfinished(client: httpx.Client) -> int:
    items = client.get("/v1/stories?limit=100").raise_for_status().json()["items"]
    return sum(item["state"] in ("queued", "running") for item in items)


def wait_for_work(service: RunningService, kills: int) -> None:
    """Until the worker has begun something since the last kill, or has nothing left to do."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        lines = service.lines()
        starts = [place for place, line in enumerate(lines) if line["event"] == "worker ready"]
        if len(starts) > kills:
            return
        time.sleep(0.1)
    raise AssertionError(f"the worker did not start again after kill {kills}")


def assert_nothing_recorded_ran_again(service: RunningService, url: str) -> None:
    """No step begins after the job engine has recorded its result."""
    engine = open_engine(database_url(read_settings(data_dir=service.folder, database_url=url)))
    table = "dbos.operation_outputs" if url else "operation_outputs"
    with engine.connect() as connection:
        rows = connection.execute(text(f"SELECT workflow_uuid, function_name, completed_at_epoch_ms FROM {table}"))
        recorded = {(row[0], row[1]): row[2] for row in rows}
    engine.dispose()
    begun = [line for line in service.lines() if line["event"] == "step begins"]
    assert len(recorded) > 10 * STORIES
    assert {(line["story_id"], line["step"]) for line in begun} >= set(recorded)
    for line in begun:
        when = datetime.fromisoformat(line["time"]).timestamp() * 1000
        assert when <= recorded[line["story_id"], line["step"]] + 1, line
