"""How well a simulated body follows what a kinematic one plans: trials of single skills, and whole stories.

Rooms, captions and seeds are drawn by chance from the library; nothing was tuned on any of them. What leads up to a
trial is kinematic, so that each also takes up a body in the middle of what it does.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np

from motion_backend.backends import DEFAULT_BACKEND
from motion_backend.director import Director, shares
from motion_backend.metrics.foot_skate import carried_slip, floor_penetration, skate_ratio, skate_speed, support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.smoothness import jerk
from motion_backend.motion import Motion, Skill
from motion_backend.physics.physics_record import physics_of
from planner_service.evaluation.intervals import drawn_anew, wilson
from planner_service.evaluation.trials import Performance, Trial, perform, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.captions import captions
from planner_service.settings import read_settings
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

BACKEND: Final = "physics"
DRAWN: Final = 1601
"""The seed of rooms and captions."""
LIMITS: Final = {
    "slip": 4.0, "skate_ratio": 0.05, "floor_pen": 0.004, "jerk_ratio": 1.2, "cpu": 1.5, "contact_error": 0.05,
    "weight_error": 0.05,
}  # fmt: skip
"""The most of each figure: cm/s, a share, metres, times the plan's, CPU-seconds a second, metres, of the weight."""
Row = dict[str, Any]


@dataclass(frozen=True)
class PhysicsTrial:
    """A trial that was acted by both bodies."""

    plan: Performance
    physics: Performance
    row: Row
    """What was measured, for JSON."""


def draw_trials(skill: Skill, count: int, drawn: int = DRAWN) -> list[Trial]:
    """So many trials of a skill, each with its own caption, room and seed by chance, from a seed of all."""
    return list(islice(_drawn(skill, drawn), count))


def _drawn(skill: Skill, drawn: int) -> Iterator[Trial]:
    """Trials of a skill without end: furnishing a room to see what it has places for takes a while."""
    rng = np.random.default_rng([drawn, list(Skill).index(skill)])
    rooms = [layout.id for layout in built_in_index().layouts]
    known = captions()[skill.value]
    while True:
        trial = Trial(
            skill, str(rng.choice(known)), rooms[int(rng.integers(len(rooms)))], int(rng.integers(DRAWN, 1 << 31))
        )
        if places_for(skill, trial.caption, setting(trial.room)):
            yield trial


def by_turns(skills: Sequence[Skill], count: int, drawn: int = DRAWN) -> Iterator[Trial]:
    """So many trials of each of some skills, one of each in turn: a run that is ended has as many of all."""
    for turn in islice(zip(*(_drawn(skill, drawn) for skill in skills), strict=True), count):
        yield from turn


def run_trial(trial: Trial) -> PhysicsTrial | None:
    """Act a trial kinematically and simulated; None where its room has no place for it."""
    try:
        plan = perform(trial)
    except (UnreachableError, NoPath):
        return None
    director, started = Director.of(BACKEND), time.process_time()
    physics = perform(trial, director)
    seconds = time.process_time() - started
    return PhysicsTrial(plan, physics, _row(plan, physics, seconds))


def _row(plan: Performance, physics: Performance, cpu: float) -> Row:
    told = physics_of(physics.motion)
    made_by = shares(physics.motion)
    reached = physics.figures.reached and made_by == {BACKEND: 1.0} and told is not None and not told["resets"]
    return {
        "skill": plan.trial.skill.value, "caption": plan.trial.caption, "room": plan.trial.room,
        "seed": plan.trial.seed, "seconds": physics.motion.duration, "reached": reached,
        "planned": plan.figures.reached, "reason": physics.figures.reason, "made_by": made_by,
        "contact_error": physics.figures.to_dict()["contact_error"],
        "resets": told["resets"] if told else 0, "rewinds": told["rewinds"] if told else 0,
        "weight_error": told["weight_error"] if told else None,
        "execution": physics.figures.to_dict()["execution_time"],
        "cpu": cpu / physics.motion.duration, **_feet(physics.motion, plan.motion),
    }  # fmt: skip


def _feet(motion: Motion, plan: Motion) -> dict[str, float]:
    """Slip, skate, floor and jerk of a simulated motion; how far it is from its plan (metres), both as long."""
    body, planned = Kinematics.of(motion), Kinematics.of(plan)
    frames = min(len(motion), len(plan))
    away = np.linalg.norm(body.positions[:frames] - planned.positions[:frames], axis=-1).mean()
    return {
        "slip": support_slip(body),
        "slip_planned": support_slip(planned),
        "slip_carried": carried_slip(body),
        "skate": skate_speed(body),
        "skate_ratio": skate_ratio(body),
        "skate_ratio_planned": skate_ratio(planned),
        "floor_pen": floor_penetration(body),
        "jerk_ratio": jerk(body.positions, motion.fps) / max(jerk(planned.positions, plan.fps), 1e-6),
        "away": float(away),
    }


def run_story(theme: str, seed: int) -> Row:
    """Make a story kinematically and simulated."""
    pipeline = Pipeline(Shelves(cache=read_settings().cache_dir))
    request = StoryRequest(theme, seed=seed, backend=BACKEND)
    started = time.process_time()
    story = pipeline.make(request)
    cpu = time.process_time() - started
    plan = pipeline.make(replace(request, backend=DEFAULT_BACKEND)).motion
    told = story.report["physics"] or {"resets": 0, "rewinds": 0, "rewound_seconds": 0.0, "keyframes": []}
    reset_in = {row["keyframe"] for row in told["keyframes"] if row["resets"]}
    kept = [figure.reached and figure.keyframe not in reset_in for figure in story.figures]
    return {
        "theme": theme, "seed": seed, "seconds": story.motion.duration, "keyframes": len(kept), "reached": sum(kept),
        "missed": [f"{one.keyframe}: {one.reason}" for one, ok in zip(story.figures, kept, strict=True) if not ok],
        "made_by": story.report["made_by"], "resets": told["resets"], "rewinds": told["rewinds"],
        "rewound_seconds": told["rewound_seconds"], "cpu": cpu / story.motion.duration, **_feet(story.motion, plan),
    }  # fmt: skip


def kept_rows(file: Path | None) -> list[Row]:
    """What an earlier run has measured, a JSON object a line."""
    if file is None or not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line]


def keep_row(file: Path | None, row: Row) -> None:
    """Write a line at once, so that a run that is ended goes on where it was."""
    if file is not None:
        with file.open("a", encoding="utf-8") as out:
            out.write(json.dumps(row, ensure_ascii=False) + "\n")


def summed(rows: Sequence[Row]) -> Iterator[tuple[str, int, dict[str, tuple[float, float, float]]]]:
    """Every skill, how many trials, and each figure's mean with a 95 % interval over trials."""
    for skill in Skill:
        own = [row for row in rows if row.get("skill") == skill.value]
        if own:
            yield skill.value, len(own), figures_of(own)


def figures_of(rows: Sequence[Row]) -> dict[str, tuple[float, float, float]]:
    """Each figure's mean over rows that have it, and its interval: Wilson's for shares, else by drawing rows anew."""
    found = {}
    for name in (
        "reached",
        "contact_error",
        "execution",
        "weight_error",
        "slip",
        "slip_planned",
        "slip_carried",
        "skate",
        "skate_ratio",
        "skate_ratio_planned",
        "floor_pen",
        "jerk_ratio",
        "away",
        "cpu",
    ):
        values = np.array([row[name] for row in rows if row.get(name) is not None], dtype=np.float64)
        if len(values):
            low, high = wilson(values) if name == "reached" else drawn_anew(values)
            found[name] = (float(values.mean()), low, high)
    return found
