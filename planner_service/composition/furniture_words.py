"""The furniture and the rooms that words name, and the places of the things in them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from planner_service.composition.deed_table import deed_table
from planner_service.scripts.script_words import affords
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, is_noun, lemma_of, verb_of
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import tokens_of
from scene_graphs import furniture

_THROUGH: Final = frozenset(("through", "in", "around", "round", "up", "down", "out", "over", "across"))
"""Words between a deed and the room that it is done to: "searches through the kitchen"."""
_LISTED: Final = re.compile(r",(?: and| then| or| even)*|\b(?:and|or)(?: then| even)*\b")
_PLACED: Final = frozenset(("in", "on", "under", "behind", "beneath", "below", "inside", "at", "above", "beside",
                             "between", "into", "onto", "with"))  # fmt: skip
"""Words that each place of a list begins with."""


def listed_places(clause: Clause) -> list[str]:
    """The furniture of two or more places or things that one thing is done to in turn, one for each: "looks under the
    cushions, | in the fridge, | behind the sofa", "turns on the radio | and the tap"."""
    parts = [part for part in _LISTED.split(clause.text) if part.strip()]
    places = [(where(part) if pieces_in(part) else typical_of(part) or where(part))[:1] for part in parts]
    begins = [part.split()[0].lower() for part in parts[1:]]
    led = all(word in _PLACED for word in begins)
    bare = all(word in grammar().marks - {"to"} for word in begins) and not _PLACED & set(clause.text.split()[2:])
    bare = bare and not re.search(r"^[^,]+, an? [^,]+$", clause.text)  # "opens the box, a scarf" names what it is
    known = [piece for some in places for piece in some if affords(piece, "touch")]
    return list(dict.fromkeys(known)) if (led or bare) and len(set(known)) > 1 and len(known) == len(parts) else []


def typical_of(text: str) -> list[str]:
    """What is typical of the rooms that something is done to, in their order: "searches the study, the hall and …";
    none for those that it is only done in."""
    words = [token.low for token in tokens_of(text)]
    typical, known = deed_table().typical, grammar()
    found: dict[str, None] = {}
    before = 0
    for at in range(len(words)):
        name = " ".join(words[at : at + 2]) if " ".join(words[at : at + 2]) in typical else words[at]
        # "washes the dishes in the kitchen"
        within = "in" in words[1:at] and any(map(is_noun, words[1 : words.index("in")]))
        if name in typical and not within and (before or not known.prepositions & set(words[1:at]) - _THROUGH):
            end = at + len(name.split())
            listed = not before or all(
                word in known.marks | known.adverbs | {",", "and", "then"} for word in words[before:at]
            )
            if listed and at and not (words[end:] and is_noun(words[end]) and words[end] not in known.prepositions):
                found[typical[name]] = None
                before = end
    return list(found)


def lemmas_of(text: str) -> list[str]:
    """The base forms of the words of a text."""
    return [lemma_of(token.text) for token in tokens_of(text)]


def where(text: str) -> tuple[str, ...]:
    """Furniture that words name, else where the first thing is that they name."""
    places = things()
    return tuple(pieces_in(text)) or next((places[word] for word in lemmas_of(text) if word in places), ())


def names_things(clause: Clause) -> bool:
    """Whether a clause names furniture or things, which "it" may mean later."""
    words = (*clause.lemmas, *lemmas_of(clause.subject))
    return bool(pieces_in(clause.text)) or any(word in things() for word in words)


def pieces_in(text: str) -> list[str]:
    """Furniture words of a text in its order, longest names first: "dining table", not "table"."""
    return [piece for _, piece in pieces_told(text)]


def pieces_told(text: str) -> list[tuple[str, str]]:
    """The same, each after the text's own words for it: "bin" for a trash can."""
    words = [token.low for token in tokens_of(text) if token.text[:1].isalpha()]
    others = {*deed_table().not_furniture.split()}
    found: list[tuple[str, str]] = []
    at = 0
    while at < len(words):
        size = next((size for size in (3, 2, 1) if _names(words[at : at + size], size)), 0)
        if (
            size
            and not (size == 1 and {words[at], lemma_of(words[at])} & others)
            and not (at == 0 and _is_a_deed(words))
        ):
            name = " ".join(words[at : at + size])
            piece = deed_table().stands_on.get(name) or furniture.canonical(name).replace("_", " ")
            after = lemma_of("".join(words[at + size : at + size + 1]))
            if piece != "picture" or after not in things_called("book"):  # "the photo album"
                found.append((name, deed_table().stands_on.get(piece, piece)))
        at += size or 1
    return found


def _is_a_deed(words: Sequence[str]) -> bool:
    """Whether a furniture word is a verb: "sinks onto the bottom stair"."""
    ways = {"into", "onto", "down", "to", "back", "on"}
    led = len(words) > 1 and words[1] in ways | (grammar().marks - {"of"})
    return led and bool(verb_of(words[0]))


def _names(words: Sequence[str], size: int) -> bool:
    """Whether these very words, and not only the last of them, are a furniture word."""
    whole = " ".join(words)
    if whole in deed_table().stands_on:
        return True
    if len(words) < size or not furniture.is_known(whole):
        return False
    return size == 1 or furniture.canonical(whole) != furniture.canonical(" ".join(words[1:]))


def room_of(clause: Clause) -> str | None:
    """The room type that the words of a clause make one think of: "cooks" is the kitchen's."""
    words = {*clause.lemmas, *pieces_in(clause.text)} - ({"sink"} if clause.verb == "sink" else set())
    return next((room for room, those in deed_table().rooms.items() if words & set(those)), None)
