"""The labelled sets are sound, and the yardstick measures what it says; how good the planner is, is not tested here."""

from __future__ import annotations

import itertools
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from motion_backend.language.sentence_encoder import HashingEncoder, Vectors
from motion_backend.motion import Skill
from planner_service.cli import app
from planner_service.composition import llm_planner as planned
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.evaluation import planning_evaluation
from planner_service.evaluation.bm25_baseline import KeywordSearch
from planner_service.evaluation.labels import LabelledEvent, LabelledTheme, Query, labelled_queries, labelled_themes
from planner_service.evaluation.planning_evaluation import Figure, figure, hits, ranked, reciprocal_rank
from planner_service.evaluation.story_evaluation import (
    SEEDS,
    RememberingEncoder,
    alike,
    captions_in,
    coverage,
    furniture_in,
    improviser,
    in_order,
    nearness,
    sentence_vectors,
    tell_themes,
    told_in,
)
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import Event, LongScript, Retrieved, ShortScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from scene_graphs.layout_library import built_in_index


def script(name: str, summary: str) -> ShortScript:
    """A short script of one step."""
    step = {"skill": "loco", "caption": "walks about", "furniture": "floor"}
    return ShortScript.model_validate(
        {"id": name, "summary": summary, "emotion": "neutral", "room": "study", "keyframes": [step]}
    )


NAP, MEAL, LETTER = (
    script("nap", "The character naps on the sofa."),
    script("meal", "The character eats a warm soup."),
    script("letter", "The character writes a letter."),
)
QUERIES = tuple(
    Query(id=f"{one.id}-{split.partition('_')[0]}", query=one.id, kind="plain", split=split, right=(one.id,))
    for one in (NAP, MEAL, LETTER)
    for split in ("tune", "held_out")
)


def event(word: str, *plays: str) -> LabelledEvent:
    """A labelled event of one word."""
    return LabelledEvent(words=(word,), emotions=("neutral",), plays=plays or (word,))


def long_script(events: Sequence[str], chosen: Sequence[tuple[int, ShortScript]], *uncovered: str) -> LongScript:
    """A long script that plays these scripts for these events."""
    return LongScript(
        theme="A theme.",
        events=tuple(Event(text=text) for text in events),
        short_scripts=tuple(Retrieved(script=played, event=at, score=1.0) for at, played in chosen),
        keyframes=(),
        uncovered=uncovered,
    )


def test_every_label_names_a_short_script_that_is_shipped() -> None:
    known = {one.id for one in built_in()}
    assert not {name for query in labelled_queries() for name in query.right} - known


def test_there_are_eighty_queries_and_forty_themes_and_none_is_there_twice() -> None:
    queries, themes = labelled_queries(), labelled_themes()
    assert len(queries) >= 80
    assert len(themes) == 40
    for labels in (queries, themes):
        assert len({one.id for one in labels}) == len(labels)
    assert len({query.query.lower() for query in queries}) == len(queries)
    assert len({theme.text.lower() for theme in themes}) == len(themes)


def test_half_of_every_kind_is_held_out() -> None:
    queries = Counter((query.kind, query.split) for query in labelled_queries())
    for kind in {kind for kind, _ in queries}:
        assert queries[kind, "tune"] == queries[kind, "held_out"] >= 10
    themes = Counter(theme.split for theme in labelled_themes())
    assert themes["tune"] == themes["held_out"] == 20


def test_a_labelled_event_has_words_of_its_theme() -> None:
    for theme in labelled_themes():
        assert all(one.told_in(theme.text) for one in theme.events), theme.id


def test_the_themes_have_one_to_six_events() -> None:
    lengths = {len(theme.events) for theme in labelled_themes()}
    assert {1, 6} <= lengths <= set(range(1, 7))


def test_a_perfect_ranking_gets_one_and_a_reversed_one_nothing_at_the_top() -> None:
    order = [NAP.id, MEAL.id, LETTER.id]
    perfect = ranked(QUERIES, lambda query, _: sorted(order, key=lambda name: name != query))
    reversed_ = ranked(QUERIES, lambda query, _: sorted(order, key=lambda name: name == query))
    assert hits(perfect, 1) == hits(perfect, 3) == reciprocal_rank(perfect) == 1
    assert hits(reversed_, 1) == 0
    assert hits(reversed_, 3) == 1
    assert reciprocal_rank(reversed_) == pytest.approx(1 / 3)


def test_a_search_that_finds_nothing_right_scores_nothing() -> None:
    lost = ranked(QUERIES, lambda _query, _k: ["other"] * 50)
    assert {len(one.found) for one in lost} == {10}
    assert hits(lost, 3) == reciprocal_rank(lost) == 0


