"""How noise is added to motion, step after step (LINGO A.6: 100 steps, linear), and taken away again (DDPM, DDIM).

`x` is a clean window, `x_t = √ᾱ_t x + √(1 - ᾱ_t) ε` what is left of it after step t. LINGO's printed betas would leave
36 % of the signal at the end; ours end in noise, as sampling begins with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.rotations import Array

if TYPE_CHECKING:
    from torch import Tensor

STEPS: Final = 100
"""Of the diffusion process (LINGO A.6)."""
FIRST_BETA, LAST_BETA = 1e-3, 0.2
"""Variance added by the first and the last step."""
MAX_TERMINAL_SIGNAL: Final = 1e-3
"""What a schedule may leave of the signal's variance at its end."""


@dataclass(frozen=True)
class NoiseSchedule:
    """Betas that rise in a line, and what follows from them."""

    steps: int = STEPS
    first: float = FIRST_BETA
    last: float = LAST_BETA

    def __post_init__(self) -> None:
        if not 2 <= self.steps <= 10_000 or not 0 < self.first <= self.last < 1:
            raise ValueError(f"a schedule has 2 steps or more and 0 < first ≤ last < 1, got {self}")
        if self.alpha_bars[-1] > MAX_TERMINAL_SIGNAL:
            raise ValueError(f"{self} leaves {self.alpha_bars[-1]:.2g} of the signal, {MAX_TERMINAL_SIGNAL:g} at most")

    @cached_property
    def betas(self) -> Array:
        """(steps,)."""
        return np.linspace(self.first, self.last, self.steps)

    @cached_property
    def alpha_bars(self) -> Array:
        """Share of the signal's variance that is left after each step. (steps,)."""
        return np.asarray(np.cumprod(1.0 - self.betas))

    def noised(self, clean: Tensor, noise: Tensor, steps: Tensor) -> Tensor:
        """x_t of windows (B, T, F) at steps (B,): q(x_t | x) of Ho et al. 2020, Eq. 4."""
        left = _left(self, str(clean.device))[steps][:, None, None].to(clean)
        return left.sqrt() * clean + (1 - left).sqrt() * noise

    def spaced(self, count: int) -> tuple[int, ...]:
        """So many of the steps, evenly, from the last to the first. ValueError for none or more than there are."""
        if not 1 <= count <= self.steps:
            raise ValueError(f"sampling takes 1 to {self.steps} steps, not {count}")
        return tuple(np.unique(np.linspace(0, self.steps - 1, count).round().astype(int))[::-1].tolist())


@cache
def _left(schedule: NoiseSchedule, device: str) -> Tensor:
    """A schedule's `alpha_bars` on a device."""
    import torch

    return torch.from_numpy(schedule.alpha_bars).to(device)


def ddim_step(
    schedule: NoiseSchedule, x: Tensor, clean: Tensor, step: int, following: int | None, fresh: Tensor | None = None
) -> Tensor:
    """x at the `following` step (None: the clean end): Song et al. 2021, Eq. 12.

    Without `fresh` noise with σ = 0: what there is of noise is kept. With it as much of it is fresh as DDPM draws
    (η = 1 in Eq. 16): from each step to the one before it this is q(x_{t-1} | x_t, clean) of Ho et al. 2020.
    """
    if following is None:
        return clean
    now, then = schedule.alpha_bars[step], schedule.alpha_bars[following]
    noise = (x - np.sqrt(now) * clean) / np.sqrt(1 - now)
    if fresh is None:
        return np.sqrt(then) * clean + np.sqrt(1 - then) * noise
    drawn = (1 - then) / (1 - now) * (1 - now / then)
    return np.sqrt(then) * clean + np.sqrt(1 - then - drawn) * noise + np.sqrt(drawn) * fresh


def pairs(steps: Sequence[int]) -> list[tuple[int, int | None]]:
    """Each step with the one that follows it; the last is followed by None."""
    return list(zip(steps, (*steps[1:], None), strict=True))
