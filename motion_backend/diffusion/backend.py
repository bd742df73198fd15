"""The backend `diffusion`: parts made by the model that was learned (LINGO A), from the weights that ship with it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Final, cast

import numpy as np

from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.backends import DIFFUSION
from motion_backend.diffusion.checkpoint import load_denoiser, load_scheduler
from motion_backend.diffusion.completion_scheduler import CompletionScheduler
from motion_backend.diffusion.denoiser import Denoiser
from motion_backend.diffusion.learned_parts import LearnedParts
from motion_backend.diffusion.learned_walker import LearnedGait
from motion_backend.diffusion.plan_follower import Missed, PlanFollower
from motion_backend.diffusion.sampler import Sampler
from motion_backend.motion import Character, Motion
from motion_backend.walk_driver import WalkDriver
from scene_graphs.home import Home

WEIGHTS: Final = Path(__file__).resolve().parents[1] / "data" / "weights" / "diffusion"
"""What ships with the package."""


class DiffusionBackend:
    """Walks in full stride as a model learned it from people; all else as another learned it from our own body."""

    name = DIFFUSION

    def __init__(self, folder: Path | None = None, watch: Callable[[Missed], None] | None = None) -> None:
        """`watch` is told what passages were off their goals. CheckpointError where weights are missing or broken."""
        self._sampler = walking() if folder is None else walking(folder)
        self._parts = LearnedParts(replace(acting() if folder is None else acting(folder), watch=watch))

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, on a free place that the seed chooses."""
        return self._driver(seed).begin(home, character, seed)

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do a part; what cannot be done so is the procedural body's, and its phases say why."""
        actor = self._driver(state.seed) if part.kind is PartKind.WALK else self._parts
        return actor.advance(home, part, upcoming, state)

    def _driver(self, seed: int) -> WalkDriver:
        """One body has one person's walk all through a story."""
        return WalkDriver(LearnedGait(self._sampler, self._sampler.gait_of(seed)), self._parts)


@lru_cache(maxsize=2)
def walking(folder: Path = WEIGHTS) -> Sampler:
    """The sampler of the weights that walk. CheckpointError."""
    return walking_by(folder / "walk")


def walking_by(path: Path) -> Sampler:
    """The sampler of some weights, whose path has no suffix, as they walk in stories. CheckpointError."""
    weights, schedule = load_denoiser(path)
    strides = None if weights.strides is None else weights.strides.double().numpy()
    gaits = int(weights.config.get("gaits", 0))
    paces = np.array(weights.config["paces"]) if "paces" in weights.config else None
    network = cast(Denoiser, weights.network)
    people = tuple(weights.config.get("learned_from", ()))
    return Sampler(
        network, weights.scale, schedule, fresh=True, gaits=gaits, strides=strides, paces=paces, learned_from=people
    )


@lru_cache(maxsize=2)
def acting(folder: Path = WEIGHTS) -> PlanFollower:
    """The model of all skills and its scheduler, of the weights that act. CheckpointError."""
    weights, schedule = load_denoiser(folder / "act")
    ends = load_scheduler(folder / "scheduler")
    sampler = Sampler(cast(Denoiser, weights.network), weights.scale, schedule)
    return PlanFollower(sampler, walking(folder), cast(CompletionScheduler, ends.network), ends.scale)
