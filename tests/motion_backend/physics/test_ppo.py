"""PPO against an oracle for its advantages, and on a task whose best control is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from motion_backend.physics.policies import Value, log_probability, mlp
from motion_backend.physics.ppo import PPO, Outcome, PPOConfig, Rollout, RunningNormalization, advantages
from motion_backend.physics.training_fault import FILE, TrainingFaultError

STEP, PRICE, LENGTH, COUNT = 0.2, 0.1, 15, 128
"""Points on a line are moved by STEP times an action, pay for being away from 0 and for acting, and live so long."""


class Points:
    """x' = x + STEP a, reward −x² − PRICE a²: the best control is a = −k x, as of every linear-quadratic regulator."""

    def __init__(self, seed: int, count: int = COUNT) -> None:
        self.rng = np.random.default_rng(seed)
        self.x, self.age = self.rng.uniform(-1, 1, (count, 1)), self.rng.integers(LENGTH, size=count)

    def observe(self) -> np.ndarray:
        return self.x.astype(np.float32)

    def step(self, actions: np.ndarray) -> Outcome:
        self.x = self.x + STEP * actions
        rewards = -(self.x[:, 0] ** 2) - PRICE * actions[:, 0] ** 2
        self.age += 1
        over, seen = self.age >= LENGTH, self.x.astype(np.float32)
        self.x[over], self.age[over] = self.rng.uniform(-1, 1, (int(over.sum()), 1)), 0
        return Outcome(rewards.astype(np.float32), seen, np.zeros_like(over), over)


class Line(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.net = mlp(1, (16,), 1)
        self.log_std = nn.Parameter(torch.full((1,), -0.7))

    def forward(self, observed: torch.Tensor) -> torch.Tensor:
        return self.net(observed)


def mean_return(control: object) -> float:
    points, total = Points(99), 0.0
    points.age[:] = 0
    for _ in range(LENGTH - 1):
        total += float(points.step(np.asarray(control(points.observe()))).rewards.mean())  # type: ignore[operator]
    return total


def test_ppo_comes_near_the_best_control_of_a_point() -> None:
    with torch.random.fork_rng():
        torch.manual_seed(0)
        policy, value = Line(), Value(1, (32,))
    learner = PPO(policy, value, 1, PPOConfig(gamma=0.95, rate=1e-2, value_rate=1e-2, batch=2048, epochs=4), seed=0)
    environment = Points(0)
    for _ in range(20):
        learner.update(learner.collect(environment, 16))

    def learned(x: np.ndarray) -> np.ndarray:
        with torch.no_grad():
            return policy(torch.from_numpy(learner.scale.apply(x))).numpy()

    nothing, best = mean_return(np.zeros_like), max(mean_return(lambda x, k=k: -k * x) for k in np.linspace(0, 5, 51))
    assert mean_return(learned) > nothing + 0.95 * (best - nothing)


def rollout(steps: int = 12, count: int = 3, seed: int = 0) -> Rollout:
    rng = np.random.default_rng(seed)
    rewards, values, next_values = rng.normal(size=(3, steps, count)).astype(np.float32)
    over = rng.random((2, steps, count)) < 0.15
    next_values[:-1] = np.where((over[0] | over[1])[:-1], next_values[:-1], values[1:])
    empty = np.zeros((steps, count, 1), np.float32)
    return Rollout(empty, empty, rewards, rewards, values, next_values, over[0], over[1])


def test_advantages_are_the_weighted_sum_of_all_n_step_returns() -> None:
    """The definition, forwards: (1 − λ) Σ λⁿ⁻¹ (n-step return) − value, the last one taking what weight is left."""
    told, gamma, lam = rollout(), 0.9, 0.8
    found = advantages(told, gamma, lam)
    for body in range(3):
        for start in range(12):
            returns, gathered = [], 0.0
            for t in range(start, 12):
                gathered += gamma ** (t - start) * float(told.rewards[t, body])
                ahead = 0.0 if told.terminated[t, body] else float(told.next_values[t, body])
                returns.append(gathered + gamma ** (t - start + 1) * ahead)
                if told.terminated[t, body] or told.truncated[t, body]:
                    break
            weights = [(1 - lam) * lam**n for n in range(len(returns))]
            weights[-1] = lam ** (len(returns) - 1)
            expected = np.dot(weights, returns) - told.values[start, body]
            assert found[start, body] == pytest.approx(expected, abs=1e-5)


def test_an_end_hides_what_comes_after_it() -> None:
    told = rollout(seed=3)
    ends = np.zeros_like(told.terminated)
    ends[5] = True
    first = advantages(replace(told, terminated=ends), 0.99, 0.95)
    later = replace(told, terminated=ends, rewards=told.rewards + (np.arange(12) > 5)[:, None].astype(np.float32))
    np.testing.assert_array_equal(first[:6], advantages(later, 0.99, 0.95)[:6])


def test_the_running_scale_is_that_of_all_rows_at_once() -> None:
    rows = np.random.default_rng(0).normal(3, 2, (500, 4)) * [1, 10, 0.1, 1]
    scale = RunningNormalization(4)
    for some in np.split(rows, [1, 7, 200]):
        scale.update(some)
    np.testing.assert_allclose(scale.mean, rows.mean(axis=0))
    np.testing.assert_allclose(scale.variance, rows.var(axis=0))
    assert np.abs(scale.apply(rows + 1e9)).max() == 10


def test_probabilities_are_those_of_independent_gaussians() -> None:
    mean, log_std, actions = torch.randn(5, 3), torch.tensor([0.1, -1.0, 0.5]), torch.randn(5, 3)
    expected = torch.distributions.Normal(mean, log_std.exp()).log_prob(actions).sum(-1)
    torch.testing.assert_close(log_probability(mean, log_std, actions), expected)


def test_a_policy_that_moves_too_far_is_left_alone_until_the_next_rollout() -> None:
    learner = PPO(Line(), Value(1, (8,)), 1, PPOConfig(rate=0.1, batch=256), seed=0)
    figures = learner.update(learner.collect(Points(1), 16))
    assert figures["batches"] < 5 * 16 * COUNT / 256
    assert figures["divergence"] > 0.03


def test_a_loss_that_is_no_number_stops_training_and_keeps_the_batch(tmp_path: Path) -> None:
    learner = PPO(Line(), Value(1, (8,)), 1, PPOConfig(), seed=0)
    told = learner.collect(Points(1), 4)
    told.rewards[2, 3] = np.nan
    before = [one.clone() for one in learner.policy.parameters()]
    with pytest.raises(TrainingFaultError, match="advantages"):
        learner.update(told, tmp_path)
    assert all(torch.equal(a, b) for a, b in zip(before, learner.policy.parameters(), strict=True))
    with np.load(tmp_path / FILE) as kept:
        assert np.isnan(kept["returns"]).any()


def test_the_same_seed_learns_the_same() -> None:
    def learned() -> list[torch.Tensor]:
        with torch.random.fork_rng():
            torch.manual_seed(2)
            learner = PPO(Line(), Value(1, (8,)), 1, PPOConfig(batch=128), seed=5)
        learner.update(learner.collect(Points(4), 4))
        return list(learner.policy.parameters())

    assert all(torch.equal(a, b) for a, b in zip(learned(), learned(), strict=True))
