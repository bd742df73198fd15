"""Which short script plays which event of a theme: what suits best and follows well, no script twice."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.succession import WIDTH, Row, succession
from planner_service.scripts.traits import Codes, Scores

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
