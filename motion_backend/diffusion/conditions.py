"""What the model is told besides its history: tokens for scene, text, hand goal and pelvis goal (LINGO A.2 to A.4).

Each can be masked, which leaves zeros in its place: goals where an action has none, the scene where it does not matter,
the text for what was learned without. Goals are in the heading frame of the window (motion_features.py).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import Final

import torch
from torch import Tensor, nn

from motion_backend.diffusion.scene_encoder import SceneEncoder, SceneSizes
from motion_backend.diffusion.transformer import mlp, sinusoid
from motion_backend.language.minilm import WIDTH as TEXT_WIDTH

TOKENS: Final = 4
"""Scene, text, hand, pelvis."""
PELVIS: Final = 9
"""Of the pelvis goal: x and z as printed; then (ours, for seats and beds) height, sine and cosine of the facing,
whether height and facing are told, seconds to go, and whether these are told."""
HAND: Final = 4
"""Of the hand goal: its place, and 1 for the left hand, -1 for the right."""
MAX_SECONDS: Final = 6.0
"""To go: what is later is told as so much."""
TIME_UNIT: Final = 3.0
"""Seconds that count as one."""
FRAME_SHARE: Final = 0.25
"""Of the frame's sinusoid in the text token, which is of length one and not of √(width / 2)."""


GAITS: Final = 64
"""Of whose walks may be told apart; 0 is nobody's."""


class MadeOf(IntEnum):
    """Where the motion of a window comes from; the first is told one time in ten in training."""

    UNKNOWN = 0
    RECORDED = 1
    KEYED = 2
    MATCHED = 3
    PROCEDURAL = 4


@dataclass(frozen=True)
class Conditions:
    """Of B windows."""

    text: Tensor
    """(B, 384) sentence features."""
    has_text: Tensor
    """(B,) 1 or 0, as all that begins with has_."""
    frame: Tensor
    """(B,) frames at 30 a second since the action began; 0 in locomotion, which is periodic (LINGO A.3)."""
    made_of: Tensor
    """(B,) of `MadeOf`."""
    gait: Tensor
    """(B,) whose walk it is, from 1 on; 0: not told (ours: the mean of all people is no person's walk)."""
    pelvis: Tensor
    """(B, 9) of `PELVIS`."""
    has_pelvis: Tensor
    hand: Tensor
    """(B, 4) of `HAND`."""
    has_hand: Tensor
    voxels: Tensor | None = None
    """(B, 64, 32, 32); None where no window sees the scene."""
    has_scene: Tensor | None = None

    def __len__(self) -> int:
        return len(self.text)

    def to(self, device: torch.device | str) -> Conditions:
        """The same on another device."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}
        return Conditions(**{name: None if value is None else value.to(device) for name, value in own.items()})

    def without(self, *names: str) -> Conditions:
        """The same with some of text, pelvis, hand and scene masked, and frame numbers zero, as in locomotion."""
        masks = {f"has_{name}": getattr(self, f"has_{name}") for name in names if name != "frame"}
        if "frame" in names:
            masks["frame"] = self.frame
        return replace(self, **{name: None if mask is None else torch.zeros_like(mask) for name, mask in masks.items()})


class FramedText(nn.Module):  # type: ignore[misc]
    """Frame-embedded text (LINGO A.3): sentence features through an MLP, plus the frame's waves, through another."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width
        self.words, self.both = mlp(TEXT_WIDTH, width), mlp(width, width)

    def forward(self, text: Tensor, has_text: Tensor, frame: Tensor) -> Tensor:
        """(B, 384), (B,) and (B,) to (B, width)."""
        words = self.words(text) * has_text[:, None]
        return self.both(words + FRAME_SHARE * sinusoid(frame, self.width).to(words))


class ConditionEncoder(nn.Module):  # type: ignore[misc]
    """The four tokens, before the step's embedding is added to each."""

    def __init__(self, width: int, scene: SceneSizes | None) -> None:
        super().__init__()
        self.text, self.made_of = FramedText(width), nn.Embedding(len(MadeOf), width)
        self.gait = nn.Embedding(GAITS, width)
        self.hand, self.pelvis = mlp(HAND, width), mlp(PELVIS, width)
        self.scene = SceneEncoder(scene, width) if scene is not None else None

    def forward(self, given: Conditions) -> Tensor:
        """(B, 4, width)."""
        text = self.text(given.text, given.has_text, given.frame)
        text = text + self.made_of(given.made_of) + self.gait(given.gait)
        hand = self.hand(given.hand) * given.has_hand[:, None]
        pelvis = self.pelvis(given.pelvis) * given.has_pelvis[:, None]
        return torch.stack([self._scene(given, text), text, hand, pelvis], dim=1)

    def _scene(self, given: Conditions, like: Tensor) -> Tensor:
        if self.scene is None or given.voxels is None or given.has_scene is None:
            return torch.zeros_like(like)
        return self.scene(given.voxels) * given.has_scene[:, None]
