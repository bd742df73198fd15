"""The language a text is in, told by its letters and its commonest words: the rules read English alone."""

from __future__ import annotations

import re
import unicodedata
from functools import cache
from typing import Final

from planner_service.themes.lexicon import Words, is_known_word
from scene_graphs.data_tables import read_table, table

ENGLISH: Final = "English"
ANOTHER: Final = "another language"
"""One that nobody here knows the name of."""
_READ: Final = 20_000
"""Letters of a text that are looked at."""
_FEW: Final = 8
"""Words below which only such count as are common in another language and no English words."""
_MIN_SHARE: Final = 0.1
"""Prose has every third of its words among the common ones of its language."""


@table
class Languages:
    """data/languages.toml."""

    common: dict[str, Words]
    letters: dict[str, str]


@cache
def languages() -> Languages:
    """The languages we know by name."""
    known: Languages = read_table("planner_service", "languages.toml", Languages)
    return known


def language_of(text: str) -> str:
    """English, another language by its name, or `ANOTHER`; English when in doubt."""
    if named := _by_letters(text):
        return named
    words = _words(text)
    if len(words) < _FEW:
        other = foreign_language(text)
        telling = {word for word in words if word in languages().common.get(other, ()) and not is_known_word(word)}
        return other if len(telling) > 1 else ENGLISH
    best = max(languages().common, key=lambda name: _share(words, name))
    if _share(words, best) < _MIN_SHARE:
        return ANOTHER if len(words) >= 3 * _FEW else ENGLISH
    return ENGLISH if _share(words, ENGLISH) >= _share(words, best) else best


def foreign_language(text: str) -> str:
    """The name of the language of a text that is not English, or `ANOTHER`."""
    words = _words(text)
    best = max((name for name in languages().common if name != ENGLISH), key=lambda name: _share(words, name))
    return _by_letters(text) or (best if _share(words, best) >= _MIN_SHARE else ANOTHER)


def _words(text: str) -> list[str]:
    """Its words; one letter alone may stand in any language."""
    return re.findall(r"[^\W\d_]{2,}", text[:_READ].lower())


def _share(words: list[str], name: str) -> float:
    return sum(word in languages().common[name] for word in words) / len(words) if words else 0.0


def _by_letters(text: str) -> str:
    """The language of a text that is mostly in other letters than Latin ones, else ""."""
    letters = [letter for letter in text[:_READ] if letter.isalpha()]
    others = [letter for letter in letters if letter > "\u024f"]
    if 2 * len(others) <= len(letters):
        return ""
    written = {re.split(r"[ -]", unicodedata.name(letter, ""))[0] for letter in others}
    return next((name for letters, name in languages().letters.items() if letters in written), ANOTHER)
