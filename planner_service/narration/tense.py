"""A present-tense sentence told in the past, and the base forms of the verbs that stand in it."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from planner_service.themes.lexicon import english_verbs, gerund, past

_SHIFTED: Final = (
    (r"\btomorrow (morning|afternoon|evening|night)\b", r"the next \1"),
    (r"(?<!about )\btomorrow\b", "the next day"),
    (r"\btonight\b", "that night"),
    (r"\btoday\b", "that day"),
    (r"\byesterday\b", "the day before"),
)
"""Days named from the teller's present, named from the story's."""


def is_past(word: str) -> bool:
    """Whether a word is a simple past we know."""
    return word in _pasts()


def base_of(present: str) -> str | None:
    """The base of a third-person present form, a regular guess for an unknown word in -s; None for anything else."""
    presents = english_verbs().presents
    if present in presents:
        return presents[present]
    if not present.endswith("s") or present.endswith("ss") or len(present) < 4:
        return None
    if present.endswith("ies"):
        return present[:-3] + "y"
    return present[:-2] if present.endswith(("sses", "shes", "ches", "xes", "zzes")) else present[:-1]


def base_of_gerund(word: str) -> str | None:
    """The base of an -ing form we know: losing → lose, having → have; None for anything else."""
    return _base_of_gerund().get(word)


def stem(word: str) -> str:
    """What the forms of a verb have in common, and a word with its plural: cries, cried, crying → cry; keys → key."""
    known = english_verbs().presents.get(word) or _base_of_past().get(word) or _base_of_gerund().get(word)
    return known or (word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word)


def before_past(told: str) -> str:
    """The past perfect of a simple past of a deed: won → had won; any other word as it is."""
    base, verbs = _base_of_past().get(told), english_verbs()
    return told if base is None or base in verbs.lasting.split() else f"had {verbs.participles.get(base, told)}"


def word_to_past(word: str, before: str, after_subject: bool = False) -> str:
    """One word of a present-tense sentence in the past; `before` is the word in front of it, lower case.

    Right after the subject any word in -s counts as a verb, and so does a base form after "they".
    """
    lower, verbs = word.lower(), english_verbs()
    if lower in verbs.auxiliary and not (lower == "do" and before == "to"):
        return _match_case(verbs.auxiliary[lower], word)
    if after_subject:
        base = lower if before == "they" and lower in verbs.bases else base_of(lower)
        return past(base) if base else word
    if lower in verbs.presents and before not in verbs.before_nouns_told.split() and before not in verbs.presents:
        return _match_case(past(verbs.presents[lower]), word)
    return word


def days_to_past(text: str) -> str:
    """Tomorrow → the next day, tonight → that night."""
    for pattern, told in _SHIFTED:
        text = re.sub(pattern, told, text)
        text = re.sub(pattern.replace(r"\bt", r"\bT"), told[:1].upper() + told[1:], text)
    return text


@cache
def _pasts() -> frozenset[str]:
    return frozenset(past(base) for base in english_verbs().bases) | {"was", "were", "could", "would", "might"}


@cache
def _base_of_past() -> dict[str, str]:
    return {past(base): base for base in english_verbs().bases}


@cache
def _base_of_gerund() -> dict[str, str]:
    return {gerund(base): base for base in english_verbs().bases}


def _match_case(told: str, word: str) -> str:
    return told[:1].upper() + told[1:] if word[:1].isupper() else told
