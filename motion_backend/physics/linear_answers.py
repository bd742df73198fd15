"""What a teacher's answers have in common: one linear rule for each way to stand, from which a policy begins.

Over all frames in which a plan stands on the same feet, the matrices K are averaged in the body's own axes. What the
teacher did besides K times the way off its plan is told by where the plan goes, as far ahead as the teacher looks
(ridge regression), and in the mirror as well: of 16 reaches the linear answers alone do 7, where they do 4 if they see
but three to five frames ahead, and 5 without the mirror.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.physics.distillation import Episode, Lesson
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mirrored_body import CONTROLS, OFF, PLAN
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.policies import AHEAD, PLAN_SIZE, SOLES, SUPPORTS
from motion_backend.physics.policy_view import level_of
from motion_backend.rotations import Array

RIDGE: Final = 0.04
"""Price of telling the rest by where the plan goes, a frame."""
WAY: Final = np.concatenate([np.tile(np.repeat([0.1, 0.2, 0.5], [3, 3, NV - 6]), len(AHEAD)), np.ones(SOLES)])
"""Metres and radians that a plan goes, on whose scale that is priced, and soles. (PLAN_SIZE - HELD,)."""
HELD: Final = NX + NU


def linear_answers(taught: Iterable[tuple[Episode, Lesson]], mirrored: bool = False) -> Array:
    """What is added to the plan's controls for what is seen of the plan and a 1. (SUPPORTS, PLAN_SIZE + 1, 30).

    `mirrored`: as if each had been taught to the body in the mirror as well.
    """
    rows = [_rows(episode, lesson) for episode, lesson in taught]
    answers, seen, told = (np.concatenate(column) for column in zip(*rows, strict=True))
    if mirrored:
        answers = np.concatenate([answers, CONTROLS.answers(answers, OFF)])
        seen, told = np.concatenate([seen, PLAN(seen)]), np.concatenate([told, CONTROLS(told)])
    soles = seen[:, -SOLES:][:, :4].reshape(-1, 2, 2).any(axis=2)
    support = np.eye(SUPPORTS)[soles @ np.array([2, 1])]
    gains = np.tensordot(support, answers, (0, 0)) / np.maximum(support.sum(axis=0), 1)[:, None, None]
    rest = told - np.einsum("nm,mij,nj->ni", support, gains, seen[:, :HELD], optimize=True)
    ways = np.column_stack([seen[:, HELD:] / WAY, support])
    price = np.diag(np.repeat([RIDGE, 1e-3], [len(WAY), SUPPORTS])) * len(ways)
    by_way = np.linalg.solve(ways.T @ ways + price, ways.T @ rest)
    found = np.empty((SUPPORTS, PLAN_SIZE + 1, NU))
    found[:, :HELD] = gains.swapaxes(1, 2)
    found[:, HELD:-1] = by_way[: len(WAY)] / WAY[:, None]
    found[:, -1] = by_way[len(WAY) :]
    return found


def _rows(episode: Episode, lesson: Lesson) -> tuple[Array, Array, Array]:
    """Of N frames: answers in the body's axes (N, 30, 102), what is seen of the plan (N, PLAN_SIZE), and what was added
    to its controls (N, 30)."""
    answers = lesson.answer.copy()
    own_axes = rotations.inverse(level_of(lesson.qpos))
    turned = np.stack([rotations.rotate(own_axes, axis) for axis in np.eye(3)], axis=-1)
    for first in (0, NV):
        answers[:, :, first : first + 3] = answers[:, :, first : first + 3] @ turned
    seen = episode.view.off_plan(lesson.qpos, lesson.qvel, lesson.held, lesson.frames)
    return answers, seen, lesson.control - episode.view.task.reference.controls[lesson.frames + 1]
