"""What stands around bodies in many rooms at once, for training: LINGO's two grids (A.2), looked up where batches are.

Of every cell of a room 32 bits say at which of the grid's heights something is solid there, so that the voxels of a
thousand bodies are two look-ups. They are those of `occupancy_pair`, which asks one body at a time.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.geometry.height_raster import Columns
from scene_graphs.geometry.occupancy_grid import LINGO, LOOK_AHEAD
from scene_graphs.home import Home


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
