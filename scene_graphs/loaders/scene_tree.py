"""The tree of a scene file: named nodes with triangles, before anybody has asked which of them are furniture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.placed import Array

Indices = NDArray[np.int64]
MAX_BYTES: Final = 64 << 20
"""Of one scene file, in bytes."""
MAX_TRIANGLES: Final = 2_000_000
MAX_NODES: Final = 20_000
MAX_DEPTH: Final = 100
"""Nodes within nodes."""


@dataclass(frozen=True)
class Triangles:
    """A triangle mesh."""

    points: Array
    """(N, 3) metres or the file's unit."""
    corners: Indices
    """(M, 3) numbers of points."""


NOTHING: Final = Triangles(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))


@dataclass(frozen=True)
class Node:
    """A node of a scene, its triangles already in the scene's frame."""

    name: str
    turn: Array
    """(3, 3) how the node's own axes, of length 1, lie in the scene."""
    own: Triangles = NOTHING
    """What the node itself draws, without its children."""
    children: tuple[Node, ...] = ()
    label: str | None = None
    """The category somebody wrote on it, beside its name."""


def joined(meshes: list[Triangles]) -> Triangles:
    """Several meshes as one."""
    meshes = [mesh for mesh in meshes if len(mesh.corners)]
    if len(meshes) < 2:
        return meshes[0] if meshes else NOTHING
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes[:-1])])
    corners = [mesh.corners + start for mesh, start in zip(meshes, starts, strict=True)]
    return Triangles(np.concatenate([mesh.points for mesh in meshes]), np.concatenate(corners))
