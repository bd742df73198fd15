"""Things that people have at home, and the furniture where they are kept."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from itertools import takewhile
from typing import Final

from planner_service.themes.lexicon import grammar, lemma_of
from scene_graphs.data_tables import read_table, table

_FEWEST: Final = 2
"""Letters of no thing's name that anybody calls a story by."""


@table
class KeptThings:
    """Things, and the furniture where they are, the likeliest first."""

    called: str
    """How patterns of other tables mean all of them: "@food"."""
    things: str
    at: tuple[str, ...]


@table
class ThingTable:
    """data/things.toml."""

    kept: tuple[KeptThings, ...]


@cache
def things() -> Mapping[str, tuple[str, ...]]:
    """Where each thing is, by its base form."""
    known: ThingTable = read_table("planner_service", "things.toml", ThingTable)
    found: dict[str, tuple[str, ...]] = {}
    for kept in known.kept:
        for thing in kept.things.split():
            found.setdefault(thing, kept.at)
    return found


@cache
def things_called(name: str) -> tuple[str, ...]:
    """All things of a kind: of "food"."""
    known: ThingTable = read_table("planner_service", "things.toml", ThingTable)
    return next(tuple(kept.things.split()) for kept in known.kept if kept.called == name)


def things_told(text: str) -> list[str]:
    """The things that a deed is done to, as they are named: after its verb and before any preposition."""
    words = re.findall(r"[a-z]+", text.lower())[1:]
    plain = takewhile(lambda word: word not in grammar().prepositions, words)
    nouns = (word for word in plain if word == lemma_of(word) or word.endswith("s"))  # not "stuck"
    return [word for word in nouns if lemma_of(word) in things() and len(word) > _FEWEST]
