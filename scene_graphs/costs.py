"""What editing one furniture graph into another costs, and the terms of the bound that follows from it.

Notes: an ultrametric a group, 0 <= sub_class <= sub_group <= delete + insert, makes the node part of the distance a sum
of clipped counts: over categories, classes and groups, `coefficient * min(query's count, room's count)` is saved.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from scene_graphs.catalogue import KINDS
from scene_graphs.furniture import categories_of, class_of, group_of, is_minor

Level = Literal["same", "class", "group"]
Key = tuple[str, str]
"""What is counted in a room: ("category" | "class" | "group", its name), or ("edge", two group names)."""


def _check_integers(costs: object) -> None:
    for name, value in vars(costs).items():
        if not isinstance(value, GroupCosts) and (type(value) is not int or value < 0):
            raise ValueError(f"{name} must be a whole number, 0 or more, got {value!r}")


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
    """`coefficient * min(room's count of members, generic + sum over parts of min(theirs, room's count))`."""

    coefficient: int
    members: tuple[Key, ...]
    generic: int
    parts: tuple[tuple[Key, int], ...] = ()

    def saved(self, count: Callable[[Sequence[Key]], Any], least: Callable[[Any, Any], Any]) -> Any:
        """The term's value for whatever `count` gives: an int for one room, a column of them for many."""
        wanted = self.generic + sum(least(number, count((key,))) for key, number in self.parts)
        return self.coefficient * least(wanted, count(self.members))


@cache
def level_between(word: str, category: str) -> Level | None:
    """How near a room's category is to a query's word; None across groups."""
    if category == word or category in categories_of(word):
        return "same"
    if class_of(word) == class_of(category):
        return "class"
    return "group" if group_of(word) == group_of(category) else None


def node_terms(words: Iterable[str], costs: CostTable, strict: bool = False) -> list[Term]:
    """The terms that bound what the nodes of a query (with repetition) can save, per room."""
    counts = Counter(words)
    terms: list[Term] = []
    for word_class in sorted({class_of(word) for word in counts}):
        inside = {word: n for word, n in counts.items() if class_of(word) == word_class}
        own = costs.of(next(iter(inside)))
        terms += _label_terms(inside, own.delete + own.insert if strict else own.sub_class)
        if not strict:
            members = (("class", word_class),)
            terms.append(Term(own.sub_group - own.sub_class, members, sum(inside.values())))
    if not strict:
        for group in sorted({group_of(word) for word in counts}):
            inside = {word: n for word, n in counts.items() if group_of(word) == group}
            own = costs.of(next(iter(inside)))
            members = (("group", group),)
            terms.append(Term(own.delete + own.insert - own.sub_group, members, sum(inside.values())))
    return [term for term in terms if term.coefficient]


def edge_key(first: str, second: str) -> Key:
    """What an edge between two categories counts as: the unordered pair of their groups."""
    return "edge", "|".join(sorted((group_of(first), group_of(second))))


def edge_terms(edges: Iterable[tuple[str, str]], costs: CostTable) -> list[Term]:
    """The terms that bound what the edges of a query can save."""
    counts = Counter(edge_key(first, second) for first, second in edges)
    saved = costs.lost_edge + costs.extra_edge
    return [Term(saved, (key,), number) for key, number in sorted(counts.items()) if saved]


def _label_terms(counts: dict[str, int], coefficient: int) -> list[Term]:
    """A term for every generic kind that is used, with the categories inside it, and for every other category."""
    kinds = [word for word in sorted(counts) if word in KINDS]
    inside = {kind: categories_of(kind) | {kind} for kind in kinds}
    taken = frozenset[str]().union(*inside.values())
    terms = [
        Term(
            coefficient,
            tuple(("category", name) for name in sorted(inside[kind])),
            counts[kind],
            tuple((("category", w), counts[w]) for w in sorted(counts) if w in inside[kind] and w != kind),
        )
        for kind in kinds
    ]
    return terms + [
        Term(coefficient, (("category", word),), counts[word]) for word in sorted(counts) if word not in taken
    ]
