"""Sentences in the order in which things happen, where that is plainly another than the one they are told in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final, Protocol, TypeVar

from planner_service.themes.lexicon import is_third_person

_EARLIER: Final = re.compile(r"(?:but |and )?(?:before (?:that|this)|earlier|beforehand)\b", re.IGNORECASE)
"""How a sentence begins that tells what was done before the one before it."""
_BEFORE: Final = re.compile(r"(?:(?:just|right|shortly|always) )?before\b", re.IGNORECASE)
"""How one begins that names first what is done after all that it tells,"""
_LAST: Final = re.compile(r"\b(?:to bed|sleep\w*|turn\w* in|leav\w+|go(?:es|ing)? out|set\w* off)\b", re.IGNORECASE)
"""where that ends a day, or the time at home;"""
_THEN: Final = re.compile(
    r"(?:(?:and )?then|next|after (?:that|this)|afterwards?|finally|lastly|at last)\b", re.IGNORECASE
)
"""how those begin that go on telling of what comes before it,"""
_AFTER_IT: Final = re.compile(
    r"\b(?:bed|sleep\w*|asleep|slept|dream\w*|wak\w+|woke\w*|pillow|returns?|comes? (?:back|home)|outside|driv\w+|drove"
    r"|to (?:work|school))\b",
    re.IGNORECASE,
)
"""unless they tell of what follows it."""


_LONG_AGO: Final = re.compile(
    r"\b(?:(?:years?|months?|weeks?|days?|decades|ages|long|a lifetime) ago|back then|in those days)\b"
    r"|^(?:last (?:spring|summer|autumn|fall|winter|year|month|week|christmas|easter|\w+day)"
    r"|in (?:(?:his|her|their|my) (?:youth|childhood|twenties|thirties)|it|the (?:photo|photograph|picture)))\b",
    re.IGNORECASE,
)
"""When, or where, what is told was done that is not done now."""
_NOW: Final = re.compile(r"\b(?:now|nowadays|today|tonight|back in the present|present day)\b", re.IGNORECASE)
"""What is told after it is of the present,"""
_IN_PRESENT: Final = re.compile(r"\b(?:he|she|it|[A-Z][a-z]+)(?: \w+ly)? (\w+s)\b")
"""as are words of what somebody does."""
_FLASHBACK: Final = re.compile(r"flashback\b", re.IGNORECASE)


class Told(Protocol):
    """A clause, as far as its order goes."""

    @property
    def text(self) -> str:
        """Its words."""

    @property
    def joint(self) -> str:
        """What joins it to the one before."""


Clause = TypeVar("Clause", bound=Told)


def in_story_time(sentences: Sequence[str], told: Sequence[Sequence[Clause]]) -> list[Clause]:
    """The clauses of sentences, those of each in the order of time already: "Before going to bed he brushes his teeth.
    Then he waters the plants." ends in bed; "He eats. Before that he showers." begins in the shower."""
    ordered: list[Sequence[Clause]] = []
    waiting: list[Clause] = []
    for sentence, clauses in zip(sentences, told, strict=True):
        if waiting and not (_THEN.match(sentence) and not _AFTER_IT.search(sentence)):
            ordered.append(waiting)
            waiting = []
        if _EARLIER.match(sentence) and ordered:
            ordered.insert(len(ordered) - 1, clauses)
        elif (
            _BEFORE.match(sentence)
            and len(clauses) > 1
            and clauses[-1].joint == "before"
            and _LAST.search(clauses[-1].text)
        ):
            ordered.append(clauses[:-1])
            waiting = [clauses[-1]]
        else:
            ordered.append(clauses)
    return [clause for clauses in (*ordered, waiting) for clause in clauses]


def long_ago(sentences: Sequence[str]) -> frozenset[int]:
    """The places of sentences that tell of another time than the others: "Last summer they danced here. She sits down",
    or of a flashback, till a word says that it is over."""
    found: set[int] = set()
    flashes = False
    for at, sentence in enumerate(sentences):
        flashes = not _NOW.search(sentence) and (flashes or _FLASHBACK.match(sentence) is not None)
        others = [*sentences[:at], *sentences[at + 1 :]]
        now = any(map(_NOW.search, sentences[at + 1 :])) or any(map(_is_present, others))
        if flashes or (_LONG_AGO.search(sentence) and now and not _is_present(sentence)):
            found.add(at)
    return frozenset(found)


def _is_present(sentence: str) -> bool:
    return any(is_third_person(word) for word in _IN_PRESENT.findall(sentence))
