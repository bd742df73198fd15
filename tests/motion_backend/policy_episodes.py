"""Short tasks for policies that tests share."""

from __future__ import annotations

from functools import cache

import numpy as np
from simulated import HOME, WALK, walk

from motion_backend.backend_protocol import History, Part, PartKind
from motion_backend.motion import Motion
from motion_backend.physics.distillation import Episode
from motion_backend.physics.mpc import moment_of
from motion_backend.physics.policies import EMBEDDING_SIZE
from motion_backend.physics.policy_view import View
from motion_backend.physics.task import Task, plan_of
from motion_backend.skeleton import build_skeleton

PART = Part(PartKind.WALK, WALK, WALK.goal)


@cache
def planned(frames: int) -> tuple[Task, Motion]:
    """The first steps of a walk across the small home."""
    motion = walk()
    before, own, rest = motion.part(0, 12), motion.part(12, 12 + frames), motion.part(12 + frames, 72 + frames)
    past = History.of(
        *(np.asarray(part, np.float64) for part in (before.root_positions, before.local_rotations, before.contacts))
    )
    return Task(HOME, build_skeleton(1.70), past, plan_of(own).followed_by(plan_of(rest))), own


@cache
def episode(frames: int) -> Episode:
    """The same, to be learned."""
    task, motion = planned(frames)
    view = View.of(task, PART, motion, np.zeros(EMBEDDING_SIZE))
    return Episode(view, moment_of(task.reference, 0), frames)
