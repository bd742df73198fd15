"""Long scripts over HTTP: the engine's plan, the same for the same seed, and refusals that name the field."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from for_each import for_each
from model_server import ModelServer, failing
from service_app import calling, check_problem, warm_app_on

from planner_service.api.scripts.schemas import EXAMPLE
from planner_service.components import MAX_PLANNED
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_repair import check

pytestmark = pytest.mark.anyio
THEME = "She comes home tired, reads a book on the sofa and falls asleep."


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with warm_app_on(tmp_path_factory.mktemp("long_scripts")) as app:
        yield app


async def ask(app: FastAPI, **body: Any) -> httpx.Response:
    async with calling(app, timeout=60) as client:
        return await client.post("/v1/long-scripts", json=body)


async def test_the_plan_is_the_engines_own_and_can_be_acted_out(app: FastAPI) -> None:
    answer = await ask(app, theme=THEME, seed=3)
    script = LongScript.model_validate_json(answer.content)
    assert script == Pipeline(app.state.parts.shelves).script(StoryRequest(THEME, seed=3))
    assert check(script) == ()
    assert (await ask(app, theme=THEME, seed=3)).content == answer.content


async def test_rooms_and_number_of_short_scripts_are_kept_to(app: FastAPI) -> None:
    script = LongScript.model_validate(
        (await ask(app, theme=THEME, rooms=["bedroom"], short_scripts=1, method="matching")).json()
    )
    assert len(script.short_scripts) == 1
    assert {keyframe.room for keyframe in script.keyframes if keyframe.room} <= {"bedroom"}


async def test_a_script_that_was_just_added_is_planned_with(app: FastAPI) -> None:
    own = EXAMPLE | {"id": "zebra", "summary": "The character rides a zebra through the living room."}
    async with calling(app, timeout=60) as client:
        assert (await client.post("/v1/short-scripts", json=own)).status_code == 201
    theme = "She rides a zebra through the living room."
    script = LongScript.model_validate((await ask(app, theme=theme, method="matching")).json())
    assert [chosen.script.id for chosen in script.short_scripts][:1] == ["zebra"]


@for_each(
    ("body", "pointer"),
    [
        ({"theme": ""}, "/theme"),
        ({"theme": "   "}, "/theme"),
        ({"theme": "... !?"}, "/theme"),
        ({"theme": "xqzt wvbnm plkj"}, "/theme"),
        ({"theme": "A \x07 bell"}, "/theme"),
        ({"theme": "x" * 2001}, "/theme"),
        ({"theme": THEME, "rooms": ["attic"]}, "/rooms/0"),
        ({"theme": THEME, "rooms": ["study"] * 5}, "/rooms"),
        ({"theme": THEME, "short_scripts": 0}, "/short_scripts"),
        ({"theme": THEME, "short_scripts": 13}, "/short_scripts"),
        ({"theme": THEME, "short_scripts": 2}, "/short_scripts"),
        ({"theme": THEME, "seed": -1}, "/seed"),
        ({"theme": THEME, "seed": 2**53}, "/seed"),
        ({"theme": THEME, "seed": True}, "/seed"),
        ({"theme": THEME, "method": "guess"}, "/method"),
        ({"theme": THEME, "mood": "blue"}, "/mood"),
        ({}, "/theme"),
    ],
)
async def test_what_cannot_be_planned_is_refused_by_its_field(app: FastAPI, body: Any, pointer: str) -> None:
    problem = check_problem(await ask(app, **body), 422)
    assert problem["errors"][0]["pointer"] == pointer


async def test_a_language_model_plans_the_beats_where_one_is_set_and_rules_do_what_it_cannot(tmp_path: Path) -> None:
    answers = tmp_path / "answers.json"
    lies = {"skill": "liedown", "emotion": "sad", "caption": "lying down, legs straight", "furniture": "bed"}
    beat = {"text": "gets a letter of glass", "kind": "deed", "emotion": "sad", "serve": "write", "keyframes": [lies]}
    answers.write_text(json.dumps({"a letter of glass": {"beats": [beat]}}), encoding="utf-8")
    with warm_app_on(tmp_path / "data", llm_model=f"scripted:{answers}") as app:
        planned = LongScript.model_validate((await ask(app, theme="She gets a letter of glass.")).json())
        by_rules = LongScript.model_validate((await ask(app, theme=THEME)).json())
    assert [(one.text, one.emotion) for one in planned.beats] == [("gets a letter of glass", "sad")]
    assert [one.skill for one in planned.keyframes] == ["loco", "liedown"]
    assert planned.planner.startswith("llm:")
    assert by_rules.planner == "rules"
    assert any("by rules" in repair for repair in by_rules.repairs)


@pytest.mark.parametrize(("wanted", "status"), [("error", 502), ("rules", 200)])
async def test_a_model_that_refuses_is_an_error_or_done_without_as_settings_say(
    wanted: str, status: int, tmp_path: Path
) -> None:
    key = "sk-test-0123456789abcdef"
    with ModelServer(lambda _: failing(401, {"error": {"message": f"wrong key {key}"}})) as server:
        chosen = {"llm_model": "openai:gpt-x", "llm_base_url": server.url, "llm_api_key": key}
        with warm_app_on(tmp_path, **chosen, llm_on_failure=wanted) as app:
            answer = await ask(app, theme=THEME)
    assert answer.status_code == status
    assert "openai:gpt-x at" in answer.text
    assert "SIMS_LLM_API_KEY" in answer.text
    assert key not in answer.text


async def test_only_so_many_wait_for_a_model_at_once(tmp_path: Path) -> None:
    answers = tmp_path / "answers.json"
    answers.write_text("{}", encoding="utf-8")
    with warm_app_on(tmp_path / "data", llm_model=f"scripted:{answers}") as app:
        for _ in range(MAX_PLANNED):
            assert app.state.parts.planning.acquire(blocking=False)
        problem = check_problem(await ask(app, theme=THEME), 503)
        assert "the language model is busy" in problem["detail"]
        app.state.parts.planning.release()
        for _ in range(2):
            assert (await ask(app, theme=THEME)).status_code == 200
