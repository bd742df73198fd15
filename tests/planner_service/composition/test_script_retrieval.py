"""Matching: a short script for every event that some script is about, none twice, in the rooms that are asked for."""

from __future__ import annotations

from functools import cache

import pytest
from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.composition.request import Record, Request
from planner_service.composition.script_retrieval import match
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import Beat, LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.themes.beats import ThemeError

THEME = "She reads a book, waters the plants and falls asleep."
BEATS = tuple(Beat(text=text) for text in ("reads a book", "waters the plants", "falls asleep"))


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def matched(*beats: Beat, **asked: object) -> LongScript:
    request = Request(method="matching", **asked)  # type: ignore[arg-type]
    return match(THEME, beats or BEATS, library(), request, None, Record())


@for_each("count", [1, 2, 3, 7, 12])
def test_as_many_short_scripts_are_used_as_are_asked_for_and_none_twice(count: int) -> None:
    script = matched(short_scripts=count)
    ids = [chosen.script.id for chosen in script.short_scripts]
    assert len(ids) == len(set(ids)) == count
    served = [chosen.beat for chosen in script.short_scripts]
    assert served == sorted(served)
    assert len(set(served)) == min(count, 3)
    assert [not beat.why for beat in script.beats] == [place in served for place in range(3)]


def test_the_best_answered_events_are_played_where_scripts_are_few() -> None:
    script = matched(Beat(text="gazes at something"), Beat(text="waters the plants"), short_scripts=1)
    assert [chosen.beat for chosen in script.short_scripts] == [1]
    assert script.beats[0].why


def test_what_no_script_is_about_and_what_is_not_done_is_named_and_not_played() -> None:
    odd = Beat(text="Quantum chromodynamics governs black holes")
    script = matched(*BEATS[:1], odd, Beat(text="falls asleep", kind="undone"))
    assert {chosen.beat for chosen in script.short_scripts} == {0}
    assert [beat.why for beat in script.beats] == ["", "no short script is about it", "it is not done"]


def test_rooms_are_kept_to_and_a_room_that_is_named_is_preferred() -> None:
    asked = matched(rooms=("living room", "study"), short_scripts=9)
    assert {chosen.script.room for chosen in asked.short_scripts} <= {"living_room", "study"}
    for name, room in (("study", "study"), ("living room", "living_room")):
        named = matched(Beat(text=f"reads a book in the {name}"))
        assert named.short_scripts[0].script.room == room


def test_a_seed_gives_the_same_script_again_and_seeds_choose_among_near_ties() -> None:
    assert matched(seed=3) == matched(seed=3)
    chosen = {tuple(one.script.id for one in matched(seed=seed).short_scripts) for seed in range(8)}
    assert len(chosen) > 1


def test_where_no_event_is_understood_the_theme_is_refused_by_its_words() -> None:
    with pytest.raises(ThemeError, match="asdf qwer"):
        matched(Beat(text="asdf qwer zxcv"))
