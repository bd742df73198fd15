"""The tree of furniture holds together, and words find their place in it."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scene_graphs.furniture import (
    AFFORDANCES,
    ALIASES,
    CATALOGUE,
    GROUP_OF_CLASS,
    KINDS,
    Furniture,
    affordances,
    canonical,
    canonical_room,
    categories_of,
    class_of,
    display_name,
    group_of,
    is_known,
    is_minor,
    typical_size,
)

WORDS = (*CATALOGUE, *KINDS)


@pytest.mark.parametrize("category", CATALOGUE)
def test_every_category_has_a_class_a_group_a_size_and_known_affordances(category: str) -> None:
    entry = CATALOGUE[category]
    assert entry.class_ in GROUP_OF_CLASS
    assert entry.affordances <= set(AFFORDANCES)
    assert min(entry.size) > 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_lies_inside_one_class(kind: str) -> None:
    assert {class_of(member) for member in categories_of(kind)} == {class_of(kind)}


def test_kinds_do_not_share_categories() -> None:
    for first, second in combinations(KINDS, 2):
        assert not categories_of(first) & categories_of(second)


def test_every_alias_leads_to_something_known() -> None:
    assert all(is_known(alias) and canonical(alias) in WORDS for alias in ALIASES)


@given(st.text(max_size=30))
@settings(max_examples=60, deadline=None)
def test_canonical_is_idempotent(word: str) -> None:
    assert canonical(canonical(word)) == canonical(word)


@pytest.mark.parametrize("word", WORDS)
def test_known_words_are_their_own_canonical_form(word: str) -> None:
    assert canonical(word) == word
    assert canonical(word.upper().replace("_", " ")) == word
    assert canonical(f"the old {word}") == word


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("Couch", "sofa"),
        ("couches", "sofa"),
        ("closet", "wardrobe"),
        ("fridge", "refrigerator"),
        ("bookcases", "bookshelf"),
        ("shelves", "shelf"),
        ("multi-seat sofa", "multi_seat_sofa"),
        ("Loveseat", "loveseat_sofa"),
        ("Lounge Chair / Cafe Chair / Office Chair", "lounge_chair"),
        ("bedside table", "nightstand"),
        ("kitchen stove", "stove"),
        ("grand piano", "grand_piano"),
    ],
)
def test_words_of_scripts_and_datasets_are_understood(word: str, name: str) -> None:
    assert canonical(word) == name


def test_an_unknown_word_is_its_own_key_group_that_can_be_touched() -> None:
    assert not is_known("grand piano")
    assert class_of("grand piano") == group_of("grand piano") == "grand_piano"
    assert categories_of("grand piano") == {"grand_piano"}
    assert affordances("grand piano") == {"touch"}
    assert not is_minor("grand piano")


def test_lamps_and_vases_are_minor_and_beds_are_not() -> None:
    assert is_minor("lamp")
    assert is_minor("vase")
    assert not is_minor("bed")


def test_one_can_lie_on_beds_and_sofas_but_not_on_chairs_or_tables() -> None:
    assert all("lie" in affordances(category) for category in categories_of("bed"))
    assert "lie" in affordances("sofa")
    assert not any("lie" in affordances(category) for category in categories_of("chair") | categories_of("table"))


def test_names_read_as_people_say_them() -> None:
    assert display_name("dining_chair") == "dining chair"
    assert display_name("tv stand") == "TV stand"
    assert display_name("multi_seat_sofa") == "sofa"


def test_a_library_is_a_study() -> None:
    assert canonical_room("Library") == "study"
    assert canonical_room("Living Room") == "living_room"


def test_a_furniture_is_a_pair() -> None:
    assert Furniture("chair") == ("chair", 1)
    assert typical_size("bed") == typical_size("double bed")
