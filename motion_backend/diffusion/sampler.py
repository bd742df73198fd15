"""Windows out of noise, one after the other: DDPM and DDIM loops around the denoiser, with clean history at each step.

The noise process is noise_schedule.py, the network denoiser.py, what pulls its guess to a goal guidance.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
import torch
from torch import Tensor

from motion_backend.diffusion.conditions import Conditions
from motion_backend.diffusion.denoiser import Denoiser
from motion_backend.diffusion.guidance import Guide
from motion_backend.diffusion.motion_features import FEATURES, HISTORY, PLACES, WINDOW
from motion_backend.diffusion.noise_schedule import NoiseSchedule, ddim_step, pairs
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

DDIM_STEPS: Final = 10
"""Of sampling, where nothing else is asked for: five are as good, twenty are no better."""
LEGS: Final = [
    PLACES.start + 3 * (INDEX[name] - 1) + axis for name in ("left_ankle", "right_ankle") for axis in (0, 1, 2)
]
"""Features by which the moment of a stride is told."""


@dataclass(frozen=True)
class Scale:
    """What a feature is on average, and how much it differs: the network sees (feature - mean) / deviation."""

    mean: Tensor
    """(202,)."""
    deviation: Tensor
    """(202,)."""

    def encode(self, features: Tensor) -> Tensor:
        """Features to what the network sees."""
        return (features - self.mean) / self.deviation

    def decode(self, seen: Tensor) -> Tensor:
        """The inverse of `encode`."""
        return seen * self.deviation + self.mean


@dataclass(frozen=True)
class Sampler:
    """A trained denoiser with the noise it was trained for."""

    denoiser: Denoiser
    scale: Scale
    schedule: NoiseSchedule = field(default_factory=NoiseSchedule)
    steps: int = DDIM_STEPS
    """Of DDIM."""
    fresh: bool = False
    """Whether each step draws fresh noise; of all the schedule's steps these are DDPM's."""
    gaits: int = 0
    """Of how many people's walks are told apart."""
    strides: Array | None = None
    """(gaits, N, 2, 202) histories of each, of the model's own walking."""
    paces: Array | None = None
    """(gaits,) metres a second at which each was recorded."""
    learned_from: tuple[str, ...] = ()
    """Everybody who was recorded in what it has learned: they are no judges of it."""

    def gait_of(self, seed: int) -> int:
        """Whose walk a body of that seed has; 0 where none are told apart."""
        return 1 + seed % self.gaits if self.gaits else 0

    def pace_of(self, gait: int) -> float | None:
        """Metres a second at which he walked whose gait it is; None where that is not known."""
        return None if self.paces is None or not gait else float(self.paces[gait - 1])

    def stride_like(self, history: Array, gait: int) -> Array:
        """The history of somebody's walk whose legs are most like those of another (2, 202); that one where none is."""
        if self.strides is None or not gait:
            return history
        own = self.strides[gait - 1]
        away = np.square((own - history)[..., LEGS]).sum(axis=(1, 2))
        return np.asarray(own[int(np.argmin(away))])

    def windows(self, history: Array, given: Conditions, seed: int | list[int], guide: Guide | None = None) -> Array:
        """What follows history (B, 2, 202) under conditions of B windows, in features. (B, 14, 202).

        The same seed gives the same motion.
        """
        noise = np.random.default_rng(seed)
        known = self.scale.encode(torch.from_numpy(history.astype(np.float32)))
        with torch.inference_mode():
            tokens = self.denoiser.encode(given)
            found = self._descend(known, tokens, noise, guide)
            return np.asarray(self.scale.decode(found).double().numpy())

    def _descend(self, known: Tensor, tokens: Tensor, rng: np.random.Generator, guide: Guide | None) -> Tensor:
        """From noise to a clean window, step by step; history is put in clean at each of them (LINGO A.1)."""
        shape = (len(known), WINDOW - HISTORY, FEATURES)

        def fresh() -> Tensor:
            return torch.from_numpy(rng.standard_normal(shape, dtype=np.float32))

        x, clean = fresh(), torch.zeros(shape)
        for step, following in pairs(self.schedule.spaced(self.steps)):
            at = torch.full((len(known),), step)
            clean = self.denoiser(torch.cat([known, x], dim=1), at, tokens)[:, HISTORY:]
            if guide is not None:
                clean = self.scale.encode(guide(self.scale.decode(clean)))
            x = ddim_step(self.schedule, x, clean, step, following, fresh() if self.fresh else None)
        return clean
