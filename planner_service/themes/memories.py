"""What a theme tells as remembered: how things used to be, and what somebody thinks back to. It is not done now."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import is_third_person
from planner_service.themes.theme_words import theme_words

RECALLING: Final = frozenset(("when", "how", "that", "where"))
"""Joints after which it is told what somebody remembers."""
_USED_TO: Final = re.compile(r"(?:\w+ )?used to \w+|would (?:always|often|sometimes|usually) \w+", re.IGNORECASE)
"""What was done often, and is no more."""
_YOUNG: Final = re.compile(
    r"(?:was|were) (?:still |only |very )*"
    r"(?:small|young|little|a (?:little |small )?(?:child|girl|boy|kid)|\w+ years old)$",
    re.IGNORECASE,
)
"""How somebody was when what is told of that time was done: "when I was small | I hid here"."""
_TIME: Final = re.compile(
    r"\b(?:day|time|night|evening|morning|summer|winter|spring|autumn|year)s?(?: (?:that|when))?$", re.IGNORECASE
)
"""What may be remembered with all that happened then: "the day | that he left"."""
_SEES: Final = re.compile(r"\b(?:sees?|saw|pictur\w+|imagin\w+) (?:him|her|my|them)sel(?:f|ves)\b", re.IGNORECASE)
"""Who sees themselves thinks of another time, or of what might be."""
_THINKING: Final = frozenset(("think", "miss", "dream", "mourn", "muse"))
"""Verbs of what is thought of: "thinks of the day | that they met"."""


def recalled_in(clauses: Sequence[Clause]) -> frozenset[int]:
    """The places of the clauses that tell what is remembered, though none of them says so itself."""
    found: set[int] = set()
    last: int | None = None
    for at in sorted(range(len(clauses)), key=lambda at: (clauses[at].sentence, clauses[at].place)):
        before = clauses[last] if last is not None else None
        if before is None or before.sentence != clauses[at].sentence:
            told = _is_habit(clauses[at]) or (
                _YOUNG.match(clauses[at].text) is not None and clauses[at].joint == "when"
            )
        else:
            more = last in found and (_goes_on(clauses[at], clauses) or _YOUNG.match(before.text) is not None)
            told = more or _is_habit(clauses[at]) or _is_recalled(before, clauses[at])
        found.update([at] if told else [])
        last = at
    return frozenset(found)


def _is_habit(clause: Clause) -> bool:
    return _USED_TO.match(clause.text) is not None and clause.verb not in ("get", "be", "become")


def _is_recalled(before: Clause, clause: Clause) -> bool:
    """Whether a clause tells what the one before it says is remembered, or thought of."""
    thinks = before.verb in theme_words()["memory_verbs"]
    bare = RECALLING.issuperset(before.lemmas[1:])
    then = bool(_TIME.search(before.text)) and clause.joint in RECALLING
    both = clause.joint in ("and", ",") and not clause.subject and clause.text.split()[0].endswith("ing")
    if thinks and both and any(word.endswith("ing") for word in before.text.split()[1:3]):
        return True  # "remembers being a girl | and skipping rope"
    goes_back = before.verb == "think" and "back" in before.lemmas and clause.joint in RECALLING
    if goes_back or (both and _SEES.search(before.text)):
        return True  # "thinks back to | when she danced", "sees himself as a boy, | running"
    if thinks:
        return clause.aside or then or (bare and clause.joint in RECALLING)
    return before.verb in _THINKING and (clause.aside or then)


def _goes_on(clause: Clause, clauses: Sequence[Clause]) -> bool:
    """Whether more is remembered: "remembers how they danced | and laughed", but not "and smiles"."""
    recalling = [
        one for one in clauses if one.sentence == clause.sentence and one.verb in theme_words()["memory_verbs"]
    ]
    now = any(is_third_person(one.text.split()[0].lower()) for one in recalling)
    first = clause.text.split()[0].lower()
    listed = not clause.subject and not clause.aside and clause.joint in ("and", ",", "or")
    return listed and now and not is_third_person(first) and not first.endswith("ing")
