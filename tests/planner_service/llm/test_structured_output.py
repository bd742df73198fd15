"""Answers of language models: read, checked, asked for again, and given up clearly."""

from __future__ import annotations

import contextlib
import json

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict

from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.protocol import InvalidAnswerError, ModelError
from planner_service.llm.structured_output import ModelAnswerError, ask, read_answer


class Meal(BaseModel):
    """What is asked for."""

    model_config = ConfigDict(extra="forbid")

    dish: str
    plates: int


SOUP = Meal(dish="soup", plates=2)
JSON = '{"dish": "soup", "plates": 2}'


@for_each(
    "text",
    [
        JSON,
        f"Sure!\n```json\n{JSON}\n```\nEnjoy.",
        f"I think {{soup}} is best, or {{}}. {JSON}",
        f'A draft: {{"dish": "bread", "plates": 1}}. The answer: {JSON}',
    ],
)
def test_json_is_found_whatever_stands_around_it(text: str) -> None:
    assert read_answer(text, Meal) == SOUP


@for_each(
    ("text", "problem"),
    [
        ("", "there is no JSON object in it"),
        ('{"dish": "soup", "pla', "the JSON is not complete"),
        ('{"dish": "soup"}', "plates: Field required"),
        ('{"dish": "soup", "plates": "many"}', "plates: Input should be a valid integer"),
        ('{"dish": "soup", "plates": 2, "spoon": 1}', "spoon: Extra inputs"),
        ('{"a":' * 3000, "the JSON is not complete"),
    ],
)
def test_an_answer_that_does_not_fit_says_why(text: str, problem: str) -> None:
    with pytest.raises(InvalidAnswerError, match=problem) as error:
        read_answer(text, Meal)
    assert error.value.text == text


@tries(100)
@given(st.text(alphabet='{}[]":,dishplates 0123\\', max_size=60))
def test_any_text_is_read_or_refused(text: str) -> None:
    with contextlib.suppress(InvalidAnswerError):
        assert isinstance(read_answer(text, Meal), Meal)


def test_a_model_is_told_what_was_wrong_and_may_mend_it() -> None:
    model = ScriptedModel(["no idea", '{"dish": "soup"}', JSON])
    assert ask(model, "What is for dinner?", Meal) == SOUP
    first, second, third = (call.prompt for call in model.calls)
    assert first == "What is for dinner?"
    assert "no idea" in second
    assert "- there is no JSON object in it" in second
    assert "- plates: Field required" in third
    assert third.startswith("What is for dinner?")


def test_what_a_check_finds_is_told_too() -> None:
    model = ScriptedModel([{"dish": "soup", "plates": 9}, SOUP])
    assert ask(model, "?", Meal, check=lambda meal: ["plates: there are only 4"] if meal.plates > 4 else []) == SOUP
    assert "plates: there are only 4" in model.calls[1].prompt


def test_after_two_repairs_it_is_given_up_clearly() -> None:
    model = ScriptedModel(lambda prompt, schema: "never")  # noqa: ARG005
    with pytest.raises(ModelAnswerError, match=r"scripted gave no usable Meal in 3 attempts; .*no JSON object"):
        ask(model, "?", Meal)
    assert len(model.calls) == 3


def test_a_lost_connection_is_not_asked_again() -> None:
    model = ScriptedModel([ModelError("no connection")])
    with pytest.raises(ModelError, match="no connection"):
        ask(model, "?", Meal)
    assert len(model.calls) == 1


def test_a_scripted_model_answers_from_a_mapping_and_says_when_it_has_no_answer() -> None:
    model = ScriptedModel({"dinner": SOUP, "lunch": json.dumps({"dish": "bread", "plates": 1})}, name="cook")
    assert model.answer("What is for lunch?", Meal, [b"jpeg"]).dish == "bread"
    assert model.calls[0].images == 1
    with pytest.raises(ModelError, match="cook: no answer for a prompt with none of 'dinner', 'lunch'"):
        model.answer("What is for tea?", Meal)
    with pytest.raises(ModelError, match="call 1 wants a Meal, but only 0 answers were given"):
        ScriptedModel([]).answer("?", Meal)
