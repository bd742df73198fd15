"""Which short script plays which event of a theme: what suits best and follows well, no script twice.

How well one comes after others: rooms, mood, what must have been before, and no repetition.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.suitability import After, Before, Codes, Scores, Traits

BEAM: Final = 64
"""Beginnings of a story that are followed up at the same time."""
WIDTH: Final = 40
"""Scripts that are considered for each row."""
_SAME_ROOM: Final = 0.06
_STEADY: Final = 0.04
"""What it counts that a mood stays where the events' mood stays."""
_OUT_OF_ORDER: Final = 0.12
"""What it costs to fall asleep and go on as if nothing were, to wake without having slept, and so on."""
_REPEATED, _ALIKE = 0.4, 0.6
"""What likeness of two summaries above that costs."""
_NOBODY: Final = -5.0
"""A row for which nothing is left."""


@dataclass(frozen=True)
class Row:
    """The scripts that may play one row of a story, best first."""

    scripts: Codes
    """Indices into the library, (K,)."""
    suits: Scores
    """How well each suits the event by itself, (K,)."""
    mood: str
    """The event's."""


def succession(rows: Sequence[Row], traits: Traits, vectors: NDArray[np.float32]) -> list[int | None]:
    """A script for each row, None where nothing is left: the best sum of what suits and what follows well.

    A beam search, so the sum is near the largest and not always the largest. `vectors` are the summaries', one row a
    candidate in the order of the rows: (sum of K, D). No script, and no two with the same keyframes, come twice.
    """
    bounds = np.cumsum([0, *(len(row.scripts) for row in rows)])
    scripts = np.concatenate([row.scripts for row in rows])
    likeness = vectors @ vectors.T
    repeats: Scores = np.where(likeness > _ALIKE, _REPEATED * (likeness - _ALIKE), 0.0)
    repeats[traits.runs[scripts][:, None] == traits.runs[scripts][None, :]] = np.inf
    chosen = np.full((1, 0), -1, dtype=np.intp)  # (beams, rows so far), candidates or -1
    sums = np.zeros(1)
    for number, row in enumerate(rows):
        places = np.arange(bounds[number], bounds[number + 1])
        follows = _follows(rows, number, traits, scripts, places)
        total = np.tile(sums[:, None] + row.suits[None, :], 1)
        for past in range(number):
            earlier = chosen[:, past]
            there = earlier >= 0
            total[there] -= repeats[np.ix_(earlier[there], places)]
        if number:
            last = chosen[:, -1]
            total[last >= 0] += follows[last[last >= 0] - bounds[number - 1]]
        nobody = (sums + _NOBODY)[:, None]
        total = np.concatenate([total, nobody], axis=1).round(6)
        order = np.argsort(-total, axis=None, kind="stable")[:BEAM]
        order = order[np.isfinite(total.ravel()[order])]
        beams, columns = np.unravel_index(order, total.shape)
        added = np.where(columns < len(places), columns + bounds[number], -1)
        chosen = np.concatenate([chosen[beams], added[:, None]], axis=1)
        sums = total[beams, columns]
    return [int(scripts[place]) if place >= 0 else None for place in chosen[0]]


def _follows(rows: Sequence[Row], number: int, traits: Traits, scripts: Codes, places: Codes) -> Scores:
    """How well each candidate of a row follows each of the row before. (K before, K)."""
    here = scripts[places]
    if not number:
        return np.zeros((0, len(here)))
    before, row = rows[number - 1].scripts, rows[number]
    total: Scores = np.where(traits.rooms[before][:, None] == traits.rooms[here][None, :], _SAME_ROOM, 0.0)
    if rows[number - 1].mood == row.mood:
        total += np.where(traits.emotions[before][:, None] == traits.emotions[here][None, :], _STEADY, 0.0)
    left, wanted = traits.after[before][:, None], traits.before[here][None, :]
    agrees = (
        ((left == After.ASLEEP) & (wanted == Before.ASLEEP))
        | ((left == After.AWAY) & (wanted == Before.AWAY))
        | ((left == After.ABOUT) & (wanted == Before.ANYTHING))
    )
    return total - np.where(agrees, 0.0, _OUT_OF_ORDER)


NEAR_TIE: Final = 0.15
"""Scripts this close together may change places: the seed chooses."""
_FREER: Final = 3


def cast(
    suits: Scores, events: Sequence[int], moods: Sequence[str], library: ScriptLibrary, seed: int
) -> list[int | None]:
    """The script for each row, None where nothing suits: what suits best and follows well, near ties by the seed.

    `suits` (rows, scripts) is how well each suits the row's event. A second row of an event is freer than the first.
    """
    rows = []
    for number, mood in enumerate(moods):
        freedom = NEAR_TIE if number == events.index(events[number]) else _FREER * NEAR_TIE
        luck = np.random.default_rng([seed, number]).uniform(0, freedom, suits.shape[1])
        drawn: Scores = (suits[number] + luck).round(6)
        best = _best(drawn, max(WIDTH, len(moods)))
        rows.append(Row(best, drawn[best], mood))
    vectors = library.summaries([int(index) for row in rows for index in row.scripts])
    return succession(rows, library.traits, vectors)


def _best(suits: Scores, count: int) -> Codes:
    """The places of the largest suits above nothing, largest first."""
    places = np.argpartition(-suits, count)[:count] if count < len(suits) else np.arange(len(suits))
    places = places[suits[places] > 0]
    return places[np.lexsort((places, -suits[places]))]
