"""The language-aware embedding of SIMS 3.3: a transformer auto-encoder of motion whose space captions are mapped into.

Enc_m turns 300 frames of s into z on the unit sphere in 64 dimensions, a decoder turns z back into them; MLP_d brings
the features of a frozen sentence encoder there, MLP_u brings them back. Losses are Eq. 3 to 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional

from motion_backend.datasets.motion_text_dataset import SAMPLED
from motion_backend.physics.observations import STATE_SIZE


@dataclass(frozen=True)
class AutoencoderConfig:
    """Sizes; what the paper does not print is small enough to be trained on a CPU."""

    size: int = 64
    """Of z (SIMS 3.3)."""
    text_size: int = 384
    """Of a sentence's features: all-MiniLM-L6-v2 where the paper has CLIP's 512."""
    text_hidden: int = 192
    patch: int = 10
    """Frames a token; the paper has a token a frame, which costs many times as much."""
    width: int = 96
    heads: int = 4
    hidden: int = 192
    """Of the feed-forward layers."""
    encoder_layers: int = 3
    decoder_layers: int = 1
    shown: float = 0.5
    """The share of tokens, by chance, that the encoder is shown in training: what it learns by heart is gone next time,
    and a step takes half the time. It has no other dropout."""


class TextMotionAutoencoder(nn.Module):  # type: ignore[misc]  # torch is not read by mypy
    """All four networks."""

    def __init__(self, config: AutoencoderConfig) -> None:
        super().__init__()
        self.config = config
        tokens, features = SAMPLED // config.patch, STATE_SIZE * config.patch
        self.tokens_of_frames = nn.Linear(features, config.width)
        self.summary = nn.Parameter(0.02 * torch.randn(1, 1, config.width))
        self.seen_places = nn.Parameter(0.02 * torch.randn(1, tokens, config.width))
        self.encoder = _transformer(config, config.encoder_layers)
        self.to_embedding = nn.Linear(config.width, config.size)
        self.from_embedding = nn.Linear(config.size, config.width)
        self.made_places = nn.Parameter(0.02 * torch.randn(1, tokens, config.width))
        self.decoder = _transformer(config, config.decoder_layers)
        self.frames_of_tokens = nn.Linear(config.width, features)
        self.text_down = _mlp(config.text_size, config.text_hidden, config.size)
        self.text_up = _mlp(config.size, config.text_hidden, config.text_size)

    def encode_motion(self, states: Tensor) -> Tensor:
        """Enc_m: normalised frames (B, SAMPLED, STATE_SIZE) to unit z (B, size)."""
        count = SAMPLED // self.config.patch
        patches, places = states.reshape(len(states), count, -1), self.seen_places
        if self.training:
            shown = torch.randperm(count)[: max(round(self.config.shown * count), 1)]
            patches, places = patches[:, shown], places[:, shown]
        tokens = self.tokens_of_frames(patches) + places  # (B, tokens, width)
        seen = self.encoder(torch.cat([self.summary.expand(len(states), -1, -1), tokens], dim=1))
        return functional.normalize(self.to_embedding(seen[:, 0]), dim=-1)

    def decode_motion(self, z: Tensor) -> Tensor:
        """Frames from z (B, size). (B, SAMPLED, STATE_SIZE).

        MotionCLIP's decoder attends to z as its only memory: that adds the same vector to every token, as here.
        """
        tokens = self.decoder(self.from_embedding(z)[:, None] + self.made_places)
        return self.frames_of_tokens(tokens).reshape(len(z), SAMPLED, STATE_SIZE)

    def encode_text(self, features: Tensor) -> Tensor:
        """MLP_d: a sentence's features (B, text_size) to unit z (B, size)."""
        return functional.normalize(self.text_down(features), dim=-1)

    def decode_text(self, z: Tensor) -> Tensor:
        """MLP_u: z (B, size) to a sentence's features (B, text_size)."""
        return self.text_up(z)


def autoencoder_loss(model: TextMotionAutoencoder, states: Tensor, features: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Eq. 3 as its three terms, of normalised frames and the features of their captions; and z of the motion (B, size).

    Returns the sum, the terms (3,) in the order of Eq. 3, and z.
    """
    z, z_text = model.encode_motion(states), model.encode_text(features)
    terms = torch.stack(
        [
            functional.mse_loss(model.decode_motion(z), states),
            alignment_loss(z, z_text),
            text_loss(model.decode_text(z_text), features),
        ]
    )
    return terms.sum(), terms, z


def alignment_loss(z_motion: Tensor, z_text: Tensor) -> Tensor:
    """Eq. 4, of unit vectors (B, size)."""
    return 1 - (z_motion * z_text).sum(-1).mean()


def text_loss(made: Tensor, features: Tensor) -> Tensor:
    """Eq. 5 (B, text_size): printed as a norm and called an MSE distance; the squared norm, as both have its least."""
    return ((made - features) ** 2).sum(-1).mean()


def contrast_loss(z_motion: Tensor, z_captions: Tensor, right: Tensor, temperature: float = 0.1) -> Tensor:
    """Not in the paper: how far each motion (B, size) is from its own of all captions (G, size); `right` (B,) names it.

    Eq. 4 draws a motion to its words and away from no others, so that captions that are alike stay hard to tell apart.
    """
    return functional.cross_entropy(z_motion @ z_captions.T / temperature, right)


def _transformer(config: AutoencoderConfig, layers: int) -> nn.Module:
    """A bidirectional transformer, normalised before each layer and at the end."""
    layer = nn.TransformerEncoderLayer(
        config.width, config.heads, config.hidden, 0.0, "gelu", batch_first=True, norm_first=True
    )
    return nn.TransformerEncoder(layer, layers, nn.LayerNorm(config.width), enable_nested_tensor=False)


def _mlp(inputs: int, hidden: int, outputs: int) -> nn.Module:
    return nn.Sequential(nn.Linear(inputs, hidden), nn.GELU(), nn.Linear(hidden, outputs))
