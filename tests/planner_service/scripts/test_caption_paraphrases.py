"""Caption synonyms: a language model's other words for captions keep the motion and its sides, and lie in one file."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from for_each import for_each
from pydantic import BaseModel

from motion_backend.motion import Skill
from planner_service.llm.fake_model import Answer, ScriptedModel
from planner_service.llm.protocol import ModelError
from planner_service.scripts.caption_paraphrases import (
    MAX_QUESTIONS,
    all_synonyms,
    fault_of,
    read_synonyms,
    rephrase,
    write_synonyms,
)
from planner_service.scripts.captions import captions, synonyms
from planner_service.scripts.script_library import LibraryError

WAYS = ("{} at ease", "{} without any haste", "calmly: {}", "{} in a quiet manner", "{} just so")


def numbered(prompt: str) -> dict[int, str]:
    """The captions that a prompt asks for."""
    listed = prompt.split('<data name="captions">')[1].split("</data>")[0]
    return {int(number): caption for number, caption in re.findall(r"^(\d+)\. (.+)$", listed, re.MULTILINE)}


def answer_well(prompt: str, _schema: type[BaseModel]) -> Answer:
    said = [{"number": n, "phrases": [way.format(one) for way in WAYS]} for n, one in numbered(prompt).items()]
    return {"captions": said}


def test_every_caption_that_the_body_knows_gets_five_other_ways_to_say_it() -> None:
    known = captions()
    every = [caption for some in known.values() for caption in some]
    made = rephrase(ScriptedModel(answer_well), known, every)
    assert (made.missing, made.notes) == ((), ())
    phrases = [phrase for some in made.synonyms.values() for five in some.values() for phrase in five]
    assert len(phrases) == len(set(phrases)) == 5 * len(every)
    assert not set(phrases) & set(every)


@for_each(
    ("phrase", "caption", "skill", "says"),
    [
        ("touch with the right hand", "touch with the left hand", "touch", "right"),
        ("touch it", "touch with the left hand", "touch", "no side"),
        ("touch with both hands", "touch with the left hand", "touch", "both"),
        ("the right hand on the left knee", "left hand on the right knee", "sitdown", "right and left"),
        ("stand up from the chair", "sit upright", "sitdown", "standup"),
        ("lying in the chair", "sit upright", "sitdown", "liedown"),
        ("walk to the chair", "sit upright", "sitdown", "loco"),
        ("x" * 201, "sit upright", "sitdown", "201 letters"),
        ("", "sit upright", "sitdown", "0 letters"),
        ("...!", "sit upright", "sitdown", "plain text"),
        ("sit\x1b[2J upright", "sit upright", "sitdown", "plain text"),
    ],
)
def test_a_phrase_that_means_another_motion_is_refused(phrase: str, caption: str, skill: str, says: str) -> None:
    assert says in str(fault_of(phrase, caption, skill))


def test_captions_and_the_synonyms_that_are_shipped_could_be_a_models() -> None:
    for skill, some in captions().items():
        assert skill in set(Skill)
        for caption in some:
            for phrase in (caption, *synonyms()[skill][caption]):
                assert fault_of(phrase, caption, skill) is None, (phrase, caption)


def test_what_is_refused_is_told_and_asked_for_again() -> None:
    good = ["sit bolt upright", "an upright seat", "seated upright"]
    model = ScriptedModel(
        [
            {"captions": [{"number": 0, "phrases": ["sit upright", "Sit, upright!", "lie down flat", *good[:2]]}]},
            {"captions": [{"number": 7, "phrases": ["nobody asked"]}, {"number": 0, "phrases": [good[1], good[2]]}]},
        ]
    )
    made = rephrase(model, {"sitdown": ["sit upright"]}, (), count=3)
    assert made.synonyms == {"sitdown": {"sit upright": good}}
    assert "lie down flat (for: sit upright): it tells of liedown" in model.calls[1].prompt


def test_a_phrase_that_is_another_caption_or_known_phrase_is_not_taken() -> None:
    model = ScriptedModel([{"captions": [{"number": 0, "phrases": ["a known one"]}]}] * MAX_QUESTIONS)
    made = rephrase(model, {"touch": ["touch"]}, ["A known one"], count=1)
    assert (made.synonyms, made.missing) == ({}, ("touch",))
    assert len(model.calls) == MAX_QUESTIONS


def test_what_was_got_is_kept_when_the_model_then_fails() -> None:
    first = {"captions": [{"number": n, "phrases": [f"way {n} of a batch"]} for n in range(12)]}
    many = [f"caption {'abcdefghijklmnopqrstuvwxyz'[n]}" for n in range(26)]
    made = rephrase(ScriptedModel([first, ModelError("gone")]), {"touch": many}, (), count=1)
    assert len(made.synonyms["touch"]) == 12
    assert list(made.missing) == many[12:]
    assert made.notes == ("asked no further: gone",)
    with pytest.raises(ModelError, match="gone"):
        rephrase(ScriptedModel([ModelError("gone")]), {"touch": many}, ())


def test_the_file_holds_what_was_there_and_what_is_new(tmp_path: Path) -> None:
    file = tmp_path / "data" / "caption_synonyms.json"
    assert read_synonyms(file) == {}
    write_synonyms(file, {"touch": {"a": ["b"], "c": ["d"]}})
    write_synonyms(file, {"touch": {"a": ["é"]}, "loco": {"e": ["f"]}})
    wanted: dict[str, Any] = {"touch": {"a": ["é"], "c": ["d"]}, "loco": {"e": ["f"]}}
    assert read_synonyms(file) == json.loads(file.read_text(encoding="utf-8")) == wanted
    assert [one.name for one in file.parent.iterdir()] == [file.name]


def test_a_users_synonyms_come_behind_those_that_are_shipped(tmp_path: Path) -> None:
    file = tmp_path / "caption_synonyms.json"
    assert all_synonyms(file) == synonyms()
    first = synonyms()["getup"]["get up"]
    write_synonyms(file, {"getup": {"get up": [first[0], "leave the bed at last"]}, "touch": {"my own": ["mine"]}})
    merged = all_synonyms(file)
    assert merged["getup"]["get up"] == [*first, "leave the bed at last"]
    assert merged["touch"]["my own"] == ["mine"]


@pytest.mark.parametrize("content", ["{", "[]", '{"touch": []}', '{"touch": {"a": 3}}', "[" * 100_000, "\ud800"])
def test_a_file_of_something_else_is_refused_and_left_as_it_is(tmp_path: Path, content: str) -> None:
    file = tmp_path / "caption_synonyms.json"
    data = content.encode("utf-8", "surrogatepass")
    file.write_bytes(data)
    with pytest.raises(LibraryError, match=r"^caption_synonyms\.json: .* mend it"):
        write_synonyms(file, {"touch": {"a": ["b"]}})
    assert file.read_bytes() == data
