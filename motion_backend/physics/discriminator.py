"""Adversarial motion priors (AMP) as SIMS 3.3 uses them: is a step (s, s') one of the clips that z stands for?

The style reward of a policy is how well its steps pass for those of clips. Training code: nothing is shipped trained.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from motion_backend.physics.observations import STATE_SIZE
from motion_backend.physics.policies import EMBEDDING_SIZE, mlp
from motion_backend.physics.training_fault import stop_if_not_finite


@dataclass(frozen=True)
class DiscriminatorConfig:
    """Sizes and rates of AMP; its own networks have (1024, 512), which costs five times as much on a CPU."""

    state: int = STATE_SIZE
    text: int = EMBEDDING_SIZE
    hidden: Sequence[int] = (256, 128)
    rate: float = 1e-4
    decay: float = 1e-4
    penalty: float = 10.0
    """Weight of the gradient penalty on steps of clips."""


@dataclass(frozen=True)
class Steps:
    """B steps of bodies, their states normalised."""

    before: Tensor
    """s (B, STATE_SIZE)."""
    after: Tensor
    """s' (B, STATE_SIZE)."""
    z: Tensor
    """The embedding of what is to be seen (B, 64): of the clip itself, or of what the policy was told."""

    @property
    def joined(self) -> Tensor:
        """What the discriminator sees. (B, 2 STATE_SIZE + 64)."""
        return torch.cat([self.before, self.after, self.z], dim=-1)


class Discriminator(nn.Module):  # type: ignore[misc]  # torch is not read by mypy
    """D(s, s' | z): near 1 for steps of clips, near −1 for those of a policy."""

    def __init__(self, config: DiscriminatorConfig) -> None:
        super().__init__()
        self.net = mlp(2 * config.state + config.text, config.hidden, 1)

    def forward(self, joined: Tensor) -> Tensor:
        """Verdicts (B,) on joined steps."""
        return self.net(joined)[..., 0]


class DiscriminatorTrainer:
    """A discriminator and what it is taught with."""

    def __init__(self, config: DiscriminatorConfig, seed: int = 0) -> None:
        with torch.random.fork_rng():
            torch.manual_seed(seed)
            self.discriminator = Discriminator(config)
        self.config = config
        self.optimizer = torch.optim.AdamW(self.discriminator.parameters(), config.rate, weight_decay=config.decay)

    def step(self, clips: Steps, policy: Steps, folder: Path | None = None) -> dict[str, float]:
        """One AMP step; returns the loss, the penalty, and how many of both sides are told rightly.

        TrainingFaultError when the loss is no number; the batch is saved in `folder`.
        """
        loss, penalty, verdicts = discriminator_loss(self.discriminator, clips, policy, self.config.penalty)
        stop_if_not_finite(loss, {"clips": clips.joined, "policy": policy.joined}, folder)
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        told = torch.cat([verdicts[0] > 0, verdicts[1] < 0]).float().mean()
        return {"loss": loss.item(), "penalty": penalty.item(), "told": told.item()}


def discriminator_loss(
    discriminator: Discriminator, clips: Steps, policy: Steps, weight: float
) -> tuple[Tensor, Tensor, tuple[Tensor, Tensor]]:
    """The least-squares loss of AMP (its Eq. 6 and 8), its gradient penalty, and the verdicts on clips and policy."""
    real = clips.joined.requires_grad_()
    on_clips, on_policy = discriminator(real), discriminator(policy.joined)
    (slope,) = torch.autograd.grad(on_clips.sum(), real, create_graph=True)
    penalty = (slope**2).sum(-1).mean()
    loss = ((on_clips - 1) ** 2).mean() + ((on_policy + 1) ** 2).mean() + 0.5 * weight * penalty
    return loss, penalty, (on_clips.detach(), on_policy.detach())


def style_reward(verdicts: Tensor) -> Tensor:
    """r^skill of AMP's Eq. 7: 1 where a step is taken for a clip's, 0 from −1 down. (B,)."""
    return (1 - 0.25 * (verdicts - 1) ** 2).clamp(min=0.0)
