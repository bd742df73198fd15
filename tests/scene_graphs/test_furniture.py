"""The tree of furniture holds together, and words find their place in it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import (
    Furniture,
    affordances,
    canonical,
    canonical_room,
    catalogue,
    categories_of,
    class_of,
    display_name,
    group_of,
    is_known,
    is_minor,
    typical_size,
)

WORDS = tuple(catalogue().class_of)


def wrong(**sections: Any) -> str:
    with pytest.raises(ValueError, match=r"^\w+") as refused:
        replace(catalogue(), **sections)
    return str(refused.value)


def test_a_catalogue_that_does_not_hold_together_is_refused_by_its_place() -> None:
    """Every category has a class, a group and a size; a kind lies inside one class and shares no category; every other
    word leads to one thing known."""
    known = catalogue()
    chair, pillow = known.categories["dining_chair"], known.categories["pillow"]
    assert "categories.pillow.of_class: cushions is" in wrong(
        categories=known.categories | {"pillow": replace(pillow, of_class="cushions")}
    )
    assert "categories.dining_chair.size_m: (0.4, 0.0, 0.5)" in wrong(
        categories=known.categories | {"dining_chair": replace(chair, size_m=(0.4, 0.0, 0.5))}
    )
    assert "kinds.chair: diner is" in wrong(kinds=known.kinds | {"chair": ("dining_chair", "diner")})
    assert "kinds.chair: its categories are not of one class" in wrong(
        kinds=known.kinds | {"chair": ("dining_chair", "desk")}
    )
    assert "kinds: dining_chair stands there twice" in wrong(kinds=known.kinds | {"throne": ("dining_chair",)})
    assert "other_words: throne is" in wrong(other_words=known.other_words | {"throne": ("royal_seat",)})
    assert "other_words: couch stands there twice" in wrong(other_words=known.other_words | {"bed": ("couch",)})
    assert "minor_groups: lights is" in wrong(minor_groups=frozenset({"lights"}))
    assert "room_words: den is" in wrong(room_words={"cellar": "den"})


def test_every_other_word_leads_to_something_known() -> None:
    assert {canonical(word) for word in catalogue().aliases} <= set(WORDS)


@given(st.text(max_size=30))
@tries(60)
def test_canonical_is_idempotent(word: str) -> None:
    assert canonical(canonical(word)) == canonical(word)


@for_each("word", WORDS)
def test_known_words_are_their_own_canonical_form(word: str) -> None:
    assert canonical(word) == word
    assert canonical(word.upper().replace("_", " ")) == word
    assert canonical(f"the old {word}") == word


@for_each(
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
