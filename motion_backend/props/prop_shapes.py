"""What props look like: a few blocks and cylinders each, of plain colours."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.props.prop_hands import euler_to_quat
from motion_backend.props.prop_table import PropPart, prop_table
from motion_backend.rotations import Array
from scene_graphs.meshes.mesh_primitives import Shape, block, cylinder

Floats = NDArray[np.float32]
STITCHES: Final = 6
"""Squares along a side of a pillow."""
DRAWN_IN: Final = 0.08
"""How far the middle of its edges is drawn in, against half its width."""


@dataclass(frozen=True)
class PropShape:
    """Triangles with flat sides, each with corners of its own, in the frame of the prop (metres)."""

    vertices: Floats
    """(3 F, 3)."""
    normals: Floats
    """(3 F, 3) unit."""
    colors: Floats
    """(F, 3) sRGB; what is brighter than 1 shines by itself."""

    @property
    def faces(self) -> NDArray[np.uint32]:
        """(F, 3), counter-clockwise seen from outside."""
        return np.arange(len(self.vertices), dtype=np.uint32).reshape(-1, 3)

    def moved(self, position: Array, turn: Array, size: float) -> tuple[Floats, Floats]:
        """Its vertices and normals in the world at a position (3,), a turn (4,) and a share of its size."""
        matrix = rotations.quat_to_matrix(turn)
        points = position + size * self.vertices @ matrix.T
        return points.astype(np.float32), (self.normals @ matrix.T).astype(np.float32)


@cache
def prop_shape(name: str) -> PropShape:
    """The shape of a prop of data/props.toml. KeyError."""
    return painted_shape([(part.color, _built(part)) for part in prop_table().shapes[name]])


def painted_shape(painted: Iterable[tuple[tuple[float, float, float], Shape]]) -> PropShape:
    """One of several, each of one colour."""
    corners, colors = [], []
    for color, (vertices, faces) in painted:
        corners.append(vertices[faces])  # (F, 3, 3)
        colors.append(np.tile(color, (len(faces), 1)))
    sides = np.concatenate(corners)
    across = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    wide = np.linalg.norm(across, axis=1) > 1e-12
    normals = rotations.normalize(across[wide]).repeat(3, axis=0)
    return PropShape(
        sides[wide].reshape(-1, 3).astype(np.float32),
        normals.astype(np.float32),
        np.concatenate(colors)[wide].astype(np.float32),
    )


def _built(part: PropPart) -> Shape:
    """The vertices and triangles of one part, turned about its middle."""
    low, high = np.array(part.low), np.array(part.high)
    middle = (low + high) / 2
    match part.form:
        case "block":
            vertices, faces = block(part.low, part.high, part.bevel)
        case "cylinder":
            vertices, faces = cylinder(part.low, part.high, part.segments)
        case "pillow":
            vertices, faces = _pillow((high - low) / 2)
            vertices = vertices + middle
    height = (vertices[:, 1:2] - low[1]) / (high[1] - low[1])
    away = (vertices - middle) * np.where([True, False, True], 1.0 + height * (part.taper - 1.0), 1.0)
    return middle + rotations.rotate(euler_to_quat(part.turned_deg), away), faces


def _pillow(half: Array) -> Shape:
    """Two sheets sewn together at their edges and stuffed, with half its size (3,)."""
    across = np.linspace(-1.0, 1.0, STITCHES + 1)
    x, y = (axis.reshape(-1) for axis in np.meshgrid(across, across, indexing="ij"))
    stuffed = np.sqrt((1 - x**2) * (1 - y**2)) ** 0.8
    # Stuffing draws in the edges between the corners.
    front = np.stack([x * (1 - DRAWN_IN * (1 - y**2)), y * (1 - DRAWN_IN * (1 - x**2)), stuffed], axis=1)
    a = (np.arange(STITCHES)[:, None] * (STITCHES + 1) + np.arange(STITCHES)).reshape(-1)
    b, c, d = a + STITCHES + 1, a + STITCHES + 2, a + 1
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    back = faces[:, ::-1] + len(front)
    return np.concatenate([front, front * [1, 1, -1]]) * half, np.concatenate([faces, back]).astype(np.int32)
