"""The words for furniture: categories, their classes and groups, generic kinds, and what a body can do with each.

The furniture we know: what stands in which class and group, what a body can do with it, how large it usually is.
"""

from __future__ import annotations

import json
import re
from functools import cache, cached_property, lru_cache
from importlib import resources
from typing import Final, Literal, NamedTuple

from scene_graphs.data_tables import read_table, require_known, require_unlike, table

Size = tuple[float, float, float]

ROOM_TYPES: Final = ("bedroom", "living_room", "dining_room", "study")
AFFORDANCES: Final = ("sit", "lie", "touch")

remembered: Final = lru_cache(maxsize=1 << 14)
"""Words come from users too: what is remembered of them is bounded."""
_UNKNOWN_SIZE: Final[Size] = (0.6, 0.8, 0.5)
_PLURALS: Final = (("ves", "f"), ("ies", "y"), ("es", ""), ("s", ""))


@table
class Category:
    """One category of furniture."""

    of_class: str
    affordances: frozenset[Literal["sit", "lie", "touch"]]
    size_m: Size
    """Usual width x, height y, depth z."""


@table
class Catalogue:
    """The tree of furniture, and the words for it."""

    minor_groups: frozenset[str]
    """Objects "with minimal interaction possibilities, such as lamps or vases" (SIMS 3.2)."""
    fronted: frozenset[str]
    """Classes and categories that are opened or looked at from one side."""
    group_of_class: dict[str, str]
    """The tree that sets costs. Affordances are a property of their own and never decide a class."""
    categories: dict[str, Category]
    kinds: dict[str, tuple[str, ...]]
    """Generic words of scripts. The kinds inside one class must not share a category: the lower bound counts on it."""
    other_words: dict[str, tuple[str, ...]]
    """Other words by category or kind."""
    room_words: dict[str, str]
    """Other words for room types."""

    def __post_init__(self) -> None:
        named = {*self.categories, *self.kinds}
        require_known("minor_groups", self.minor_groups, self.group_of_class.values())
        require_known("fronted", self.fronted, {*self.group_of_class, *self.categories})
        for category, entry in self.categories.items():
            require_known(f"categories.{category}.of_class", [entry.of_class], self.group_of_class)
            if min(entry.size_m) <= 0:
                raise ValueError(f"categories.{category}.size_m: {entry.size_m} is no size")
        for kind, members in self.kinds.items():
            require_known(f"kinds.{kind}", members, self.categories)
            if len({self.categories[member].of_class for member in members}) != 1:
                raise ValueError(f"kinds.{kind}: its categories are not of one class")
        require_unlike("kinds", (member for members in self.kinds.values() for member in members))
        require_unlike("other_words", (word for words in self.other_words.values() for word in words))
        require_known("other_words", self.other_words, named)
        require_known("room_words", self.room_words.values(), ROOM_TYPES)

    @cached_property
    def aliases(self) -> dict[str, str]:
        """The category or kind that each other word means."""
        return {word: name for name, words in self.other_words.items() for word in words}

    @cached_property
    def class_of(self) -> dict[str, str]:
        """The class of every kind and category."""
        of_kind = {kind: self.categories[members[0]].of_class for kind, members in self.kinds.items()}
        return of_kind | {category: entry.of_class for category, entry in self.categories.items()}


@cache
def catalogue() -> Catalogue:
    """The furniture we know, from data/furniture.toml."""
    known: Catalogue = read_table("scene_graphs", "furniture.toml", Catalogue)
    return known


@cache
def display_names() -> dict[str, str]:
    """Categories whose slug does not read as a person would say it: data/furniture_names.json, which the page reads
    too."""
    text = resources.files("scene_graphs").joinpath("data", "furniture_names.json").read_text(encoding="utf-8")
    known: dict[str, str] = json.loads(text)
    require_known("furniture_names", known, catalogue().categories)
    return known


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
    return catalogue().room_words.get(slug, slug)


def is_known(word: str) -> bool:
    """Whether the word means a category or a generic kind."""
    return canonical(word) in catalogue().class_of


@remembered
def categories_of(word: str) -> frozenset[str]:
    """The categories a word names exactly: several for a generic kind, else the category itself."""
    name = canonical(word)
    return frozenset(catalogue().kinds.get(name, (name,)))


@remembered
def class_of(category: str) -> str:
    """The class, inside which furniture stands in for other furniture; an unknown word is a class of its own."""
    name = canonical(category)
    return catalogue().class_of.get(name, name)


@remembered
def group_of(category: str) -> str:
    """The group, outside which nothing is ever substituted; an unknown word is a group of its own."""
    class_ = class_of(category)
    return catalogue().group_of_class.get(class_, class_)


def has_front(category: str) -> bool:
    """Whether it is opened or looked at from one side: the front of its `Placed`."""
    return not {canonical(category), class_of(category)}.isdisjoint(catalogue().fronted)


def is_minor(category: str) -> bool:
    """Whether the graph counts it as a less important node (SIMS 3.2)."""
    return group_of(category) in catalogue().minor_groups


@remembered
def affordances(category: str) -> frozenset[str]:
    """What a body can usually do there, out of `AFFORDANCES`; for a kind, what at least one of it offers.

    An unknown object can at least be touched.
    """
    name = canonical(category)
    known = catalogue()
    if name not in known.class_of:
        return frozenset({"touch"})
    return frozenset().union(*(known.categories[member].affordances for member in categories_of(name)))


def typical_size(category: str) -> Size:
    """Usual (width, height, depth) in metres; of a kind, that of its first category."""
    name, known = canonical(category), catalogue()
    entry = known.categories.get(known.kinds.get(name, (name,))[0])
    return entry.size_m if entry else _UNKNOWN_SIZE


def display_name(word: str) -> str:
    """The name as a person would say it: "dining chair", "TV stand"."""
    name = canonical(word)
    return display_names().get(name, name.replace("_", " "))


def _slug(word: str) -> str:
    return re.sub(r"[\s_\-]+", "_", re.sub(r"\s*/\s*", "/", word.strip().lower().replace("'", ""))).strip("_")


def _known_word(slug: str) -> str | None:
    """The category or kind this very slug names, in singular or plural."""
    known = catalogue()
    for ending, singular in (("", ""), *_PLURALS):
        if slug.endswith(ending):
            stem = slug[: len(slug) - len(ending)] + singular
            name = known.aliases.get(stem, stem)
            if name in known.class_of:
                return name
    return None
