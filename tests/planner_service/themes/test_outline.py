"""Outlines are read by what stands in their lines, whatever marks and counts them."""

from __future__ import annotations

import pytest
from for_each import for_each

from planner_service.themes.beats import ThemeError, beats_of
from planner_service.themes.outline import lines_of

DEEDS = ("sit down", "read", "go to bed")
OUTLINES = (
    "- sit down\n- read\n- go to bed",
    "→ sit down\n→ read\n→ go to bed",
    "sit down -> read -> go to bed",
    "sit down / read / go to bed",
    "1. sit down 2. read 3. go to bed",
    "a) sit down b) read c) go to bed",
    "Beat 1: sit down. Beat 2: read. Beat 3: go to bed.",
    "SHOT A - sit down\nSHOT B - read\nSHOT C - go to bed",
    "8:00 sit down\n8:15 am - read\n9 pm: go to bed",
    "[ ] sit down\n[x] read\n[ ] go to bed",
    "Please sit down, read and go to bed.",
    "Could you sit down, read and go to bed",
    "The robot should sit down, read and go to bed.",
)


@for_each("outline", OUTLINES)
def test_the_deeds_of_an_outline_are_those_of_its_lines(outline: str) -> None:
    read = beats_of(outline)
    assert tuple(one.text.removesuffix(".") for one in read) == DEEDS
    assert {one.beat.kind for one in read} == {"deed"}


@for_each(
    "theme",
    (
        "He sits down, reads and/or sleeps at 8:00, and that is that.",
        "Anna - a nurse - comes home; she sits down.",
        "A scene one remembers: he acts as if nothing had happened.",
        "He should sit down, but he does not.",
    ),
)
def test_prose_is_no_outline(theme: str) -> None:
    assert lines_of(theme) == theme


def test_a_line_of_verse_ends_no_sentence_that_has_marks() -> None:
    assert (
        lines_of("She sits, / she sleeps / until the walls / dance.") == "She sits, she sleeps until the walls dance."
    )


@for_each("outline", OUTLINES)
def test_lines_are_made_once(outline: str) -> None:
    assert lines_of(lines_of(outline)) == lines_of(outline)


@for_each("theme", ("Please tell me a story.", "Could you write a poem?", "Please ignore what stands above."))
def test_who_is_asked_to_tell_something_does_nothing(theme: str) -> None:
    with pytest.raises(ThemeError):
        beats_of(theme)


def test_english_words_are_english_whatever_else_they_are() -> None:
    assert beats_of("enters tired\ndrops bag\ncollapses on sofa\nno TV, no phone\nfalls asleep")
