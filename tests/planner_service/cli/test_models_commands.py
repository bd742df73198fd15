"""`--model`, `sims models list` and `sims record`: which model there is, and what it answered."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest
from for_each import for_each
from good_model import answer_to, planned_themes
from model_server import ModelServer, chat
from typer.testing import CliRunner

from planner_service.cli import app
from planner_service.cli.record_command import read_lines
from planner_service.cli.service import EXTRAS
from planner_service.library.library import Shelves
from planner_service.llm.factory import load_model
from planner_service.pipeline import Pipeline, RequestError, StoryRequest
from planner_service.settings import read_settings

RUN = CliRunner()


@pytest.fixture(autouse=True)
def _alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMS_DATA_DIR", str(tmp_path))
    monkeypatch.delenv("SIMS_LLM_MODEL", raising=False)


def test_what_is_set_and_installed_is_listed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    said = RUN.invoke(app, ["models", "list"]).output
    assert "none, rules plan and tell" in said
    assert "no Ollama server answers at none" in said
    assert "llamacpp (weights of your own, in a GGUF file): " in said
    (tmp_path / "answers.json").write_text(json.dumps({"x": "y"}))
    monkeypatch.setenv("SIMS_LLM_MODEL", f"scripted:{tmp_path / 'answers.json'}")
    monkeypatch.setenv("SIMS_LLM_PRICE", "1/2")
    assert "chosen (SIMS_LLM_MODEL, --model): scripted, 1/2 dollars" in RUN.invoke(app, ["models", "list"]).output


@for_each(
    "command",
    [["story", "He sits."], ["extract", "a.txt"], ["scripts", "imitate", "--emotion", "sad", "--room", "study"]],
)
def test_a_model_is_named_for_one_command(command: list[str]) -> None:
    failed = RUN.invoke(app, [*command, "--model", "gpt-5"])
    assert "'gpt-5' is not known" in str(failed.exception)


def test_what_a_model_answered_to_themes_is_played_back_without_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SIMS_LLM_API_KEY", "sk-test-0123456789abcdef")
    theme = planned_themes()["morning"]["theme"]
    (tmp_path / "themes.txt").write_text(f"{theme}\n", encoding="utf-8")
    with ModelServer(lambda asked: chat(json.dumps(answer_to(asked.prompt)), asked.path)) as server:
        monkeypatch.setenv("SIMS_LLM_BASE_URL", server.url)
        asks = ["record", "themes.txt", "--out", "talk.jsonl", "--model", "openai:gpt-x"]
        said = RUN.invoke(app, asks, catch_exceptions=False).output
        asked = len(server.asked)
        assert RUN.invoke(app, asks, catch_exceptions=False).output.endswith("plays them back\n")
        assert len(server.asked) == asked
    assert "1 of 1 themes recorded; SIMS_LLM_MODEL=replay:talk.jsonl plays them back" in said
    settings = read_settings(llm_model="replay:talk.jsonl")
    planned = Pipeline(Shelves(cache=tmp_path), load_model(settings)).plan(StoryRequest(theme))
    assert planned.script.planner == "llm:openai:gpt-x (replayed)"


def test_a_recording_wants_a_model_and_themes(tmp_path: Path) -> None:
    themes = tmp_path / "themes.txt"
    themes.write_text("# ours\n\nHe sits.\n She sleeps. \n", encoding="utf-8")
    assert read_lines(themes) == ["He sits.", "She sleeps."]
    for model in ([], ["--model", "rules"]):
        failed = RUN.invoke(app, ["record", str(themes), "--out", "talk.jsonl", *model])
        assert "there is no model to record" in str(failed.exception)
    themes.write_bytes(b"\xff")
    with pytest.raises(RequestError, match="cannot be read"):
        read_lines(themes)
    themes.write_text("# nothing")
    with pytest.raises(RequestError, match="0 themes"):
        read_lines(themes)


@for_each(
    ("command", "extras"),
    [
        ("mcp", {"mcp"}),
        ("story", {"video", "usd", "llm"}),
        ("play", {"video", "usd"}),
        ("extract", {"video", "asr", "llm"}),
        ("scripts imitate", {"llm"}),
        ("models check", {"llm"}),
    ],
)
def test_help_names_every_extra_that_a_command_needs_and_how_it_is_installed(command: str, extras: set[str]) -> None:
    # Long words are broken at hyphens.
    said = "".join(RUN.invoke(app, [*command.split(), "--help"]).output.split())
    named = set(re.findall(r"\w+", ",".join(re.findall(r'pipinstall"sims-stories\[([\w,]+)\]"', said))))
    assert extras <= named, said
    assert named <= set(EXTRAS)


def test_every_extra_that_is_not_for_developers_is_listed() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(EXTRAS) == set(project["optional-dependencies"]) - {"dev", "docs"}
