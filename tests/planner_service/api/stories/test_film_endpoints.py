"""A story's film over HTTP: asked for once, made by a worker, fetched, stopped, and gone with its story."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from service_app import app_on, calling, check_problem
from sqlalchemy import update

from motion_backend.formats import usd_film
from motion_backend.formats.gltf_document import read_glb
from planner_service.jobs import film_stages
from planner_service.jobs.film_stages import Filmer
from planner_service.jobs.story_stages import Maker
from planner_service.output import film as films
from planner_service.output.film import Filmed
from planner_service.pipeline import Pipeline
from planner_service.store.story_store import Stories, StoryGone
from planner_service.store.tables import workflow_status

pytestmark = pytest.mark.anyio
SMALL, FRAMES = (64, 36), 8
MOTION = {
    "layout_id": "living-room-0016",
    "keyframes": [{"skill": "sitdown", "caption": "sit down", "furniture": "sofa"}],
}


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FastAPI]:
    real = films.write_film

    def few(filmed: Filmed, path: Path, show: Callable[[float], None]) -> Path:
        """The first frames of it, small."""
        short = replace(filmed, motion=filmed.motion.part(0, FRAMES), segments=((0, FRAMES),))
        return real(short, path, SMALL, show)

    monkeypatch.setattr(film_stages, "write_film", few)
    with app_on(tmp_path) as app:
        yield app


def ended(app: FastAPI, story_id: str, status: str) -> None:
    """What the job engine says when a workflow has ended."""
    with app.state.parts.engine.execution_options(writes=True).begin() as connection:
        mine = workflow_status.c.workflow_uuid == story_id
        connection.execute(update(workflow_status).where(mine).values(status=status))


async def made(app: FastAPI, client: Any, motion: dict[str, Any] = MOTION) -> dict[str, Any]:
    """A motion that was acted out."""
    return moved(app, (await client.post("/v1/motions", json=motion)).json())


def moved(app: FastAPI, story: dict[str, Any]) -> dict[str, Any]:
    """A story that was posted, acted out."""
    desk = Maker(Stories(app.state.parts.engine), Pipeline(app.state.parts.shelves), "one")
    desk.plan(story["id"])
    desk.furnish(story["id"])
    for index in range(desk.act(story["id"])):
        desk.move(story["id"], index)
    ended(app, story["id"], "SUCCESS")
    return dict(story)


def filmer(app: FastAPI) -> Filmer:
    return Filmer(Stories(app.state.parts.engine), Pipeline(app.state.parts.shelves), "one")


async def test_a_film_is_made_once_kept_and_gone_with_its_story(app: FastAPI) -> None:
    pytest.importorskip("av")
    async with calling(app) as client:
        story = await made(app, client)
        here = story["links"]["self"]
        assert "POST" in check_problem(await client.get(f"{here}/film.mp4"), 404)["detail"]
        assert (await client.get(f"{here}/film")).json()["state"] == "absent"
        asked = await client.post(f"{here}/film")
        assert (asked.status_code, asked.headers["location"]) == (202, f"{here}/film")
        film = asked.json()
        assert (film["state"], film["frames"]) == ("queued", None)
        problem = check_problem(await client.get(story["links"]["mp4"]), 404)
        assert problem["type"] == "urn:sims:problem:not-ready"
        assert (await client.post(f"{here}/film")).json()["id"] == film["id"]
        assert (await client.get("/v1/stories")).json()["items"][0]["id"] == story["id"]
        check_problem(await client.get(f"/v1/stories/{film['id']}"), 404)

        filmer(app).film(film["id"])
        ended(app, film["id"], "SUCCESS")
        shown = (await client.get(f"{here}/film")).json()
        assert (shown["state"], shown["progress"]) == ("succeeded", 1.0)
        file = await client.get(shown["links"]["mp4"])
        assert (file.status_code, file.headers["content-type"]) == (200, "video/mp4")
        assert file.content[4:8] == b"ftyp"
        assert (len(file.content), shown["frames"] > 60) == (shown["bytes"], True)
        again = await client.get(shown["links"]["mp4"], headers={"If-None-Match": file.headers["etag"]})
        assert again.status_code == 304
        assert (await client.post(f"{here}/film")).json()["id"] == film["id"]

        assert (await client.delete(here)).status_code == 204
        with pytest.raises(StoryGone):
            Stories(app.state.parts.engine).get(film["id"])


async def test_a_film_is_had_as_usd_once_the_body_has_moved(app: FastAPI, tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd")
    async with calling(app) as client:
        fresh = (await client.post("/v1/motions", json=MOTION)).json()
        assert check_problem(await client.get(fresh["links"]["usd"]), 404)["type"] == "urn:sims:problem:not-ready"
        story = await made(app, client)
        file = await client.get(story["links"]["usd"])
        assert (file.status_code, file.headers["content-type"]) == (200, "model/vnd.usd")
        assert ".usd" in file.headers["content-disposition"]
        again = await client.get(story["links"]["usd"], headers={"If-None-Match": file.headers["etag"]})
        assert again.status_code == 304
    path = tmp_path / "film.usd"
    path.write_bytes(file.content)
    stage = usd.Stage.Open(str(path))
    assert stage.GetEndTimeCode() > 60
    assert stage.GetPrimAtPath("/Film/Body/Skeleton/Motion")
    assert stage.GetPrimAtPath("/Film/Home/furniture")


async def test_what_is_in_the_hands_is_had_as_soon_as_the_body_has_moved(app: FastAPI) -> None:
    drinks = {"skill": "sitdown", "caption": "drinking from a cup in the right hand", "furniture": "sofa"}
    async with calling(app) as client:
        fresh = (await client.post("/v1/motions", json=MOTION)).json()
        assert check_problem(await client.get(fresh["links"]["props"]), 404)["type"] == "urn:sims:problem:not-ready"
        empty = await client.get((await made(app, client))["links"]["props"])
        assert (empty.status_code, empty.content) == (204, b"")
        story = await made(app, client, MOTION | {"keyframes": [drinks]})
        file = await client.get(story["links"]["props"])
        assert (file.status_code, file.headers["content-type"]) == (200, "model/gltf-binary")
        again = await client.get(story["links"]["props"], headers={"If-None-Match": file.headers["etag"]})
        assert again.status_code == 304
    document, _ = read_glb(file.content)
    # It stands on what is near until it is in the hand.
    assert [node["name"] for node in document["nodes"]] == ["prop_cup_0", "prop_cup_1"]
    assert {channel["target"]["path"] for channel in document["animations"][0]["channels"]} == {
        "translation", "rotation", "scale",
    }  # fmt: skip


async def test_what_is_held_and_what_doors_do_is_had_of_a_story_in_which_somebody_comes_home(app: FastAPI) -> None:
    theme = "He comes home, slams the cabinet and drinks a glass of wine on the sofa."
    async with calling(app) as client:
        story = moved(app, (await client.post("/v1/stories", json={"theme": theme, "seed": 2})).json())
        file = await client.get(story["links"]["props"])
    assert file.status_code == 200
    document, _ = read_glb(file.content)
    names = " ".join(node["name"] for node in document["nodes"])
    assert "wine" in names
    assert "door" in names


async def test_without_the_library_usd_is_not_provided_and_the_remedy_is_told(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(usd_film, "find_spec", lambda _: None)
    async with calling(app) as client:
        story = await made(app, client)
        problem = check_problem(await client.get(story["links"]["usd"]), 501)
    assert "sims-stories[usd]" in problem["detail"]


async def test_a_film_that_nobody_wants_any_more_is_left(app: FastAPI, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("av")
    monkeypatch.setattr(film_stages, "TOLD_EVERY", 0.0)
    async with calling(app) as client:
        story = await made(app, client)
        film = (await client.post(f"{story['links']['self']}/film")).json()
        assert (await client.delete(film["links"]["self"])).status_code == 204
        with pytest.raises(StoryGone):
            filmer(app).film(film["id"])
        assert (await client.get(film["links"]["self"])).json()["state"] == "absent"
        check_problem(await client.delete(film["links"]["self"]), 404)
        again = (await client.post(f"{story['links']['self']}/film")).json()
        assert again["id"] != film["id"]
        ended(app, again["id"], "ERROR")
        third = (await client.post(f"{story['links']['self']}/film")).json()
        assert third["id"] not in (film["id"], again["id"])


async def test_a_story_that_is_not_there_yet_and_a_service_that_cannot_film_say_so(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with calling(app) as client:
        story = (await client.post("/v1/stories", json={"theme": "He reads."})).json()
        assert "events" in check_problem(await client.post(f"{story['links']['self']}/film"), 409)["detail"]
        ended(app, story["id"], "ERROR")
        assert "failed" in check_problem(await client.post(f"{story['links']['self']}/film"), 409)["detail"]
        ended(app, story["id"], "SUCCESS")
        real = importlib.util.find_spec
        monkeypatch.setattr(films, "find_spec", lambda name: None if name == "av" else real(name))
        problem = check_problem(await client.post(f"{story['links']['self']}/film"), 501)
        assert "sims-stories[video]" in problem["detail"]
        check_problem(await client.post("/v1/stories/nowhere/film"), 404)
