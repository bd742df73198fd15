"""Captioned motion of our own body, acted in rooms of the library: what the embedding learns from and is asked of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby

import numpy as np

from motion_backend.datasets.splits import splits
from motion_backend.emotion_words import emotion_of
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.motion import Emotion, Motion
from motion_backend.skeleton import build_skeleton
from planner_service.evaluation.body_evaluation import in_processes
from planner_service.evaluation.caption_classifier import group_of
from planner_service.evaluation.trials import Trial, act_trial
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import synonyms
from scene_graphs.navigation.path_planner import NoPath

Progress = Callable[[int, int], None]


def act_clips(trials: Sequence[Trial], workers: int, progress: Progress = lambda _done, _all: None) -> Dataset:
    """A clip a trial, with its caption and that caption's synonyms; rooms are told apart as subjects are.

    The same whatever the number of processes. Trials that find no place in their room are left out.
    """
    in_rooms = sorted(trials, key=lambda trial: (trial.room, trial.seed, trial))
    batches = [list(some) for _, some in groupby(in_rooms, key=lambda trial: (trial.room, trial.seed))]
    found: list[tuple[Trial, Motion]] = []
    done = 0
    for batch in in_processes(_act_batch, batches, workers):
        found += [(trial, motion) for trial, motion in batch if motion is not None]
        done += len(batch)
        progress(done, len(trials))
    found.sort(key=lambda one: one[0])
    sides = splits([(trial.room, len(motion)) for trial, motion in found])
    said = synonyms()
    return Dataset(build_skeleton(), tuple(_entry(trial, motion, said, sides[trial.room]) for trial, motion in found))


def _act_batch(trials: Sequence[Trial]) -> list[tuple[Trial, Motion | None]]:
    return [(trial, _act(trial)) for trial in trials]


def _act(trial: Trial) -> Motion | None:
    try:
        return act_trial(trial, led_alike=True)[2][-1]
    except (UnreachableError, NoPath):
        return None


def _entry(trial: Trial, motion: Motion, said: dict[str, dict[str, list[str]]], side: str) -> Entry:
    return Entry(
        name=f"{trial.room}/{trial.seed}/{trial.skill.value}/{trial.caption}",
        skill=trial.skill.value,
        style=group_of(trial.skill, trial.caption),
        emotion=(emotion_of(trial.caption) or Emotion.NEUTRAL).value,
        captions=(trial.caption, *said.get(trial.skill.value, {}).get(trial.caption, ())),
        subject=trial.room,
        kind="procedural",
        licence="MIT",
        source="sims",
        changed=(),
        split=side,
        motion=motion,
        hands=np.zeros((len(motion), 2), dtype=bool),
    )
