"""A served language model's budget and memory, without a server: what is spent, and what is never asked twice."""

from __future__ import annotations

import json
import os
import threading
from pathlib import Path

import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

import prompts
from planner_service.llm.answer_cache import Memory
from planner_service.llm.budget import BudgetError, Limits, Spending, Spent
from planner_service.llm.client import ServedModel, for_story, spent_on
from planner_service.llm.messages import Question, Reply, portable, question_of
from planner_service.llm.protocol import Remembering
from planner_service.llm.structured_output import ModelAnswerError, ask


class Meal(BaseModel):
    """What is asked for."""

    dish: str


class Spoken:
    """A source that says what it was given, in turn, the last for ever; and counts."""

    def __init__(self, *texts: str, tokens: tuple[int, int] = (10, 10)) -> None:
        self.name = "spoken"
        self.texts = list(texts)
        self.tokens = tokens
        self.asked: list[tuple[Question, int, float]] = []

    def reply(self, question: Question, tokens: int, seconds: float) -> Reply:
        self.asked.append((question, tokens, seconds))
        return Reply(self.texts.pop(0) if len(self.texts) > 1 else self.texts[0], *self.tokens)

    def close(self) -> None:
        """Nothing is waited for."""


SOUP = '{"dish": "soup"}'


def test_a_story_spends_its_tokens_and_is_then_told_so() -> None:
    source = Spoken(SOUP, tokens=(400, 100))
    model = ServedModel(source, Spending(Limits(story_tokens=1100)))
    assert [model.answer("?", Meal).dish for _ in range(2)] == ["soup", "soup"]
    with pytest.raises(BudgetError, match=r"unnamed: .*spent 1000 of 1100 tokens.*SIMS_LLM_STORY_TOKENS"):
        model.answer("?", Meal)
    assert len(source.asked) == 2
    assert source.asked[1][1] < source.asked[0][1] <= 1100
    assert model.for_story(1).answer("?", Meal).dish == "soup"


def test_a_story_spends_its_dollars_and_is_then_told_so() -> None:
    model = ServedModel(Spoken(SOUP, tokens=(1000, 1000)), Spending(Limits(story_dollars=0.0425, price=(1.0, 20.0))))
    for _ in range(2):
        model.answer("?", Meal)
    assert model.spending.dollars == pytest.approx(0.042)
    with pytest.raises(BudgetError, match=r"0\.0420 of 0\.0425 dollars"):
        model.answer("?", Meal)


def test_what_a_story_spent_is_told_and_parts_of_it_are_differences() -> None:
    model = ServedModel(Spoken(SOUP, tokens=(1000, 1000)), Spending(Limits(price=(1.0, 20.0))))
    assert spent_on(None) is None
    before = spent_on(model)
    model.answer("?", Meal)
    model.answer("?", Meal)
    after = spent_on(model)
    assert before is not None
    assert after is not None
    assert (after.calls, after.tokens) == (2, 4000)
    assert after.dollars == pytest.approx(0.042)
    assert after - before == after
    assert after - after == Spent(dollars=0.0)
    assert str(after).startswith("2 calls, 4000 tokens, 0.0 s, 0.0420 dollars")
    assert "dollars" not in str(spent_on(ServedModel(Spoken(SOUP))))


def test_a_story_waits_so_long_and_no_longer() -> None:
    source = Spoken(SOUP)
    model = ServedModel(source, Spending(Limits(seconds=30, story_seconds=100), seconds=80.0))
    model.answer("?", Meal)
    assert 19 < source.asked[0][2] <= 20
    with pytest.raises(BudgetError, match="SIMS_LLM_STORY_SECONDS"):
        ServedModel(source, Spending(Limits(story_seconds=100), seconds=100.0)).answer("?", Meal)


@tries(60)
@given(st.integers(-100, 10**9), st.integers(-100, 10**9), st.text(max_size=2000), st.integers(1, 10**6))
def test_the_ledger_never_falls_and_an_allowance_never_passes_the_budget(
    tokens_in: int, tokens_out: int, text: str, most: int
) -> None:
    spending, question = Spending(Limits(story_tokens=most)), question_of("?" * 50, Meal)
    before = 0
    for _ in range(3):
        try:
            tokens, _ = spending.allowance(question)
        except BudgetError:
            break
        assert 0 < tokens <= most - spending.tokens
        spending.spend(question, Reply(text, tokens_in, tokens_out))
        assert spending.tokens >= before + question.guess + len(text) // 4
        before = spending.tokens


def test_a_good_answer_is_asked_for_once_a_seed(tmp_path: Path) -> None:
    source = Spoken(SOUP)
    model = ServedModel(source, memory=Memory(tmp_path))
    for seed in (1, 1, 2, 1):
        assert ask(model.for_story(seed), "?", Meal).dish == "soup"
    assert len(source.asked) == 2
    ask(model.for_story(1), "Another?", Meal)
    ask(model.for_story(1), "?", Meal, images=[b"\xff\xd8\xff"])
    assert len(source.asked) == 4


