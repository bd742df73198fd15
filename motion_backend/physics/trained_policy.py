"""A policy that has learned, with its scales and its figures, on disk and in use."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from motion_backend.datasets.normalization import Normalization
from motion_backend.physics.policies import Policy, PolicyConfig, PolicyName
from motion_backend.rotations import Array
from scene_graphs.errors import UserError

VERSION: Final = "3"
LARGEST: Final = 10.0
"""Normalised observations are cut here, in training too."""
_SCALES: Final = ("seen.mean", "seen.spread", "done.mean", "done.spread")


class PolicyError(UserError):
    """Weights are missing, damaged, of another version or of another body."""


@dataclass(frozen=True)
class TrainedPolicy:
    """A network between the scale of what it sees and that of the controls it gives."""

    name: PolicyName
    network: Policy
    seen: Normalization
    """Of observations (O,)."""
    done: Normalization
    """Of offsets of controls (30,)."""
    figures: Mapping[str, Any] = field(default_factory=dict)
    """How it was trained and what it is worth."""

    def offsets(self, observed: Array) -> Array:
        """What is added to the plan's controls (N, 30) for observations (N, O), in radians."""
        rows = np.clip(self.seen.apply(observed), -LARGEST, LARGEST)
        with torch.inference_mode():
            found = self.network(torch.from_numpy(rows)).numpy()
        return self.done.undo(found).astype(np.float64)

    def save(self, path: Path) -> None:
        """Write it in half precision, put in place at once."""
        tensors = {name: value.half().contiguous() for name, value in self.network.state_dict().items()}
        scales = (self.seen.mean, self.seen.spread, self.done.mean, self.done.spread)
        tensors |= {name: torch.from_numpy(rows) for name, rows in zip(_SCALES, scales, strict=True)}
        told = {
            "version": VERSION,
            "name": self.name.value,
            "sizes": json.dumps(asdict(self.network.config), sort_keys=True),
            "figures": json.dumps(dict(self.figures), sort_keys=True),
        }
        path.parent.mkdir(parents=True, exist_ok=True)
        aside = path.with_suffix(".writing")
        save_file(tensors, aside, told)
        aside.replace(path)

    @staticmethod
    def load(path: Path) -> TrainedPolicy:
        """What `save` wrote. PolicyError."""
        if not path.is_file():
            raise PolicyError(f"{path} is missing", "train one: sims train physics")
        try:
            with safe_open(path, "pt") as file:
                told, tensors = file.metadata(), {name: file.get_tensor(name).float() for name in file.keys()}  # noqa: SIM118
            if told["version"] != VERSION:
                raise ValueError(f"it is of version {told['version']}")
            name, sizes = PolicyName(told["name"]), json.loads(told["sizes"])
            config = PolicyConfig(**sizes | {"hidden": tuple(sizes["hidden"])})
            if config != PolicyConfig.of(name, config.actions):
                raise ValueError("it is of another body, or sees something else")
            seen_mean, seen_spread, done_mean, done_spread = (tensors.pop(key).numpy() for key in _SCALES)
            network = Policy(config)
            network.load_state_dict(tensors)
        except (SafetensorError, OSError, ValueError, KeyError, TypeError, RuntimeError) as error:
            raise PolicyError(f"{path}: these are no weights of this version: {error}", "reinstall them") from error
        network.eval().requires_grad_(False)
        scales = Normalization(seen_mean, seen_spread), Normalization(done_mean, done_spread)
        return TrainedPolicy(name, network, *scales, json.loads(told["figures"]))
