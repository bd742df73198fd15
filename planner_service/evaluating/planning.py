"""How well themes are planned without a language model: search, coverage and variety beside their limits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from motion_backend.language.text import HashingEncoder
from planner_service.evaluating.covering import Coverage
from planner_service.evaluating.figures import Figure, Miss, figure
from planner_service.evaluating.keywords import KeywordSearch
from planner_service.evaluating.labels import Query, labelled_queries, labelled_themes
from planner_service.evaluating.ranking import Ranked, Search, hits, mean, ranked, reciprocal_rank
from planner_service.evaluating.stories import SEEDS, Theme, tell_themes
from planner_service.scripts.library import Features, ScriptLibrary
from scene_graphs.retrieval import LayoutIndex

FIRST, FIRST_THREE = 0.80, 0.95
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
    """Dense search, beside hashed words and shared words, and the queries that dense search does not answer first."""
    hashed = ScriptLibrary(library.scripts, Features(HashingEncoder()))
    dense = ranked(queries, _dense(library))
    figures = [
        figure("search: right first", queries, dense, lambda part: hits(part, 1), FIRST, "held_out"),
        figure("search: right in three", queries, dense, lambda part: hits(part, 3), FIRST_THREE, "held_out"),
        figure("search: reciprocal rank", queries, dense, reciprocal_rank),
    ]
    for name, search in (("hashed words", _dense(hashed)), ("keywords", KeywordSearch(library.scripts).search)):
        found = ranked(queries, search)
        figures.append(figure(f"{name}: right first", queries, found, lambda part: hits(part, 1)))
        figures.append(figure(f"{name}: right in three", queries, found, lambda part: hits(part, 3)))
    return figures, [_unfound(one) for one in dense if one.rank != 1]


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


def _dense(library: ScriptLibrary) -> Search:
    return lambda query, k: [found.script.id for found in library.search(query, k)]


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
