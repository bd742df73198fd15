"""Many stories at once, one key for one story, and stopping one: over real HTTP, on both databases before a release.

`SIMS_TEST_STORIES` sets how many are posted at once: 50 before a release.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
from running import ENDED, LOOK, SHORT, RunningService, begun, finished

from motion_backend.formats.npz import read_raw

pytestmark = pytest.mark.service
STORIES = int(os.environ.get("SIMS_TEST_STORIES", "4"))
"""Stories posted at once, on each database; every film is asked for twice."""
SEVERAL = "He wakes up, reads at the desk, argues on the phone, eats at the table and falls asleep in bed."
LONG = (
    "He wakes up, reads at the desk, sits on the sofa, argues on the phone, drinks, dances, tidies the shelf, "
    "eats at the table, gets angry, calms down and falls asleep in bed."
)


# Day by day one database each: that of the tests of killing is PostgreSQL.
@pytest.fixture(scope="module", params=["sqlite", pytest.param("postgresql", marks=pytest.mark.sweep)])
def running(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    url = ""
    if request.param == "postgresql":
        url = request.getfixturevalue("postgres_server").get_uri()
    with RunningService(tmp_path_factory.mktemp("jobs"), workers=2, database_url=url) as service:
        yield service


@pytest.fixture
def client(running: RunningService) -> Iterator[httpx.Client]:
    with running.client() as client:
        yield client


def post(client: httpx.Client, key: str | None = None, **asked: Any) -> httpx.Response:
    headers = {"Idempotency-Key": key} if key else {}
    return client.post("/v1/stories", json={"theme": SHORT, **asked}, headers=headers)


def test_many_stories_posted_at_once_all_end(client: httpx.Client) -> None:
    films = STORIES // 2
    with ThreadPoolExecutor(16) as pool:
        answers = list(pool.map(lambda number: post(client, seed=number % films), range(STORIES)))
    assert [answer.status_code for answer in answers] == [202] * STORIES
    ids = {answer.json()["id"] for answer in answers}
    assert len(ids) == STORIES
    stories = [finished(client, story_id, patience=400) for story_id in ids]
    assert {story["state"] for story in stories} == {"succeeded"}
    etags = {(story["seed"], client.head(story["links"]["film"]).headers["etag"]) for story in stories}
    assert len(etags) == films  # the same seed, the same film


def test_one_key_makes_one_story_however_often_and_at_once_it_is_sent(client: httpx.Client) -> None:
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: post(client, key="one-key"), range(8)))
    assert {answer.status_code for answer in answers} == {202}
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert len({answer.headers["location"] for answer in answers}) == 1


def test_one_key_with_another_body_is_refused(client: httpx.Client) -> None:
    first = post(client, key="two-bodies", seed=1)
    second = post(client, key="two-bodies", seed=2)
    assert (first.status_code, second.status_code) == (202, 422)
    assert second.json()["errors"][0]["pointer"] == "header:Idempotency-Key"
    finished(client, first.json()["id"])


def test_a_story_that_is_cancelled_stops_within_one_segment(client: httpx.Client) -> None:
    story = post(client, theme=LONG).json()
    begun(client, story["id"])
    answer = client.post(story["links"]["cancel"])
    at_cancel = answer.json()
    assert answer.status_code == 202
    ended = finished(client, story["id"])
    time.sleep(1.0)
    later = client.get(story["links"]["self"]).json()
    assert ended["state"] == later["state"] == "cancelled"
    moved_then = sum(keyframe["end"] is not None for keyframe in at_cancel["keyframes"])
    moved_later = sum(keyframe["end"] is not None for keyframe in later["keyframes"])
    assert moved_later == moved_then < len(later["keyframes"])  # what was in the making then is thrown away
    assert not later["motion"]["complete"]
    events = read_events(client, story["id"])
    assert [name for _, name, _ in events].count("cancelled") == 1
    assert read_events(client, story["id"], events[-2][0]) == events[-1:]


def test_what_a_cancelled_story_has_can_still_be_fetched(client: httpx.Client) -> None:
    story = post(client, theme=LONG).json()
    begun(client, story["id"])
    client.post(story["links"]["cancel"])
    ended = finished(client, story["id"])
    time.sleep(0.5)
    frames = client.get(story["links"]["self"]).json()["motion"]["frames"]
    assert frames == ended["motion"]["frames"] > 0
    positions = read_raw(client.get(story["links"]["motion"], params={"format": "f32"}).content)
    assert len(positions) == frames
    assert client.get(story["links"]["film"]).status_code == 404
    assert client.get(story["links"]["scene"]).status_code == 200


def test_a_story_that_waits_can_be_cancelled_and_is_never_begun(client: httpx.Client) -> None:
    ahead = [post(client, theme=LONG).json() for _ in range(2)]
    story = post(client).json()
    cancelled = client.post(story["links"]["cancel"]).json()
    assert cancelled["state"] == "cancelled"
    for one in ahead:
        client.post(one["links"]["cancel"])
        finished(client, one["id"])
    time.sleep(0.5)
    assert client.get(story["links"]["self"]).json()["stage"] is None
    nothing = client.get(story["links"]["motion"])
    assert nothing.status_code == 404
    assert "cancelled" in nothing.json()["detail"]


def test_a_story_that_has_ended_cannot_be_cancelled(client: httpx.Client) -> None:
    story = finished(client, post(client).json()["id"])
    answer = client.post(story["links"]["cancel"])
    assert answer.status_code == 409
    assert "succeeded" in answer.json()["detail"]
    assert client.get(story["links"]["self"]).json()["state"] == "succeeded"


def test_a_story_deleted_while_it_is_made_is_gone_and_the_next_one_is_made(client: httpx.Client) -> None:
    story = post(client, theme=LONG).json()
    while client.get(story["links"]["self"]).json()["stage"] != "move":
        time.sleep(LOOK)
    assert client.delete(story["links"]["self"]).status_code == 204
    assert client.get(story["links"]["self"]).status_code == 404
    assert client.delete(story["links"]["self"]).status_code == 404
    assert finished(client, post(client).json()["id"])["state"] == "succeeded"


def test_a_theme_that_is_not_understood_fails_with_the_reason(client: httpx.Client) -> None:
    story = finished(client, post(client, theme="Interest rates rose sharply in March.").json()["id"])
    assert story["state"] == "failed"
    assert "nothing in it can be acted" in story["error"]["detail"]
    assert story["error"]["title"]


def test_events_are_numbered_the_same_from_wherever_one_listens(client: httpx.Client) -> None:
    story = post(client, theme=SEVERAL).json()
    live = read_events(client, story["id"])
    assert live[-1][1] == "done"
    assert [event[0] for event in live] == sorted({event[0] for event in live})
    assert read_events(client, story["id"]) == live
    for number, _, _ in live[:: len(live) // 6]:
        assert read_events(client, story["id"], number) == [event for event in live if event[0] > number]
    assert client.get(story["links"]["events"], headers={"Last-Event-ID": str(live[-1][0])}).status_code == 204
    segments = [json.loads(event[2]) for event in live if event[1] == "segment"]
    assert [segment["start"] for segment in segments[1:]] == [segment["end"] for segment in segments[:-1]]


def read_events(client: httpx.Client, story_id: str, after: int | None = None) -> list[tuple[int, str, str]]:
    headers = {} if after is None else {"Last-Event-ID": str(after)}
    found, event = [], {}
    with client.stream("GET", f"/v1/stories/{story_id}/events", headers=headers) as stream:
        for line in stream.iter_lines():
            name, _, value = line.partition(": ")
            if line and name:
                event[name] = value
            elif event:
                found.append((int(event["id"]), event["event"], event["data"]))
                event = {}
    return found


def test_stories_are_listed_newest_first_page_after_page(client: httpx.Client) -> None:
    pages, cursor = [], None
    while True:
        params = {"limit": 7} | ({"cursor": cursor} if cursor else {})
        page = client.get("/v1/stories", params=params).raise_for_status().json()
        pages += page["items"]
        cursor = page["next"]
        if cursor is None:
            break
    ids = [item["id"] for item in pages]
    assert ids == sorted(set(ids), reverse=True)
    assert all(item["state"] in ENDED for item in pages)


@pytest.mark.sweep
def test_a_service_stops_gracefully_and_goes_on_when_it_starts_again(running: RunningService) -> None:
    with running.client() as client:
        story = post(client, theme=SEVERAL).json()
        begun(client, story["id"])
    asked = time.monotonic()
    assert running.stop() == 0
    assert time.monotonic() - asked < 10
    running.start()
    with running.client() as client:
        assert finished(client, story["id"])["state"] == "succeeded"
