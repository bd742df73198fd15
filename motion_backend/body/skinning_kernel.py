"""Where the vertices of a skinned mesh are in poses; compiled. Imported late: see `skinning`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array
from scene_graphs.jit import filling

Floats = NDArray[np.float32]


@filling
def skin_poses(
    vertices: Floats, normals: Floats, joints: NDArray[np.uint16], weights: Floats, frames: Array,
    points: Floats, turned: Floats,
) -> None:  # fmt: skip
    """Fill world vertices and unit normals, (T, V, 3) each, of a mesh whose joints stand at `frames` (T, J, 3, 4)."""
    for pose in range(len(frames)):
        for one in range(len(vertices)):
            x, y, z = vertices[one, 0], vertices[one, 1], vertices[one, 2]
            nx, ny, nz = normals[one, 0], normals[one, 1], normals[one, 2]
            square = 0.0
            for axis in range(3):
                a = b = c = d = 0.0
                for held in range(4):
                    weight, joint = weights[one, held], joints[one, held]
                    if weight > 0:
                        a, b = a + weight * frames[pose, joint, axis, 0], b + weight * frames[pose, joint, axis, 1]
                        c, d = c + weight * frames[pose, joint, axis, 2], d + weight * frames[pose, joint, axis, 3]
                points[pose, one, axis] = a * x + b * y + c * z + d
                turned[pose, one, axis] = a * nx + b * ny + c * nz
                square += turned[pose, one, axis] ** 2
            length = np.sqrt(max(square, 1e-18))
            for axis in range(3):
                turned[pose, one, axis] /= length
