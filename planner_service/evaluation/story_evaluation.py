"""How well whole stories are acted: themes planned and acted as a user's are, every figure over all of them beside its
limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import cycle, islice, repeat
from typing import Any, Final

import numpy as np

from motion_backend.metrics.figure_limits import STORY_LIMITS, Limit
from motion_backend.metrics.joint_speed import MOST
from motion_backend.metrics.skin_penetration import THIN, SkinDepth, skin_penetration
from motion_backend.metrics.story_figures import story_figures
from motion_backend.metrics.story_flow import Share
from motion_backend.motion import Skill
from planner_service.evaluation.body_evaluation import in_processes
from planner_service.evaluation.labels import labelled_themes
from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline, Story, StoryRequest
from planner_service.settings import read_settings
from scene_graphs.errors import UserError
from scene_graphs.meshes.convex_shapes import convex_shapes

RESAMPLES: Final = 1000
BY_TIME: Final = (
    "skate", "slip", "pen_mean", "pen_share", "floor_pen", "floating", "self_pen_share", "limits_share",
    "frozen_share", "jerk", "jerk_peak",
)  # fmt: skip
"""Figures of a story that count by its seconds when stories are added up."""
LARGEST: Final = ("pen_max", "skin_pen_max", "self_pen_max", "joint_speed", "seam_jump", "seam_speed_jump")
"""Figures of which the largest of all stories counts."""
Progress = Callable[[int, int], None]


@dataclass(frozen=True, order=True)
class StoryTrial:
    """A theme and the seed that it is made into a story with."""

    theme: str
    seed: int


@dataclass(frozen=True)
class StoryResult:
    """What came of one story."""

    trial: StoryTrial
    seconds: float = 0.0
    shares: Mapping[str, Share] | None = None
    """Every figure that stories are added up by; None where there is no story."""
    largest: Mapping[str, float] | None = None
    """And those of which the largest counts."""
    report: Mapping[str, Any] | None = None
    """Figures as the story's own report.json has them, and those of its skin."""
    fault: str = ""
    """Why there is no story."""


@dataclass(frozen=True)
class StoryFigure:
    """A figure over many stories, with a 95 % interval over stories."""

    name: str
    value: float
    low: float
    high: float
    stories: int
    """In how many there is something to measure."""
    missed_in: int
    """How many of them miss the limit by themselves."""
    limit: Limit | None = None

    @property
    def missed(self) -> bool:
        """Whether it does not keep its limit."""
        return self.limit is not None and self.limit.missed(self.value)


def plan_stories(themes: Sequence[str], count: int | None, seeds: int = 1) -> list[StoryTrial]:
    """So many stories, each theme once before any is told again with the next seed; or each theme with every seed."""
    if count is None:
        return [StoryTrial(theme, seed) for seed in range(seeds) for theme in themes]
    seeded = (seed for one in range(count) for seed in repeat(one, len(themes)))
    return [StoryTrial(theme, seed) for theme, seed in islice(zip(cycle(themes), seeded, strict=False), count)]


def own_themes() -> tuple[str, ...]:
    """The labelled themes that rules are tuned on: what is kept apart to judge planning by is not looked at here."""
    return tuple(label.theme for label in labelled_themes() if label.split == "tune" and not label.refuse)


def run_stories(
    trials: Sequence[StoryTrial], workers: int, progress: Progress = lambda _done, _all: None
) -> list[StoryResult]:
    """Make and judge all of them, in as many processes; the same whatever their number."""
    found = []
    for result in in_processes(run_story, trials, workers):
        found.append(result)
        progress(len(found), len(trials))
    return sorted(found, key=lambda result: result.trial)


@lru_cache(maxsize=1)
def _pipeline() -> Pipeline:
    """By rules and with the library that is shipped: a model of somebody's own plans otherwise every time."""
    return Pipeline(Shelves(cache=read_settings().cache_dir))


def run_story(trial: StoryTrial) -> StoryResult:
    """Make and judge one story; one that cannot be made says why."""
    try:
        story = _pipeline().make(StoryRequest(trial.theme, seed=trial.seed))
    except UserError as error:
        return StoryResult(trial, fault=str(error))
    skin = _skin(story)
    seen = {"skin_pen_share": round(skin.share, 5), "skin_pen_max": round(skin.most, 5)}
    report = dict(story.report) | seen
    shares = dict(_shares(story)) | {"skin_pen_share": Share(skin.share * len(skin.depths), len(skin.depths))}
    return StoryResult(trial, story.motion.duration, shares, {name: float(report[name]) for name in LARGEST}, report)


