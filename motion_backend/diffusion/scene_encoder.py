"""What stands around the body and around its goal, as one token: a vision transformer over two voxel grids (LINGO A.2).

The grids are those of `occupancy_pair`, put one on the other: 64 heights are the channels of a 32 × 32 plan.
For training they are looked up for a whole batch at once: 32 bits a cell say at which of the grid's heights
something is solid there.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from motion_backend.diffusion.transformer import Encoder
from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.geometry.height_raster import Columns
from scene_graphs.geometry.occupancy_grid import LINGO, LOOK_AHEAD, Occupancy
from scene_graphs.home import Home

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


class RoomVoxels:
    """Rooms by number, and what is solid in them."""

    def __init__(self, homes: Sequence[Home]) -> None:
        columns = [SceneHeights(home).columns for home in homes]
        rasters = [one.raster for one in columns]
        self._solid = torch.from_numpy(np.concatenate([solid_heights(one) for one in columns]))
        self._begins = torch.tensor(np.cumsum([0, *(r.shape[0] * r.shape[1] for r in rasters)])[:-1])
        self._origins = torch.tensor([raster.origin for raster in rasters], dtype=torch.float64)
        self._cells = torch.tensor([raster.cell for raster in rasters], dtype=torch.float64)
        self._shapes = torch.tensor([raster.shape for raster in rasters])
        _, x, z = LINGO.offsets
        self._across, self._ahead = torch.from_numpy(x), torch.from_numpy(z)
        self._levels = torch.arange(LINGO.size, dtype=torch.int32)

    def on(self, device: str) -> RoomVoxels:
        """The same on another device."""
        found = copy.copy(self)
        for name, value in vars(self).items():
            setattr(found, name, value.to(device))
        return found

    def images(self, rooms: Tensor, here: Tensor, goal: Tensor, yaw: Tensor, walks: Tensor) -> Tensor:
        """Around bodies at [x, z] (B, 2) that face yaw (B,), and around their goals (B, 2). (B, 64, 32, 32).

        Who walks (B,) looks `LOOK_AHEAD` towards his goal.
        """
        here, goal, yaw = here.double(), goal.double(), yaw.double()
        way = goal - here
        distance = way.norm(dim=1, keepdim=True)
        ahead = here + way * torch.where(distance > 0, LOOK_AHEAD / distance, 1.0)
        seen = torch.where(walks[:, None], ahead, goal)
        return torch.cat([self._around(rooms, here, yaw), self._around(rooms, seen, yaw)], dim=1)

    def _around(self, rooms: Tensor, places: Tensor, yaw: Tensor) -> Tensor:
        """One grid of each body. (B, 32, 32, 32)."""
        cos, sin = yaw.cos()[:, None], yaw.sin()[:, None]
        x = places[:, :1] + cos * self._across + sin * self._ahead  # (B, 1024)
        z = places[:, 1:] + cos * self._ahead - sin * self._across
        origins, scale, shapes = self._origins[rooms], 1 / self._cells[rooms][:, None], self._shapes[rooms]
        i = ((x - origins[:, :1]) * scale + 0.5).clamp(min=0).long().minimum(shapes[:, :1] - 1)
        j = ((z - origins[:, 1:]) * scale + 0.5).clamp(min=0).long().minimum(shapes[:, 1:] - 1)
        solid = self._solid[self._begins[rooms][:, None] + i * shapes[:, 1:] + j]
        bits = (solid[:, None] >> self._levels[:, None]) & 1  # (B, 32, 1024)
        return bits.float().reshape(len(rooms), LINGO.size, LINGO.size, LINGO.size)


def solid_heights(columns: Columns) -> NDArray[np.int32]:
    """At which of LINGO's heights each cell is solid, a bit a height, the lowest first; outside at all. (cells,)."""
    heights = LINGO.offsets[0]
    of_part = (columns.bottoms[:, None] <= heights) & (heights <= columns.tops[:, None])
    values = (of_part * (1 << np.arange(LINGO.size, dtype=np.uint64))).sum(axis=1, dtype=np.uint64).astype(np.uint32)
    found = np.where(columns.inside.ravel(), np.uint32(0), np.uint32(0xFFFFFFFF))
    np.bitwise_or.at(found, np.repeat(np.arange(len(found)), np.diff(columns.first)), values)
    return found.view(np.int32)
