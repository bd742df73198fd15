"""A theme's events held against the library: their feelings, and how well each short script suits each event."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from planner_service.scripts.events import Clause, moods_of
from planner_service.scripts.keyframe import Event
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.mood_reader import clear_moods
from planner_service.scripts.sentences import state_words
from planner_service.scripts.suiting import Demand, Limits, suitability
from planner_service.scripts.traits import Scores

NEAREST: Final = {"hashing": 0.15}
"""Scores below this are no match, by encoder name; `_NEAREST` for any that knows meaning."""
_NEAREST: Final = 0.27
"""Measured for MiniLM: "goes to work" has 0.29 with this library, "lorem ipsum dolor sit amet" 0.26."""
_BARE_NOUN: Final = 0.1
"""What an event without a verb must reach above that."""
_CONTEXT, _MOOD_CONTEXT = 0.25, 0.5
"""How much nearness to the whole theme counts beside nearness to the event; more where it is a bare mood."""
_SHARED: Final = 0.5
"""What it counts that a summary has the event's words, rare ones for most."""
_READ: Final = 300
"""Letters of the theme read as a whole: a long text takes the encoder as long as all its events."""
_UNSURE: Final = 0.8
"""How much an emotion counts that no word names."""
_LIKE: Final = 0.15
"""How much it counts that a script feels like the event."""


@dataclass(frozen=True)
class Reading:
    """The events of a theme and what the library has for them."""

    events: tuple[Event, ...]
    scores: Scores
    """How near in meaning, (events, scripts)."""
    suits: Scores
    """The same with feeling, rooms, furniture and theme weighed in; negative where nothing may be chosen."""

    @property
    def covered(self) -> tuple[int, ...]:
        """Events for which there is a script at all."""
        return tuple(index for index, row in enumerate(self.suits) if row.max(initial=-1.0) > 0)


def read(theme: str, clauses: Sequence[Clause], library: ScriptLibrary, limits: Limits) -> Reading:
    """Look at all events, and at the theme as a whole, in one call of the encoder."""
    vectors = library.encoder.encode([*(clause.query for clause in clauses), theme[:_READ]])
    *scored, context = library.scores(vectors)
    scores = np.array(scored)
    felt = library.moods(vectors[:-1])
    moods = moods_of(clauses, clear_moods(felt))
    nearest = NEAREST.get(library.encoder.name, _NEAREST)
    demands = [
        Demand(
            clause.text,
            mood,
            1.0 if clause.sure else _UNSURE,
            nearest if clause.active else nearest + _BARE_NOUN,
            clause.room,
        )
        for clause, mood in zip(clauses, moods, strict=True)
    ]
    events = tuple(Event(text=clause.text, emotion=mood) for clause, mood in zip(clauses, moods, strict=True))
    suits = suitability(demands, scores, library.traits, limits)
    weights = np.array([[_MOOD_CONTEXT if state_words(clause.text) else _CONTEXT] for clause in clauses])
    shared = np.array([library.sharing(clause.text) for clause in clauses])
    raised = weights * context + _SHARED * shared + _LIKE * felt[:, library.traits.emotions]
    return Reading(events, scores, np.where(suits > 0, suits + raised, suits))
