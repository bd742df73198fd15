"""The cast over HTTP: who can play, who does, and what is refused."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi import FastAPI
from service_app import app_on, calling, check_problem

from motion_backend.body.cast import GIVEN, cast

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def app(tmp_path: Path) -> Iterator[FastAPI]:
    with app_on(tmp_path, lambda _: None) as app:
        yield app


async def test_all_who_can_play_and_all_words_are_listed(app: FastAPI) -> None:
    async with calling(app) as client:
        shown = (await client.get("/v1/cast")).json()
    assert [one["name"] for one in shown["members"]] == [one.name for one in cast().member]
    assert set(shown["words"]) == set(GIVEN)
    assert "pyjamas" in shown["words"]["outfit"]


async def test_a_story_shows_who_plays_it_from_the_beginning(app: FastAPI) -> None:
    async with calling(app) as client:
        read = (await client.post("/v1/stories", json={"theme": "A girl of six jumps on the sofa."})).json()
        given = {"member": "nora", "outfit": "nurse"}
        asked = (await client.post("/v1/stories", json={"theme": "The phone rings.", "character": given})).json()
    assert (read["character"]["member"], read["character"]["age"], read["character"]["height"]) == (
        "mia",
        "child",
        1.17,
    )
    assert asked["character"] | given == asked["character"]
    assert (asked["character"]["name"], asked["character"]["pronouns"]) == ("Nora", "she")


@pytest.mark.parametrize(
    ("character", "pointer"),
    [
        ({"member": "gandalf"}, "/character/member"),
        ({"hair_color": "blue"}, "/character/hair_color"),
        ({"member": "nora", "pronouns": "he"}, "/character/pronouns"),
        ({"age": "child", "height": 1.9}, "/character/height"),
        ({"height": 1.0}, "/character/height"),
        ({"hat": "red"}, "/character/hat"),
    ],
)
async def test_what_nobody_can_be_is_refused_where_it_stands(
    app: FastAPI, character: dict[str, object], pointer: str
) -> None:
    async with calling(app) as client:
        answer = await client.post("/v1/stories", json={"theme": "She reads.", "character": character})
    assert [one["pointer"] for one in check_problem(answer, 422)["errors"]] == [pointer]
