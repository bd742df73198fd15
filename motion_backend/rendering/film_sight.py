"""Whether a camera really sees a body, or furniture, lamps and walls hide it: by what is nearest in the picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import skin
from motion_backend.motion import Motion
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Solid, nearness_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

HEIGHT: Final = 120
"""Pixels of the picture that is looked at."""
EVERY: Final = 6
"""Frames between two looks."""
SLACK: Final = 0.06
"""Metres that a body may be behind what hides it: it sinks into cushions, and pixels are large."""
SHOWN: Final = 0.4
"""The share of its near side from which a body counts as shown: who sits behind a table is."""
FACED: Final = 0.5
"""The same of its head."""
ENOUGH: Final = 0.96
"""The share of looks in which it is."""


@dataclass(frozen=True)
class Appearances:
    """Bodies of some frames of a motion, as a camera may see them."""

    vertices: NDArray[np.float32]
    """(T, V, 3)."""
    normals: NDArray[np.float32]
    """(T, V, 3)."""
    areas: Array
    """How much skin is around each vertex. (V,)."""
    head: NDArray[np.bool_]
    """Which vertices are the head's. (V,)."""
    aspect: float
    """How many times pictures are as wide as high."""

    @staticmethod
    def of(motion: Motion, start: int, stop: int, aspect: float) -> Appearances:
        """The bodies of frames start to stop (exclusive)."""
        frames, mesh = np.arange(start, stop, EVERY), build_mannequin(motion.skeleton)
        vertices, normals = skin(mesh, motion.skeleton, motion.root_positions[frames], motion.local_rotations[frames])
        corners = mesh.vertices[mesh.faces].astype(np.float64)
        whole = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        areas = np.zeros(len(mesh.vertices))
        np.add.at(areas, mesh.faces, whole[:, None])
        return Appearances(vertices, normals, areas, mesh.joints[:, 0] == INDEX["head"], aspect)

    @cached_property
    def size(self) -> tuple[int, int]:
        """Pixels of a picture that is looked at."""
        return round(HEIGHT * self.aspect), HEIGHT

    def shares(self, scene: Sequence[Solid], camera: Camera) -> Array:
        """How much of each body's near side, and of its head's, is in the picture with nothing before it. (T, 2)."""
        width, height = self.size
        near = nearness_of(scene, camera, self.size) if scene else np.full((height, width), -np.inf)
        shares = np.zeros((len(self.vertices), 2))
        for frame, (points, normals) in enumerate(zip(self.vertices, self.normals, strict=True)):
            turned = np.einsum("vk,vk->v", normals, np.asarray(camera.eye, dtype=np.float32) - points) > 0
            viewed = camera.view(points[turned].astype(np.float64))
            viewed[:, 2] = np.maximum(viewed[:, 2] - SLACK, SLACK)
            x, y, nearness = np.moveaxis(camera.project(viewed, self.size), -1, 0)
            inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
            column, row = (np.clip(value, 0, most - 1).astype(int) for value, most in ((x, width), (y, height)))
            seen = inside & (near[row, column] <= nearness)
            for part, weights in enumerate((self.areas[turned], self.areas[turned] * self.head[turned])):
                shares[frame, part] = weights @ seen / max(weights.sum(), 1e-9)
        return shares

    def shown(self, scene: Sequence[Solid], camera: Camera) -> float:
        """The share of frames in which enough of the body and its head is seen."""
        return float(np.mean((self.shares(scene, camera) >= (SHOWN, FACED)).all(axis=1)))

    @staticmethod
    def enough(shown: float) -> bool:
        """Whether a body is hidden for no more than a moment."""
        return shown >= ENOUGH
