"""A transformer encoder's layers and the waves that tell tokens and steps apart (Vaswani et al. 2017)."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn import functional


def sinusoid(values: Tensor, width: int) -> Tensor:
    """Sines and cosines of values at wavelengths from 2π to 20,000π. (…) to (…, width)."""
    half = width // 2
    rates = torch.exp(-math.log(10_000.0) * torch.arange(half, dtype=torch.float32, device=values.device) / half)
    angles = values.float()[..., None] * rates
    return torch.cat([angles.sin(), angles.cos()], dim=-1)


def mlp(inputs: int, width: int) -> nn.Sequential:
    """Two layers with a smooth unit between them."""
    return nn.Sequential(nn.Linear(inputs, width), nn.SiLU(), nn.Linear(width, width))


class Layer(nn.Module):  # type: ignore[misc]
    """Self-attention and a two-layer network, normalised after each as printed, or before each, which learns faster."""

    def __init__(self, width: int, heads: int, hidden: int, norm_first: bool, dropout: float = 0.0) -> None:
        super().__init__()
        self.heads, self.norm_first, self.dropout = heads, norm_first, nn.Dropout(dropout)
        self.queries_keys_values, self.joined = nn.Linear(width, 3 * width), nn.Linear(width, width)
        self.wider, self.narrower = nn.Linear(width, hidden), nn.Linear(hidden, width)
        self.first_norm, self.second_norm = nn.LayerNorm(width), nn.LayerNorm(width)

    def forward(self, x: Tensor) -> Tensor:
        """(B, tokens, width) to the same."""
        if self.norm_first:
            x = x + self._attended(self.first_norm(x))
            return x + self._mixed(self.second_norm(x))
        x = self.first_norm(x + self._attended(x))
        return self.second_norm(x + self._mixed(x))

    def _attended(self, x: Tensor) -> Tensor:
        batch, tokens, width = x.shape
        split = self.queries_keys_values(x).view(batch, tokens, 3, self.heads, width // self.heads)
        queries, keys, values = split.permute(2, 0, 3, 1, 4)  # (batch, heads, tokens, width / heads) each
        found = functional.scaled_dot_product_attention(queries, keys, values)
        return self.dropout(self.joined(found.transpose(1, 2).reshape(batch, tokens, width)))

    def _mixed(self, x: Tensor) -> Tensor:
        return self.dropout(self.narrower(functional.gelu(self.wider(x), approximate="tanh")))


class Encoder(nn.Module):  # type: ignore[misc]
    """Layer after layer; those that normalise first end in one more normalisation."""

    def __init__(
        self, layers: int, width: int, heads: int, hidden: int, norm_first: bool, dropout: float = 0.0
    ) -> None:
        super().__init__()
        if width % heads or width % 2:
            raise ValueError(f"width {width} is not even or cannot be shared by {heads} heads")
        self.layers = nn.ModuleList([Layer(width, heads, hidden, norm_first, dropout) for _ in range(layers)])
        self.norm = nn.LayerNorm(width) if norm_first else nn.Identity()

    def forward(self, x: Tensor) -> Tensor:
        """(B, tokens, width) to the same."""
        for layer in self.layers:
            x = layer(x)
        return self.norm(x)
