"""How well themes are planned without a language model: search, coverage and variety beside their limits.

Where a search puts the right scripts: hits at one and three, and the mean reciprocal rank.

One measured figure over a labelled set and its halves, beside its limit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeVar

import numpy as np

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.evaluation.labels import SPLITS, LabelledTheme, Query, Split, labelled_queries, labelled_themes
from planner_service.evaluation.story_evaluation import SEEDS, Coverage, Theme, tell_themes
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_search import Scores
from scene_graphs.retrieval.layout_index import LayoutIndex

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


Part = Literal["all", "tune", "held_out"]
T = TypeVar("T")


@dataclass(frozen=True)
class Figure:
    """A figure of the whole set and of each half; shares are between 0 and 1."""

    name: str
    all: float
    tune: float
    held_out: float
    limit: float | None = None
    """None where it is only told."""
    sense: Literal["least", "below", "most"] = "least"
    judged: Part = "all"
    """Which of the three the limit is for."""

    @property
    def missed(self) -> bool:
        """Whether the limit is not kept."""
        value: float = getattr(self, self.judged)
        if self.limit is None:
            return False
        return {"least": value < self.limit, "below": value >= self.limit, "most": value > self.limit}[self.sense]


@dataclass(frozen=True)
class Miss:
    """One thing that went wrong, with the half it was found in."""

    split: Split
    id: str
    """Of the query or theme."""
    text: str


def figure(
    name: str,
    labels: Sequence[Query | LabelledTheme],
    values: Sequence[T],
    summed: Callable[[Sequence[T]], float],
    limit: float | None = None,
    judged: Part = "all",
) -> Figure:
    """A figure `summed` up of one value a label, over all and over each half. Rounded to 1e-4."""
    halves = {
        split: [value for label, value in zip(labels, values, strict=True) if label.split == split] for split in SPLITS
    }
    tune, held_out = (round(summed(halves[split]), 4) for split in SPLITS)
    return Figure(name, round(summed(list(values)), 4), tune, held_out, limit, judged=judged)


FIRST, FIRST_THREE = 0.87, 0.97
HIDDEN = 0.0
"""What is not covered is to be told as not covered."""
COVERED, VALID, OWN_THEME = 0.85, 1.0, 0.95


@dataclass(frozen=True)
class Evaluation:
    """Every figure, and what went wrong behind them."""

    figures: tuple[Figure, ...]
    misses: tuple[Miss, ...]
    encoder: str
    scripts: int
    """Size of the library."""


def evaluate_planning(library: ScriptLibrary, rooms: LayoutIndex) -> Evaluation:
    """The shipped labels against a library that holds our short scripts; no language model has a part in it."""
    found, missed = search_figures(labelled_queries(), library)
    themes = tell_themes(labelled_themes(), library, rooms)
    figures = (*found, *coverage_figures(themes), *variety_figures(themes))
    return Evaluation(figures, (*missed, *theme_misses(themes)), library.encoder.name, len(library))


def search_figures(queries: Sequence[Query], library: ScriptLibrary) -> tuple[list[Figure], list[Miss]]:
    """The search beside its parts and its fall-back, and the queries that it does not answer first."""
    hashed = ScriptLibrary(library.scripts, Features(HashingEncoder()))
    fused = ranked(queries, _searched(library))
    figures = [
        figure("search: right first", queries, fused, lambda part: hits(part, 1), FIRST, "held_out"),
        figure("search: right in three", queries, fused, lambda part: hits(part, 3), FIRST_THREE, "held_out"),
        figure("search: reciprocal rank", queries, fused, reciprocal_rank),
    ]
    for name, search in (
        ("meaning alone", _best(library, lambda query: library.scores(library.encoder.encode([query]))[0])),
        ("keywords alone", _best(library, lambda query: library.keywords.scores([query])[0])),
        ("with hashed words", _searched(hashed)),
    ):
        found = ranked(queries, search)
        figures.append(figure(f"{name}: right first", queries, found, lambda part: hits(part, 1)))
        figures.append(figure(f"{name}: right in three", queries, found, lambda part: hits(part, 3)))
    return figures, [_unfound(one) for one in fused if one.rank != 1]


def coverage_figures(themes: Sequence[Theme]) -> list[Figure]:
    """Valid and executable scripts, and what became of the labelled events, over all seeds."""
    labels = [theme.label for theme in themes]
    events = [[event for one in theme.woven for event in one.coverage] for theme in themes]
    wanted = [len(theme.label.events) * len(SEEDS) for theme in themes]
    lost = [count - len(each) for count, each in zip(wanted, events, strict=True)]  # of themes not understood

    def share(name: str, counts: Sequence[int], limit: float | None = None) -> Figure:
        return figure(name, labels, list(zip(counts, wanted, strict=True)), _share, limit)

    hidden = [sum(e.hidden for e in each) + more for each, more in zip(events, lost, strict=True)]
    valid = [(sum(one.valid for one in theme.woven), len(SEEDS)) for theme in themes]
    executable = [(int(not theme.fault), 1) for theme in themes]
    return [
        figure("themes: valid", labels, valid, _share, VALID),
        figure("themes: executable", labels, executable, _share, VALID),
        share("events: covered in order", [sum(event.covered for event in each) for each in events], COVERED),
        share("events: told as not covered", [sum(e.listed and not e.covered for e in each) for each in events]),
        replace(share("events: hidden", hidden), limit=HIDDEN, sense="most"),
        share("events: emotion right", [sum(event.felt for event in each) for each in events]),
    ]


def variety_figures(themes: Sequence[Theme]) -> list[Figure]:
    """How alike the stories of several seeds are, woven and improvised, and how near to their own themes."""
    labels = [theme.label for theme in themes]
    woven = figure(f"stories of {len(SEEDS)} seeds: alike", labels, [theme.alike for theme in themes], mean)
    direct = figure("improvised by direct: alike", labels, [theme.direct_alike for theme in themes], mean)
    least = [min(theme.nearness, default=0.0) for theme in themes]
    near = [(sum(share >= OWN_THEME for share in theme.nearness), len(SEEDS)) for theme in themes]
    return [
        replace(woven, limit=direct.all, sense="below"),
        direct,
        figure("nearer to its theme: least story", labels, least, min, OWN_THEME),
        figure("nearer to its theme: stories", labels, near, _share),
    ]


def theme_misses(themes: Sequence[Theme]) -> list[Miss]:
    """Whatever keeps a figure of a theme from being perfect, one line each with how many seeds it befell."""
    misses = []
    for theme in themes:
        lines = Counter(_missed(event) for one in theme.woven for event in one.coverage if not event.covered)
        lines += Counter(_unfelt(event) for one in theme.woven for event in one.coverage if not event.felt)
        lines += Counter("not valid" for one in theme.woven if not one.valid)
        lines += Counter("nearer to other themes" for share in theme.nearness if share < OWN_THEME)
        said = [f"{line} ({count} of {len(SEEDS)})" for line, count in lines.items()]
        said += [f"cannot be acted: {theme.fault}"] if theme.fault else []
        misses += [Miss(theme.label.split, theme.label.id, line) for line in said]
    return misses


def _searched(library: ScriptLibrary) -> Search:
    return lambda query, k: [found.script.id for found in library.search(query, k)]


def _best(library: ScriptLibrary, scores: Callable[[str], Scores]) -> Search:
    """By scores alone, and by id among equals."""
    names = np.array([script.id for script in library.scripts])
    return lambda query, k: list(names[np.lexsort((names, -scores(query)))[:k]])


def _unfound(result: Ranked) -> Miss:
    where = f"the first right one is {result.rank}." if result.rank else "no right one was found"
    first = result.found[0] if result.found else "nothing"
    return Miss(result.query.split, result.query.id, f"“{result.query.query}” finds {first}; {where}")


def _missed(event: Coverage) -> str:
    words, played = " ".join(event.event.words), ", ".join(event.played)
    if event.listed:
        return f"“{words}” is told as not covered"
    return f"“{words}” is played by {played}" if played else f"“{words}” is not there"


def _unfelt(event: Coverage) -> str:
    return f"“{' '.join(event.event.words)}” is {event.emotion or 'not felt'}, not {' or '.join(event.event.emotions)}"


def _share(counts: Sequence[tuple[int, int]]) -> float:
    whole = sum(of for _, of in counts)
    return sum(count for count, _ in counts) / whole if whole else 0.0
