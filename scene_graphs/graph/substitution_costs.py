"""What editing one furniture graph into another costs, and the terms of the bound that follows from it.

Notes: an ultrametric a group, 0 <= sub_class <= sub_group <= delete + insert, makes the node part of the distance a sum
of clipped counts: over categories, classes and groups, `coefficient * min(query's count, room's count)` is saved.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal, TypeVar

from scene_graphs.furniture import catalogue, categories_of, class_of, group_of, is_minor

Level = Literal["same", "class", "group"]
Key = tuple[str, ...]
"""What is counted in a room: ("category" | "kind" | "class" | "group", its name), or ("edge", two group names)."""
_Name = TypeVar("_Name", str, Key)
DEAREST: Final = 10_000
"""No cost is higher, so that no distance passes 32 bits."""


def _check_integers(costs: object) -> None:
    for name, value in vars(costs).items():
        if not isinstance(value, GroupCosts) and (type(value) is not int or not 0 <= value <= DEAREST):
            raise ValueError(f"{name} must be a whole number from 0 to {DEAREST}, got {value!r}")


@dataclass(frozen=True)
class GroupCosts:
    """Costs of the nodes of one group; ValueError unless 0 <= sub_class <= sub_group <= delete + insert."""

    delete: int
    """The query's object is missing."""
    insert: int
    """Furniture the script does not use."""
    sub_class: int
    """Another category of the same class stands in."""
    sub_group: int
    """Another class of the same group stands in."""

    def __post_init__(self) -> None:
        _check_integers(self)
        if not self.sub_class <= self.sub_group <= self.delete + self.insert:
            raise ValueError(
                "costs must rise from sub_class over sub_group to delete + insert, got "
                f"{self.sub_class}, {self.sub_group}, {self.delete} + {self.insert}"
            )


@dataclass(frozen=True)
class CostTable:
    """Whole-number costs; 100 is one missing key object. ValueError if one is negative or the axioms fail."""

    key: GroupCosts = GroupCosts(100, 1, 30, 60)
    minor: GroupCosts = GroupCosts(25, 0, 8, 15)
    lost_edge: int = 20
    """A relation of the query that the room does not keep."""
    extra_edge: int = 0
    """A relation of the room that the query does not ask for."""

    def __post_init__(self) -> None:
        _check_integers(self)

    def of(self, category: str) -> GroupCosts:
        """The costs of the group a category is in."""
        return self.minor if is_minor(category) else self.key

    def substitution(self, word: str, category: str, strict: bool = False) -> int | None:
        """Cost of a room's category standing in for a query's word; None where that is forbidden."""
        level = level_between(word, category)
        if level == "same":
            return 0
        if level is None or strict:
            return None
        costs = self.of(category)
        return costs.sub_class if level == "class" else costs.sub_group


@dataclass(frozen=True)
class Term:
    """What a query can save at most: `coefficient * min(room's count of key, asked + sum over parts of min(theirs,
    room's count of the part))`."""

    coefficient: int
    key: Key
    places: tuple[int, ...]
    """Which of the query's nodes, or edges, ask for it, rising."""
    parts: tuple[tuple[Key, tuple[int, ...]], ...] = ()
    """The same for the categories inside a kind that are asked for by their own names."""

    @property
    def last(self) -> int:
        """The last of all places that ask."""
        return max(self.places[-1], *(places[-1] for _, places in self.parts)) if self.parts else self.places[-1]


@lru_cache(maxsize=65536)
def level_between(word: str, category: str) -> Level | None:
    """How near a room's category is to a query's word; None across groups."""
    if category == word or category in categories_of(word):
        return "same"
    if class_of(word) == class_of(category):
        return "class"
    return "group" if group_of(word) == group_of(category) else None


def node_terms(words: Sequence[str], costs: CostTable, strict: bool = False) -> list[Term]:
    """The terms that bound what the nodes of a query can save, given their words in order."""
    classes, groups = _places(class_of(word) for word in words), _places(group_of(word) for word in words)
    terms: list[Term] = []
    for name, places in classes.items():
        own = costs.of(words[places[0]])
        inside = {word: [i for i in places if words[i] == word] for word in sorted({words[i] for i in places})}
        terms += _label_terms(inside, own.delete + own.insert if strict else own.sub_class)
        if not strict:
            terms.append(Term(own.sub_group - own.sub_class, ("class", name), tuple(places)))
    if not strict:
        for name, places in groups.items():
            own = costs.of(words[places[0]])
            terms.append(Term(own.delete + own.insert - own.sub_group, ("group", name), tuple(places)))
    return [term for term in terms if term.coefficient]


def edge_key(first: str, second: str) -> Key:
    """What an edge between two categories counts as: the unordered pair of their groups."""
    return "edge", *sorted((group_of(first), group_of(second)))


def edge_terms(edges: Iterable[tuple[str, str]], costs: CostTable) -> list[Term]:
    """The terms that bound what the edges of a query can save, given the words of their ends in order."""
    saved = costs.lost_edge + costs.extra_edge
    places = _places(edge_key(first, second) for first, second in edges)
    return [Term(saved, key, tuple(asked)) for key, asked in places.items() if saved]


def _places(names: Iterable[_Name]) -> dict[_Name, list[int]]:
    """Where each name is, in the order of names."""
    found: dict[_Name, list[int]] = defaultdict(list)
    for place, name in enumerate(names):
        found[name].append(place)
    return dict(sorted(found.items()))


def _label_terms(inside: dict[str, list[int]], coefficient: int) -> list[Term]:
    """A term for every generic kind that is used, with the categories inside it, and for every other category."""
    kinds = [word for word in inside if word in catalogue().kinds]
    terms = [
        Term(
            coefficient,
            ("kind", kind),
            tuple(inside[kind]),
            tuple((("category", w), tuple(at)) for w, at in inside.items() if w != kind and w in categories_of(kind)),
        )
        for kind in kinds
    ]
    taken = frozenset[str]().union(*(categories_of(kind) for kind in kinds), kinds)
    return terms + [
        Term(coefficient, ("category", word), tuple(at)) for word, at in inside.items() if word not in taken
    ]
