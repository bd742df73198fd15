"""What somebody looks for in a library, held against every script: meaning first, then feeling, room and furniture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from planner_service.scripts.events import Clause, ThemeError, clauses_of
from planner_service.scripts.suiting import Demand, Limits, raises
from planner_service.scripts.traits import Scores

if TYPE_CHECKING:
    from planner_service.scripts.library import ScriptLibrary

_EVENTS: Final = 0.5
"""How much the single events of a query count beside the whole of it."""
_RAISED: Final = 0.5
"""How much feeling, room and furniture count: less than for a story, since they are not what was asked."""
_SHARED: Final = 0.1
"""What it counts that a summary has the query's words, rare ones for most."""
_MOOD: Final = 0.3
"""How much it counts that a script feels like the query: sentence features hardly tell "passed" from "failed"."""


def answers(query: str, library: ScriptLibrary) -> Scores:
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
