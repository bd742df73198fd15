"""LINGO's autonomous scheduler (A.5): is the action over that a window belongs to?

A transformer encoder of three layers over the sixteen frames and the frame-embedded text; a value from 0 to 1 is read
off the text's place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from motion_backend.diffusion.conditions import FramedText
from motion_backend.diffusion.motion_features import FEATURES, WINDOW
from motion_backend.diffusion.transformer import Encoder, sinusoid

DONE: Final = 0.5
"""From which value an action is over."""


@dataclass(frozen=True)
class SchedulerSizes:
    """The paper's by default (LINGO A.5)."""

    layers: int = 3
    heads: int = 8
    width: int = 512
    hidden: int = 512
    norm_first: bool = False

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    @staticmethod
    def from_dict(row: Mapping[str, Any]) -> SchedulerSizes:
        """The inverse of `to_dict`. TypeError for other fields."""
        return SchedulerSizes(**row)


SCHEDULER_PRESETS: Final = {"paper": SchedulerSizes(), "small": SchedulerSizes(3, 8, 128, 256, True)}


class CompletionScheduler(nn.Module):  # type: ignore[misc]
    """Windows, words and frame numbers to how sure it is that the action is over."""

    positions: Tensor

    def __init__(self, sizes: SchedulerSizes) -> None:
        super().__init__()
        self.sizes = sizes
        self.text, self.frames = FramedText(sizes.width), nn.Linear(FEATURES, sizes.width)
        self.register_buffer("positions", 0.5 * sinusoid(torch.arange(1 + WINDOW), sizes.width), persistent=False)
        self.encoder = Encoder(sizes.layers, sizes.width, sizes.heads, sizes.hidden, sizes.norm_first)
        self.answer = nn.Linear(sizes.width, 1)

    def logits(self, windows: Tensor, text: Tensor, frame: Tensor) -> Tensor:
        """(B, 16, 202) clean, (B, 384) and (B,) frames since the action began, to (B,)."""
        words = self.text(text, torch.ones_like(frame, dtype=text.dtype), frame)
        tokens = torch.cat([words[:, None], self.frames(windows)], dim=1)  # (B, 17, width)
        found: Tensor = self.answer(self.encoder(tokens + self.positions)[:, 0])[:, 0]
        return found

    def forward(self, windows: Tensor, text: Tensor, frame: Tensor) -> Tensor:
        """Completion from 0 to 1. (B,)."""
        return self.logits(windows, text, frame).sigmoid()

    def over(self, windows: Tensor, text: Tensor, frame: Tensor) -> NDArray[np.bool_]:
        """Whether what is done is over with each window. (B,)."""
        with torch.inference_mode():
            return np.asarray((self(windows, text, frame) > DONE).numpy())
