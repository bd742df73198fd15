"""A policy learns what a teacher's lessons say: supervised, on one thread of a CPU, the same for a seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import torch

from motion_backend.datasets.normalization import Floats, Normalization
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.policies import PLAN_SIZE, SOLES, Policy, PolicyConfig, PolicyName
from motion_backend.physics.policy_view import OFFSET_FLOOR, floors
from motion_backend.physics.trained_policy import LARGEST, TrainedPolicy
from motion_backend.physics.training_fault import stop_if_not_finite
from motion_backend.rotations import Array

LAST_RATE: Final = 0.03
"""Of the full rate, at the end of its cosine."""
MAX_GRADIENT: Final = 1.0


@dataclass(frozen=True)
class CloningConfig:
    """How it is learned."""

    steps: int = 2000
    batch: int = 512
    rate: float = 1e-3
    decay: float = 1e-4
    seed: int = 0


@dataclass(frozen=True)
class Rows:
    """What was seen (N, O) and by what offsets the teacher would answer (N, 30)."""

    seen: Floats
    done: Floats

    def scales(self, name: PolicyName) -> tuple[Normalization, Normalization]:
        """Of both."""
        seen, state = Normalization.of(self.seen, floors(name)), PolicyConfig.of(name, NU).state
        # What is planted is 1 and what is not -1, however often either is.
        for one in (seen.mean, seen.spread):
            one[state - SOLES : state] = 0.5
        return seen, Normalization.of(self.done, OFFSET_FLOOR)


def new_policy(name: PolicyName, rows: Rows, seed: int = 0, answers: Array | None = None) -> TrainedPolicy:
    """One on the scale of some rows: it does their mean, or what linear answers (`linear_answers`) say."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        network = Policy(PolicyConfig.of(name, NU))
    policy = TrainedPolicy(name, network.requires_grad_(False), *rows.scales(name))
    if answers is not None:
        state = network.config.state
        mean, spread = (
            one[state - PLAN_SIZE : state].astype(np.float64) for one in (policy.seen.mean, policy.seen.spread)
        )
        told = answers.copy()
        told[:, -1] += mean @ answers[:, :-1] - policy.done.mean
        told[:, :-1] *= spread[:, None]
        network.answer.copy_(torch.from_numpy((told / policy.done.spread).astype(np.float32)))
    return policy


def clone(policy: TrainedPolicy, rows: Rows, config: CloningConfig, folder: Path | None = None) -> Sequence[float]:
    """Teach a policy in place; its loss in every step, in squared spreads of the controls.

    TrainingFaultError when it is no number; the batch is saved in `folder`.
    """
    torch.set_num_threads(1)
    network = policy.network.train().requires_grad_(True)
    optimizer = torch.optim.AdamW(network.parameters(), config.rate, weight_decay=config.decay)
    told, losses = torch.from_numpy(policy.done.apply(rows.done)), []
    for step in range(config.steps):
        chosen = np.random.default_rng([config.seed, step]).integers(len(rows.seen), size=config.batch)
        for group in optimizer.param_groups:
            group["lr"] = config.rate * _share(step / config.steps)
        seen = torch.from_numpy(np.clip(policy.seen.apply(rows.seen[chosen]), -LARGEST, LARGEST))
        loss = ((network(seen) - told[chosen]) ** 2).mean()
        stop_if_not_finite(loss, {"seen": seen, "done": told[chosen]}, folder)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), MAX_GRADIENT)
        optimizer.step()
        losses.append(loss.item())
    network.eval().requires_grad_(False)
    return losses


def _share(done: float) -> float:
    return float(LAST_RATE + (1 - LAST_RATE) * (1 + np.cos(np.pi * done)) / 2)
