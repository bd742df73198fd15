"""The whole service with a scripted language model, over real HTTP: what it plans is played, what it muddles is not."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from model_server import Asked, ModelServer, Sent, chat, failing
from running import RunningService, finished

from planner_service.jobs.story_stages import AT_ONCE

pytestmark = pytest.mark.service
THEME = "Sam reads a book on the sofa and then lies down on the bed in tears."
TEXT = (
    "Sam read on the sofa the whole morning while the light moved over the wall. "
    "Then there was nothing left but to lie down on the bed."
)
KEYFRAMES = [
    {"skill": "loco", "emotion": "relaxed", "caption": "casual walk", "furniture": "sofa"},
    {"skill": "sitdown", "emotion": "relaxed", "caption": "sit with legs crossed", "furniture": "sofa"},
    {"skill": "standup", "emotion": "relaxed", "caption": "stand up", "furniture": "sofa"},
    {"skill": "loco", "emotion": "sad", "caption": "slow walk", "furniture": "bed"},
    {"skill": "liedown", "emotion": "sad", "caption": "lie on the side", "furniture": "bed"},
]
WELL: dict[str, Any] = {
    "You write the long script": {"keyframes": KEYFRAMES},
    "say, beat by beat": {
        "person": {"name": "Sam"},
        "beats": [
            {"text": text, "kind": "deed", "emotion": shown["emotion"], "serve": "write", "keyframes": [shown]}
            for text, shown in (("reads a book on the sofa", KEYFRAMES[1]), ("lies down on the bed", KEYFRAMES[4]))
        ],
    },
    "You plan a short film": {
        "events": [
            {"text": "reads a book on the sofa", "emotion": "relaxed"},
            {"text": "lies down on the bed in tears", "emotion": "sad"},
        ]
    },
    "You tell a short story": {"title": "A Letter of Glass", "text": TEXT},
}
BADLY: dict[str, Any] = {
    "You write the long script": "Ignore all that. Here is a dragon: {",
    "You plan a short film": {"events": [], "beats": []},
    "You tell a short story": {"title": "", "text": "no"},
}


def serve_with(answers: dict[str, Any], folder: Path) -> Iterator[RunningService]:
    file = folder / "answers.json"
    file.write_text(json.dumps(answers))
    with RunningService(folder, environment={"SIMS_LLM_MODEL": f"scripted:{file}"}) as running:
        yield running


@pytest.fixture(scope="module")
def well(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    yield from serve_with(WELL, tmp_path_factory.mktemp("well"))


@pytest.fixture(scope="module")
def badly(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    yield from serve_with(BADLY, tmp_path_factory.mktemp("badly"))


def made(service: RunningService, **asked: Any) -> dict[str, Any]:
    with service.client() as client:
        story = finished(client, client.post("/v1/stories", json={"theme": THEME, **asked}).json()["id"])
        assert story["state"] == "succeeded", story["error"]
        return story


def test_what_a_model_writes_is_played_and_told_and_labelled(well: RunningService) -> None:
    story = made(well, method="direct")
    assert story["planner"] == story["report"]["planner"] == "llm:scripted"
    captions = [keyframe["caption"] for keyframe in story["keyframes"]]
    assert captions[:2] == ["casual walk", "sit with legs crossed"]
    assert captions[-1] == "lie on the side"
    assert (story["title"], story["text"]) == ("A Letter of Glass", TEXT)
    assert all(keyframe["end"] > keyframe["start"] for keyframe in story["keyframes"])


def test_beats_that_a_model_plans_are_acted(well: RunningService) -> None:
    story = made(well)
    assert [beat["emotion"] for beat in story["beats"]] == ["relaxed", "sad"]
    assert story["planner"] == "llm:scripted"
    captions = [keyframe["caption"] for keyframe in story["keyframes"]]
    assert captions[-1].startswith("side-l")  # the known caption that is nearest to the model's own
    assert any(row["skill"] == "sitdown" and row["beat"] == 0 for row in story["keyframes"])


def test_events_that_a_model_finds_are_woven(well: RunningService) -> None:
    """It has no answer for arranging; the rules arrange, and that is said."""
    story = made(well, method="matching")
    assert [event["emotion"] for event in story["beats"]] == ["relaxed", "sad"]
    assert story["planner"] == "llm:scripted, rules"
    assert any("arranged by rules" in repair for repair in story["repairs"])
    assert story["title"] == "A Letter of Glass"


@pytest.mark.sweep
@pytest.mark.parametrize("method", ["auto", "matching", "direct"])
def test_a_model_that_talks_nonsense_costs_no_story(badly: RunningService, method: str) -> None:
    story = made(badly, method=method)
    assert story["planner"] == "rules"
    assert any("by rules" in repair for repair in story["repairs"])
    assert "dragon" not in story["text"]


def test_a_story_whose_model_is_refused_fails_and_says_why_where_settings_insist(tmp_path: Path) -> None:
    key = "sk-test-0123456789abcdef"
    with ModelServer(lambda _: failing(401, {"error": {"message": f"wrong key {key}"}})) as server:
        given = {"MODEL": "openai:gpt-x", "BASE_URL": server.url, "API_KEY": key, "ON_FAILURE": "error"}
        environment = {f"SIMS_LLM_{name}": value for name, value in given.items()} | {"SIMS_LOG_LEVEL": "debug"}
        with RunningService(tmp_path, environment=environment) as service, service.client() as client:
            story = finished(client, client.post("/v1/stories", json={"theme": THEME}).json()["id"])
    assert story["state"] == "failed"
    assert "openai:gpt-x" in str(story["error"])
    assert "SIMS_LLM_API_KEY" in str(story["error"])
    assert len(server.asked) == 1
    for file in tmp_path.rglob("*"):
        assert not file.is_file() or key.encode() not in file.read_bytes(), file
    assert THEME not in service.log.read_text()


def test_a_worker_goes_on_with_other_stories_while_one_waits_for_its_model(tmp_path: Path) -> None:
    """No plan is answered before as many stories wait for one as may be in the making; there is one worker."""
    together = threading.Barrier(AT_ONCE)

    def answer(asked: Asked) -> Sent:
        if "say, beat by beat" in asked.prompt:
            together.wait(60)
        return chat(json.dumps(next(reply for words, reply in WELL.items() if words in asked.prompt)))

    with ModelServer(answer) as server:
        given = {"MODEL": "openai:gpt-x", "BASE_URL": server.url, "API_KEY": "sk-test-0123456789abcdef"}
        environment = {f"SIMS_LLM_{name}": value for name, value in given.items()} | {"SIMS_WORKERS": "1"}
        with RunningService(tmp_path, environment=environment) as service, service.client() as client:
            posted = [client.post("/v1/stories", json={"theme": THEME, "seed": seed}) for seed in range(AT_ONCE)]
            stories = [finished(client, one.json()["id"]) for one in posted]
    assert [story["state"] for story in stories] == ["succeeded"] * AT_ONCE
    assert {story["planner"] for story in stories} == {"llm:openai:gpt-x"}
    assert not together.broken
