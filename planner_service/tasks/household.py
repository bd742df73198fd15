"""What an instruction needs beyond what people do at home: what is in hand for it, and what no body does."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field
from functools import cache
from typing import Final

from planner_service.composition.deed_lexicon import DeedRow, deed_table, says
from planner_service.scripts.captions import captions
from planner_service.themes.lexicon import Words, lemma_of
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import is_known

_NONE: Final = frozenset[str]()


@table
class Captions:
    """How it looks, where the deed has no captions of its own."""

    walk: str
    touch: str
    sit: tuple[str, ...]
    lie: tuple[str, ...]


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
class Never:
    """What a body does not do, and why."""

    says: tuple[str, ...]
    why: str


@table
class Household:
    """data/household.toml."""

    examples: str
    tables: tuple[str, ...]
    seats: tuple[str, ...]
    fixed: Words
    both_hands: tuple[str, ...]
    captions: Captions
    takes: tuple[Takes, ...]
    tools: dict[str, tuple[str, ...]]
    never: tuple[Never, ...]

    def __post_init__(self) -> None:
        if unknown := next((word for word in (*self.tables, *self.seats) if not is_known(word)), None):
            raise ValueError(f"household: {unknown!r} is no furniture we know")
        shown = {caption for of_skill in captions().values() for caption in of_skill}
        require_known("takes", (caption for takes in self.takes for caption in takes.shown), shown)


@cache
def household() -> Household:
    """What we know of task plans."""
    known: Household = read_table("planner_service", "household.toml", Household)
    return known


def kept_at(thing: str) -> tuple[str, ...]:
    """Furniture where a thing is looked for, the likeliest first; anything may lie on a table."""
    places = deed_table().places
    found = next((places[word] for word in map(lemma_of, reversed(_head(thing))) if word in places), ())
    return tuple(dict.fromkeys((*found, *household().tables)))


def takes_of(row: DeedRow) -> Takes | None:
    """What a deed needs in hand."""
    return next((takes for takes in household().takes if set(takes.shown) & set(row.captions)), None)


def in_hand(takes: Takes, thing: str) -> str:
    """What one holds for a deed with a thing: a glass for water, the apple itself; "" for nothing."""
    if is_one(thing, takes.itself):
        return thing.split(" of ")[0]
    named = (part for part in (thing.split(" of ")[0], thing.rpartition(" of ")[2]) if part)
    return next((holder for part in named for holder, those in takes.comes_in.items() if is_one(part, those)),
                takes.usual)  # fmt: skip


def tool_for(lemmas: tuple[str, ...]) -> str:
    """What hands work with; "" for nothing."""
    return next((tool for tool, ways in household().tools.items() if says(ways, lemmas)), "")


def why_never(lemmas: tuple[str, ...]) -> str:
    """Why no body does it; "" where one may."""
    return next((never.why for never in household().never if says(never.says, lemmas)), "")


def is_one(thing: str, names: Iterable[str]) -> bool:
    """Whether a noun phrase means one of the names, in singular or plural."""
    return bool(thing) and lemma_of(_head(thing)[-1]) in names


def _head(thing: str) -> list[str]:
    return thing.lower().split(" of ")[0].split()
