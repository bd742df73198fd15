"""Patterns of words by which tables say what clauses tell: base forms, gaps, and kinds of things."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Final

from planner_service.themes.lexicon import lemma_of
from planner_service.themes.things import things_called

_GAP: Final = "..."
END: Final = frozenset(("$",))
"""The end of a clause in a pattern."""
_MAX_GAP: Final = 4
"""Words that a gap of a pattern may stand for."""
Pattern = tuple[frozenset[str], ...]
"""Base forms of each word; an empty set is a gap."""


def words_in(pattern: Pattern) -> int:
    """How many words a pattern has, its gaps and its end aside."""
    return sum(bool(word) and word != END for word in pattern)


def fits(pattern: Pattern, lemmas: Sequence[str]) -> bool:
    """Whether words begin as a pattern says."""
    if not pattern:
        return True
    first, rest = pattern[0], pattern[1:]
    if first == END:
        return not lemmas
    if not first:  # a gap
        return any(fits(rest, lemmas[skip:]) for skip in range(min(_MAX_GAP, len(lemmas)) + 1))
    return bool(lemmas) and lemmas[0] in first and fits(rest, lemmas[1:])


def says(ways: tuple[str, ...], lemmas: Sequence[str]) -> bool:
    """Whether words say what one of some patterns says."""
    by_first = _by_first_word(ways)
    likely = by_first.get(lemmas[0] if lemmas else "$", by_first[""])
    return any(fits(pattern, lemmas) for pattern in likely)


@cache
def _by_first_word(ways: tuple[str, ...]) -> dict[str, list[Pattern]]:
    """The patterns that words may say, by the first of them; "" for any other: those that begin with a gap."""
    patterns = [pattern_of(way) for way in ways]
    first = {form for pattern in patterns if pattern for form in pattern[0]}
    return {form: [one for one in patterns if not one or not one[0] or form in one[0]] for form in (*first, "")}


@cache
def pattern_of(says: str) -> Pattern:
    """The pattern that a saying of a table is."""
    return tuple(
        frozenset() if word == _GAP else frozenset(form for one in word.split("|") for form in _forms(one))
        for word in says.split()
    )


def _forms(word: str) -> tuple[str, ...]:
    if word.startswith("@"):
        return things_called(word[1:])
    return (word,) if word == "lay" else (word, lemma_of(word))  # who lies lays nothing
