"""Which form of which verb a word is, and any form of it in the simple past."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Final, Literal

from planner_service.themes.lexicon import gerund, kinds_of, participle, past, third_person, verb_of

Form = Literal["past", "present", "ing", "participle"]
"""Of verbs that are not in their base form; present is that of he and she."""
_FORMS: Final[dict[Form, Callable[[str], str]]] = {
    "past": past, "present": third_person, "ing": gerund, "participle": participle
}  # fmt: skip
_NO_VERBS: Final = (
    "a an and as at but by for he her his i in it my no of on or she so the they to we first second third fourth fifth"
)
"""Small words that a dictionary also has as verbs."""


@cache
def bases(word: str) -> tuple[str, ...]:
    """The base forms of the verbs that a word in small letters may be a form of; a guess for one in -s, -ed or -ing
    that no dictionary has: facetimes → facetime."""
    from lemminflect import getAllLemmasOOV

    if word in _NO_VERBS.split():
        return ()
    known = kinds_of(word)
    if not known and len(word) > 4 and word.endswith(("s", "ed", "ing")):
        known = getAllLemmasOOV(word, upos="VERB")
    return tuple(known.get("VERB", ())) or ((word,) if verb_of(word) == word else ())  # "hoover"


@cache
def form_of(word: str) -> Form | None:
    """Which form a word in small letters is of a verb; None for a base form and for what is no verb."""
    from lemminflect import getInflection

    for base in bases(word):
        if word != base and word in getInflection(base, tag="VBD"):
            return "past"
        for form, inflected in _FORMS.items():
            if word != base and inflected(base) == word:
                return form
    return None


@cache
def in_past(word: str) -> str | None:
    """Any form of a verb in the simple past, None for what is no verb: sits, sit, sitting and sat are all "sat"."""
    known = bases(word)
    return (word if form_of(word) == "past" else past(known[0])) if known else None
