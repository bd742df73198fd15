"""A whole service whose bodies are moved by somebody else's package: that of docs/backends.md."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import httpx
import pytest
from forking import Forked
from running import SHORT, RunningService, finished
from stranger import install
from test_service_inputs import (  # noqa: F401 - they are tests here as well, on the service below
    SIT,
    WALK,
    refused,
    test_a_home_that_was_had_can_be_played_in_again,
    test_a_motion_that_cannot_be_is_refused_at_once,
    test_a_room_that_lacks_what_is_needed_fails_with_the_reason,
    test_frames_of_any_range_are_those_of_the_whole,
    test_keyframes_of_ones_own_are_acted_out_and_not_told,
    test_ranges_that_cannot_be_are_refused,
    test_what_never_changes_need_not_be_sent_twice,
)

pytestmark = pytest.mark.service


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """That of a machine where the stranger's package is installed."""
    folder = install(tmp_path_factory.mktemp("site"))
    return {"PYTHONPATH": os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")]))}


@pytest.fixture(scope="module")
def client(environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    given = environment | {"SIMS_BACKEND": "ghost"}
    with RunningService(tmp_path_factory.mktemp("ghosts"), environment=given) as service, service.client() as client:
        yield client


@pytest.fixture(scope="module")
def story(client: httpx.Client) -> dict[str, Any]:
    made = finished(client, client.post("/v1/stories", json={"theme": SHORT}).json()["id"])
    assert made["state"] == "succeeded", made["error"]
    return made


def test_a_story_is_made_by_the_backend_of_the_settings(client: httpx.Client, story: dict[str, Any]) -> None:
    assert story["backend"] == "ghost"
    assert story["report"]["motion"]["reached"] == story["report"]["motion"]["keyframes"] > 0
    assert client.get(story["links"]["film"]).content[:4] == b"glTF"


def test_a_request_chooses_among_all_backends(client: httpx.Client) -> None:
    asked = {"keyframes": [WALK, SIT], "layout_id": "living-room-0016", "backend": "procedural"}
    ours = finished(client, client.post("/v1/motions", json=asked).json()["id"])
    assert (ours["backend"], ours["state"]) == ("procedural", "succeeded")
    detail = refused(client.post("/v1/stories", json={"theme": SHORT, "backend": "magic"}), "/backend")
    assert detail == "Input should be 'procedural', 'physics', 'diffusion', 'broken' or 'ghost'"


def test_the_description_names_all_backends(client: httpx.Client) -> None:
    names = ["procedural", "physics", "diffusion", "broken", "ghost"]
    schemas = client.get("/openapi.json").json()["components"]["schemas"]
    for ask in ("StoryAsk", "MotionAsk"):
        named = schemas[ask]["properties"]["backend"]["anyOf"]
        assert {"type": "string", "enum": names} in named


def test_a_backend_that_cannot_be_loaded_is_a_503_that_says_why(client: httpx.Client) -> None:
    answer = client.post("/v1/stories", json={"theme": SHORT, "backend": "broken"})
    assert answer.status_code == 503
    assert int(answer.headers["retry-after"]) > 0
    assert answer.headers["content-type"] == "application/problem+json"
    assert "'broken' cannot be loaded" in answer.json()["detail"]
    assert "no_such_library" in answer.json()["detail"]


def test_a_backend_that_is_missing_or_broken_is_one_line_on_a_terminal(
    environment: dict[str, str], tmp_path: Path
) -> None:
    said = {"broken": "cannot be loaded", "magic": "is none of procedural, "}
    with Forked(environment["PYTHONPATH"]) as forked:
        for words, name in product((["serve", "--port", "0"], ["story", SHORT]), said):
            given = os.environ | environment | {"SIMS_BACKEND": name, "SIMS_DATA_DIR": str(tmp_path)}
            code, output, error = forked.run(words, tmp_path, given)
            assert code == 2
            assert b"ready at" not in output
            (line,) = error.decode().splitlines()
            assert line.startswith("sims: ")
            assert f"{name!r} {said[name]}" in line
