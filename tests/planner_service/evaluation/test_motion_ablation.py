"""What is left out is not told, and nothing else changes; parts to compare are found in rooms not learned from."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
import torch
from torch import Tensor
from typer.testing import CliRunner

from motion_backend.diffusion.conditions import Conditions
from motion_backend.diffusion.denoiser import Denoiser, DenoiserSizes
from motion_backend.diffusion.motion_features import FEATURES, HISTORY
from motion_backend.diffusion.sampler import Sampler, Scale
from planner_service.cli import app
from planner_service.evaluation.motion_ablation import ABLATIONS, AblatedSampler, Ablation


def told() -> Conditions:
    ones, number = torch.ones(1), torch.ones(1, dtype=torch.long)
    return Conditions(
        torch.ones(1, 384), ones, 40 * number, number, 0 * number,
        torch.ones(1, 9), ones, torch.ones(1, 4), ones,
    )  # fmt: skip


@pytest.mark.parametrize("ablation", [one for one in ABLATIONS if one.steps in (5, 10)], ids=lambda one: one.name)
def test_what_is_left_out_is_not_told_and_nothing_else_changes(
    ablation: Ablation, monkeypatch: pytest.MonkeyPatch
) -> None:
    network = Denoiser(DenoiserSizes(1, 2, 16, 16, True, None))
    heard: list[Conditions] = []
    encode = network.encode

    def overheard(given: Conditions) -> Tensor:
        heard.append(given)
        return encode(given)

    monkeypatch.setattr(network, "encode", overheard)
    sampler = Sampler(network, Scale(torch.zeros(FEATURES), torch.ones(FEATURES)))
    found = AblatedSampler.of(sampler, ablation).windows(np.zeros((1, HISTORY, FEATURES)), told(), 0)
    assert found.shape == (1, 14, FEATURES)
    expected = {"frame": 0 if "frame" in ablation.untold else 40}
    expected |= {f"has_{name}": int(name not in ablation.untold) for name in ("text", "pelvis", "hand")}
    for field in fields(Conditions):
        if field.name in expected:
            assert getattr(heard[0], field.name).item() == expected[field.name], field.name


def test_every_ablation_has_a_name_of_its_own() -> None:
    assert len({one.name for one in ABLATIONS}) == len(ABLATIONS)


def test_weights_are_judged_by_people_alone() -> None:
    found = CliRunner().invoke(app, ["evaluate", "motion", "--weights", "own/step000100"])
    assert "give --clips FILE too" in str(found.exception)
