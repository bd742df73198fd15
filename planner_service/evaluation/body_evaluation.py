"""How well the body acts every caption it knows, over rooms and seeds, beside the limits (SIMS 4.3, Table 1)."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import groupby
from multiprocessing import get_context
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from motion_backend.metrics.figure_limits import LIMITS, Limit
from motion_backend.motion import Skill
from motion_backend.rotations import Array
from planner_service.evaluation.caption_classifier import describe
from planner_service.evaluation.diversity import contact_frames
from planner_service.evaluation.trials import Trial, perform, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.pipeline import RequestError
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

RESAMPLES: Final = 1000
WORST_OF_TRIALS: Final = ("pen_max", "skin_pen_max", "self_pen_max", "bone_deviation", "joint_speed")
"""Of these the largest of all trials counts, not the mean."""
Progress = Callable[[int, int], None]
T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True)
class Result:
    """What came of one trial."""

    trial: Trial
    figures: Mapping[str, Any]
    """As `Performance.to_dict` has them; empty where it could not begin."""
    features: Array | None
    """As `describe` has them, for trials that were reached."""
    contact: NDArray[np.float32] | None
    """As `contact_frames` has them, for sitting and lying."""
    fault: str = ""
    """Why it could not begin."""


@dataclass(frozen=True)
class Figure:
    """A figure over many trials, with a 95 % interval over rooms and seeds."""

    name: str
    skill: str
    """A skill, or "all"."""
    value: float
    low: float
    high: float
    trials: int
    limit: Limit | None = None

    @property
    def missed(self) -> bool:
        """Whether it does not keep its limit."""
        return self.limit is not None and self.limit.missed(self.value)


def plan_trials(
    captions: Mapping[Skill, Sequence[str]], rooms: int, seeds: int, without: Collection[str] = ()
) -> list[Trial]:
    """Every caption in as many rooms of the library, in an order by chance, as have what it needs, with every seed.

    Rooms in `without` are left out.
    """
    every = [layout.id for layout in built_in_index().layouts if layout.id not in without]
    order = [every[index] for index in np.random.default_rng(0).permutation(len(every))]
    wanted = [(skill, caption) for skill, some in captions.items() for caption in some]
    left = dict.fromkeys(wanted, rooms)
    found: list[Trial] = []
    for room in order:
        for skill, caption in wanted:
            if left[skill, caption] and places_for(skill, caption, setting(room)):
                left[skill, caption] -= 1
                found += [Trial(skill, caption, room, seed) for seed in range(seeds)]
        if not any(left.values()):
            break
    return sorted(found)


def run_trials(trials: Sequence[Trial], workers: int, progress: Progress = lambda _done, _all: None) -> list[Result]:
    """Act and judge all of them, room by room, in as many processes; the same whatever their number."""
    in_rooms = sorted(trials, key=lambda trial: (trial.room, trial.seed, trial))
    batches = [list(some) for _, some in groupby(in_rooms, key=lambda trial: (trial.room, trial.seed))]
    found: list[Result] = []
    for results in in_processes(run_batch, batches, workers):
        found += results
        progress(len(found), len(trials))
    return sorted(found, key=lambda result: result.trial)


def in_processes(work: Callable[[T], R], rows: Sequence[T], workers: int) -> Iterator[R]:
    """What some work makes of every row, in as many processes; as they are done, in no order."""
    if workers == 1:
        yield from map(work, rows)
        return
    # Libraries read this when they are loaded, and a process of its own loads them anew.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    pool = ProcessPoolExecutor(workers, get_context("spawn"), _ended_quietly)
    try:
        for future in as_completed([pool.submit(work, row) for row in rows]):
            yield future.result()
    except BrokenProcessPool as error:
        raise RequestError(
            "a process was ended from outside, as when memory runs out", "use fewer", at="--workers"
        ) from error
    finally:
        pool.shutdown(cancel_futures=True)


def _ended_quietly() -> None:
    """Ctrl-C reaches every process of a terminal: these end without a word, the command says what there is to say."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def run_batch(trials: Sequence[Trial]) -> list[Result]:
    """Act and judge some trials, one after the other."""
    return [run_trial(trial) for trial in trials]


def run_trial(trial: Trial) -> Result:
    """Act and judge one trial; one that cannot begin says why."""
    try:
        done = perform(trial)
    except (UnreachableError, NoPath) as error:
        return Result(trial, {}, None, None, str(error))
    features = describe(done.motion, trial.skill) if done.figures.reached else None
    frames = contact_frames(done.motion, trial.skill) if trial.skill in (Skill.SITDOWN, Skill.LIEDOWN) else None
    return Result(trial, done.to_dict(), features, frames)


def sum_up(results: Sequence[Result], names: Sequence[str], seed: int = 0) -> list[Figure]:
    """Each figure of each skill, and of all, with its limit if it has one; intervals draw rooms and seeds anew."""
    begun = [result for result in results if result.figures]
    skills = [skill for skill in Skill if any(result.trial.skill is skill for result in begun)]
    figures = []
    for name in names:
        for skill in (*skills, None):
            chosen = [one for one in begun if skill in (None, one.trial.skill) and one.figures[name] is not None]
            if chosen:
                value, low, high = _with_interval(chosen, name, seed)
                limit = next((limit for limit in LIMITS if limit.figure == name and skill in limit.skills), None)
                figures.append(Figure(name, skill.value if skill else "all", value, low, high, len(chosen), limit))
    return figures


def _with_interval(results: Sequence[Result], name: str, seed: int) -> tuple[float, float, float]:
    """A mean with its bootstrapped interval, or the largest value, of which there is none."""
    values = np.array([float(result.figures[name]) for result in results])
    if name in WORST_OF_TRIALS:
        return (float(values.max()),) * 3
    keys = [(result.trial.room, result.trial.seed) for result in results]
    cells = {key: index for index, key in enumerate(sorted(set(keys)))}
    cell = np.array([cells[key] for key in keys])
    sums, counts = np.bincount(cell, values), np.bincount(cell)
    drawn = np.random.default_rng(seed).integers(len(cells), size=(RESAMPLES, len(cells)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return float(values.mean()), float(low), float(high)
