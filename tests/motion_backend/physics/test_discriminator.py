"""The discriminator of AMP learns to tell clips from a policy, given what is to be seen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from motion_backend.physics.discriminator import (
    DiscriminatorConfig,
    DiscriminatorTrainer,
    Steps,
    discriminator_loss,
    style_reward,
)
from motion_backend.physics.training_fault import FILE, TrainingFaultError

SMALL = DiscriminatorConfig(state=6, text=4, hidden=(32, 16), rate=3e-3)


def steps(push: float, count: int = 256, seed: int = 0, text: float = 1.0) -> Steps:
    """Bodies whose second state is the first, moved."""
    chance = torch.Generator().manual_seed(seed)
    before = torch.randn(count, 6, generator=chance)
    z = torch.zeros(count, 4)
    z[:, 0] = text
    return Steps(before, before + push, z)


def test_one_step_moves_the_verdict_the_right_way() -> None:
    trainer = DiscriminatorTrainer(SMALL)
    clips, policy = steps(0.5), steps(-0.5, seed=1)

    def gap() -> float:
        with torch.no_grad():
            return float((trainer.discriminator(clips.joined) - trainer.discriminator(policy.joined)).mean())

    before = gap()
    trainer.step(clips, policy)
    assert gap() > before


def test_it_learns_which_steps_are_a_clips_and_which_words_they_have() -> None:
    """Forwards under one text and backwards under the other: neither step nor text alone tells anything."""
    trainer = DiscriminatorTrainer(replace(SMALL, penalty=0.1))

    def both(push: float, seed: int) -> Steps:
        one, other = steps(push, 128, seed, 1.0), steps(-push, 128, seed + 1, -1.0)
        return Steps(*(torch.cat([getattr(one, name), getattr(other, name)]) for name in ("before", "after", "z")))

    for turn in range(120):
        figures = trainer.step(both(0.5, 2 * turn), both(-0.5, 1000 + 2 * turn))
    assert figures["told"] > 0.95
    with torch.no_grad():
        assert style_reward(trainer.discriminator(both(0.5, 7).joined)).mean() > 0.6
        assert style_reward(trainer.discriminator(both(-0.5, 9).joined)).mean() < 0.2


def test_the_style_reward_is_amps() -> None:
    told = style_reward(torch.tensor([1.0, 0.0, -1.0, -5.0, 3.0]))
    torch.testing.assert_close(told, torch.tensor([1.0, 0.75, 0.0, 0.0, 0.0]))


def test_the_penalty_is_the_squared_slope_on_clips() -> None:
    trainer = DiscriminatorTrainer(SMALL)
    clips, policy = steps(0.5, 8), steps(-0.5, 8, seed=1)
    _, penalty, _ = discriminator_loss(trainer.discriminator, clips, policy, 10.0)
    slopes, tiny = [], 1e-3
    with torch.no_grad():
        for column in range(16):
            nudge = torch.zeros(16)
            nudge[column] = tiny
            seen = trainer.discriminator
            slopes.append((seen(clips.joined + nudge) - seen(clips.joined - nudge)) / (2 * tiny))
    assert penalty.item() == pytest.approx(float((torch.stack(slopes) ** 2).sum(0).mean()), rel=0.02)


def test_a_loss_that_is_no_number_stops_training_and_keeps_the_batch(tmp_path: Path) -> None:
    trainer = DiscriminatorTrainer(SMALL)
    policy = steps(-0.5, 8)
    policy.after[3, 2] = torch.inf
    with pytest.raises(TrainingFaultError, match="in policy"):
        trainer.step(steps(0.5, 8), policy, tmp_path)
    with np.load(tmp_path / FILE) as kept:
        assert kept["policy"].shape == (8, 16)
