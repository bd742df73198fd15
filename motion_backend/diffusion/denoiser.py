"""The motion diffusion module (LINGO A.1): a transformer encoder that guesses the clean window from a noised one.

Twenty tokens: four of conditions, each with the embedding of the diffusion step, and sixteen frames, all with their
position. The first two frames are the end of the window before; they come in clean and go out as they came in.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Final

import torch
from torch import Tensor, nn

from motion_backend.diffusion.conditions import TOKENS, ConditionEncoder, Conditions
from motion_backend.diffusion.motion_features import FEATURES, HISTORY, WINDOW
from motion_backend.diffusion.scene_encoder import SceneSizes
from motion_backend.diffusion.transformer import Encoder, mlp, sinusoid


@dataclass(frozen=True)
class DenoiserSizes:
    """The paper's by default (LINGO A.1, A.2); it prints no hidden width, this is that of its networks."""

    layers: int = 8
    heads: int = 16
    width: int = 512
    hidden: int = 512
    norm_first: bool = False
    scene: SceneSizes | None = field(default_factory=SceneSizes)
    dropout: float = 0.0
    """Of what each layer adds, in training alone."""

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    @staticmethod
    def from_dict(row: Mapping[str, Any]) -> DenoiserSizes:
        """The inverse of `to_dict`. TypeError for other fields."""
        scene = row.get("scene")
        return DenoiserSizes(**{**row, "scene": None if scene is None else SceneSizes(**scene)})


PRESETS: Final = {
    "paper": DenoiserSizes(),
    "small": DenoiserSizes(4, 6, 192, 384, True, SceneSizes(2, 4, 128, 256)),
    "walk": DenoiserSizes(4, 4, 128, 256, True, None),
    "wide_walk": DenoiserSizes(6, 6, 192, 384, True, None),
}
"""`small` is what a laptop runs; `walk` is smaller still and sees no voxels, for weights that only walk; `wide_walk` is
three times that, for more data than nine people's."""


class Denoiser(nn.Module):  # type: ignore[misc]
    """x_t, step and conditions to the clean window."""

    positions: Tensor

    def __init__(self, sizes: DenoiserSizes) -> None:
        super().__init__()
        width, tokens = sizes.width, TOKENS + WINDOW
        self.sizes = sizes
        self.conditions = ConditionEncoder(width, sizes.scene)
        self.step = mlp(width, width)
        self.frames, self.guess = nn.Linear(FEATURES, width), nn.Linear(width, FEATURES)
        self.register_buffer("positions", 0.5 * sinusoid(torch.arange(tokens), width), persistent=False)
        self.kinds = nn.Parameter(torch.randn(tokens, width) * 0.02)
        self.encoder = Encoder(sizes.layers, width, sizes.heads, sizes.hidden, sizes.norm_first, sizes.dropout)
        # Small first guesses: at the start the loss is that of the mean, and steps are as large as in the middle.
        nn.init.zeros_(self.guess.bias)
        self.guess.weight.data.mul_(0.1)

    def encode(self, given: Conditions) -> Tensor:
        """The condition tokens (B, 4, width): the same at every step, so worked out once a window."""
        found: Tensor = self.conditions(given)
        return found

    def forward(self, noised: Tensor, steps: Tensor, conditions: Tensor) -> Tensor:
        """Windows (B, 16, 202) at steps (B,) under tokens (B, 4, width) to clean ones, history as it was given."""
        step = self.step(sinusoid(steps, self.sizes.width).to(noised))
        tokens = torch.cat([conditions + step[:, None], self.frames(noised)], dim=1)  # (B, 20, width)
        read = self.encoder(tokens + self.positions + self.kinds)[:, TOKENS:]
        return torch.cat([noised[:, :HISTORY], self.guess(read)[:, HISTORY:]], dim=1)
