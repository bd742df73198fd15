"""A query held against every short script of a library: meaning first, then feeling, room and furniture (SIMS 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors
from planner_service.scripts.script import ShortScript
from planner_service.scripts.suitability import Demand, Limits, Scores, Traits, raises
from planner_service.themes.beats import EventClause as Clause, ThemeError, clauses_of

_EVENTS: Final = 0.5
"""How much the single events of a query count beside the whole of it."""
_RAISED: Final = 0.5
"""How much feeling, room and furniture count: less than for a story, since they are not what was asked."""
_SHARED: Final = 0.1
"""What it counts that a summary has the query's words, rare ones for most."""
_MOOD: Final = 0.3
"""How much it counts that a script feels like the query: sentence features hardly tell "passed" from "failed"."""


@dataclass(frozen=True)
class Found:
    """A short script and how well it answers what was asked, -1 to 1."""

    script: ShortScript
    score: float


class Searched(Protocol):
    """What a library knows of its scripts: see `ScriptLibrary`."""

    @property
    def encoder(self) -> SentenceEncoder: ...

    @property
    def traits(self) -> Traits: ...

    def scores(self, vectors: Vectors) -> Scores: ...

    def moods(self, vectors: Vectors) -> Scores: ...

    def sharing(self, text: str) -> Scores: ...


def answers(query: str, library: Searched) -> Scores:
    """How well each script answers the query, -1 to 1, rounded to 1e-4. (scripts,)."""
    clauses = _clauses(query)
    vectors = library.encoder.encode([query, *(clause.query for clause in clauses)])
    near = library.scores(vectors)
    whole, events = near[0], near[1:]
    if len(clauses) == 1:
        total = np.maximum(whole, events[0])  # what a saying means, where it is one
    elif clauses:
        total = (1 - _EVENTS) * whole + _EVENTS * events.mean(axis=0)
    else:
        total = whole
    total = total + _MOOD * library.moods(vectors[:1])[0][library.traits.emotions]
    for clause in clauses:
        demand = Demand(clause.text, clause.emotion, 1.0 if clause.sure else 0.8, -1.0, clause.room)
        raised = _RAISED * raises(demand, library.traits, Limits()) + _SHARED * library.sharing(clause.text)
        total = total + raised / len(clauses)
    answered: Scores = np.clip(total, -1.0, 1.0).round(4)
    return answered


def _clauses(query: str) -> tuple[Clause, ...]:
    try:
        return clauses_of(query)
    except ThemeError:
        return ()
