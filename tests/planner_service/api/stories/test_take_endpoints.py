"""Takes over HTTP: what is wrong is told where it stands, what stays the same is not made again, and all else is as
for stories."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI
from service_app import app_on, calling, check_problem, warm_app_on
from sqlalchemy import update

from planner_service.jobs import story_stages
from planner_service.jobs.story_stages import Maker, read_segments
from planner_service.pipeline import Pipeline
from planner_service.store.story_store import Stories
from planner_service.store.tables import workflow_status

pytestmark = pytest.mark.anyio
MOTION = {
    "layout_id": "living-room-0016",
    "keyframes": [
        {"skill": "sitdown", "caption": "sit down", "furniture": "sofa"},
        {"skill": "touch", "caption": "touch medium height", "furniture": "coffee table"},
    ],
}
"""A walk to the sofa, sitting, rising, a walk to the table, and touching it."""


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def app(tmp_path: Path) -> Iterator[FastAPI]:
    with app_on(tmp_path) as app:
        yield app


def desk(app: FastAPI) -> Maker:
    return Maker(Stories(app.state.parts.engine), Pipeline(app.state.parts.shelves), "one")


def grounded(story_id: str, maker: Maker) -> int:
    """Made as far as its actions; how many there are."""
    maker.plan(story_id)
    maker.furnish(story_id)
    if not maker.store.request(story_id).keyframes:
        maker.narrate(story_id)
    return maker.act(story_id)


def moved(story_id: str, maker: Maker) -> list[Any]:
    """Made as far as its motion; what each segment is."""
    count = grounded(story_id, maker)
    for index in range(count):
        maker.move(story_id, index)
    return read_segments(maker.store, story_id, range(count))


def ended(app: FastAPI, story_id: str, status: str) -> None:
    """What the job engine says when a workflow has ended."""
    with app.state.parts.engine.execution_options(writes=True).begin() as connection:
        mine = workflow_status.c.workflow_uuid == story_id
        connection.execute(update(workflow_status).where(mine).values(status=status))


async def posted(client: httpx.AsyncClient, path: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = await client.post(path, json=body)
    assert answer.status_code == 202, answer.text
    return dict(answer.json())


async def look(client: httpx.AsyncClient, story: dict[str, Any]) -> dict[str, Any]:
    return dict((await client.get(story["links"]["self"])).json())


def script_of(story: dict[str, Any]) -> list[dict[str, Any]]:
    """A story's script as it would be posted again."""
    names = ("index", "skill", "emotion", "caption", "furniture", "object_id")
    return [{name: keyframe[name] for name in names} for keyframe in story["keyframes"]]


def same(one: Any, other: Any) -> bool:
    arrays = ("root_positions", "local_rotations", "contacts", "actions")
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in arrays)


