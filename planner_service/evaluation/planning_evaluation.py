"""How well themes are planned without a language model: search, and beats that are acted, beside their limits.

Where a search puts the right scripts: hits at one and three, and the mean reciprocal rank.

One measured figure over a labelled set and its halves, beside its limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeVar

import numpy as np

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Character
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import SPLITS, LabelledTheme, Query, Split, labelled_queries, labelled_themes
from planner_service.evaluation.second_labellers import judged_labellers
from planner_service.grounding.furnish import FurnishError, furnish
from planner_service.grounding.keyframes_to_actions import UnreachableError, act
from planner_service.narration.narrator import narrate
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_search import Scores
from planner_service.themes.beats import ThemeError
from scene_graphs.home import HomeError
from scene_graphs.navigation.path_planner import NoPath
from scene_graphs.retrieval.layout_index import LayoutIndex, NoSuitableRoom

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
    """A figure of the whole set and of each half."""

    name: str
    all: float
    tune: float
    held_out: float
    limit: float | None = None
    """None where it is only told."""
    sense: Literal["least", "below", "most"] = "least"
    judged: Part = "all"
    """Which of the three the limit is for."""
    unit: Literal["%", ""] = "%"
    """Shares are between 0 and 1 and shown in percent; the rest are counts."""

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
ACTED, UNASKED, NAMED, DEEDS = 0.85, 0.10, 0.95, 4.0


@dataclass(frozen=True)
class Evaluation:
    """Every figure, and what went wrong behind them."""

    figures: tuple[Figure, ...]
    misses: tuple[Miss, ...]
    encoder: str
    scripts: int
    """Size of the library."""


def evaluate_planning(
    library: ScriptLibrary, rooms: LayoutIndex, fresh: Sequence[LabelledTheme] | None = None
) -> Evaluation:
    """The shipped labels against a library that holds our short scripts, or `fresh` themes alone; no language model has
    a part in it."""
    if fresh is not None:
        themes = judged_themes(fresh, lambda theme: compose(theme, library, Request()))
        made = (*beat_figures(themes), *labeller_figures(fresh), executable(themes, rooms))
        figures = tuple(replace(one, judged="all") for one in made)
        return Evaluation(figures, tuple(theme_misses(themes)), library.encoder.name, len(library))
    found, missed = search_figures(labelled_queries(), library)
    themes = judged_themes(labelled_themes(), lambda theme: compose(theme, library, Request()))
    agreed = labeller_figures(labelled_themes())
    figures = (*found, *beat_figures(themes), *agreed, executable(themes, rooms))
    return Evaluation(figures, (*missed, *theme_misses(themes)), library.encoder.name, len(library))


def judged_themes(labels: Sequence[LabelledTheme], plan: Callable[[str], LongScript]) -> tuple[Judgement, ...]:
    """Every theme as it is planned, or refused."""

    def planned(theme: str) -> LongScript | None:
        try:
            return plan(theme)
        except ThemeError:
            return None

    return tuple(Judgement(label, planned(label.theme)) for label in labels)


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


def beat_figures(themes: Sequence[Judgement]) -> list[Figure]:
    """What became of the labelled beats, what was played that nobody asked for, and what was refused."""
    played = [one for one in themes if not one.label.refuse]
    labels = [one.label for one in played]

    def share(name: str, parts: Sequence[tuple[float, float]], limit: float | None = None) -> Figure:
        return figure(name, labels, parts, ratio if limit is None else fulfilled, limit, "held_out")

    beats = [
        share("beats: actable, acted in order", [(len(one.acted), len(one.actable)) for one in played], ACTED),
        share("beats: the rest, named as not acted", [_named_rest(one) for one in played]),
        share("beats: all not acted, named as such", [(len(one.named), len(one.missing)) for one in played], NAMED),
        share("beats: acted, yet named", [(len(one.doubted), len(one.acted)) for one in played]),
    ]
    stories = [narrate(one.script, Character()) if one.script else None for one in played]
    # What is a thought the narrator says itself: the first of the two does not believe it.
    told = [
        (len(one.told(story.text if story else "")), len(one.missing))
        for one, story in zip(played, stories, strict=True)
    ]
    as_done = [
        (len(one.told_as_done(story.events if story else "")), len(one.missing))
        for one, story in zip(played, stories, strict=True)
    ]
    unasked = share("screen time: unasked", [(one.unasked_seconds, one.seconds) for one in played])
    deeds = share("keyframes a beat", [(one.deeds, len(one.actable)) for one in played])
    forbidden = figure("keyframes: forbidden", labels, [len(one.forbidden) for one in played], sum, 0.0, "held_out")
    refused = [(float(one.script is None), 1.0) for one in themes]
    nonsense = [(one.label, part) for one, part in zip(themes, refused, strict=True) if one.label.refuse]
    sound = [part for one, part in zip(themes, refused, strict=True) if not one.label.refuse]
    return [
        *beats,
        share("beats: not acted, yet told", told),
        share("beats: not acted, yet told as done", as_done),
        replace(unasked, limit=UNASKED, sense="most"),
        replace(forbidden, sense="most", unit=""),
        replace(deeds, limit=DEEDS, sense="most", unit=""),
        figure(
            "nonsense: refused", [one for one, _ in nonsense], [part for _, part in nonsense], fulfilled, 1, "held_out"
        ),
        share("other themes: refused", sound),
    ]


def labeller_figures(labels: Sequence[LabelledTheme]) -> list[Figure]:
    """What two further labellers reach by these labels, handed the beats: as far as fair people agree."""
    figures = []
    for reader, themes in judged_labellers(labels).items():
        if not themes:
            continue
        read = [one.label for one in themes]
        for name, parts in (
            ("in order", [(len(one.acted), len(one.actable)) for one in themes]),
            ("not acted, named", [(len(one.named), len(one.missing)) for one in themes]),
        ):
            figures.append(figure(f"labeller {reader}, handed the beats: {name}", read, parts, ratio))
    return figures


def executable(themes: Sequence[Judgement], rooms: LayoutIndex) -> Figure:
    """Themes for which a home is found in which every keyframe becomes an action."""
    made = [(one.label, one.script) for one in themes if one.script is not None]
    able = [(float(not _fault(script, rooms)), 1.0) for _, script in made]
    return figure("scripts: executable", [label for label, _ in made], able, fulfilled, 1.0)


def theme_misses(themes: Sequence[Judgement]) -> list[Miss]:
    """Whatever keeps a figure of a theme from being perfect, one line each."""
    return [Miss(one.label.split, one.label.id, line) for one in themes for line in _missed(one)]


def _missed(one: Judgement) -> list[str]:
    if not one.refused_rightly:
        return ["refused" if one.script is None else f"played: “{one.label.theme[:60]}”"]
    beats, keyframes = one.label.beats, one.keyframes
    lost = [f"not acted{'' if index in one.named else ', and not named'}: “{beats[index].text}”"
            for index in one.missing if index in one.actable]  # fmt: skip
    hidden = [f"not named as not acted: “{beats[index].text}”"
              for index in one.missing if index not in (*one.actable, *one.named)]  # fmt: skip
    shown = [(f"{keyframes[index].skill} “{keyframes[index].caption}” at the {keyframes[index].furniture}", what)
             for what, places in (("forbidden", one.forbidden), ("unasked", one.unasked))
             for index in places if not connects(keyframes[index])]  # fmt: skip
    return [*lost, *hidden, *(f"{what}: {line}" for line, what in shown)]


def _named_rest(one: Judgement) -> tuple[int, int]:
    rest = [index for index in one.missing if index not in one.actable]
    return sum(index in one.named for index in rest), len(rest)


def _fault(script: LongScript, rooms: LayoutIndex) -> str:
    """Why a script cannot be acted out in any home; empty when it can."""
    try:
        stage = furnish(script, rooms, seed=script.seed)
        act(stage.script.keyframes, stage.places, stage.home, script.seed)
    except (FurnishError, NoSuitableRoom, HomeError, NoPath, UnreachableError) as error:
        return str(error)
    return ""


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


def ratio(parts: Sequence[tuple[float, float]]) -> float:
    """The sum of the first over the sum of the second, 0 for none."""
    whole = sum(of for _, of in parts)
    return sum(part for part, _ in parts) / whole if whole else 0.0


def fulfilled(parts: Sequence[tuple[float, float]]) -> float:
    """The same, 1 for none: where nothing is asked, nothing is missing."""
    return ratio(parts) if any(of for _, of in parts) else 1.0
