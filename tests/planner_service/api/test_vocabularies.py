"""The words of scripts over HTTP are those that the engine knows."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from service_app import app_on, calling, check_problem

from motion_backend.emotion_words import emotion_of
from motion_backend.motion import Emotion, Skill
from planner_service.scripts.captions import captions
from scene_graphs.furniture import affordances, is_known

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def app(tmp_path: Path) -> Iterator[FastAPI]:
    with app_on(tmp_path) as app:
        yield app


async def test_every_word_of_a_keyframe_can_be_looked_up(app: FastAPI) -> None:
    async with calling(app) as client:

        async def items(path: str) -> list[dict[str, Any]]:
            answer = await client.get(f"/v1/{path}")
            assert answer.status_code == 200, answer.text
            return list(answer.json()["items"])

        known = [(one["skill"], one["caption"]) for one in await items("captions")]
        assert known == [(skill.value, text) for skill in Skill for text in captions()[skill.value]]
        assert {one["skill"] for one in await items("captions?skill=touch")} == {"touch"}
        assert {one["skill"] for one in await items("captions?skill=sit down")} == {"sitdown"}
        (clapping, seated) = await items("captions?q=applaud")
        assert clapping["caption"] == "clapping hands"
        assert "applaud" in clapping["shows"]
        assert clapping["others"]
        assert seated["skill"] == "sitdown"
        emotions = await items("emotions")
        assert [one["emotion"] for one in emotions] == list(Emotion)
        wrong = [word for one in emotions for word in one["words"] if emotion_of(word) != one["emotion"]]
        assert not wrong
        seats = await items("furniture?affords=sit")
        assert {"sofa", "chair"} <= {one["word"] for one in seats}
        assert all(is_known(one["word"]) and "sit" in affordances(one["word"]) for one in seats)
        assert len(await items("furniture")) > len(seats)
        assert {one["skill"]: one["needs"] for one in await items("skills")} == {
            "loco": None, "sitdown": "sit", "standup": None, "getup": None, "liedown": "lie", "touch": "touch",
        }  # fmt: skip
        assert [one["backend"] for one in await items("backends") if one["default"]] == ["procedural"]
        problem = check_problem(await client.get("/v1/captions?skill=hop"), 422)
    assert problem["errors"][0]["pointer"] == "?skill"


@pytest.mark.parametrize(
    ("skill", "caption"),
    [("touch", "pouring with the right hand"), ("sit down", "writing at the table, right hand moving")],
)
async def test_a_caption_is_shown_by_keyframes_that_can_be_posted_as_they_are(
    app: FastAPI, skill: str, caption: str
) -> None:
    async with calling(app) as client:
        answer = await client.get("/v1/captions/example", params={"skill": skill, "caption": caption})
        assert answer.status_code == 200, answer.text
        example = answer.json()
        assert example["keyframes"][-1]["caption"] == caption
        posted = await client.post("/v1/motions", json=example)
        assert posted.status_code == 202, posted.text


async def test_a_caption_of_another_skill_has_no_example(app: FastAPI) -> None:
    async with calling(app) as client:
        asked = {"skill": "liedown", "caption": "clapping hands"}
        problem = check_problem(await client.get("/v1/captions/example", params=asked), 422)
    assert problem["errors"][0]["pointer"] == "?caption"
