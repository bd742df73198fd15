"""Themes taken apart into events by rules."""

from __future__ import annotations

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from themes import THEMES, Theme

from motion_backend.emotion_words import emotion_of
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import EMOTIONS
from planner_service.themes.beats import ThemeError, clause_of, clauses_of, grouped, moods_of, rooms_in
from planner_service.themes.verb_finder import has_verb


def read(theme: str) -> list[tuple[str, str]]:
    """Text and mood of each event."""
    clauses = clauses_of(theme)
    return [(clause.text, mood) for clause, mood in zip(clauses, moods_of(clauses, [None] * len(clauses)), strict=True)]


@for_each("theme", THEMES)
def test_the_themes_of_the_paper_have_the_expected_events(theme: Theme) -> None:
    found = read(theme.text)
    assert len(found) == len(theme.events), found
    for (text, mood), wanted in zip(found, theme.events, strict=True):
        assert all(word in text for word in wanted.words), (text, wanted.words)
        assert mood in wanted.emotions, (text, mood)


@for_each(
    ("theme", "texts"),
    [
        # the order of time, not of the words
        ("He washes up after he eats.", ["eats", "washes up"]),
        ("Before going to bed, he reads and drinks tea.", ["reads", "drinks tea", "going to bed"]),
        ("After eating, she sleeps.", ["eating", "sleeps"]),
        ("He drops the glass when the phone rings.", ["the phone rings", "drops the glass"]),
        ("He is reading when the phone rings.", ["is reading", "the phone rings"]),
        ("She panics because guests arrive.", ["guests arrive", "panics"]),
        # what is no event of its own
        ("He eats bread and butter, cheese and a pear.", ["eats bread and butter, cheese and a pear"]),
        ("After dinner, he sleeps.", ["after dinner, he sleeps"]),
        ("He sits next to the window.", ["sits next to the window"]),
        ("He becomes excited when he finds a ring.", ["becomes excited when he finds a ring"]),
        ("He finds it and becomes glad.", ["finds it and becomes glad"]),
        ("He gets angry and throws a vase.", ["gets angry and throws a vase"]),
        # names, lists, later
        ("Anna reads. Mr. Smith then sleeps.", ["reads", "Mr Smith sleeps"]),
        ("1. wake up\n2. cook\n- go out", ["wake up", "cook", "go out"]),
        ("The man then suddenly falls and finally he sleeps.", ["falls", "sleeps"]),
    ],
)
def test_a_theme_is_told_in_the_order_of_time(theme: str, texts: list[str]) -> None:
    assert [clause.text for clause in clauses_of(theme)] == texts


@for_each(
    ("theme", "moods"),
    [
        ("He is happy. He eats. He cries. He sleeps on the floor.", ["happy", "happy", "sad", "tired"]),
        ("She is dressing up and feels excited about the party.", ["happy", "happy"]),
        ("He gets drunk and rests on the sofa.", ["drunk", "drunk"]),
        ("He cries a lot. He rests on the sofa.", ["sad", "tired"]),
        ("He eats. He rests on the sofa.", ["neutral", "relaxed"]),
        ("A tired student studies.", ["tired"]),
        ("He is not happy.", ["sad"]),
    ],
)
def test_a_mood_lasts_until_another_one_comes(theme: str, moods: list[str]) -> None:
    assert [mood for _, mood in read(theme)] == moods


@for_each(
    ("saying", "emotion", "meant"),
    [
        ("He is drowning his sorrows.", "drunk", "wine"),
        ("He is told in the phone that he fails the job interview.", "sad", "bad news"),
        ("She is over the moon.", "happy", "overjoyed"),
        ("He hits the sack.", "tired", "bed"),
        ("He loses his temper.", "angry", "furious"),
        ("She puts her feet up.", "relaxed", "relaxes"),
    ],
)
def test_a_saying_is_looked_up_by_what_it_means(saying: str, emotion: str, meant: str) -> None:
    (clause,) = clauses_of(saying)
    assert clause.emotion == emotion
    assert meant in clause.query


def test_it_stands_for_what_was_there_before() -> None:
    _, found = clauses_of("He searches for the ring. He finds it.")
    assert found.text == "finds it"
    assert found.query == "searches for the ring, finds it"


def test_an_emotion_is_judged_from_the_meaning_only_where_no_word_shows_one() -> None:
    clauses = clauses_of("He stares at the wall. He is happy. He stares at the wall.")
    assert moods_of(clauses, ["sad", "sad", "sad"]) == ("sad", "happy", "happy")