async def test_what_stays_the_same_is_taken_over_and_is_what_would_be_made_again(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    maker = desk(app)
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        before = moved(origin["id"], maker)
        origin = await look(client, origin)
        script = script_of(origin)
        assert [one["skill"] for one in script] == ["loco", "sitdown", "standup", "loco", "touch"]
        script[4]["caption"] = "touch low height with the left hand"
        take = await posted(client, origin["links"]["takes"], {"keyframes": script})
        assert (take["derived_from"], take["kind"], take["state"]) == (origin["id"], "motion", "queued")
        after = moved(take["id"], maker)
        take = await look(client, take)
        # The walk to the table looked ahead to how it is touched.
        assert take["reused"] == 3
        assert [one["reused"] for one in take["keyframes"]] == [True, True, True, False, False]
        assert [same(one, other) for one, other in zip(before, after, strict=True)][:3] == [True] * 3
        assert not same(before[4], after[4])
        assert take["keyframes"][4]["caption"] == "touch low height with the left hand"
        assert take["motion"]["frames"] == sum(map(len, after))

        nothing_else = await posted(client, origin["links"]["takes"], {})
        again = moved(nothing_else["id"], maker)
        assert (await look(client, nothing_else))["reused"] == 5
        assert all(map(same, before, again))

        monkeypatch.setattr(story_stages, "reused_segments", lambda *_: [])
        anew = await posted(client, origin["links"]["takes"], {"keyframes": script})
        assert all(map(same, after, moved(anew["id"], desk(app))))
        assert (await look(client, anew))["reused"] == 0


async def test_everything_that_is_wrong_is_told_at_its_place_with_what_would_be_right(app: FastAPI) -> None:
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        grounded(origin["id"], desk(app))
        origin = await look(client, origin)
        script = script_of(origin)
        script[0] |= {"caption": "yodel"}
        script[1] |= {"object_id": "0/throne_1"}
        script[3] |= {"emotion": "zork"}
        script[4] |= {"index": 99}
        script += [
            {"skill": "sitdown", "caption": "sit down", "furniture": "fridge"},
            {"skill": "liedown", "caption": "lying down, legs straight", "object_id": "0/floor_lamp_1"},
            {"skill": "touch", "caption": "touch medium height", "furniture": "floor"},
        ]
        problem = check_problem(await client.post(origin["links"]["takes"], json={"keyframes": script}), 422)
        told = {fault["pointer"]: fault["detail"] for fault in problem["errors"]}
        assert set(told) == {
            "/keyframes/0/caption", "/keyframes/1/object_id", "/keyframes/3/emotion", "/keyframes/4/index",
            "/keyframes/5/furniture", "/keyframes/6/object_id", "/keyframes/7/furniture",
        }  # fmt: skip
        assert "GET /v1/captions?skill=loco" in told["/keyframes/0/caption"]
        assert "loveseat (0/loveseat_sofa_1)" in told["/keyframes/1/object_id"]
        assert "relaxed" in told["/keyframes/3/emotion"]
        assert "floor lamp" in told["/keyframes/6/object_id"]
        for body, pointer in (
            ({"keyframes": []}, "/keyframes"),
            ({"keyframes": [{"skill": "hop", "caption": "hop"}]}, "/keyframes/0/skill"),
            ({"keyframes": [{"skill": "standup", "caption": "stand up"}]}, "/keyframes/0/skill"),
            ({"backend": "magic"}, "/backend"),
            ({"home": {}}, "/home/rooms"),
            ({"home": {}, "layouts": ["study-0000"]}, "/home"),
            ({"layouts": ["nowhere"]}, "/layouts/0"),
            ({"theme": "He sleeps."}, "/theme"),
        ):
            refused = check_problem(await client.post(origin["links"]["takes"], json=body), 422)
            assert [fault["pointer"] for fault in refused["errors"]] == [pointer]


async def test_a_take_needs_a_story_that_has_its_script_and_home(app: FastAPI) -> None:
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        here = origin["links"]["takes"]
        assert "events" in check_problem(await client.post(here, json={}), 409)["detail"]
        ended(app, origin["id"], "CANCELLED")
        assert "cancelled" in check_problem(await client.post(here, json={}), 409)["detail"]
        check_problem(await client.post("/v1/stories/nowhere/takes", json={}), 404)


async def test_one_key_makes_one_take_though_its_story_is_gone(app: FastAPI) -> None:
    headers = {"Idempotency-Key": "once"}
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        grounded(origin["id"], desk(app))
        first = (await client.post(origin["links"]["takes"], json={}, headers=headers)).json()
        other = check_problem(await client.post(origin["links"]["takes"], json={"seed": 1}, headers=headers), 422)
        assert other["errors"][0]["pointer"] == "header:Idempotency-Key"
        assert (await client.delete(origin["links"]["self"])).status_code == 204
        again = await client.post(origin["links"]["takes"], json={}, headers=headers)
        assert (again.status_code, again.json()["id"]) == (202, first["id"])
        assert grounded(first["id"], desk(app)) == 5, "what it derives from may be gone"
        assert (await look(client, first))["reused"] == 0
        assert (await client.post(first["links"]["cancel"])).json()["state"] == "cancelled"


@pytest.mark.sweep
async def test_another_seed_home_or_character_begins_anew_with_the_same_script(app: FastAPI) -> None:
    maker = desk(app)
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        moved(origin["id"], maker)
        origin = await look(client, origin)
        study = app.state.parts.shelves.rooms()["living-room-0017"]
        other = await posted(client, "/v1/motions", MOTION | {"layout_id": study.id})
        grounded(other["id"], maker)
        maker.move(other["id"], 0)
        early = await posted(client, other["links"]["takes"], {})
        grounded(early["id"], maker)
        assert (await look(client, early))["reused"] == 1, "of a story still being made, what is there"
        home = (await client.get(other["links"]["home"])).json()
        for ask, reused in (
            ({"seed": 5}, 0), ({"home": home}, 0), ({"layouts": [study.id]}, 0), ({"character": {"height": 1.5}}, 0),
            ({"character": {"outfit": "nurse"}}, 5),
        ):  # fmt: skip
            take = await posted(client, origin["links"]["takes"], ask)
            grounded(take["id"], maker)
            take = await look(client, take)
            said = [(one["skill"], one["caption"]) for one in take["keyframes"]]
            assert said == [(one["skill"], one["caption"]) for one in origin["keyframes"]]
            assert take["reused"] == reused, ask
            assert take["home"]["rooms"][0]["layout_id"] == (
                study.id if {"home", "layouts"} & set(ask) else MOTION["layout_id"]
            )


async def test_a_take_of_a_story_is_told_anew(tmp_path: Path) -> None:
    with warm_app_on(tmp_path) as app:
        maker = desk(app)
        async with calling(app) as client:
            origin = await posted(client, "/v1/stories", {"theme": "A woman sits on the sofa and reads. She is sad."})
            grounded(origin["id"], maker)
            origin = await look(client, origin)
            script = [one | {"emotion": "happy"} for one in script_of(origin)]
            script.append({"skill": "liedown", "caption": "lying down, legs straight", "furniture": "sofa"})
            take = await posted(client, origin["links"]["takes"], {"keyframes": script})
            grounded(take["id"], maker)
            take = await look(client, take)
        assert {one["mood"] for one in take["keyframes"]} == {"happy", "neutral"}
        assert (take["keyframes"][-1]["skill"], take["keyframes"][-1]["beat"]) == ("liedown", None)
        assert [one["text"] for one in take["beats"]] == [one["text"] for one in origin["beats"]]
        assert take["text"] != origin["text"]
        assert take["theme"] == origin["theme"]


async def test_takes_of_a_story_and_of_its_takes_are_counted_as_they_were_asked_for(app: FastAPI) -> None:
    maker = desk(app)
    async with calling(app) as client:
        origin = await posted(client, "/v1/motions", MOTION)
        grounded(origin["id"], maker)
        first = await posted(client, origin["links"]["takes"], {"seed": 1})
        grounded(first["id"], maker)
        third = await posted(client, first["links"]["takes"], {"seed": 2})
        fourth = await posted(client, origin["links"]["takes"], {"seed": 3})
        for one in (fourth, third):  # in whatever order they are made
            grounded(one["id"], maker)
        other = await posted(client, "/v1/motions", MOTION)
        grounded(other["id"], maker)
        assert [(await look(client, one))["take"] for one in (origin, first, third, fourth, other)] == [0, 1, 2, 3, 0]
