"""Where a search puts the right scripts: hits at one and three, and the mean reciprocal rank."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from planner_service.evaluating.labels import Query

Search = Callable[[str, int], Sequence[str]]
"""Ids of the k scripts nearest to a query, nearest first."""
DEPTH: Final = 10
"""How far down a ranking is read."""


@dataclass(frozen=True)
class Ranked:
    """A query with what was found for it."""

    query: Query
    found: tuple[str, ...]
    """Ids, best first, `DEPTH` at most."""

    @property
    def rank(self) -> int | None:
        """Where the first right script stands, from 1; None when it is not among those read."""
        return next((place for place, found in enumerate(self.found, 1) if found in self.query.right), None)


def ranked(queries: Sequence[Query], search: Search) -> tuple[Ranked, ...]:
    """What the search finds for every query."""
    return tuple(Ranked(query, tuple(search(query.query, DEPTH))[:DEPTH]) for query in queries)


def hits(results: Sequence[Ranked], k: int) -> float:
    """Share of the queries with a right script among the first k."""
    return mean([result.rank is not None and result.rank <= k for result in results])


def reciprocal_rank(results: Sequence[Ranked]) -> float:
    """Mean of one over the rank of the first right script, 0 where none was found."""
    return mean([1 / result.rank if result.rank else 0.0 for result in results])


def mean(values: Sequence[float]) -> float:
    """Their mean, 0 for none."""
    return sum(values) / len(values) if values else 0.0