@tries(60)
@given(st.integers(1, 8))
def test_clauses_are_grouped_to_the_number_wanted_without_losing_words(most: int) -> None:
    clauses = clauses_of(THEMES[5].text)
    told = grouped(clauses, most)
    assert len(told) == min(most, len(clauses))
    assert " and ".join(clause.text for clause in told) == " and ".join(clause.text for clause in clauses)


@tries(200)
@given(st.text(max_size=200))
def test_any_text_has_events_or_is_refused(theme: str) -> None:
    try:
        clauses = clauses_of(theme)
    except ThemeError:
        return
    assert clauses
    assert all(clause.text.strip() for clause in clauses)


def test_what_is_not_text_is_refused() -> None:
    with pytest.raises(ThemeError, match="it is bytes, not text"):
        clauses_of(b"He sits.")  # type: ignore[arg-type]  # bytes


def test_rooms_are_read_in_order() -> None:
    assert rooms_in("from the bedroom to the living-room and the kitchen") == ("bedroom", "living_room", "dining_room")
    assert rooms_in("she studies hard") == ()


def test_an_event_of_a_model_keeps_its_words_and_emotion() -> None:
    clause = clause_of("hits the sack", "relaxed")
    assert (clause.text, clause.emotion, clause.sure) == ("hits the sack", "relaxed", True)
    assert "bed" in clause.query


@for_each(
    ("words", "emotion"),
    [
        ("neutral, calm", "neutral"),
        ("tired, depressed, drunk", "drunk"),
        ("painful, sad", "sad"),
        ("cold, disturbed, anxious", "stressed"),
        ("anxious, angry", "angry"),
        ("happy, childish", "happy"),
        ("thinking", "neutral"),
        ("thinking, stressed", "stressed"),
        ("zombie like, drunk", "drunk"),
        ("relaxed, calm", "relaxed"),
        ("confident, thinking", "happy"),
        ("stressed, uncomfortable", "stressed"),
        ("depressed", "sad"),
        ("purple", None),
        ("", None),
    ],
)
def test_the_papers_emotion_words_mean_one_of_nine(words: str, emotion: str | None) -> None:
    assert emotion_of(words) == emotion


def test_each_emotion_means_itself() -> None:
    assert [emotion_of(emotion) for emotion in EMOTIONS] == list(EMOTIONS)


def test_a_negated_feeling_is_not_felt() -> None:
    assert feelings("he is not angry") == []
    assert [feeling.emotion for feeling in feelings("can't stop crying")] == ["sad"]
    assert [feeling.emotion for feeling in feelings("nobody comes to her party")][-1] == "sad"


def test_what_is_over_leaves_relief_and_is_looked_for_as_such() -> None:
    assert [feeling.emotion for feeling in feelings("she is no longer nervous")] == ["relaxed"]
    (clause,) = clauses_of("She is no longer nervous.")
    assert (clause.emotion, "nervous" in clause.query) == ("relaxed", False)


def test_words_of_a_longer_saying_mean_what_the_whole_means() -> None:
    assert [feeling.emotion for feeling in feelings("tears up the letter")] == ["angry"]
    assert [feeling.emotion for feeling in feelings("tears run down her face")] == ["sad"]


def test_nobody_is_not_the_one_the_story_is_about() -> None:
    assert [clause.text for clause in clauses_of("Nobody came, so she eats alone.")] == ["Nobody came", "eats alone"]
    assert clauses_of("Somebody scratched his car.")[0].text == "Somebody scratched his car"


def test_a_hint_within_a_sentence_does_not_end_a_louder_mood() -> None:
    clauses = clauses_of("He shouts, hides from her mother and slams the door. He hides from her.")
    assert moods_of(clauses, [None] * len(clauses)) == ("angry", "angry", "angry", "stressed")


def test_a_time_without_a_comma_comes_before_whoever_does_it() -> None:
    assert [clause.text for clause in clauses_of("After a long shift the nurse sings and yawns.")] == [
        "after a long shift, the nurse sings", "yawns"
    ]  # fmt: skip


@for_each("text", ["reads books", "he yodels", "is sitting", "to win", "cried"])
def test_verbs_are_known(text: str) -> None:
    assert has_verb(text)


@for_each("text", ["a walk", "the drink and his dreams", "butter", "insomnia"])
def test_nouns_are_no_verbs(text: str) -> None:
    assert not has_verb(text)
