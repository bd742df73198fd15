"""Weights on disk: a safetensors file and beside it a config that says what they are weights of. No pickle."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from motion_backend.diffusion.completion_scheduler import CompletionScheduler, SchedulerSizes
from motion_backend.diffusion.denoiser import Denoiser, DenoiserSizes
from motion_backend.diffusion.motion_features import FEATURES
from motion_backend.diffusion.noise_schedule import NoiseSchedule
from motion_backend.diffusion.sampler import Scale
from scene_graphs.errors import UserError

FORMAT: Final = 1
MEAN, DEVIATION, STRIDES = "scale.mean", "scale.deviation", "strides"


class CheckpointError(UserError):
    """Weights are missing, damaged or of another config; says which and what to do."""


@dataclass(frozen=True)
class Weights:
    """A trained network with the scale of what it sees."""

    network: nn.Module
    scale: Scale
    config: Mapping[str, Any] = field(default_factory=dict)
    """Kind, sizes, and how it was trained."""
    strides: Tensor | None = None
    """(gaits, N, 2, 202) histories of everybody's walk, as the model itself walks; None where it has none."""


def save_weights(weights: Weights, path: Path, half: bool = False) -> None:
    """PATH.safetensors and PATH.json; `half` stores 16 bits a number, as weights are shipped."""
    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in weights.network.state_dict().items()}
    if half:
        tensors = {name: tensor.half() for name, tensor in tensors.items()}
    tensors |= {MEAN: weights.scale.mean.cpu().float(), DEVIATION: weights.scale.deviation.cpu().float()}
    if weights.strides is not None:
        tensors[STRIDES] = weights.strides.half()
    written = path.with_suffix(".safetensors.part")
    save_file(tensors, written)
    path.with_suffix(".json").write_text(json.dumps({"format": FORMAT, **weights.config}, indent=1), encoding="utf-8")
    written.replace(path.with_suffix(".safetensors"))


def load_denoiser(path: Path) -> tuple[Weights, NoiseSchedule]:
    """The denoiser of PATH.safetensors, ready to sample, and the schedule it was trained for. CheckpointError."""
    config = _config(path, "denoiser")
    try:
        network, schedule = Denoiser(DenoiserSizes.from_dict(config["sizes"])), NoiseSchedule(**config["noise"])
    except (TypeError, ValueError, KeyError) as error:
        raise _broken(path.with_suffix(".json"), f"it is no config of a denoiser ({error})") from error
    return _filled(network, config, path), schedule


def load_scheduler(path: Path) -> Weights:
    """The completion scheduler of PATH.safetensors. CheckpointError."""
    config = _config(path, "scheduler")
    try:
        network = CompletionScheduler(SchedulerSizes.from_dict(config["sizes"]))
    except (TypeError, ValueError, KeyError) as error:
        raise _broken(path.with_suffix(".json"), f"it is no config of a scheduler ({error})") from error
    return _filled(network, config, path)


def read_tensors(path: Path) -> dict[str, Tensor]:
    """All tensors of a file. CheckpointError where it is missing, cut off or something else."""
    try:
        found: dict[str, Tensor] = load_file(path)
        return found
    except FileNotFoundError as error:
        raise _broken(path, "it is missing") from error
    except (SafetensorError, OSError, ValueError) as error:
        raise _broken(path, f"it is damaged ({error})") from error


def _config(path: Path, kind: str) -> dict[str, Any]:
    where = path.with_suffix(".json")
    try:
        config = json.loads(where.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise _broken(where, "it is missing") from error
    except (OSError, ValueError) as error:
        raise _broken(where, f"it is damaged ({error})") from error
    if not isinstance(config, dict) or config.get("format") != FORMAT or config.get("kind") != kind:
        raise _broken(where, f"it is no config of a {kind} of format {FORMAT}")
    return config


def _filled(network: nn.Module, config: dict[str, Any], path: Path) -> Weights:
    where = path.with_suffix(".safetensors")
    tensors = {name: tensor.float() for name, tensor in read_tensors(where).items()}
    scale = Scale(tensors.pop(MEAN, torch.zeros(0)), tensors.pop(DEVIATION, torch.zeros(0)))
    if scale.mean.shape != (FEATURES,) or scale.deviation.shape != (FEATURES,):
        raise _broken(where, f"it has no scale of {FEATURES} features")
    strides = tensors.pop(STRIDES, None)
    try:
        network.load_state_dict(tensors)
    except RuntimeError as error:
        raise _broken(where, "its tensors are not those of its config") from error
    if not all(bool(torch.isfinite(tensor).all()) for tensor in (*tensors.values(), scale.mean, scale.deviation)):
        raise _broken(where, "it holds numbers that are not finite")
    return Weights(network.eval().requires_grad_(False), scale, config, strides)


def _broken(path: Path, why: str) -> CheckpointError:
    return CheckpointError(f"{path}: {why}", "install the package anew, or train weights with `sims train`")
