"""What stands around the body and around its goal, as one token: a vision transformer over two voxel grids (LINGO A.2).

The grids are those of `occupancy_pair`, put one on the other: 64 heights are the channels of a 32 × 32 plan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from motion_backend.diffusion.transformer import Encoder
from scene_graphs.geometry.occupancy_grid import Occupancy

CHANNELS, SIDE, PATCH = 64, 32, 8
"""Heights of both grids, points along a side of the plan, and points along a side of a patch."""


@dataclass(frozen=True)
class SceneSizes:
    """Of the vision transformer; the paper's by default. It does not print the width of the networks."""

    layers: int = 6
    heads: int = 16
    width: int = 512
    hidden: int = 1024


def voxel_image(pair: Occupancy) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    """Current and predictive grid (2, height, x, z) as an image (64, 32, 32). ValueError for another shape."""
    if pair.shape != (2, CHANNELS // 2, SIDE, SIDE):
        raise ValueError(f"voxels must be of shape {(2, CHANNELS // 2, SIDE, SIDE)}, not {pair.shape}")
    return pair.reshape(CHANNELS, SIDE, SIDE).astype(np.float32)


class SceneEncoder(nn.Module):  # type: ignore[misc]
    """(B, 64, 32, 32) to one token of the denoiser's width, read off where no patch is."""

    def __init__(self, sizes: SceneSizes, out: int) -> None:
        super().__init__()
        self.patches = nn.Conv2d(CHANNELS, sizes.width, PATCH, PATCH)
        count = (SIDE // PATCH) ** 2
        self.reader = nn.Parameter(torch.zeros(1, 1, sizes.width))
        self.positions = nn.Parameter(torch.randn(1, count + 1, sizes.width) * 0.02)
        self.encoder = Encoder(sizes.layers, sizes.width, sizes.heads, sizes.hidden, norm_first=True)
        self.out = nn.Linear(sizes.width, out)

    def forward(self, voxels: Tensor) -> Tensor:
        """(B, 64, 32, 32) to (B, out)."""
        patches = self.patches(voxels).flatten(2).transpose(1, 2)  # (B, 16, width)
        reader = self.reader.expand(len(patches), -1, -1)
        read: Tensor = self.encoder(torch.cat([reader, patches], dim=1) + self.positions)[:, 0]
        return self.out(read)
