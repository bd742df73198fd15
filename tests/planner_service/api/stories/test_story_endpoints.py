"""Stories over HTTP where something changes between two looks: deleted meanwhile, asked for again, counted after."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi import FastAPI
from service_app import app_on, calling, check_problem

from planner_service.jobs.story_stages import read_segments
from planner_service.store.story_store import Stories, StoryGone

pytestmark = pytest.mark.anyio
NOOK = {
    "id": "nook",
    "room_type": "study",
    "floor_polygon": [[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]],
    "doors": [{"segment": [[-1.5, -0.4], [-1.5, 0.4]]}],
    "objects": [
        {"id": "armchair_1", "category": "armchair", "position": [0.8, 0, -0.8], "size": [0.8, 0.9, 0.8], "yaw": 0}
    ],
}


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def app(tmp_path: Path) -> Iterator[FastAPI]:
    def add(app: FastAPI) -> None:
        @app.get("/gone")
        def gone() -> None:
            raise StoryGone("that-one")

    with app_on(tmp_path, add) as app:
        yield app


async def test_a_story_that_is_deleted_while_it_is_read_is_not_found(app: FastAPI) -> None:
    async with calling(app) as client:
        problem = check_problem(await client.get("/gone"), 404)
    assert "deleted" in problem["detail"]


def test_segments_that_are_no_longer_there_are_not_an_empty_motion(app: FastAPI) -> None:
    with pytest.raises(StoryGone):
        read_segments(Stories(app.state.parts.engine), "that-one", [0, 1])


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/v1/stories", {"theme": "He reads.", "layouts": ["nook"]}),
        (
            "/v1/motions",
            {"layout_id": "nook", "keyframes": [{"skill": "sitdown", "caption": "sit", "furniture": "armchair"}]},
        ),
    ],
)
async def test_a_key_gives_its_story_though_its_room_is_gone(app: FastAPI, path: str, body: dict[str, object]) -> None:
    headers = {"Idempotency-Key": "once"}
    async with calling(app) as client:
        assert (await client.post("/v1/layouts", json=NOOK)).status_code == 201
        first = await client.post(path, json=body, headers=headers)
        assert first.status_code == 202, first.text
        assert (await client.delete("/v1/layouts/nook")).status_code == 204
        again = await client.post(path, json=body, headers=headers)
        assert (again.status_code, again.json()["id"]) == (202, first.json()["id"])
        assert again.headers["location"] == first.headers["location"]
        check_problem(await client.post(path, json=body), 422)
        other = check_problem(await client.post(path, json=body | {"seed": 1}, headers=headers), 422)
        assert other["errors"][0]["pointer"] == "header:Idempotency-Key"


async def test_a_story_that_is_deleted_before_it_is_made_is_no_longer_counted(app: FastAPI) -> None:
    async with calling(app) as client:
        first, second = [(await client.post("/v1/stories", json={"theme": "He reads."})).json() for _ in range(2)]
        await client.post(first["links"]["cancel"])
        assert (await client.delete(second["links"]["self"])).status_code == 204
        figures = (await client.get("/metrics")).text
    assert 'sims_stories{state="cancelled"} 1.0' in figures
    assert 'sims_stories{state="queued"} 0.0' in figures
