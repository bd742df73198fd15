"""Forms of English verbs: the past, the -ing form, the base form of any of them."""

from __future__ import annotations

from functools import cache
from typing import Final, Literal

Form = Literal["VBD", "VBG", "VBN", "VBZ"]
"""Simple past, -ing, past participle, present of he and she."""
_CHOSEN: Final = {
    ("wake", "VBN"): "woken", ("lie", "VBN"): "lain", ("get", "VBN"): "got", ("quit", "VBN"): "quit",
    ("weave", "VBD"): "wove", ("spit", "VBN"): "spat", ("spit", "VBD"): "spat", ("wed", "VBD"): "wed",
    ("program", "VBD"): "programmed", ("program", "VBG"): "programming",
}  # fmt: skip
"""Where the first of the forms in the dictionary is not ours."""
_NO_VERBS: Final = "a an and as at but by for he her his i in it my no of on or she so the they to we"
"""Small words that a dictionary also has as verbs."""


@cache
def inflected(base: str, form: Form) -> str:
    """A base form in another form, spelt as in Britain where it can be: travel → travelled."""
    from lemminflect import getInflection

    if (base, form) in _CHOSEN:
        return _CHOSEN[base, form]
    forms = getInflection(base, form) or (base,)
    return str(next((one for one in forms if base.endswith("l") and "ll" in one), forms[0]))


def past(base: str) -> str:
    """Sit → sat."""
    return inflected(base, "VBD")


def gerund(base: str) -> str:
    """Sit → sitting."""
    return inflected(base, "VBG")


@cache
def bases(word: str, guessed: bool = False) -> tuple[str, ...]:
    """The base forms of the verbs that a word in small letters may be a form of; a guess, if wanted, for one in -s, -ed
    or -ing that no dictionary has: facetimes → facetime."""
    from lemminflect import getAllLemmas, getAllLemmasOOV

    if word in _NO_VERBS.split():
        return ()
    known = getAllLemmas(word, upos="VERB")
    if not known and guessed and len(word) > 4 and word.endswith(("s", "ed", "ing")):
        known = getAllLemmasOOV(word, upos="VERB")
    return tuple(known.get("VERB", ()))


def is_adjective(word: str) -> bool:
    """Whether a word can say how somebody is: tired, exhausted, lonely."""
    from lemminflect import getAllLemmas

    adjective = "ADJ" in getAllLemmas(word)
    return adjective or any(inflected(base, "VBN") == word != base for base in bases(word))


def form_of(word: str) -> Form | None:
    """Which form a word in small letters is of a verb; None for a base form and for what is no verb."""
    for base in bases(word, guessed=True):
        for form in ("VBD", "VBZ", "VBG", "VBN"):
            if word != base and (inflected(base, form) == word or (form == "VBD" and _also_past(base, word))):
                return form
    return None


def _also_past(base: str, word: str) -> bool:
    from lemminflect import getInflection

    return word in getInflection(base, "VBD")


def in_past(word: str) -> str | None:
    """Any form of a verb in the simple past, None for what is no verb: sits, sit, sitting and sat are all "sat"."""
    known = bases(word, guessed=True)
    if not known:
        return None
    return word if form_of(word) == "VBD" else past(known[0])
