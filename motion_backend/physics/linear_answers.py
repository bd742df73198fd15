"""What a teacher's answers have in common: one linear rule for each way to stand, from which a policy begins.

Over all frames in which a plan stands on the same feet, the matrices K are averaged in the body's own axes. What the
teacher did besides K times the way off its plan is told by where the plan goes next (ridge regression). With the gains
of other episodes alone a body fell after a second and a half of a reach, with both it did one of two to its end.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.physics.distillation import Episode, Lesson
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.policies import PLAN_SIZE, SUPPORTS
from motion_backend.physics.policy_view import level_of
from motion_backend.rotations import Array

RIDGE: Final = 0.3
"""Price of telling the rest by where the plan goes, a frame."""
WAY: Final = 0.05
"""Metres and radians that a plan goes in five frames, on whose scale that is priced."""
HELD: Final = NX + NU


def linear_answers(taught: Iterable[tuple[Episode, Lesson]]) -> Array:
    """What is added to the plan's controls for what is seen of the plan and a 1. (SUPPORTS, PLAN_SIZE + 1, 30)."""
    rows = [_rows(episode, lesson) for episode, lesson in taught]
    support, answers, seen, told = (np.concatenate(column) for column in zip(*rows, strict=True))
    found = np.zeros((SUPPORTS, PLAN_SIZE + 1, NU))
    for mode in np.unique(support):
        own = support == mode
        gain = answers[own].mean(axis=0)
        rest = told[own] - seen[own, :HELD] @ gain.T
        way = np.column_stack([seen[own, HELD : HELD + NV] / WAY, np.ones(own.sum())])
        price = np.diag([*np.full(NV, RIDGE * len(way)), 1e-3 * len(way)])
        by_way = np.linalg.solve(way.T @ way + price, way.T @ rest)
        found[mode, :HELD] = gain.T
        found[mode, HELD : HELD + NV] = by_way[:-1] / WAY
        found[mode, -1] = by_way[-1]
    return found


def _rows(episode: Episode, lesson: Lesson) -> tuple[Array, Array, Array, Array]:
    """Of N frames: how the plan stands next (N,), answers in the body's axes (N, 30, 102), what is seen of the plan
    (N, PLAN_SIZE), and what was added to its controls (N, 30)."""
    reference, following = episode.view.task.reference, lesson.frames + 1
    answers = lesson.answer.copy()
    own_axes = rotations.inverse(level_of(lesson.qpos))
    turned = np.stack([rotations.rotate(own_axes, axis) for axis in np.eye(3)], axis=-1)
    for first in (0, NV):
        answers[:, :, first : first + 3] = answers[:, :, first : first + 3] @ turned
    support = reference.planted[following].reshape(-1, 2, 2).any(axis=2) @ np.array([2, 1])
    seen = episode.view.off_plan(lesson.qpos, lesson.qvel, lesson.held, lesson.frames)
    return support, answers, seen, lesson.control - reference.controls[following]