@given(st.lists(st.lists(st.booleans(), min_size=4, max_size=4), max_size=5))
def test_no_choice_of_events_in_order_is_larger_than_the_one_found(fits: list[list[bool]]) -> None:
    def possible(rows: Sequence[int]) -> bool:
        return any(
            all(fits[row][column] for row, column in zip(rows, columns, strict=True))
            for columns in itertools.combinations_with_replacement(range(4), len(rows))
        )

    found = sorted(in_order(fits))
    assert possible(found)
    largest = max(
        (
            count
            for count in range(len(fits) + 1)
            for rows in itertools.combinations(range(len(fits)), count)
            if possible(rows)
        ),
        default=0,
    )
    assert len(found) == largest


def test_events_count_when_they_are_told_played_and_in_order() -> None:
    labels = (event("naps"), event("soup", "meal"))
    told = ("naps a little", "has soup")
    both = coverage(labels, long_script(told, [(0, NAP), (1, MEAL)]))
    assert [(one.covered, one.played) for one in both] == [(True, ("nap",)), (True, ("meal",))]
    swapped = coverage(labels, long_script(told[::-1], [(0, MEAL), (1, NAP)]))
    assert [one.covered for one in swapped] == [True, False]
    assert [one.hidden for one in swapped] == [False, True]


def test_an_event_played_by_the_wrong_script_is_hidden_and_one_told_as_missing_is_not() -> None:
    (wrong,) = coverage([event("naps")], long_script(["naps"], [(0, MEAL)]))
    assert (wrong.covered, wrong.hidden, wrong.played) == (False, True, ("meal",))
    (listed,) = coverage([event("naps")], long_script(["naps"], [], "naps"))
    assert (listed.covered, listed.hidden, listed.listed) == (False, False, True)


def test_an_emotion_is_right_when_the_event_has_it() -> None:
    (found,) = coverage([event("naps")], long_script(["naps"], []))
    assert found.felt
    (lost,) = coverage([event("naps")], long_script(["eats"], []))
    assert (lost.felt, lost.emotion) == (False, None)


def test_a_stem_begins_a_word_and_an_id_is_whole() -> None:
    assert event("x", "nap").played_by(NAP)
    assert event("x", "writes a").played_by(LETTER)
    assert not event("x", "etter").played_by(LETTER)
    assert event("x", "meal").played_by(MEAL)
    assert not event("x", "mea").played_by(MEAL)


def vectors_of(*texts: str) -> list[Vectors]:
    return [sentence_vectors(text, HashingEncoder()) for text in texts]


def test_equal_stories_are_wholly_alike_and_others_less() -> None:
    same = vectors_of(*["He eats. He naps."] * 3)
    assert alike(same) == 1
    assert alike(vectors_of("He eats. He naps.", "Snow fell upon Peru.")) < 0.6
    with pytest.raises(ValueError, match=r"^texts: 1 of them"):
        alike(same[:1])


def test_the_order_of_sentences_does_not_change_how_alike_texts_are() -> None:
    assert alike(vectors_of("He eats. She naps! Why?", "Why? She naps! He eats.")) == 1


def test_what_else_a_story_tells_does_not_take_it_from_its_theme() -> None:
    theme, story = vectors_of("He eats soup.", "She walked about. He eats soup. The room was quiet.")
    assert told_in(theme, story) == pytest.approx(1)
    assert told_in(story, theme) < 1


def test_a_story_is_nearer_to_its_own_theme_than_to_those_about_other_things() -> None:
    themes = vectors_of("He eats soup.", "She naps on the sofa.", "They write a letter.")
    assert [nearness(themes[own], themes, own) for own in range(3)] == [1, 1, 1]
    assert nearness(themes[0], themes, 1) < 1


def test_a_remembering_encoder_gives_the_same_vectors_and_makes_each_once() -> None:
    class Counting(HashingEncoder):
        made = 0

        def encode(self, texts: Sequence[str]) -> np.ndarray:
            self.made += len(texts)
            return super().encode(texts)

    inside = Counting()
    encoder = RememberingEncoder(inside)
    texts = ["a nap", "a meal", "a nap"]
    assert np.array_equal(encoder.encode(texts), HashingEncoder().encode(texts))
    encoder.encode(["a meal"])
    assert inside.made == 2
    assert encoder.encode([]).shape[0] == 0


