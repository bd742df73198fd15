"""A theme's events held against the library: their feelings, and how well each short script suits each event."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.language.text import Vectors
from planner_service.scripts.events import Clause, moods_of
from planner_service.scripts.keyframe import Event
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.sentences import state_words
from planner_service.scripts.suiting import Limits, Wish, suitability
from planner_service.scripts.traits import Scores

NEAREST: Final = {"hashing": 0.15}
"""Scores below this are no match, by encoder name; `_NEAREST` for any that knows meaning."""
_NEAREST: Final = 0.27
"""Measured for MiniLM: "goes to work" has 0.29 with this library, "lorem ipsum dolor sit amet" 0.26."""
_BARE_NOUN: Final = 0.1
"""What an event without a verb must reach above that."""
MEANINGS: Final = {
    "happy": "is happy, excited and full of joy",
    "angry": "is angry and furious about something unfair",
    "hurried": "is late and in a hurry, rushing to be in time",
    "tired": "is tired and sleepy and needs rest",
    "sad": "is sad, in tears over a loss or bad news",
    "stressed": "is stressed, worried and afraid",
    "drunk": "is drunk on alcohol",
    "relaxed": "is relaxed, calm and comfortable",
}
"""What each emotion looks like; an event without a word of feeling is compared with these."""
_CONTEXT, _MOOD_CONTEXT = 0.25, 0.5
"""How much nearness to the whole theme counts beside nearness to the event; more where it is a bare mood."""
_NAMED: Final = 0.08
"""What it counts that a summary has a rare word of the event."""
_READ: Final = 300
"""Letters of the theme read as a whole: a long text takes the encoder as long as all its events."""
_UNSURE: Final = 0.8
"""How much an emotion counts that no word names."""
_FELT, _AHEAD = 0.35, 0.06
"""How near an event must be to an emotion's meaning, and how much nearer than to the next, to show it."""


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
    moods = moods_of(clauses, _judged(vectors[:-1], library))
    nearest = NEAREST.get(library.encoder.name, _NEAREST)
    wishes = [
        Wish(
            clause.text,
            mood,
            1.0 if clause.sure else _UNSURE,
            nearest if clause.active else nearest + _BARE_NOUN,
            clause.room,
        )
        for clause, mood in zip(clauses, moods, strict=True)
    ]
    events = tuple(Event(text=clause.text, emotion=mood) for clause, mood in zip(clauses, moods, strict=True))
    suits = suitability(wishes, scores, library.traits, limits)
    weights = np.array([[_MOOD_CONTEXT if state_words(clause.text) else _CONTEXT] for clause in clauses])
    named = np.array([library.naming(clause.text) for clause in clauses])
    return Reading(events, scores, np.where(suits > 0, suits + weights * context + _NAMED * named, suits))


def _judged(vectors: Vectors, library: ScriptLibrary) -> list[str | None]:
    """The emotion whose meaning each vector is clearly nearest to, or None."""
    near = np.round(vectors @ library.vectors_of(tuple(MEANINGS.values())).T, 4)  # (events, emotions)
    order = np.argsort(-near, axis=1, kind="stable")
    judged: list[str | None] = []
    for row, (first, second, *_) in zip(near, order, strict=True):
        clear = row[first] >= _FELT and row[first] - row[second] >= _AHEAD
        judged.append(tuple(MEANINGS)[first] if clear else None)
    return judged
