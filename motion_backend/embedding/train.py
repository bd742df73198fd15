"""Training of the embedding: resumable, the same for a seed, on one thread of a CPU."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
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
from motion_backend.embedding.text_motion_embedding import LARGEST
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
    with torch.random.fork_rng():
        torch.manual_seed(config.seed)
        run = _Run(dataset, features, folder, config, sizes)
        for step in range(run.resume(), config.steps):
            terms = run.step(step)
            if (step + 1) % config.save_every == 0 or step + 1 == config.steps:
                run.save(step + 1)
                report(step + 1, terms)
    return run.model.eval(), run.scale


def normalization_of(dataset: MotionTextDataset) -> Normalization:
    """The scale of s over all clips, from frames by chance."""
    frames = np.concatenate([clip.states for clip in dataset.clips])
    chosen = np.random.default_rng(0).permutation(len(frames))[:SCALE_FRAMES]
    return Normalization.of(frames[np.sort(chosen)].astype(np.float32), STATE_FLOOR)


class _Run:
    """A model on its way, and what it learns from."""

    def __init__(
        self,
        dataset: MotionTextDataset,
        features: Mapping[str, Floats],
        folder: Path,
        config: TrainConfig,
        sizes: AutoencoderConfig,
    ) -> None:
        self.dataset, self.features, self.config = dataset, features, config
        self.path = folder / CHECKPOINT
        self.scale = normalization_of(dataset)
        self.model = TextMotionAutoencoder(sizes).train()
        self.optimizer = torch.optim.AdamW(self.model.parameters(), config.rate, weight_decay=config.decay)
        # What must be the same for a run to be gone on with.
        told: dict[str, Any] = asdict(replace(config, save_every=0)) | asdict(sizes)
        self.name = json.dumps(told, sort_keys=True)

    def step(self, step: int) -> dict[str, float]:
        """One batch; its chance hangs on seed and step alone, so that a resumed run is the same run."""
        rng = np.random.default_rng([self.config.seed, step])
        torch.manual_seed(int(rng.integers(1 << 31)))
        for group in self.optimizer.param_groups:
            group["lr"] = self.config.rate * _rate_share(step, self.config.steps)
        drawn = self.dataset.draw(self.config.batch, rng)
        states = torch.from_numpy(np.clip(self.scale.apply(drawn.states), -LARGEST, LARGEST))
        total, terms, z = autoencoder_loss(self.model, states, self._features_of(drawn.wordings))
        contrast = self._contrast(z, drawn.groups, rng)
        loss = total + self.config.contrast * contrast
        if not torch.isfinite(loss):
            kept = self.path.with_name(f"batch{step}.npz")
            np.savez(kept, states=drawn.states, wordings=np.array(drawn.wordings))
            raise TrainingError(f"step {step}: the loss is {loss.item()}", f"look at {kept}, or lower the rate")
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.model.parameters(), MAX_GRADIENT)
        self.optimizer.step()
        return dict(zip(("motion", "align", "text", "contrast"), [*terms.tolist(), contrast.item()], strict=True))

    def _contrast(self, z: Tensor, groups: Sequence[str], rng: np.random.Generator) -> Tensor:
        """Every clip that has a group against one wording of each group."""
        told = [index for index, group in enumerate(groups) if group]
        if not self.config.contrast or not told:
            return torch.zeros(())
        grouped = self.dataset.grouped
        said = [some[rng.integers(len(some))] for some in grouped.values()]
        names = list(grouped)
        right = torch.tensor([names.index(groups[index]) for index in told])
        return contrast_loss(z[told], self.model.encode_text(self._features_of(said)), right)

    def _features_of(self, wordings: Sequence[str]) -> Tensor:
        return torch.from_numpy(np.stack([self.features[wording] for wording in wordings]))

    def save(self, step: int) -> None:
        """Everything the run needs to go on, put in place at once."""
        tensors = {f"model.{name}": value for name, value in self.model.state_dict().items()}
        for index, moments in self.optimizer.state_dict()["state"].items():
            tensors |= {f"optimizer.{index}.{name}": moments[name] for name in _MOMENTS}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        aside = self.path.with_suffix(".writing")
        whole = {name: value.contiguous() for name, value in tensors.items()}
        save_file(whole, aside, {"run": self.name, "step": str(step)})
        aside.replace(self.path)

    def resume(self) -> int:
        """Take over what a checkpoint holds; the step to go on with, 0 where there is none. TrainingError."""
        if not self.path.is_file():
            return 0
        try:
            with safe_open(self.path, "pt") as file:
                told, tensors = file.metadata(), {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        except (SafetensorError, OSError) as error:
            raise TrainingError(f"{self.path} is damaged: {error}", "move it away to begin anew") from error
        if told.get("run") != self.name:
            raise TrainingError(f"{self.path} is of a run with other settings", "give another --out, or move it away")
        self.model.load_state_dict(_under("model.", tensors))
        kept: dict[int, dict[str, Tensor]] = {}
        for name, value in _under("optimizer.", tensors).items():
            index, moment = name.split(".")
            kept.setdefault(int(index), {})[moment] = value
        self.optimizer.load_state_dict({"state": kept, "param_groups": self.optimizer.state_dict()["param_groups"]})
        return int(told["step"])


def _rate_share(step: int, steps: int) -> float:
    """Up in a line, then down in a cosine."""
    share = min(step / max(steps, 1), 1.0)
    return float(min((step + 1) / WARMS_UP, 1.0) * (LAST_RATE + (1 - LAST_RATE) * (1 + np.cos(np.pi * share)) / 2))


def _under(prefix: str, tensors: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): value for name, value in tensors.items() if name.startswith(prefix)}
