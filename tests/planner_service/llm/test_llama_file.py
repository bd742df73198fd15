"""A user's own weights: the schema goes along as a grammar, time is bounded, and what is missing is named."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from pydantic import BaseModel

from planner_service.llm import factory
from planner_service.llm.client import ServedModel
from planner_service.llm.factory import load_model
from planner_service.llm.llama_file import LlamaFile
from planner_service.llm.messages import question_of
from planner_service.llm.protocol import ModelError
from planner_service.settings import Settings, SettingsError


class Meal(BaseModel):
    """What is asked for."""

    dish: str


class Llama:
    """What llama-cpp-python offers, as far as it is used."""

    made: list[Any] = []  # noqa: RUF012
    asked: list[dict[str, Any]] = []  # noqa: RUF012
    wait = 0.0

    def __init__(self, path: str, **_: object) -> None:
        self.made.append(path)

    def create_chat_completion(self, **asked: Any) -> Iterator[dict[str, Any]]:
        self.asked.append(asked)
        if "window" in asked["messages"][1]["content"]:
            raise ValueError("Requested tokens (99999) exceed context window of 16384")
        for piece in ("", '{"dish":', ' "soup"}'):
            time.sleep(self.wait)
            yield {"choices": [{"delta": {"content": piece} if piece else {"role": "assistant"}}]}


@pytest.fixture
def file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    library = ModuleType("llama_cpp")
    library.Llama = Llama  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "llama_cpp", library)
    monkeypatch.setattr(Llama, "made", [])
    monkeypatch.setattr(Llama, "asked", [])
    monkeypatch.setattr(Llama, "wait", 0.0)
    path = tmp_path / "small.gguf"
    path.write_bytes(b"GGUF")
    return path


def test_weights_are_read_once_and_the_schema_is_their_grammar(file: Path) -> None:
    model = ServedModel(LlamaFile(file, 0.5)).for_story(7)
    assert model.name == "llamacpp:small.gguf"
    assert Llama.made == []
    assert [model.answer("?", Meal).dish for _ in range(2)] == ["soup", "soup"]
    assert Llama.made == [str(file)]
    asked = Llama.asked[0]
    assert asked["response_format"] == {"type": "json_object", "schema": question_of("?", Meal).schema}
    assert (asked["temperature"], asked["seed"]) == (0.5, 7)
    assert [one["role"] for one in asked["messages"]] == ["system", "user"]


def test_weights_that_take_too_long_are_broken_off(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Llama, "wait", 0.05)
    with pytest.raises(ModelError, match=r"within 0\.01 seconds; SIMS_LLM_TIMEOUT allows more"):
        LlamaFile(file).reply(question_of("?", Meal), 100, 0.01)


def test_what_the_library_stumbles_over_is_told(file: Path) -> None:
    with pytest.raises(ModelError, match=r"llamacpp:small\.gguf gave no answer: Requested tokens"):
        LlamaFile(file).reply(question_of("a window", Meal), 100, 10)
    with pytest.raises(ModelError, match="is shown no pictures"):
        LlamaFile(file).reply(question_of("?", Meal, [b"\xff\xd8\xff"]), 100, 10)


def test_weights_that_are_closed_say_no_more(file: Path) -> None:
    source = LlamaFile(file)
    source.close()
    with pytest.raises(ModelError, match="the service stops"):
        source.reply(question_of("?", Meal), 100, 10)


def test_the_setting_names_the_file_and_what_is_missing(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factory, "find_spec", lambda _: object())
    model = load_model(Settings(_env_file=None, llm_model=f"llamacpp:{file}"))
    assert isinstance(model, ServedModel)
    assert isinstance(model.source, LlamaFile)
    with pytest.raises(SettingsError, match=r"nowhere\.gguf is no file; give the path of a GGUF file"):
        load_model(Settings(_env_file=None, llm_model="llamacpp:nowhere.gguf"))
    monkeypatch.setattr(factory, "find_spec", lambda _: None)
    with pytest.raises(SettingsError, match=r'not installed; install it: pip install "sims-stories\[llamacpp\]"'):
        load_model(Settings(_env_file=None, llm_model=f"llamacpp:{file}"))
