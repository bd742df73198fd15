"""Misspelt words are read as they are meant, and words that nobody misspelt stay."""

from __future__ import annotations

import pytest
from for_each import for_each

from planner_service.scripts.captions import captions
from planner_service.themes.beats import beats_of
from planner_service.themes.spell_check import spelt


@for_each(
    ("written", "meant"),
    (
        ("he washs the dishs", "he washes the dishes"),
        ("she drys her hands", "she dries her hands"),
        ("he openned the frige", "he opened the fridge"),
        ("she slamed the door and droped the bag", "she slammed the door and dropped the bag"),
        ("he is siting on the coutch, eatting", "he is sitting on the couch, eating"),
        ("she hugs the pilow and streches", "she hugs the pillow and stretches"),
        ("he is danceing", "he is dancing"),
    ),
)
def test_a_misspelt_word_is_read_as_it_is_meant(written: str, meant: str) -> None:
    assert spelt(written) == meant
    assert spelt(meant) == meant


@for_each(
    "text",
    (
        "forty dregs, the tenth changer",
        "they facetimed their grandma",
        "pim and lotte run",
        "he taked a book",
        *(caption.lower() for some in captions().values() for caption in some),
    ),
)
def test_what_is_no_mistake_stays(text: str) -> None:
    assert spelt(text) == text


@pytest.mark.parametrize(
    ("theme", "verb"), [("He lays on the sofa.", "lie"), ("She lays down.", "lie"), ("She lays the table.", "lay")]
)
def test_who_lays_on_something_lies_there(theme: str, verb: str) -> None:
    assert [one.clause.verb for one in beats_of(theme)] == [verb]
