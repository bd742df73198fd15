"""What an instruction needs beyond what people do at home: what is in hand for it, and what no body does."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from functools import cache
from typing import Final

from planner_service.composition.deed_patterns import says
from planner_service.composition.deed_table import DeedRow
from planner_service.scripts.captions import captions
from planner_service.themes.lexicon import Words, lemma_of
from planner_service.themes.things import things
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import is_known

_NONE: Final = frozenset[str]()


@table
class Takes:
    """What must be in hand for what a caption shows."""

    shown: tuple[str, ...]
    usual: str = ""
    itself: Words = _NONE
    """Things that are taken themselves."""
    comes_in: dict[str, Words] = field(default_factory=dict)
    """What to take for other things: a glass for water."""
    first: str = ""
    """What is done before with what is named."""


@table
class Household:
    """data/household.toml."""

    examples: str
    tables: tuple[str, ...]
    seats: tuple[str, ...]
    fixed: Words
    both_hands: tuple[str, ...]
    captions: dict[str, tuple[str, ...]]
    """How it looks where the deed has no captions of its own."""
    takes: tuple[Takes, ...]
    tools: dict[str, tuple[str, ...]]
    """What hands work with, and the ways to say for what."""
    never: dict[str, tuple[str, ...]]
    """Why a body does not do it, and the ways to say what."""

    def __post_init__(self) -> None:
        if unknown := next((word for word in (*self.tables, *self.seats) if not is_known(word)), None):
            raise ValueError(f"household: {unknown!r} is no furniture we know")
        shown = {caption for of_skill in captions().values() for caption in of_skill}
        require_known("takes", (caption for takes in self.takes for caption in takes.shown), shown)

    def takes_of(self, row: DeedRow) -> Takes | None:
        """What a deed needs in hand."""
        return next((takes for takes in self.takes if set(takes.shown) & set(row.captions)), None)


@cache
def household() -> Household:
    """What we know of task plans."""
    known: Household = read_table("planner_service", "household.toml", Household)
    return known


def kept_at(thing: str) -> tuple[str, ...]:
    """Furniture where a thing is looked for, the likeliest first; anything may lie on a table."""
    places = things()
    found = next((places[word] for word in map(lemma_of, reversed(_head(thing))) if word in places), ())
    return tuple(dict.fromkeys((*found, *household().tables)))


def in_hand(row: DeedRow, thing: str) -> str:
    """What one holds for a deed with a thing: a glass for water, the apple itself; "" for nothing."""
    takes = household().takes_of(row)
    if takes is None:
        return ""
    head, _, content = thing.partition(" of ")
    if is_one(head, takes.itself):
        return head
    holders = takes.comes_in.items()
    return next((holder for part in (head, content) for holder, those in holders if is_one(part, those)), takes.usual)


def told_by(ways: Mapping[str, tuple[str, ...]], lemmas: Sequence[str]) -> str:
    """The first name whose ways to say it say what the words do; "" where none does."""
    return next((name for name, those in ways.items() if says(those, lemmas)), "")


def is_one(thing: str, names: Iterable[str]) -> bool:
    """Whether a noun phrase means one of the names, in singular or plural."""
    return bool(thing) and lemma_of(_head(thing)[-1]) in names


def _head(thing: str) -> list[str]:
    return thing.lower().split(" of ")[0].split()
