"""Texts taken apart: bytes to letters, letters to scenes, clauses to deeds, clauses to summaries."""

from __future__ import annotations

import re

import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from stories import NARRATIVE, SCREENPLAY

from planner_service.extraction.script_writer import in_present
from planner_service.extraction.subtitles import Cue
from planner_service.extraction.text_files import MAX_TEXT_LENGTH, ExtractionError, read_text
from planner_service.extraction.text_scenes import scenes_of_cues, scenes_of_text
from planner_service.scripts.script_duplicates import slug_of

CUES = st.builds(
    lambda start, text, speaker: Cue(start, start + 2, text, speaker, () if text else ("door slams",)),
    st.floats(0, 100),
    st.text(max_size=40),
    st.none() | st.text(max_size=8),
)


@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused_with_their_name(data: bytes) -> None:
    try:
        text, _ = read_text(data, "a file")
    except ExtractionError as error:
        assert str(error).startswith("a file: ")  # noqa: PT017
    else:
        assert any(letter.isalpha() for letter in text)
        assert all(letter.isprintable() or letter in "\n\t" or letter.isspace() for letter in text if letter < "\x80")


def test_a_letter_in_a_hundred_and_a_few_more_may_be_hidden_and_bytes_with_others_are_no_text() -> None:
    words = "Anna sits. " * 100
    hidden = len(words) // 99 + 8
    assert read_text((words + "\x01" * hidden).encode(), "a")[0].count("Anna") == 100
    with pytest.raises(ExtractionError, match="control characters"):
        read_text((words + "\x01" * (hidden + 2)).encode(), "a")


@given(st.text(max_size=400))
def test_any_text_has_scenes_in_which_every_line_says_something(text: str) -> None:
    for scene in scenes_of_text(text):
        assert scene.lines
        assert all(line.text.strip() for line in scene.lines)


@given(st.lists(CUES, max_size=8))
def test_scenes_of_subtitles_keep_the_order_of_time(cues: list[Cue]) -> None:
    starts = [scene.start for scene in scenes_of_cues(cues)]
    assert None not in starts
    assert starts == sorted(starts, key=lambda start: start or 0.0)


def test_a_screenplay_has_a_scene_for_each_slugline() -> None:
    inside, street, bedroom = scenes_of_text(SCREENPLAY)
    assert [scene.place for scene in (inside, street, bedroom)] == [
        "LIVING ROOM - NIGHT",
        "STREET - NIGHT",
        "BEDROOM - LATER",
    ]
    assert [scene.outside for scene in (inside, street, bedroom)] == [False, True, False]
    assert "Anna sinks into the armchair." in inside.told
    assert inside.spoken.startswith("sighing I can't do this anymore. I am so tired. Where are you?")
    assert "CUT" not in inside.told + inside.spoken


def test_what_a_screenplay_shouts_is_told_in_small_letters_but_people_keep_theirs() -> None:
    told = scenes_of_text(SCREENPLAY)[0].told
    assert "Anna comes in, drops her keys in a bowl and slumps onto the couch." in told
    assert "The phone rings." in told


def test_a_narrative_has_scenes_by_paragraphs_and_what_is_quoted_is_speech() -> None:
    scenes = scenes_of_text(NARRATIVE)
    assert len(scenes) == 8
    assert scenes[1].spoken == "You will be late,"
    assert "late" not in scenes[1].told


def test_subtitles_are_told_where_they_tell_of_somebody_and_else_spoken() -> None:
    cues = [Cue(0, 1, "She storms through the room"), Cue(1, 2, "and sits down."), Cue(3, 4, "He is late!", "Anna")]
    (scene,) = scenes_of_cues([*cues, Cue(5, 6, "You sit down."), Cue(7, 8, "", None, ("she gets up",))])
    assert [(line.text, line.spoken) for line in scene.lines] == [
        ("She storms through the room and sits down.", False),
        ("He is late!", True),
        ("You sit down.", True),
        ("She gets up", False),
    ]


@given(st.text(max_size=120))
def test_any_clause_is_told_now_or_not_at_all(clause: str) -> None:
    assert in_present(clause) == " ".join(in_present(clause).split())


@for_each(
    ("clause", "told"),
    [
        ("sat by her bed", "sits by their bed"),
        ("throws herself onto the sofa", "throws themself onto the sofa"),
        ("was reading his book", "is reading their book"),
        ("lay down", "lies down"),
        ("could not sleep", "cannot sleep"),
        ("danced, alone", "dances, alone"),
        ("typing a letter to Anna's mother", "types a letter to their mother"),
        ("the rain", ""),
    ],
)
def test_a_clause_is_told_now_of_one_person(clause: str, told: str) -> None:
    assert in_present(clause, ["Anna"]) == told


@given(st.text(max_size=200), st.sets(st.text(alphabet="abc-1", max_size=4)))
def test_an_id_is_a_slug_that_is_not_taken(summary: str, taken: set[str]) -> None:
    first = slug_of(summary, "a text", taken)
    second = slug_of(summary, "a text", {*taken, first})
    assert re.fullmatch(r"[a-z0-9][a-z0-9-]{0,79}", first)
    assert len({first, second} - taken) == 2


@for_each(
    ("data", "why"),
    [
        (b"", "is empty"),
        (b" \n\t ", "is empty"),
        (b"1234 --- !!", "no word in it"),
        (bytes(range(256)) * 8, "is no text"),
        (b"a" * (MAX_TEXT_LENGTH + 1), "cut it into chapters"),
        (b"word " * 2_000_000, "cut it into chapters"),
    ],
)
def test_what_cannot_be_read_says_why_in_one_line(data: bytes, why: str) -> None:
    with pytest.raises(ExtractionError, match=why) as caught:
        read_text(data, "a file")
    assert "\n" not in str(caught.value)


def test_encodings_are_guessed_and_the_guess_is_told() -> None:
    assert read_text("Ann sat in the café.".encode("utf-16"), "a")[0] == "Ann sat in the café."
    text, notes = read_text("Ann sat in the café.".encode("cp1252"), "a")
    assert text == "Ann sat in the café."
    assert "guess" in notes[0]
