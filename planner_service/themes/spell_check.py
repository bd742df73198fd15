"""Words that no dictionary has, spelt as they are meant: "openned", "siting", "the pilow", "coutch"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache, lru_cache
from string import ascii_lowercase
from typing import Final

from planner_service.scripts.captions import captions
from planner_service.themes.lexicon import (
    gerund,
    grammar,
    is_known_word,
    kinds_of,
    lemma_of,
    past,
    third_person,
    verb_of,
)
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from scene_graphs.furniture import catalogue, is_known

_WORD: Final = re.compile(r"(?<![\w'’-])[a-z]{4,24}(?![\w'’-])")
_FEWEST: Final = 5
"""Letters of a word in which there may be one too many or too few."""
_SLANG: Final = frozenset(("booty", "hiit"))
"""Words that are spelt so, and that the dictionary does not have."""
_VOWELS: Final = "aeiou"


def spelt(text: str) -> str:
    """The text with its misspelt words as they are meant; what may be a name, or means nothing near, stays."""
    return _WORD.sub(lambda one: _meant(one[0]), text)


@lru_cache(maxsize=20_000)
def _meant(word: str) -> str:
    if word in _MISTAKEN:
        return _MISTAKEN[word]
    if _is_spelt(word):
        return word
    near = [one for one in dict.fromkeys(_respelt(word)) if kinds_of(one) and (verb_of(one) or one in _words())]
    if base := _inflected(word):  # "washs", but not "taked", which has another form
        return next((one for one in near if verb_of(one) == base), word)
    if len(word) >= _FEWEST and not near:
        near = sorted(one for one in _one_off(word) if one[0] == word[0] and (one in _words() or is_known(one)))
    bases = {lemma_of(one) for one in near}
    return near[0] if len(bases) == 1 or (near and near[0] in _words()) else word


_MISTAKEN: Final = {"siting": "sitting", "lieing": "lying", "goed": "went"}
"""Words of which another word is meant, whatever else they may be."""


def _is_spelt(word: str) -> bool:
    known = kinds_of(word) or is_known_word(word) or is_known(word) or word in things()
    names = theme_words()
    named = word in names["names_she"] | names["names_he"] | names["names_they"] | names["people"]
    return (
        bool(known)
        or named
        or word in grammar().numbers
        or word.endswith("th")
        or word in _SLANG | grammar().slang.keys()
    )


def _inflected(word: str) -> str:
    """The base form of a verb that a word is a form of, whoever would write it so, else ""."""
    base = verb_of(word)
    return base if base in grammar().more_verbs or "VERB" in kinds_of(base or word) else ""


def _respelt(word: str) -> Iterator[str]:
    """The word by the rules that people forget: a letter doubled or not, a silent e, an ending of s."""
    for at, letter in enumerate(word):
        if letter not in _VOWELS + "hjkqvwxy":
            yield word[: at + 1] + word[at:]
        if at and word[at - 1] == letter:
            yield word[:at] + word[at + 1 :]
    for ending in ("ing", "ed", "es"):
        if word.endswith("e" + ending):
            yield word.removesuffix("e" + ending) + ending
    if word.endswith(("shs", "chs", "sss", "xs")):
        yield f"{word[:-1]}es"
    if word.endswith(("ys", "yed")):
        yield re.sub(r"y(s|ed)$", lambda one: "ies" if one[1] == "s" else "ied", word)
    if word.endswith("es"):
        yield f"{word[:-2]}s"


def _one_off(word: str) -> set[str]:
    """All words that one letter more or less, or two of them changed about, make of it."""
    parts = [(word[:at], word[at:]) for at in range(len(word) + 1)]
    found = {first + rest[1:] for first, rest in parts if rest}
    found |= {first + rest[1] + rest[0] + rest[2:] for first, rest in parts if len(rest) > 1}
    return found | {first + letter + rest for first, rest in parts for letter in ascii_lowercase}


@cache
def _words() -> frozenset[str]:
    """The words of what is done at home: captions' verbs in their forms, things, furniture and the body."""
    told = {word for some in captions().values() for one in some for word in re.findall(r"[a-z]{3,}", one.lower())}
    verbs = {base for word in told if word.endswith(("ing", "e")) and (base := verb_of(word))} | {
        "open",
        "close",
        "clean",
    }
    forms = {form(base) for base in verbs for form in (str, past, third_person, gerund)}
    furniture = {part for name in catalogue().categories for part in name.split("_")}
    return frozenset(told | forms | furniture | {*things()} | theme_words()["body"])
