"""Conversations with a language model, recorded to a file and played back."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from pydantic import BaseModel

import prompts
from planner_service.llm.client import ServedModel
from planner_service.llm.messages import Question, Reply
from planner_service.llm.protocol import ModelError
from planner_service.llm.replay_model import Line, Recorder, RecordingError, Replay
from planner_service.llm.structured_output import ask

JPEG = b"\xff\xd8\xff\xe0picture"


class Meal(BaseModel):
    """What is asked for."""

    dish: str


class Cook:
    """A source that says no once, and then soup."""

    name = "openai:cook"

    def __init__(self) -> None:
        self.asked = 0

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:  # noqa: ARG002
        self.asked += 1
        return Reply('{"dish": "soup"}' if "refused" in question.prompt else "no ☕", 7, 3)

    def close(self) -> None:
        """Nothing is waited for."""


def prompt(furniture: str = "a chair") -> str:
    return prompts.render("try_model", furniture=furniture)


def record(path: Path, cook: Cook | None = None) -> Cook:
    cook = cook or Cook()
    assert ask(ServedModel(Recorder(path, cook)), prompt(), Meal, images=[JPEG]).dish == "soup"
    return cook


def test_a_recorded_conversation_is_played_back_whole(tmp_path: Path) -> None:
    path = tmp_path / "new" / "talk.jsonl"
    assert record(path).asked == 2
    model = ServedModel(Replay(path))
    assert ask(model, prompt(), Meal, images=[JPEG]).dish == "soup"
    assert model.name == "openai:cook (replayed)"
    assert model.spending.tokens > 0


def test_the_same_conversation_gives_the_same_bytes(tmp_path: Path) -> None:
    record(tmp_path / "a.jsonl")
    record(tmp_path / "b.jsonl")
    assert (tmp_path / "a.jsonl").read_bytes() == (tmp_path / "b.jsonl").read_bytes()
    rows = [json.loads(line) for line in (tmp_path / "a.jsonl").read_text().splitlines()]
    assert [row["prompt"].split("@")[0] for row in rows] == ["try_model", "repair_answer"]
    assert all(set(row) == set(Line.model_fields) for row in rows)
    assert b"picture" not in (tmp_path / "a.jsonl").read_bytes()


def test_recording_goes_on_where_it_was_and_asks_nothing_twice(tmp_path: Path) -> None:
    path = tmp_path / "talk.jsonl"
    record(path)
    before = path.read_bytes()
    assert record(path).asked == 0
    assert path.read_bytes() == before


def test_a_miss_names_what_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "talk.jsonl"
    record(path)
    model = ServedModel(Replay(path))
    version = prompts.read("try_model").version
    said = rf"no answer of openai:cook to try_model@{version} \([0-9a-f]{{12}}\); .*other content.*record:"
    with pytest.raises(RecordingError, match=said):
        ask(model, prompt("a table"), Meal, images=[JPEG])
    with pytest.raises(RecordingError, match="other content"):
        ask(model, prompt(), Meal)
    with pytest.raises(RecordingError, match=r"unnamed .*it has repair_answer@\d, try_model@\d"):
        ask(model, "What is for dinner?", Meal)


def test_another_version_of_a_prompt_is_a_miss_that_names_the_recorded_one(tmp_path: Path) -> None:
    path = tmp_path / "talk.jsonl"
    record(path)
    newer = prompts.Filled(str(prompt()), "try_model", 99)
    with pytest.raises(RecordingError, match=r"to try_model@99 \(.*\); it has try_model@1"):
        ask(ServedModel(Replay(path)), newer, Meal, images=[JPEG])


def test_a_file_of_several_models_wants_one_to_be_named(tmp_path: Path) -> None:
    path = tmp_path / "talk.jsonl"
    record(path)
    other = Cook()
    other.name = "openai:baker"
    record(path, other)
    with pytest.raises(RecordingError, match=r"one model; choose it as replay:.*=MODEL; there are .*baker, .*cook"):
        Replay(path)
    with pytest.raises(RecordingError, match=r"does not hold answers of openai:smith"):
        Replay(path, "openai:smith")
    assert Replay(path, "openai:cook").name == "openai:cook (replayed)"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it is empty"), ("{", "line 1: .*JSON"), ("{}", "line 1: model: Field required"), ("[1]", "line 1"),
        ('{"a":' * 90_000, "line 1"), ('\n\n{"model": 3}', "line 3"),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_refused_with_its_line(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "talk.jsonl"
    path.write_text(text)
    with pytest.raises(RecordingError, match=said) as error:
        Replay(path)
    assert isinstance(error.value, ModelError)
    assert len(str(error.value)) < 1000


def test_a_file_that_is_not_there_or_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="cannot be read"):
        Replay(tmp_path / "nothing.jsonl")
    (tmp_path / "folder").mkdir()
    with pytest.raises(RecordingError, match="folder cannot be"):
        Recorder(tmp_path / "folder", Cook())
