"""Training of the embedding: resumable, the same for a seed, on one thread of a CPU."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from motion_backend.datasets.motion_text_dataset import MotionTextDataset
from motion_backend.datasets.normalization import Floats, Normalization
from motion_backend.embedding.text_motion_autoencoder import (
    AutoencoderConfig,
    TextMotionAutoencoder,
    autoencoder_loss,
    contrast_loss,
)
from motion_backend.physics.observations import STATE_FLOOR
from scene_graphs.errors import UserError

WARMS_UP: Final = 50
"""Steps until the full rate."""
LAST_RATE: Final = 0.02
"""Of the full rate, at the end of a cosine."""
MAX_GRADIENT: Final = 1.0
CHECKPOINT: Final = "checkpoint.safetensors"
SCALE_FRAMES: Final = 50_000
"""Frames that mean and spread are taken from."""
_MOMENTS: Final = ("exp_avg", "exp_avg_sq", "step")
Report = Callable[[int, dict[str, float]], None]


class TrainingError(UserError):
    """Training cannot go on."""


@dataclass(frozen=True)
class TrainConfig:
    """How it is trained."""

    steps: int = 4000
    batch: int = 64
    """Clips a step."""
    rate: float = 1e-3
    decay: float = 0.02
    contrast: float = 1.0
    """Weight of `contrast_loss`; 0 is the paper's Eq. 3."""
    seed: int = 0
    save_every: int = 100


def train(
    dataset: MotionTextDataset,
    features: Mapping[str, Floats],
    folder: Path,
    config: TrainConfig,
    sizes: AutoencoderConfig,
    report: Report = lambda _step, _terms: None,
) -> tuple[TextMotionAutoencoder, Normalization]:
    """Learn from captioned clips; `features` are those of every wording. Goes on from a checkpoint in `folder`.

    TrainingError when a loss is no number (its batch is saved beside the checkpoint), or a checkpoint is of another
    run.
    """
    torch.set_num_threads(1)
    scale = normalization_of(dataset)
    with torch.random.fork_rng():
        torch.manual_seed(config.seed)
        model = TextMotionAutoencoder(sizes)
        optimizer = torch.optim.AdamW(model.parameters(), config.rate, weight_decay=config.decay)
        first = _resume(folder / CHECKPOINT, model, optimizer, config, sizes)
        model.train()
        for step in range(first, config.steps):
            terms = _step(model, optimizer, dataset, features, scale, config, step, folder)
            if (step + 1) % config.save_every == 0 or step + 1 == config.steps:
                _save(folder / CHECKPOINT, model, optimizer, config, sizes, step + 1)
                report(step + 1, terms)
    return model.eval(), scale


def normalization_of(dataset: MotionTextDataset) -> Normalization:
    """The scale of s over all clips, from frames by chance."""
    frames = np.concatenate([clip.states for clip in dataset.clips])
    chosen = np.random.default_rng(0).permutation(len(frames))[:SCALE_FRAMES]
    return Normalization.of(frames[np.sort(chosen)].astype(np.float32), STATE_FLOOR)


def _step(
    model: TextMotionAutoencoder,
    optimizer: torch.optim.Optimizer,
    dataset: MotionTextDataset,
    features: Mapping[str, Floats],
    scale: Normalization,
    config: TrainConfig,
    step: int,
    folder: Path,
) -> dict[str, float]:
    """One batch; its chance hangs on seed and step alone, so that a resumed run is the same run."""
    rng = np.random.default_rng([config.seed, step])
    torch.manual_seed(int(rng.integers(1 << 31)))
    for group in optimizer.param_groups:
        group["lr"] = config.rate * _rate_share(step, config.steps)
    drawn = dataset.draw(config.batch, rng)
    states = torch.from_numpy(np.clip(scale.apply(drawn.states), -10.0, 10.0))
    total, terms, z = autoencoder_loss(model, states, _stack(features, drawn.wordings))
    names = list(dataset.grouped)
    told = [index for index, group in enumerate(drawn.groups) if group]
    contrast = torch.zeros(())
    if config.contrast and told:
        said = [dataset.grouped[name][rng.integers(len(dataset.grouped[name]))] for name in names]
        right = torch.tensor([names.index(drawn.groups[index]) for index in told])
        contrast = contrast_loss(z[told], model.encode_text(_stack(features, said)), right)
    loss = total + config.contrast * contrast
    if not torch.isfinite(loss):
        np.savez(folder / f"batch{step}.npz", states=drawn.states, wordings=np.array(drawn.wordings))
        raise TrainingError(
            f"step {step}: the loss is {loss.item()}", f"look at batch{step}.npz, lower --rate", at=folder
        )
    optimizer.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(model.parameters(), MAX_GRADIENT)
    optimizer.step()
    return dict(zip(("motion", "align", "text", "contrast"), [*terms.tolist(), contrast.item()], strict=True))


def _rate_share(step: int, steps: int) -> float:
    """Up in a line, then down in a cosine."""
    share = min(step / max(steps, 1), 1.0)
    return float(min((step + 1) / WARMS_UP, 1.0) * (LAST_RATE + (1 - LAST_RATE) * (1 + np.cos(np.pi * share)) / 2))


def _stack(features: Mapping[str, Floats], wordings: list[str] | tuple[str, ...]) -> Tensor:
    return torch.from_numpy(np.stack([features[wording] for wording in wordings]))


def _save(
    path: Path,
    model: TextMotionAutoencoder,
    optimizer: torch.optim.Optimizer,
    config: TrainConfig,
    sizes: AutoencoderConfig,
    step: int,
) -> None:
    """Everything a run needs to go on, put in place at once."""
    tensors = {f"model.{name}": value for name, value in model.state_dict().items()}
    for index, moments in optimizer.state_dict()["state"].items():
        tensors |= {f"optimizer.{index}.{name}": moments[name] for name in _MOMENTS}
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_suffix(".writing")
    told = {"run": _run_of(config, sizes), "step": str(step)}
    save_file({name: value.contiguous() for name, value in tensors.items()}, aside, told)
    aside.replace(path)


def _resume(
    path: Path,
    model: TextMotionAutoencoder,
    optimizer: torch.optim.Optimizer,
    config: TrainConfig,
    sizes: AutoencoderConfig,
) -> int:
    """Take over what a checkpoint holds; the step to go on with, 0 where there is none. TrainingError."""
    if not path.is_file():
        return 0
    try:
        with safe_open(path, "pt") as file:
            told, tensors = file.metadata(), {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError) as error:
        raise TrainingError(f"{path} is damaged: {error}", "move it away to begin anew") from error
    if told.get("run") != _run_of(config, sizes):
        raise TrainingError(f"{path} is of a run with other settings", "give another --out, or move it away")
    model.load_state_dict(_under("model.", tensors))
    kept: dict[int, dict[str, Tensor]] = {}
    for name, value in _under("optimizer.", tensors).items():
        index, moment = name.split(".")
        kept.setdefault(int(index), {})[moment] = value
    optimizer.load_state_dict({"state": kept, "param_groups": optimizer.state_dict()["param_groups"]})
    return int(told["step"])


def _under(prefix: str, tensors: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): value for name, value in tensors.items() if name.startswith(prefix)}


def _run_of(config: TrainConfig, sizes: AutoencoderConfig) -> str:
    """What must be the same for a run to be gone on with."""
    told: dict[str, Any] = asdict(replace(config, save_every=0)) | asdict(sizes)
    return json.dumps(told, sort_keys=True)
