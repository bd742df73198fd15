"""The seven themes made into stories in one warm process: how long each stage takes and how well the body did."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from benchmarks.figure import Figure
from benchmarks.themes import LONG, SEED, THEMES
from motion_backend.director import Director
from motion_backend.formats.glb_film import film_glb
from motion_backend.metrics.story_metrics import summarise
from motion_backend.motion import Motion
from motion_backend.rendering.film_frames import compile_film
from planner_service.grounding.keyframes_to_actions import act
from planner_service.output.film import Filmed, write_film
from planner_service.output.storyboard import storyboard
from planner_service.pipeline import Pipeline, Planned, Story, StoryRequest, judge, move

PLAN_MS, SPEED = 300.0, 40.0
REACHED, CONTACT_CM, PEN_MEAN_CM, PEN_SHARE = 95.0, 3.0, 2.0, 5.0
SKATE = 16.0
"""Percent; the published definition calls so much of recorded walking skating (docs/metrics.md)."""
FILM_MS, FILM_MB = 300.0, 1.5
FILMED_S, FILMED_MB = 30.0, 8.0
MINUTE = 60
REPEATS = 3
T = TypeVar("T")


@dataclass(frozen=True)
class Timed:
    """A story and what making it took, in seconds."""

    name: str
    story: Story
    plans: tuple[float, ...]
    """Theme to narrated story, each time it was done."""
    acted: float
    moved: float
    judged: float

    @property
    def speed(self) -> float:
        """How many times faster the motion is made than it plays."""
        return self.story.motion.duration / self.moved


def silent(stage: str, share: float) -> None:
    """Progress that nobody watches."""


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """What some work gives, and its seconds."""
    started = time.perf_counter()
    return work(), time.perf_counter() - started


def make_stories(pipeline: Pipeline) -> list[Timed]:
    """All seven stories; each is planned once untimed, so that every cache that a server would have is warm."""
    return [_make(pipeline, name, StoryRequest(theme, seed=SEED)) for name, theme in THEMES.items()]


def _make(pipeline: Pipeline, name: str, request: StoryRequest) -> Timed:
    planned: Planned = pipeline.plan(request)
    plans = tuple(timed(lambda: pipeline.plan(request))[1] for _ in range(REPEATS))
    script, stage = planned.script, planned.stage
    actions, acted = timed(lambda: act(script.keyframes, stage.places, planned.home, request.seed))
    motions, moved = timed(lambda: move(Director.of(request.backend), planned, actions, silent))
    story, judged = timed(lambda: judge(planned, actions, motions, silent))
    return Timed(name, story, plans, acted, moved, judged)


def speed_figures(made: Sequence[Timed]) -> list[Figure]:
    """Planning and moving against their limits."""
    plans = 1000 * np.array([seconds for one in made for seconds in one.plans])
    slowest = min(made, key=lambda one: one.speed)
    played = sum(one.story.motion.duration for one in made)
    total = played / sum(one.moved for one in made)
    runs = f"{len(made)} themes × {REPEATS}, warm"
    return [
        Figure("theme to narrated story, median", float(np.median(plans)), "ms", PLAN_MS, note=runs, digits=0),
        Figure("theme to narrated story, p90", float(np.quantile(plans, 0.9)), "ms", PLAN_MS, note=runs, digits=0),
        Figure("motion against playing it, all", total, "×", SPEED, "least", f"{played:.0f} s of motion", 0),
        Figure("motion against playing it, slowest", slowest.speed, "×", SPEED, "least", slowest.name, 0),
    ]


def file_figures(pipeline: Pipeline, folder: Path) -> list[Figure]:
    """Writing and filming a minute of a longer story, and its whole storyboard. ValueError where it is no minute."""
    story = pipeline.make(StoryRequest(LONG, seed=SEED))
    planned, count = story.planned, len(story.actions)
    minute = story.motion.part(0, MINUTE * story.motion.fps)
    if minute.duration < MINUTE:
        raise ValueError(f"a story of {minute.duration:.0f} s tells nothing of one of {MINUTE} s")
    film, writing = timed(lambda: film_glb(planned.home, minute, story.role))
    _, again = timed(lambda: film_glb(planned.home, minute, story.role))
    targets = [action.object_id for action in story.actions]
    _, drawing = timed(
        lambda: storyboard(planned.home, story.motion, planned.script.keyframes, folder / "board.png", "", targets)
    )
    filmed, filming, worked, shown = _film(story, minute, folder)
    speed = f"{shown:.0f} s of film, {shown / filming:.1f} times as fast as it plays, {worked:.0f} s of one core"
    length = f"the first minute of {story.motion.duration:.0f} s, {len(planned.home.rooms)} rooms"
    looks = f"{length}; with the body built; once it is, {1000 * again:.0f} ms"
    return [
        Figure("film.glb of a 60 s story, written", 1000 * writing, "ms", FILM_MS, note=looks, digits=0),
        Figure("film.glb of a 60 s story, size", len(film) / 1e6, "MB", FILM_MB, note=length, digits=2),
        Figure(
            "film.mp4 of a 60 s story, filmed",
            filming,
            "s",
            FILMED_S,
            note=f"{length}; 1280 × 720; {speed}",
        ),
        Figure("film.mp4 of a 60 s story, size", filmed, "MB", FILMED_MB, note=length),
        Figure("storyboard for 20 keyframes", drawing / count * 20, "s", note=f"from {count} keyframes"),
    ]


def _film(story: Story, part: Motion, folder: Path) -> tuple[float, float, float, float]:
    """Megabytes of a film of the beginning of a story, seconds it took, seconds of one core, and how long it is."""
    compile_film()
    cut = tuple((min(start, len(part)), min(stop, len(part))) for start, stop in story.segments)
    filmed = Filmed(story.planned.home, part, story.planned.told, cut, story.role)
    before = time.process_time()
    path, seconds = timed(lambda: write_film(filmed, folder / "film.mp4"))
    return path.stat().st_size / 1e6, seconds, time.process_time() - before, len(filmed.edit) / part.fps


def quality(report: dict[str, Any]) -> tuple[float, float, float, float, float]:
    """Reached %, contact error cm, pen_mean cm, pen_share %, skate_ratio_loco % of a report."""
    return (
        100 * report["success"],
        100 * (report["contact_error"] or 0.0),
        100 * report["pen_mean"],
        100 * report["pen_share"],
        100 * report["skate_ratio_loco"],
    )


def quality_figures(made: Sequence[Timed]) -> list[Figure]:
    """The worst story of the seven against each limit; the note tells the figure over all."""
    reports = [one.story.report for one in made]
    rows = np.array([quality(report) for report in reports])
    whole = quality(summarise([figure for one in made for figure in one.story.figures]))
    keyframes, reached = (sum(report[name] for report in reports) for name in ("keyframes", "reached"))
    beats = [one.story.beats for one in made]
    asked = sum(one.asked for one in beats)
    return [
        Figure("beats not acted", asked - sum(one.acted for one in beats), "", 0, note=f"of {asked}", digits=0),
        Figure("keyframes reached", rows[:, 0].min(), "%", REACHED, "least", f"all: {reached} of {keyframes}"),
        Figure("contact error", rows[:, 1].max(), "cm", CONTACT_CM, note=f"all: {whole[1]:.2f} cm", digits=2),
        Figure("pen_mean", rows[:, 2].max(), "cm", PEN_MEAN_CM, note=f"all: {whole[2]:.2f} cm", digits=2),
        Figure("pen_share", rows[:, 3].max(), "%", PEN_SHARE, note=f"all: {whole[3]:.2f} %", digits=2),
        Figure("skate_ratio_loco", rows[:, 4].max(), "%", SKATE, note=f"all: {whole[4]:.2f} %", digits=2),
    ]
