"""The labelled sets are sound, and the yardstick measures what it says; how good the planner is, is not tested here."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.cli import app
from planner_service.evaluation import planning_evaluation
from planner_service.evaluation.labels import (
    Alternative,
    LabelledBeat,
    LabelledTheme,
    Query,
    labelled_queries,
    labelled_themes,
)
from planner_service.evaluation.planning_evaluation import Figure, figure, hits, judged_themes, ranked, reciprocal_rank
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe, ShortScript
from planner_service.themes.beats import ThemeError
from scene_graphs.furniture import is_known
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


def test_every_label_names_a_short_script_that_is_shipped() -> None:
    known = {one.id for one in built_in()}
    assert not {name for query in labelled_queries() for name in query.right} - known


def test_there_are_eighty_queries_and_forty_themes_and_none_is_there_twice() -> None:
    queries, themes = labelled_queries(), labelled_themes()
    assert len(queries) >= 80
    assert len(themes) >= 40
    for labels in (queries, themes):
        assert len({one.id for one in labels}) == len(labels)
    assert len({query.query.lower() for query in queries}) == len(queries)
    assert len({theme.theme.lower() for theme in themes}) == len(themes)


def test_half_of_every_kind_is_held_out() -> None:
    queries = Counter((query.kind, query.split) for query in labelled_queries())
    for kind in {kind for kind, _ in queries}:
        assert queries[kind, "tune"] == queries[kind, "held_out"] >= 10
    themes = Counter((theme.refuse, theme.split) for theme in labelled_themes())
    for refuse in (False, True):
        assert abs(themes[refuse, "tune"] - themes[refuse, "held_out"]) <= 2


def test_what_shows_a_labelled_beat_is_at_furniture_that_there_is() -> None:
    for theme in labelled_themes():
        alternatives = [*theme.forbidden, *(one for beat in theme.beats for one in beat.shown_by)]
        words = {word for one in alternatives for word in one.furniture} - {"floor"}
        assert not {word for word in words if not is_known(word)}, theme.id


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


def test_a_figure_is_summed_over_each_half_and_missed_only_where_it_is_judged() -> None:
    values = [1.0 if query.split == "tune" else 0.5 for query in QUERIES]
    measured = figure("hits", QUERIES, values, lambda part: sum(part) / len(part), 0.8, "held_out")
    assert (measured.all, measured.tune, measured.held_out) == (0.75, 1.0, 0.5)
    assert measured.missed
    assert not replace(measured, judged="tune").missed
    assert not replace(measured, limit=None).missed
    assert replace(measured, limit=0.5, sense="below").missed
    assert not replace(measured, limit=0.51, sense="below").missed


def theme(name: str, split: str, text: str = "She sits down.", **more: object) -> LabelledTheme:
    """A theme of one beat, or one to be refused."""
    sits = LabelledBeat(text="sits down", actable=True, shown_by=(Alternative(skill=("sitdown",)),))
    beats = {} if more.get("refuse") else {"beats": (sits,)}
    return LabelledTheme.model_validate({"id": name, "theme": text, "split": split, **beats, **more})


def planned(text: str) -> LongScript:
    """She sits where the theme says so; what is no English is refused."""
    if "xq" in text:
        raise ThemeError("nothing is understood")
    sitting = PlannedKeyframe(skill="sitdown", caption="sitting still", furniture="chair", beat=0)
    kept = (sitting,) if "sits" in text else (sitting.model_copy(update={"skill": "liedown", "furniture": "bed"}),)
    return LongScript(theme=text, beats=(Beat(text="sits down"),), short_scripts=(), keyframes=kept)


def test_figures_of_beats_are_of_each_half_and_nonsense_that_is_played_counts_against_it() -> None:
    labels = [
        theme("sits", "tune"),
        theme("lies", "held_out", "She does something."),
        theme("noise", "tune", "xq", refuse=True),
        theme("words", "held_out", "table sits", refuse=True),
    ]
    judged = judged_themes(labels, planned)
    shown = {one.name: one for one in (*planning_evaluation.beat_figures(judged),)}
    acted, unasked = shown["beats: actable, acted in order"], shown["screen time: unasked"]
    assert (acted.all, acted.tune, acted.held_out, acted.missed) == (0.5, 1, 0, True)
    assert (unasked.tune, unasked.held_out, unasked.missed) == (0, 1, True)
    assert (shown["nonsense: refused"].tune, shown["nonsense: refused"].held_out) == (1, 0)
    # It says that "sits down" is acted.
    assert shown["beats: all not acted, named as such"].held_out == 0
    misses = {(one.id, one.text) for one in planning_evaluation.theme_misses(judged)}
    assert ("lies", "not acted, and not named: “sits down”") in misses
    assert ("lies", "unasked: liedown “sitting still” at the bed") in misses
    assert ("words", "played: “table sits”") in misses
    assert not {name for name, _ in misses} & {"sits", "noise"}


def test_a_script_that_no_home_can_hold_is_not_executable() -> None:
    judged = judged_themes([theme("sits", "tune")], planned)
    assert planning_evaluation.executable(judged, built_in_index()).all == 1


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
    told = CliRunner().invoke(app, ["evaluate", "planning", "--json", "--show-held-out"])
    answer = json.loads(told.output)
    assert [one["id"] for one in answer["misses"]] == ["the-tune", "the-held_out"]
    assert answer["figures"][0]["missed"] is False
    monkeypatch.setattr(
        planning_evaluation, "evaluate_planning", lambda *_: replace(found, figures=(replace(kept, limit=0.95),))
    )
    assert CliRunner().invoke(app, ["evaluate", "planning"]).exit_code == 1


def test_labels_of_ones_own_are_judged_as_held_out_and_what_is_none_is_named(tmp_path: Path) -> None:
    beat = {"text": "sits down on the sofa", "actable": True, "shown_by": [{"skill": ["sitdown"]}]}
    missed = {"text": "sails round the world", "actable": True, "shown_by": [{"skill": ["liedown"]}]}
    rows = [{"id": "mine", "theme": "She sits down on the sofa. She sails round the world.", "beats": [beat, missed]}]
    labels = tmp_path / "labels.jsonl"
    labels.write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    told = CliRunner().invoke(app, ["evaluate", "planning", "--labels", str(labels), "--json"])
    answer = json.loads(told.output)
    acted = next(one for one in answer["figures"] if one["name"] == "beats: actable, acted in order")
    assert (acted["all"], acted["missed"], told.exit_code, answer["misses"]) == (0.5, True, 1, [])
    shown = CliRunner().invoke(app, ["evaluate", "planning", "--labels", str(labels), "--show-held-out"])
    assert "sails round the world" in shown.output
    assert "tune" not in shown.output
    labels.write_text('{"id": "mine", "theme": "x"}\n', encoding="utf-8")
    refused = CliRunner().invoke(app, ["evaluate", "planning", "--labels", str(labels)])
    assert "line 1 is no labelled theme" in str(refused.exception) + refused.output
    for path in (tmp_path / "none.jsonl", tmp_path):
        refused = CliRunner().invoke(app, ["evaluate", "planning", "--labels", str(path)])
        assert "cannot be read as text" in str(refused.exception) + refused.output
