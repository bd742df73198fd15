"""What props look like: a few blocks and cylinders each, of plain colours."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.props.prop_table import PropPart, prop_table
from motion_backend.rotations import Array
from scene_graphs.meshes.mesh_primitives import Shape, block, cylinder

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class PropShape:
    """Triangles with flat sides, each with corners of its own, in the frame of the prop (metres)."""

    vertices: Floats
    """(3 F, 3)."""
    normals: Floats
    """(3 F, 3) unit."""
    colors: Floats
    """(F, 3) sRGB."""

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
    corners, colors = [], []
    for part in prop_table().shapes[name]:
        vertices, faces = _built(part)
        corners.append(vertices[faces])  # (F, 3, 3)
        colors.append(np.tile(part.color, (len(faces), 1)))
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
    if part.form == "block":
        vertices, faces = block(part.low, part.high, part.bevel)
    else:
        vertices, faces = cylinder(part.low, part.high, part.segments, part.taper)
    middle = np.add(part.low, part.high) / 2
    x, y, z = (rotations.axis_to_quat(axis, np.radians(angle)) for axis, angle in zip("xyz", part.turned_deg, strict=True))
    turn = rotations.compose(z, rotations.compose(y, x))
    return middle + rotations.rotate(turn, vertices - middle), faces
