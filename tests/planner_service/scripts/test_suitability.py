"""What follows what in a story, what counts of a script besides its meaning, and how a sentence feels."""

from __future__ import annotations

import itertools
from functools import cache
from typing import Any

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.composition.sequence_search import Row, succession
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.emotion_classifier import MoodReader, clear_moods, lessons, moments
from planner_service.scripts.script import EMOTIONS, Keyframe, ShortScript
from planner_service.scripts.script_library import Features, LibraryError, ScriptLibrary
from planner_service.scripts.suitability import After, Before, Traits, after_of, before_of
from scene_graphs.furniture import categories_of


@cache
def ours() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def script(
    number: int, summary: str = "", emotion: str = "neutral", room: str = "study", **more: object
) -> ShortScript:
    keyframe = {"skill": "sitdown", "caption": f"hands on thighs {number}", "furniture": "chair"}
    told = {"id": f"s{number}", "summary": summary or f"The character does thing {number}."}
    return ShortScript.model_validate({"emotion": emotion, "room": room, "keyframes": [keyframe]} | told | more)


# Traits.


def test_traits_say_of_every_script_what_its_fields_say() -> None:
    traits = ours().traits
    for index, one in enumerate(ours().scripts[::9]):
        place = index * 9
        assert traits.of_emotion(one.emotion)[place]
        assert traits.in_rooms([one.room])[place]
        assert all(traits.doing([keyframe.skill])[place] for keyframe in one.keyframes)
        assert all(
            traits.using(categories_of(keyframe.piece[0]))[place] for keyframe in one.keyframes if not keyframe.on_floor
        )
    assert sum(int(traits.of_emotion(emotion).sum()) for emotion in EMOTIONS) == len(ours())
    assert not traits.doing([]).any()
    assert not traits.using(["no such category"]).any()


def test_only_scripts_with_the_same_keyframes_share_a_run() -> None:
    same = script(2).model_copy(update={"keyframes": script(1).keyframes})
    first, second, third = Traits([script(1), same, script(3)]).runs
    assert first == second != third


@pytest.mark.parametrize(
    ("summary", "before"),
    [
        ("The alarm rings, and the character wakes up.", Before.ASLEEP),
        ("The character comes home from work, exhausted.", Before.AWAY),
        ("The character sits down. Later they wake up.", Before.ANYTHING),
    ],
)
def test_a_summary_begins_with_what_must_have_been(summary: str, before: Before) -> None:
    assert before_of(script(1, summary)) is before


def test_only_who_lies_and_sleeps_is_left_asleep() -> None:
    lying: dict[str, Any] = {"keyframes": [Keyframe(skill=Skill.LIEDOWN, caption="hands on belly", furniture="bed")]}
    assert after_of(script(1, "The character falls asleep.", **lying)) is After.ASLEEP
    assert after_of(script(1, "The character cannot fall asleep.", **lying)) is After.ABOUT
    assert after_of(script(1, "The character falls asleep.")) is After.ABOUT
    assert after_of(script(1, "The character leaves the house.")) is After.AWAY


# Succession.


def row(suits: list[float], scripts: list[int] | None = None, mood: str = "neutral") -> Row:
    places = np.array(scripts if scripts is not None else range(len(suits)), dtype=np.intp)
    return Row(places, np.array(suits), mood)


def following(rows: list[Row], scripts: list[ShortScript]) -> list[int | None]:
    vectors = np.eye(len(scripts), dtype=np.float32)[np.concatenate([one.scripts for one in rows])]
    return succession(rows, Traits(scripts), vectors)


@tries(60)
@given(
    st.lists(st.lists(st.floats(0.1, 1.0).map(lambda x: round(x, 3)), min_size=4, max_size=4), min_size=1, max_size=4)
)
def test_few_rows_get_the_best_sum_there_is_and_no_script_twice(suits: list[list[float]]) -> None:
    scripts = [script(number) for number in range(4)]
    chosen = following([row(one) for one in suits], scripts)
    assert None not in chosen
    assert len(set(chosen)) == len(suits)
    best = max(
        sum(suits[i][p] for i, p in enumerate(places)) for places in itertools.permutations(range(4), len(suits))
    )
    assert sum(suits[number][place] for number, place in enumerate(chosen) if place is not None) == pytest.approx(best)