def test_an_answer_that_was_refused_is_not_remembered(tmp_path: Path) -> None:
    source = Spoken("no", '{"dish": "stone"}', SOUP)
    model = ServedModel(source, memory=Memory(tmp_path))
    refuse = lambda meal: ["dish: nobody eats it"] if meal.dish == "stone" else []  # noqa: E731
    assert ask(model, "?", Meal, refuse).dish == "soup"
    assert len(source.asked) == 3
    assert ask(model, "?", Meal, refuse).dish == "soup"
    assert len(source.asked) == 3


def test_what_was_remembered_is_checked_again(tmp_path: Path) -> None:
    source = Spoken(SOUP, '{"dish": "bread"}')
    model = ServedModel(source, memory=Memory(tmp_path))
    ask(model, "?", Meal)
    assert ask(model, "?", Meal, lambda meal: ["no soup"] if meal.dish == "soup" else []).dish == "bread"


def test_nothing_is_remembered_of_a_model_that_never_answers_well(tmp_path: Path) -> None:
    with pytest.raises(ModelAnswerError):
        ask(ServedModel(Spoken("no"), memory=Memory(tmp_path)), "?", Meal)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("row", [b"", b"{", b"[]", b'{"answer": 3}', b"\xff", b'{"a":' * 10_000])
def test_a_spoilt_file_is_only_asked_for_again(row: bytes, tmp_path: Path) -> None:
    source = Spoken(SOUP)
    model = ServedModel(source, memory=Memory(tmp_path))
    ask(model, "?", Meal)
    (file,) = tmp_path.iterdir()
    file.write_bytes(row)
    assert ask(model, "?", Meal).dish == "soup"
    assert len(source.asked) == 2


def test_a_file_of_another_question_is_no_answer(tmp_path: Path) -> None:
    memory = Memory(tmp_path)
    memory.keep("m", "one", 0, SOUP)
    (file,) = tmp_path.iterdir()
    memory.keep("m", "two", 0, '{"dish": "bread"}')
    other = next(path for path in tmp_path.iterdir() if path != file)
    other.write_bytes(file.read_bytes())
    assert memory.recall("m", "two", 0) is None
    assert memory.recall("m", "one", 0) == SOUP


def test_a_folder_keeps_its_bound_and_loses_what_was_not_used_for_longest(tmp_path: Path) -> None:
    memory = Memory(tmp_path, most_bytes=3000)
    for number in range(40):
        memory.keep("m", str(number), 0, "x" * 300)
        for path in tmp_path.iterdir():
            os.utime(path, (path.stat().st_mtime - 10,) * 2)
        memory.recall("m", "0", 0)
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) <= 3000
    assert memory.recall("m", "0", 0) is not None
    assert memory.recall("m", "5", 0) is None
    assert memory.recall("m", "39", 0) is not None


def test_a_folder_that_cannot_be_written_costs_nothing(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert ask(ServedModel(Spoken(SOUP), memory=Memory(blocked / "answers")), "?", Meal).dish == "soup"
    assert "could not be kept" in caplog.text


def test_many_threads_may_share_a_memory(tmp_path: Path) -> None:
    memory = Memory(tmp_path, most_bytes=5000)
    wrong: list[object] = []

    def use(mine: int) -> None:
        for number in range(30):
            memory.keep("m", str(number), 0, f"answer {number}")
            if memory.recall("m", str(number), 0) not in (f"answer {number}", None):
                wrong.append((mine, number))

    threads = [threading.Thread(target=use, args=(mine,)) for mine in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
    assert not list(tmp_path.glob("*.tmp"))


def test_a_prompt_is_named_with_its_version_and_its_content() -> None:
    one = question_of(prompts.render("try_model", furniture="a chair"), Meal)
    other = question_of(prompts.render("try_model", furniture="a table"), Meal)
    assert one.title == other.title == f"try_model@{prompts.read('try_model').version}"
    assert one.digest != other.digest
    assert one.digest != question_of(prompts.render("try_model", furniture="a chair"), Meal, [b"\xff\xd8\xff"]).digest
    assert one.digest == question_of(prompts.render("try_model", furniture="a chair"), Meal).digest


class Tree(BaseModel):
    """It contains itself."""

    branches: list[Tree]


def test_a_schema_that_contains_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="contains itself"):
        portable(Tree.model_json_schema())


def test_a_model_without_a_memory_or_budget_stays_as_it_is() -> None:
    model = ServedModel(Spoken(SOUP))
    assert isinstance(model, Remembering)
    assert model.recall("?", Meal) is None
    assert for_story(None, 1) is None
    assert json.loads(model.answer("?", Meal).model_dump_json()) == {"dish": "soup"}
