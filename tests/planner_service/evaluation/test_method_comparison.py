"""Methods side by side: likeness of stories, what a model was asked, and films whose names give nothing away."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from motion_backend.language.sentence_encoder import HashingEncoder, Vectors
from planner_service.composition.request import METHODS
from planner_service.evaluation import method_comparison
from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import Alternative, LabelledBeat, LabelledTheme
from planner_service.evaluation.method_comparison import (
    QUESTIONS,
    Method,
    alike,
    compare,
    methods_of,
    sentence_vectors,
    told_in,
    write_pairs,
)
from planner_service.llm.fake_model import ScriptedModel
from planner_service.pipeline import Pipeline, RequestError, Story, StoryRequest

SITS = LabelledBeat(text="sits down", actable=True, shown_by=(Alternative(skill=("sitdown",)),))
LABELS = tuple(
    LabelledTheme(id=name, theme=text, split="tune", beats=(SITS,))
    for name, text in (("a", "She sits down on the sofa."), ("b", "He sits down at the table and reads."))
)
NONSENSE = LabelledTheme(id="n", theme="Zxqv wvzk.", split="tune", refuse=True)


def vectors_of(*texts: str) -> list[Vectors]:
    """Each text as its sentences."""
    return [sentence_vectors(text, HashingEncoder()) for text in texts]


def test_equal_stories_are_wholly_alike_and_others_less() -> None:
    same = vectors_of(*["He eats. He naps."] * 3)
    assert alike(same) == 1
    assert alike(vectors_of("He eats. He naps.", "Snow fell upon Peru.")) < 0.6
    with pytest.raises(ValueError, match=r"^texts: 1 of them"):
        alike(same[:1])


def test_the_order_of_sentences_does_not_change_how_alike_texts_are() -> None:
    assert alike(vectors_of("He eats. She naps! Why?", "Why? She naps! He eats.")) == 1


def test_what_else_a_story_tells_does_not_make_it_tell_a_text_less() -> None:
    text, story = vectors_of("He eats soup.", "She walked about. He eats soup. The room was quiet.")
    assert told_in(text, story) == pytest.approx(1)
    assert told_in(story, text) < 1


def test_every_method_is_there_by_rules_and_by_the_model_where_there_is_one() -> None:
    rules, both = methods_of(Pipeline()), methods_of(Pipeline(model=ScriptedModel([], "m")))
    assert [one.name for one in rules] == list(METHODS)
    assert [one.title for one in both] == [f"{name} by {by}" for by in ("rules", "m") for name in METHODS]


def test_rules_ask_no_model_and_the_same_seed_compares_the_same() -> None:
    method = Method("direct", Pipeline())
    first, again = (compare(method, (*LABELS, NONSENSE), HashingEncoder(), 3) for _ in range(2))
    assert replace(first, seconds=0) == replace(again, seconds=0)
    assert (first.calls, first.tokens, first.forbidden) == (0, 0, 0)
    assert first.acted == 1
    assert 0 < first.alike <= 1


def test_what_a_model_is_asked_is_a_mean_over_themes(monkeypatch: pytest.MonkeyPatch) -> None:
    spent = iter([(2, 50, 1.0), (4, 150, 3.0)])

    def plan(_: Method, label: LabelledTheme, _seed: int) -> method_comparison._Plan:
        return method_comparison._Plan(Judgement(label, None), *next(spent))

    monkeypatch.setattr(method_comparison, "_plan", plan)
    found = compare(Method("auto", Pipeline(model=ScriptedModel([], "m"))), LABELS, HashingEncoder())
    assert (found.calls, found.tokens, found.seconds) == (3, 100, 2)
    assert (found.wrong, found.alike, found.deeds) == (2, 0, 0)


def test_films_are_told_apart_by_the_key_alone_and_a_theme_that_one_cannot_make_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def make(_: Pipeline, request: StoryRequest) -> str:
        if request.theme == LABELS[0].theme and request.method == "direct":
            raise RequestError("no", at="theme")
        return f"{request.theme} {request.method}"

    def write(story: Story, folder: Path, name: str) -> None:
        (folder / f"{name}.txt").write_text(str(story), encoding="utf-8")

    monkeypatch.setattr(Pipeline, "make", make)
    monkeypatch.setattr(method_comparison, "_write_film", write)
    many = [*LABELS, *(LABELS[1].model_copy(update={"id": f"b{number}"}) for number in range(12)), NONSENSE]
    pair = Method("matching", Pipeline()), Method("direct", Pipeline())
    assert list(write_pairs(pair, many, 10, tmp_path)) == ["b", *(f"b{number}" for number in range(9))]
    sheet, key = (
        list(csv.DictReader((tmp_path / name).read_text(encoding="utf-8").splitlines()))
        for name in ("sheet.csv", "key.csv")
    )
    assert (len(sheet), len(key), len(QUESTIONS)) == (20, 10, 5)
    assert all(row[question] == "" for row in sheet for question in QUESTIONS)
    assert not any(one.name in str(row) for one in pair for row in sheet)
    for row in key:
        for letter in "AB":
            assert row[letter].split()[0] in (tmp_path / f"{row['pair']}-{letter}.txt").read_text(encoding="utf-8")
    assert len({row["A"] for row in key}) == 2