def test_where_scripts_run_out_a_row_stays_empty() -> None:
    scripts = [script(1), script(2).model_copy(update={"keyframes": script(1).keyframes})]
    assert following([row([0.9, 0.5]), row([0.8, 0.7])], scripts).count(None) == 1


def test_among_equals_the_room_and_the_mood_stay() -> None:
    scripts = [script(0, room="bedroom", emotion="sad"), script(1), script(2, room="bedroom"), script(3, emotion="sad")]
    assert following([row([1.0], [0]), row([0.5, 0.5], [1, 2])], scripts) == [0, 2]
    assert following([row([1.0], [0], "sad"), row([0.5, 0.5], [1, 3], "sad")], scripts) == [0, 3]


def test_after_falling_asleep_comes_waking_rather_than_going_on() -> None:
    lying: dict[str, Any] = {"keyframes": [Keyframe(skill=Skill.LIEDOWN, caption="hands on belly", furniture="bed")]}
    scripts = [script(0, "The character falls asleep.", **lying), script(1), script(2, "The character wakes up.")]
    assert following([row([1.0], [0]), row([0.5, 0.45], [1, 2])], scripts) == [0, 2]
    assert following([row([0.5, 0.45], [1, 2])], scripts) == [1]


def test_what_was_told_already_is_not_told_again() -> None:
    scripts = [script(0), script(1), script(2)]
    alike = np.array([[1, 0], [1, 0], [0, 1]], dtype=np.float32)
    assert succession([row([1.0], [0]), row([0.6, 0.5], [1, 2])], Traits(scripts), alike) == [0, 2]


# Moods.


def test_a_mood_reader_reads_what_it_was_taught_and_is_unsure_of_what_is_like_nothing() -> None:
    texts = ["tears and grief", "grief and sorrow", "joy and laughter", "laughter and delight"]
    encoder = HashingEncoder()
    reader = MoodReader(np.repeat(encoder.encode(texts), 8, axis=0), ["sad"] * 16 + ["happy"] * 16)
    felt = reader.read(encoder.encode(["sorrow and grief", "delight and joy", "zebra"]))
    assert felt.shape == (3, len(EMOTIONS))
    assert clear_moods(felt)[:2] == ["sad", "happy"]
    assert abs(felt[2, EMOTIONS.index("sad")] - felt[2, EMOTIONS.index("happy")]) < 0.2


def test_scripts_teach_by_summary_and_cues_and_moments_of_all_emotions_are_taught_besides() -> None:
    one = script(1, emotion="sad", cues=["weeps"])
    texts, emotions = lessons([one])
    assert (texts[:2], emotions[:2]) == ([one.summary, "weeps"], ["sad", "sad"])
    assert set(emotions[2:]) == set(moments()) == set(EMOTIONS)
    assert len(set(texts)) == len(texts) == len(emotions)


def test_a_kind_of_emotion_shows_where_no_single_one_is_far_ahead() -> None:
    row = np.zeros((1, len(EMOTIONS)))
    row[0, [EMOTIONS.index("sad"), EMOTIONS.index("angry"), EMOTIONS.index("happy")]] = 0.4, 0.35, 0.3
    assert clear_moods(row) == ["sad"]
    row[0, EMOTIONS.index("angry")] = 0.1
    assert clear_moods(row) == [None]


# Searching.


def test_a_cue_finds_its_script_though_the_summary_shares_no_word() -> None:
    library = ScriptLibrary([script(1), script(2, cues=["hits the sack"]), script(3)], Features(HashingEncoder()))
    assert library.search("she hits the sack", k=1)[0].script.id == "s2"


def test_furniture_that_is_asked_for_is_used_by_all_that_is_found() -> None:
    found = ours().search("sits and thinks", k=30, furniture=("desk", "chair"))
    assert found
    for one in found:
        used = set().union(*(categories_of(keyframe.piece[0]) for keyframe in one.script.keyframes))
        assert used & categories_of("desk")
        assert used & categories_of("chair")
    with pytest.raises(LibraryError, match=r"^furniture: 'throne' is not known"):
        ours().search("sits", furniture=("throne",))
