"""What the rules know people to do at home: verbs, what it takes in hand and where, and where things are kept."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from typing import Final, Literal

from scene_graphs.data_tables import read_table, require_known, require_unlike, table
from scene_graphs.furniture import is_known

Kind = Literal["walk", "sit", "lie", "rise", "take", "put", "carry", "touch", "operate", "use", "stand", "never"]
_ANY: Final = "any "


@table
class Deed:
    """Verbs with the same ways."""

    verbs: tuple[str, ...]
    """Base forms; particles may also stand behind the object ("turn the TV on")."""
    kind: Kind
    where: tuple[str, ...] = ()
    """Furniture where it is done when nobody says where, the usual first."""
    takes: str = ""
    """What must be in hand: a thing, or "=" for the object itself."""
    hands: Literal["", "one", "both"] = ""
    """The hands it takes."""
    how: tuple[str, ...] = ()
    """Captions that show it; {hand} is the hand."""
    first: str = ""
    """What is done before it."""
    why: str = ""
    """Why a body does not do it (never), or what its acting leaves out."""


@table
class Captions:
    """How it looks."""

    walk: str
    touch: str
    sit: tuple[str, ...]
    lie: tuple[str, ...]
    walk_by_verb: dict[str, str]
    lie_by_verb: dict[str, str]
    phone_by_hand: dict[Literal["left", "right"], str]
    """A call while seated."""


@table
class House:
    """What homes are made of, and where one sits at a table."""

    fixed: tuple[str, ...]
    """What belongs to the house: no body finds a surface there, since homes do not have it as furniture."""
    seats_at_a_table: tuple[str, ...]
    seats_beside: dict[str, tuple[str, ...]]
    """Seats at tables where they are others."""


@table
class Kept:
    """Things, and furniture where they are looked for, the likeliest first."""

    things: tuple[str, ...]
    at: tuple[str, ...]


@table
class Vessel:
    """Food and drink, and what they come in: "=" for what is taken in hand itself."""

    contents: tuple[str, ...]
    vessel: str


@table
class Household:
    """data/household.toml."""

    any: dict[str, tuple[str, ...]]
    """Furniture that is meant by "any seat"."""
    home: House
    captions: Captions
    kept: tuple[Kept, ...]
    vessel: tuple[Vessel, ...]
    deed: tuple[Deed, ...]

    def __post_init__(self) -> None:
        for name, group in self.any.items():
            _check_furniture(f"any.{name}", group)
        _check_furniture("home.seats_at_a_table", self.home.seats_at_a_table)
        for at, kept in enumerate(self.kept):
            self._check(f"kept.{at}.at", kept.at)
        for at, deed in enumerate(self.deed):
            self._check(f"deed.{at}.where", deed.where)
            if not deed.how and deed.kind in ("stand", "operate", "use"):
                raise ValueError(f"deed.{at}.how: a deed of kind {deed.kind} needs a caption that shows it")
            if not deed.where and deed.kind in ("lie", "put"):
                raise ValueError(f"deed.{at}.where: a deed of kind {deed.kind} needs a usual place")
        require_unlike("deed", (verb for deed in self.deed for verb in deed.verbs))

    def furniture(self, words: Iterable[str]) -> tuple[str, ...]:
        """The words, each once, with all that is meant by "any seat"."""
        each = (self.any[word.removeprefix(_ANY)] if word.startswith(_ANY) else (word,) for word in words)
        return tuple(dict.fromkeys(word for group in each for word in group))

    def _check(self, place: str, words: tuple[str, ...]) -> None:
        require_known(place, (word.removeprefix(_ANY) for word in words if word.startswith(_ANY)), self.any)
        _check_furniture(place, self.furniture(words))


def _check_furniture(place: str, words: Iterable[str]) -> None:
    if unknown := next((word for word in words if not is_known(word)), None):
        raise ValueError(f"{place}: {unknown!r} is no furniture we know")


@cache
def household() -> Household:
    """What people do at home, from data/household.toml."""
    known: Household = read_table("planner_service", "household.toml", Household)
    return known


@cache
def deeds() -> tuple[Deed, ...]:
    """All deeds, where they are done with every furniture word."""
    return tuple(replace(deed, where=household().furniture(deed.where)) for deed in household().deed)


def any_of(*names: str) -> tuple[str, ...]:
    """The furniture that "any seat" or "any table" stands for."""
    return household().furniture(_ANY + name for name in names)


def anywhere() -> tuple[str, ...]:
    """Furniture that anything may lie on or in."""
    return any_of("table", "store")


def kept_at(thing: str) -> tuple[str, ...]:
    """Furniture where a thing is looked for, the likeliest first; anything may lie on a table."""
    found = next((kept.at for kept in household().kept if is_one(thing, kept.things)), anywhere())
    return household().furniture((*found, _ANY + "table"))


def vessel_of(content: str, usual: str) -> str:
    """What one holds to drink or eat it: "glass" for water, the apple itself; `usual` where nothing is known."""
    head = content.split(" of ")[0]
    for part in (head, content):
        for known in household().vessel:
            if is_one(part, known.contents):
                return head if known.vessel == "=" else known.vessel
    return usual


def is_one(thing: str, names: tuple[str, ...]) -> bool:
    """Whether a noun phrase ends in one of the names, in singular or plural."""
    head = thing.lower().split(" of ")[0]
    return re.search(rf"\b(?:{'|'.join(names)})(?:s|es)?$", head) is not None


def is_fixed(thing: str) -> bool:
    """Whether a noun phrase means what belongs to the house."""
    return is_one(thing, household().home.fixed)
