"""The words for furniture: categories, their classes and groups, generic kinds, and what a body can do with each."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final, NamedTuple

from scene_graphs.catalogue import (
    ALIASES,
    CATALOGUE,
    DISPLAY_NAMES,
    GROUP_OF_CLASS,
    KINDS,
    MINOR_GROUPS,
    NONE,
    TOUCH,
    Size,
)

ROOM_TYPES: Final = ("bedroom", "living_room", "dining_room", "study")
AFFORDANCES: Final = ("sit", "lie", "touch")

remembered: Final = lru_cache(maxsize=1 << 14)
"""Words come from users too: what is remembered of them is bounded."""
_ROOM_WORDS: Final = {"library": "study", "office": "study", "living": "living_room", "lounge": "living_room"}
_UNKNOWN_SIZE: Final[Size] = (0.6, 0.8, 0.5)
_PLURALS: Final = (("ves", "f"), ("ies", "y"), ("es", ""), ("s", ""))
_CLASS_OF: Final = {kind: CATALOGUE[members[0]].class_ for kind, members in KINDS.items()} | {
    category: entry.class_ for category, entry in CATALOGUE.items()
}


class Furniture(NamedTuple):
    """A node of a furniture graph, "(c, i), where the first number represents the category and the second the
    instance" (SIMS 3.2)."""

    category: str
    """A category, a generic kind, or a word we do not know."""
    instance: int = 1


@remembered
def canonical(word: str) -> str:
    """The category or generic kind a word means ("Couches" -> "sofa"), or its slug where we know neither.

    Tries aliases and plurals first, then drops leading words, so that "big wooden chair" is a chair.
    """
    slug = _slug(word)
    words = slug.split("_")
    for start in range(len(words)):
        if (known := _known_word("_".join(words[start:]))) is not None:
            return known
    return slug


def canonical_room(word: str) -> str:
    """The room type a word means ("Library" -> "study"), or its slug where it is none of `ROOM_TYPES`."""
    slug = _slug(word)
    return _ROOM_WORDS.get(slug, slug)


def is_known(word: str) -> bool:
    """Whether the word means a category or a generic kind."""
    return canonical(word) in _CLASS_OF


@remembered
def categories_of(word: str) -> frozenset[str]:
    """The categories a word names exactly: several for a generic kind, else the category itself."""
    name = canonical(word)
    return frozenset(KINDS.get(name, (name,)))


@remembered
def class_of(category: str) -> str:
    """The class, inside which furniture stands in for other furniture; an unknown word is a class of its own."""
    name = canonical(category)
    return _CLASS_OF.get(name, name)


@remembered
def group_of(category: str) -> str:
    """The group, outside which nothing is ever substituted; an unknown word is a group of its own."""
    class_ = class_of(category)
    return GROUP_OF_CLASS.get(class_, class_)


def is_minor(category: str) -> bool:
    """Whether the graph counts it as a less important node (SIMS 3.2)."""
    return group_of(category) in MINOR_GROUPS


@remembered
def affordances(category: str) -> frozenset[str]:
    """What a body can usually do there, out of `AFFORDANCES`; for a kind, what at least one of it offers.

    An unknown object can at least be touched.
    """
    name = canonical(category)
    if name not in _CLASS_OF:
        return TOUCH
    return NONE.union(*(CATALOGUE[member].affordances for member in categories_of(name)))


def typical_size(category: str) -> Size:
    """Usual (width, height, depth) in metres; of a kind, that of its first category."""
    name = canonical(category)
    entry = CATALOGUE.get(KINDS.get(name, (name,))[0])
    return entry.size if entry else _UNKNOWN_SIZE


def display_name(word: str) -> str:
    """The name as a person would say it: "dining chair", "TV stand"."""
    name = canonical(word)
    return DISPLAY_NAMES.get(name, name.replace("_", " "))


def _slug(word: str) -> str:
    return re.sub(r"[\s_\-]+", "_", re.sub(r"\s*/\s*", "/", word.strip().lower().replace("'", ""))).strip("_")


def _known_word(slug: str) -> str | None:
    """The category or kind this very slug names, in singular or plural."""
    for ending, singular in (("", ""), *_PLURALS):
        if slug.endswith(ending):
            stem = slug[: len(slug) - len(ending)] + singular
            name = ALIASES.get(stem, stem)
            if name in _CLASS_OF:
                return name
    return None
