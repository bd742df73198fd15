"""Sentences in the order in which things happen, where that is plainly another than the one they are told in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from planner_service.themes.sentence_parser import Clause

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
