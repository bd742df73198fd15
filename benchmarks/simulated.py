"""What a simulated body costs: following a plan, on one thread and on two, and asking a policy in every frame."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

import numpy as np

from benchmarks.figure import Figure
from motion_backend.motion import FPS, Skill
from motion_backend.physics.cloned_policy import Rows, new_policy
from motion_backend.physics.distillation import Episode
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.physics_options import PhysicsOptions, give_physics, physics_options
from motion_backend.physics.policies import PolicyName
from motion_backend.physics.policy_player import PolicyPlayer
from motion_backend.physics.tracker import Tracker
from motion_backend.physics.trained_policy import TrainedPolicy
from planner_service.evaluation.skill_episodes import JUDGED_IN, episodes

FOLLOWED: Final = 60
"""Frames of a walk that are simulated."""
CPU, TWO, POLICY = 1.5, 1.7, 20.0
"""CPU-seconds a second of motion, how much sooner two threads are ready, times real time."""


def physics_figures() -> list[Figure]:
    """The beginning of a walk in a room of the library, followed and played."""
    walk = next(episodes(Skill.LOCO, JUDGED_IN, unseen=True)).episode
    told = physics_options()
    try:
        _follow(walk, 1)
        seconds, _ = _follow(walk, 1)
        one, two = _follow(walk, 1)[1], _follow(walk, 2)[1]
    finally:
        give_physics(told)
    return [
        Figure("simulated walk, CPU-seconds a second", seconds / (FOLLOWED / FPS), "s", CPU, "most", "one thread", 2),
        Figure("the same on two threads, sooner", one / two, "×", TWO, "least", "needs two free processors", 2),
        Figure("a policy against playing it", _played(walk), "×", POLICY, "least", "network not trained", 0),
    ]


def _follow(walk: Episode, threads: int) -> tuple[float, float]:
    """Seconds of processors and of the clock."""
    give_physics(PhysicsOptions(threads=threads))
    task = walk.view.task
    tracker = Tracker(task.models_at, task.reference, task.skeleton.scale)
    return _timed(lambda: tracker.track(walk.start, np.zeros((0, NU)), FOLLOWED))


def _played(walk: Episode) -> float:
    """How much faster than it plays a body is that asks a network in every frame, and does what its plan says."""
    player = PolicyPlayer.of(walk.view)
    seen = player.observe(walk.start, 0).astype(np.float32)
    asked = new_policy(PolicyName.WALK, Rows(seen, np.zeros((1, NU), np.float32)))
    seconds, _ = _timed(lambda: player.play(_AsPlanned(asked), walk.start, FPS))
    return 1 / seconds


class _AsPlanned:
    """Asks a network, and does what a plan says: what has not learned falls at once."""

    def __init__(self, asked: TrainedPolicy) -> None:
        self.asked = asked

    def offsets(self, observed: np.ndarray) -> np.ndarray:
        return np.zeros_like(self.asked.offsets(observed))


def _timed(work: Callable[[], object]) -> tuple[float, float]:
    cpu, clock = time.process_time(), time.perf_counter()
    work()
    return time.process_time() - cpu, time.perf_counter() - clock