def _skin(story: Story) -> SkinDepth:
    """How deep the skin is in what is drawn, action by action, since each may sink into what it uses."""
    shapes = convex_shapes(story.planned.home, THIN)
    found = [
        skin_penetration(story.motion.part(*span), action, shapes).depths
        for action, span in zip(story.actions, story.segments, strict=True)
    ]
    return SkinDepth(np.concatenate(found))


def _shares(story: Story) -> Iterator[tuple[str, Share]]:
    """Every figure of a story, with what it counts when stories are added up."""
    figures, report = story.figures, story.report
    seconds = sum(figure.seconds for figure in figures)
    yield "success", Share(sum(figure.reached for figure in figures), len(figures))
    for name in ("contact_error", "contact_mean"):
        errors = [getattr(figure, name) for figure in figures if getattr(figure, name) is not None]
        yield name, Share(sum(errors), len(errors))
    for name in BY_TIME:
        yield name, Share(report[name] * seconds, seconds)
    walks = sum(figure.seconds for figure in figures if figure.skill == Skill.LOCO.value)
    yield "skate_ratio_loco", Share(report["skate_ratio_loco"] * walks, walks)
    yield "fast_stories", Share(report["joint_speed"] > MOST, 1)
    if report["jerk_against_real"] is not None:
        yield "jerk_against_real", Share(report["jerk_against_real"], 1)
    whole = story_figures(story.motion, story.actions, story.segments)
    yield from ((name, one) for name, one in vars(whole).items() if isinstance(one, Share))


def sum_up_stories(results: Sequence[StoryResult], seed: int = 0) -> list[StoryFigure]:
    """Each figure over all stories with its limit if it has one; intervals draw stories anew."""
    made = [result for result in results if result.shares is not None]
    limits = {limit.figure: limit for limit in STORY_LIMITS}
    figures = []
    for name in dict.fromkeys(name for result in made for name in result.shares or ()):
        shares = [result.shares[name] for result in made if result.shares and name in result.shares]
        own = [share for share in shares if share.whole]
        if own:
            limit = limits.get(name)
            missed = sum(limit is not None and share.value is not None and limit.missed(share.value) for share in own)
            figures.append(StoryFigure(name, *_with_interval(own, seed), len(own), missed, limit))
    for name in LARGEST:
        values = [result.largest[name] for result in made if result.largest]
        if values:
            limit = limits.get(name)
            missed = sum(limit is not None and limit.missed(value) for value in values)
            figures.append(StoryFigure(name, *(max(values),) * 3, len(values), missed, limit))
    order = {name: place for place, name in enumerate(limits)}
    return sorted(figures, key=lambda figure: (order.get(figure.name, len(order)), figure.name))


def _with_interval(shares: Sequence[Share], seed: int) -> tuple[float, float, float]:
    """All parts over all wholes, and the bootstrapped interval of that."""
    parts, wholes = (np.array(column, dtype=float) for column in zip(*((s.part, s.whole) for s in shares), strict=True))
    drawn = np.random.default_rng(seed).integers(len(parts), size=(RESAMPLES, len(parts)))
    low, high = np.quantile(parts[drawn].sum(axis=1) / wholes[drawn].sum(axis=1), [0.025, 0.975])
    return float(parts.sum() / wholes.sum()), float(low), float(high)


def worst_stories(
    results: Sequence[StoryResult], figures: Sequence[StoryFigure], most: int = 2
) -> list[dict[str, Any]]:
    """Of every figure that misses its limit, the stories that miss it most."""
    rows = []
    for figure in (one for one in figures if one.missed and one.limit is not None):
        told = [(result, result.report[figure.name]) for result in results if result.report]
        measured = [(result, value) for result, value in told if value is not None]
        low = figure.limit is not None and figure.limit.least is not None and figure.limit.missed(-np.inf)
        measured.sort(key=lambda one: float(one[1]), reverse=not low)
        rows += [
            {"figure": figure.name, "value": value, "theme": result.trial.theme, "seed": result.trial.seed}
            for result, value in measured[:most]
        ]
    return rows