def test_keywords_find_the_summary_with_the_rarest_shared_word() -> None:
    search = KeywordSearch([NAP, MEAL, LETTER])
    assert search.search("the soup", 3)[0] == "meal"
    assert search.search("nothing shared here", 2) == ["letter", "meal"]


def test_a_figure_is_summed_over_each_half_and_missed_only_where_it_is_judged() -> None:
    values = [1.0 if query.split == "tune" else 0.5 for query in QUERIES]
    measured = figure("hits", QUERIES, values, lambda part: sum(part) / len(part), 0.8, "held_out")
    assert (measured.all, measured.tune, measured.held_out) == (0.75, 1.0, 0.5)
    assert measured.missed
    assert not replace(measured, judged="tune").missed
    assert not replace(measured, limit=None).missed
    assert replace(measured, limit=0.5, sense="below").missed
    assert not replace(measured, limit=0.51, sense="below").missed


def test_the_improviser_writes_the_same_for_a_seed_and_its_answer_is_used() -> None:
    theme = "A woman sits down with a book, then she sleeps."
    library = ScriptLibrary((NAP,), Features(HashingEncoder()))

    def written(seed: int) -> LongScript:
        asked = Request(seed=seed, method="direct")
        return compose(theme, library, asked, improviser(theme, seed), insist=True)

    assert written(1) == written(1)
    assert written(1).planner == "llm:improviser"
    assert len({written(seed).keyframes for seed in SEEDS}) > 1


def test_the_improviser_chooses_among_what_the_prompt_offers() -> None:
    model = improviser("A woman sits down with a book, then she sleeps.", 3)
    chosen = planned.direct(model, "A woman sits down with a book, then she sleeps.")
    prompt = model.calls[0].prompt
    captions, furniture = captions_in(prompt), furniture_in(prompt)
    assert {Skill.LOCO, Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH} <= captions.keys()
    assert {"sofa", "dining table"} <= set(furniture)
    assert all(one.caption in captions[one.skill] and one.furniture in (*furniture, "floor") for one in chosen)


def test_themes_are_told_by_every_seed_and_one_that_nobody_understands_is_lost() -> None:
    library = ScriptLibrary((NAP, MEAL, LETTER), Features(HashingEncoder()))
    labels = [
        LabelledTheme(id="nap", text="She naps on the sofa.", split="tune", events=(event("naps", "nap"),)),
        LabelledTheme(id="lost", text="Zxqv wvzk.", split="held_out", events=(event("zxqv"),)),
    ]
    told, lost = tell_themes(labels, library, built_in_index())
    assert [one.script.seed for one in told.woven] == list(SEEDS)
    assert all(one.valid and one.coverage[0].covered for one in told.woven)
    assert (told.fault, lost.woven, lost.nearness) == ("", (), ())
    figures = {
        one.name: one
        for one in (
            *planning_evaluation.coverage_figures([told, lost]),
            *planning_evaluation.variety_figures([told, lost]),
        )
    }
    assert figures["themes: valid"].tune == figures["events: covered in order"].tune == 1
    assert figures["themes: valid"].held_out == figures["themes: executable"].held_out == 0
    assert figures["events: hidden"].held_out == 1
    assert figures["nearer to its theme: least story"].held_out == 0
    assert planning_evaluation.theme_misses([lost])[0].text == "cannot be acted: the theme was not understood"


def test_the_command_ends_with_one_where_a_limit_is_missed_and_keeps_held_out_misses_to_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    misses = tuple(
        planning_evaluation.Miss(split, f"the-{split}", "“naps” is not there") for split in ("tune", "held_out")
    )
    kept = Figure("a share", 0.9, 0.9, 0.9, limit=0.8)
    found = planning_evaluation.Evaluation((kept,), misses, "hashing", 3)
    monkeypatch.setattr(planning_evaluation, "evaluate_planning", lambda *_: found)
    monkeypatch.setattr("motion_backend.language.sentence_encoder.load_encoder", lambda **_: HashingEncoder())
    shown = CliRunner().invoke(app, ["evaluate", "planning"])
    assert (shown.exit_code, "the-tune" in shown.output, "the-held_out" in shown.output) == (0, True, False)
    told = CliRunner().invoke(app, ["evaluate", "planning", "--json", "--all"])
    answer = json.loads(told.output)
    assert [one["id"] for one in answer["misses"]] == ["the-tune", "the-held_out"]
    assert answer["figures"][0]["missed"] is False
    monkeypatch.setattr(
        planning_evaluation, "evaluate_planning", lambda *_: replace(found, figures=(replace(kept, limit=0.95),))
    )
    assert CliRunner().invoke(app, ["evaluate", "planning"]).exit_code == 1
