"""Proximal policy optimisation (Schulman et al. 2017): rollouts, advantages, a clipped step that stops at a divergence.

Observations are normalised by what was seen so far. Arrays of a rollout are (T, N): T steps of N bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from motion_backend.physics.policies import LOG_STD_RANGE, log_probability
from motion_backend.physics.training_fault import stop_if_not_finite

Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]


class VectorEnvironment(Protocol):
    """N bodies that are stepped together and begin anew by themselves."""

    def observe(self) -> Floats:
        """What they see now. (N, O)."""
        ...

    def step(self, actions: Floats) -> Outcome:
        """Do actions (N, A); those that ended have begun anew when it returns."""
        ...


@dataclass(frozen=True)
class Outcome:
    """What a step led to."""

    rewards: Floats
    """(N,)."""
    observed: Floats
    """(N, O) after the step and before a new beginning."""
    terminated: Flags
    """(N,) over for good: what comes after is worth nothing."""
    truncated: Flags
    """(N,) over because its time was: what would have come is worth what it was worth."""


@dataclass(frozen=True)
class PPOConfig:
    """Rates and bounds; usual values, SIMS prints none."""

    gamma: float = 0.99
    lam: float = 0.95
    clip: float = 0.2
    rate: float = 3e-4
    value_rate: float = 1e-3
    epochs: int = 5
    batch: int = 1024
    entropy: float = 1e-3
    """Weight of the entropy of actions."""
    max_divergence: float = 0.02
    """Passes over a rollout end at one and a half times this KL divergence from the policy that acted."""
    max_gradient: float = 1.0


class RunningNormalization:
    """Mean and variance of all rows seen so far, by the parallel formula of Chan et al.; rows come out cut at ± 10."""

    def __init__(self, size: int) -> None:
        self.mean, self.variance, self.count = np.zeros(size), np.ones(size), 0

    def update(self, rows: NDArray[np.floating]) -> None:
        """Take in rows (N, size)."""
        mean, variance, count = rows.mean(axis=0, dtype=np.float64), rows.var(axis=0, dtype=np.float64), len(rows)
        total, away = self.count + count, mean - self.mean
        kept = self.variance * self.count if self.count else np.zeros_like(variance)
        self.variance = (kept + variance * count + away**2 * self.count * count / total) / total
        self.mean = self.mean + away * count / total
        self.count = total

    def apply(self, rows: NDArray[np.floating]) -> Floats:
        """Rows (..., size) with mean 0 and variance 1."""
        scaled = (rows - self.mean) / np.sqrt(self.variance + 1e-6)
        return np.asarray(np.clip(scaled, -10.0, 10.0), dtype=np.float32)


@dataclass(frozen=True)
class Rollout:
    """What a policy did and got; all (T, N) but what is said."""

    observed: Floats
    """(T, N, O), normalised."""
    actions: Floats
    """(T, N, A)."""
    log_probability: Floats
    rewards: Floats
    values: Floats
    next_values: Floats
    """Of the state that a step led to, before any new beginning."""
    terminated: Flags
    truncated: Flags


def advantages(rollout: Rollout, gamma: float, lam: float) -> Floats:
    """Generalised advantage estimation (Schulman et al. 2016), backwards in time. (T, N).

    Nothing is worth anything after an end; a truncated trial is worth its next value, and neither looks beyond it.
    """
    found = np.zeros_like(rollout.rewards)
    later = np.zeros_like(rollout.rewards[0])
    for t in reversed(range(len(found))):
        next_value = np.where(rollout.terminated[t], 0.0, rollout.next_values[t])
        over = rollout.terminated[t] | rollout.truncated[t]
        later = rollout.rewards[t] + gamma * next_value - rollout.values[t] + gamma * lam * np.where(over, 0.0, later)
        found[t] = later
    return found


class PPO:
    """A policy, its critic, and what both are taught with.

    A policy gives mean actions (B, A) of observations (B, O), and has a `log_std` (A,) that is learned.
    """

    def __init__(self, policy: nn.Module, value: nn.Module, size: int, config: PPOConfig, seed: int = 0) -> None:
        self.policy, self.value, self.config = policy, value, config
        self.scale = RunningNormalization(size)
        self.optimizer = torch.optim.Adam(policy.parameters(), config.rate)
        self.value_optimizer = torch.optim.Adam(value.parameters(), config.value_rate)
        self.chance = torch.Generator().manual_seed(seed)

    def collect(self, environment: VectorEnvironment, steps: int) -> Rollout:
        """Let the policy act, with its noise, for so many steps; the scale follows what is seen."""
        rows: list[tuple[Floats | Flags, ...]] = []
        seen = [environment.observe()]
        self.scale.update(seen[0])
        for _ in range(steps):
            observed = self.scale.apply(environment.observe())
            with torch.no_grad():
                told = torch.from_numpy(observed)
                mean, log_std = self.policy(told), self.policy.log_std
                actions = mean + log_std.exp() * torch.randn(mean.shape, generator=self.chance)
                chance, worth = log_probability(mean, log_std, actions), self.value(told)
            done = environment.step(actions.numpy())
            with torch.no_grad():
                next_worth = self.value(torch.from_numpy(self.scale.apply(done.observed)))
            seen.append(done.observed)
            rows.append(
                (observed, actions.numpy(), chance.numpy(), done.rewards.astype(np.float32), worth.numpy(),
                 next_worth.numpy(), done.terminated, done.truncated)
            )  # fmt: skip
        self.scale.update(np.concatenate(seen[1:]))
        return Rollout(*(np.stack(column) for column in zip(*rows, strict=True)))

    def update(self, rollout: Rollout, folder: Path | None = None) -> dict[str, float]:
        """Learn from a rollout; returns losses, the divergence, and how many batches it came to.

        TrainingFaultError when a loss is no number; the batch is saved in `folder`.
        """
        told = _flat(rollout, advantages(rollout, self.config.gamma, self.config.lam))
        figures: dict[str, float] = {}
        batches, count = 0, len(told["observed"])
        for _ in range(self.config.epochs):
            for chosen in torch.randperm(count, generator=self.chance).split(self.config.batch):
                figures = self._step({name: value[chosen] for name, value in told.items()}, folder)
                batches += 1
                if figures["divergence"] > 1.5 * self.config.max_divergence:
                    return figures | {"batches": float(batches)}
        return figures | {"batches": float(batches)}

    def _step(self, batch: dict[str, Tensor], folder: Path | None) -> dict[str, float]:
        """One step of policy and critic. The divergence is Schulman's estimate of KL that is never below 0."""
        mean, log_std = self.policy(batch["observed"]), self.policy.log_std
        log_ratio = log_probability(mean, log_std, batch["actions"]) - batch["log_probability"]
        ratio, gain = log_ratio.exp(), batch["advantages"]
        near = ratio.clamp(1 - self.config.clip, 1 + self.config.clip)
        loss = -torch.min(ratio * gain, near * gain).mean() - self.config.entropy * log_std.sum()
        value_loss = ((self.value(batch["observed"]) - batch["returns"]) ** 2).mean()
        stop_if_not_finite(loss + value_loss, batch, folder)
        for parameters, optimizer, one in (
            (self.policy.parameters(), self.optimizer, loss),
            (self.value.parameters(), self.value_optimizer, value_loss),
        ):
            optimizer.zero_grad()
            one.backward()
            nn.utils.clip_grad_norm_(parameters, self.config.max_gradient)
            optimizer.step()
        with torch.no_grad():
            self.policy.log_std.clamp_(*LOG_STD_RANGE)
        divergence = ((ratio - 1) - log_ratio).mean().item()
        return {"policy": loss.item(), "value": value_loss.item(), "divergence": divergence}


def _flat(rollout: Rollout, gains: Floats) -> dict[str, Tensor]:
    """All steps of all bodies as rows, advantages with mean 0 and spread 1."""
    scaled = (gains - gains.mean()) / (gains.std() + 1e-6)
    told = {
        "observed": rollout.observed,
        "actions": rollout.actions,
        "log_probability": rollout.log_probability,
        "advantages": scaled,
        "returns": gains + rollout.values,
    }
    return {name: torch.from_numpy(rows.reshape(-1, *rows.shape[2:]).astype(np.float32)) for name, rows in told.items()}
