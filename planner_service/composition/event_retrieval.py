"""A theme's events held against the library: their feelings, and how well each short script suits each event."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.motion import Emotion
from planner_service.scripts.emotion_classifier import clear_moods
from planner_service.scripts.script import Beat
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.suitability import Demand, Limits, Scores, suitability
from planner_service.themes.beats import EventClause as Clause, moods_of
state_words = lambda text: None

MIN_SCORES: Final = {"hashing": 0.15}
"""Scores below this are no match, by encoder name; `_MIN_SCORE` for any that knows meaning."""
_MIN_SCORE: Final = 0.27
"""Measured for MiniLM: "goes to work" has 0.29 with this library, "lorem ipsum dolor sit amet" 0.26."""
_BARE_NOUN: Final = 0.1
"""What an event without a verb must reach above that."""
_CONTEXT, _MOOD_CONTEXT = 0.25, 0.5
"""How much nearness to the whole theme counts beside nearness to the event; more where it is a bare mood."""
_SHARED: Final = 0.5
"""What it counts that a summary has the event's words, rare ones for most."""
_ABOUT: Final = 0.23
"""How much nearer than the nearest that may be chosen a script is that is about an event.

On our labelled themes a third of the events that were played wrongly stay below, and 4 % of those played rightly.
"""
_READ: Final = 300
"""Letters of the theme read as a whole: a long text takes the encoder as long as all its events."""
_UNSURE: Final = 0.8
"""How much an emotion counts that no word names."""
_LIKE: Final = 0.15
"""How much it counts that a script feels like the event."""


@dataclass(frozen=True)
class Reading:
    """The events of a theme and what the library has for them."""

    events: tuple[Beat, ...]
    scores: Scores
    """How near in meaning, (events, scripts)."""
    suits: Scores
    """The same with feeling, rooms, furniture and theme weighed in; negative where nothing may be chosen."""
    tells: Scores
    """How near each script is to what the event says, in meaning and words; feeling and all else left out."""
    enough: float
    """What `tells` must reach for a script to be about the event, and not only the nearest there is."""

    def told(self, chosen: Sequence[tuple[int, int]]) -> frozenset[int]:
        """The events that one of these scripts is about; `chosen` is (event, script)."""
        return frozenset(event for event, script in chosen if self.tells[event, script] >= self.enough)

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
    nearest = MIN_SCORES.get(library.encoder.name, _MIN_SCORE)
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
    events = tuple(Beat(text=clause.text, emotion=Emotion(mood)) for clause, mood in zip(clauses, moods, strict=True))
    suits = suitability(demands, scores, library.traits, limits)
    weights = np.array([[_MOOD_CONTEXT if state_words(clause.text) else _CONTEXT] for clause in clauses])
    shared = np.array([library.sharing(clause.text) for clause in clauses])
    tells: Scores = scores + _SHARED * shared
    raised = weights * context + _SHARED * shared + _LIKE * felt[:, library.traits.emotions]
    return Reading(events, scores, np.where(suits > 0, suits + raised, suits), tells, nearest + _ABOUT)
