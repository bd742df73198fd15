"""The schedule of LINGO A.6, and steps of DDPM and DDIM against densities worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from motion_backend.diffusion.noise_schedule import NoiseSchedule, ddim_step

SCHEDULE = NoiseSchedule()


def test_a_hundred_linear_steps_end_in_noise() -> None:
    assert SCHEDULE.steps == 100 == len(SCHEDULE.betas)
    assert np.allclose(np.diff(SCHEDULE.betas, 2), 0)
    assert SCHEDULE.betas[[0, -1]].tolist() == [1e-3, 0.2]
    assert SCHEDULE.alpha_bars[0] == 1 - 1e-3
    assert 0 < SCHEDULE.alpha_bars[-1] < 1e-3
    assert (np.diff(SCHEDULE.alpha_bars) < 0).all()


def test_a_schedule_that_leaves_signal_is_refused() -> None:
    with pytest.raises(ValueError, match="of the signal"):
        NoiseSchedule(100, 1e-4, 2e-2)  # LINGO's printed betas leave 36 %


def test_noised_windows_have_the_mean_and_variance_of_the_step() -> None:
    clean, steps = torch.full((3, 2, 4000), 2.0), torch.tensor([0, 50, 99])
    found = SCHEDULE.noised(clean, torch.randn(clean.shape, generator=torch.Generator().manual_seed(0)), steps)
    left = SCHEDULE.alpha_bars[[0, 50, 99]]
    assert np.allclose(found.mean(dim=(1, 2)), 2 * np.sqrt(left), atol=0.05)
    assert np.allclose(found.var(dim=(1, 2)), 1 - left, atol=0.05)


@pytest.mark.parametrize("step", [1, 40, 99])
def test_a_step_back_with_fresh_noise_is_bayes_rule_on_a_grid(step: int) -> None:
    """q(x_{t-1} | x_t, x_0) ∝ q(x_t | x_{t-1}) q(x_{t-1} | x_0), multiplied out over a fine grid of x_{t-1}."""
    clean, x, beta, before = 0.7, -0.4, SCHEDULE.betas[step], SCHEDULE.alpha_bars[step - 1]
    grid = np.linspace(-6, 6, 200_001)
    density = -((x - np.sqrt(1 - beta) * grid) ** 2) / (2 * beta)
    density += -((grid - np.sqrt(before) * clean) ** 2) / (2 * (1 - before))
    weights = np.exp(density - density.max())
    weights /= weights.sum()
    mean = float(weights @ grid)
    deviation = float(np.sqrt(weights @ (grid - mean) ** 2))
    at, one = (torch.tensor([value], dtype=torch.float64) for value in (x, clean))
    for noise in (0.0, 1.0):
        found = ddim_step(SCHEDULE, at, one, step, step - 1, torch.tensor([noise], dtype=torch.float64))
        assert found.item() == pytest.approx(mean + noise * deviation, abs=1e-4)


def test_a_ddim_step_keeps_the_noise_that_it_came_with() -> None:
    clean, noise = torch.tensor([0.3, -1.2]), torch.tensor([0.9, 0.1])
    bars = SCHEDULE.alpha_bars
    x = np.sqrt(bars[80]) * clean + np.sqrt(1 - bars[80]) * noise
    found = ddim_step(SCHEDULE, x, clean, 80, 35)
    assert torch.allclose(found, np.sqrt(bars[35]) * clean + np.sqrt(1 - bars[35]) * noise, atol=1e-6)
    assert torch.equal(ddim_step(SCHEDULE, x, clean, 80, None), clean)
    assert torch.equal(ddim_step(SCHEDULE, x, clean, 0, None, noise), clean)


@pytest.mark.parametrize("width", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("stochastic", [True, False])
def test_noise_becomes_the_data_where_the_guess_is_the_best_there_is(width: float, stochastic: bool) -> None:
    """Of data from N(1, width²) the mean given x_t is known: with it as the guess, what is sampled is such data."""
    made = torch.Generator().manual_seed(1)
    x = torch.randn(20_000, generator=made, dtype=torch.float64)
    steps = SCHEDULE.spaced(100)
    for step, following in zip(steps, (*steps[1:], None), strict=True):
        left = SCHEDULE.alpha_bars[step]
        told = width**2 * np.sqrt(left) / (width**2 * left + 1 - left)
        guess = 1.0 + told * (x - np.sqrt(left))
        fresh = torch.randn(len(x), generator=made, dtype=torch.float64) if stochastic else None
        x = ddim_step(SCHEDULE, x, guess, step, following, fresh)
    assert float(x.mean()) == pytest.approx(1.0, abs=0.05)
    assert float(x.std()) == pytest.approx(width, rel=0.08)


def test_sampling_goes_from_the_last_step_to_the_first() -> None:
    assert SCHEDULE.spaced(100) == tuple(range(99, -1, -1))
    for count in (1, 5, 10, 20):
        steps = SCHEDULE.spaced(count)
        assert len(steps) == count
        assert list(steps) == sorted(steps, reverse=True)
        assert steps[-1] == 0 or count == 1
    with pytest.raises(ValueError, match="1 to 100 steps"):
        SCHEDULE.spaced(0)
