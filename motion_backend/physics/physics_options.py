"""What the physics of this process is told: how long it may take, on how many threads, and who controls the body."""

from __future__ import annotations

import os
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Final

BUDGET: Final = 3600.0
"""Seconds that a story may take in all, where nobody says more."""


class Mode(StrEnum):
    """Who chooses a simulated body's controls."""

    MPC = "mpc"
    """Model-predictive control, for all skills."""
    POLICY = "policy"
    """Networks for the skills that one has passed its bar at, model-predictive control for all others."""


@dataclass(frozen=True)
class PhysicsOptions:
    """Of all physics backends of a process."""

    seconds: float = BUDGET
    """That a story may take in all."""
    threads: int = 0
    """That linearise; 0: as many as there are processors for us."""
    mode: Mode = Mode.MPC
    policies: Path | None = None
    """A folder of weights; None: those that are shipped."""

    @property
    def linearising(self) -> int:
        """How many threads linearise."""
        return self.threads or len(os.sched_getaffinity(0))


_given = [PhysicsOptions()]


def give_physics(told: PhysicsOptions) -> None:
    """From now on, in this process; backends that are made already keep theirs."""
    _given[0] = told


def physics_options() -> PhysicsOptions:
    """What was told last, else what holds where nobody says anything."""
    return _given[0]
