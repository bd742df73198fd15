"""Who else is told to be there: people and animals that a deed is done with, or to, and no picture has; one person is
played."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import grammar, lemma_of
from planner_service.themes.protagonist import is_person
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things_called
from planner_service.themes.verb_finder import Token, tokens_of

_BESIDE: Final = frozenset(("with", "to", "at", "from", "against", "beside", "behind", "by", "for", "on", "next"))
"""Words before whom it is done with, or to."""
_HIM: Final = "him"
_AFAR: Final = re.compile(r"\b(?:phone|writing|typing|reading|book|paper)\b")
"""Captions in which nobody else need be there: they are called, or written to."""
_APART: Final = frozenset((",", ";"))
_LONGEST: Final = 4
"""Words that somebody is told in."""


def others_in(clause: Clause, keyframes: Sequence[PlannedKeyframe]) -> tuple[str, ...]:
    """The words of an acted clause for whoever else would be seen: "at him", "his mother", "together", "and Ben"."""
    if clause.quotes or any(_AFAR.search(one.caption) for one in keyframes):
        return ()
    tokens = [token for token in tokens_of(clause.text) if token.text[:1].isalnum() or token.text in _APART]
    found = [*_beside(clause.subject), *_together(clause, tokens)]
    at = 1
    while at < len(tokens):
        led = tokens[at].low in _BESIDE
        start = at + (2 if led and tokens[at + 1 : at + 2] and tokens[at + 1].low == "to" else led)
        end = _person_at(tokens, start) if led or _is_object(tokens, at) else 0
        if end:
            found.append(clause.text[tokens[at].start : tokens[end - 1].end])
        at = max(end, at + 1)
    return tuple(found)


def _beside(subject: str) -> list[str]:
    """Who does it with whom a theme is about: "and Ben" of "Julia and Ben"."""
    one, _, other = subject.partition(" and ")
    return [f"and {other}"] if other and is_person(one) and is_person(other) else []


def _together(clause: Clause, tokens: Sequence[Token]) -> list[str]:
    """The word itself where it is said of people, and not of pieces that are put together."""
    apart = clause.verb in theme_words()["putting_verbs"] | theme_words()["joining_verbs"]
    words = [token.low for token in tokens]
    told = [" ".join(pair) for pair in (("each", "other"), ("one", "another")) if " ".join(pair) in " ".join(words)]
    return [*told, *(["together"] if "together" in words and not apart else [])]


def _is_object(tokens: Sequence[Token], at: int) -> bool:
    """Whether what begins there is what the verb's deed is done to: it stands behind the verb, or an adverb."""
    between = tokens[1:at]
    return all(token.low in grammar().adverbs for token in between)


def _person_at(tokens: Sequence[Token], start: int) -> int:
    """Where the words for somebody end that begin there; 0 where they are for nobody."""
    if start >= len(tokens):
        return 0
    first, after = tokens[start], tokens[start + 1].low if start + 1 < len(tokens) else ""
    ends = not after or after in _APART or after in grammar().prepositions | grammar().joints | grammar().adverbs
    if first.low == _HIM or (first.low == "her" and (ends or after in grammar().marks - {"to"})):
        return start + 1
    if first.low in grammar().subjects:
        return 0
    words: list[Token] = []
    for token in tokens[start : start + _LONGEST]:
        if words and (token.low in grammar().prepositions | grammar().joints or token.text in _APART):
            break
        words.append(token)
        if _lives(words):
            return start + len(words)
    return 0


def _lives(words: Sequence[Token]) -> bool:
    """Whether words end in a person, or an animal: "his mother", not "his mother's"."""
    last, text = words[-1], " ".join(token.text for token in words)
    if last.text.endswith(("'s", "’s")):
        return False
    pet = lemma_of(last.low) in things_called("pet")
    known = last.low in theme_words()["people"] or lemma_of(last.low) in theme_words()["people"]
    named = len(words) == 1 and last.text[:1].isupper() and is_person(last.text)
    marked = len(words) > 1 and words[0].low in grammar().marks
    return (pet or known or named) and (marked or named) and is_person(text) | pet
