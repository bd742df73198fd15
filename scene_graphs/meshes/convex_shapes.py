"""The convex shapes that a home's meshes are drawn with, as planes: how deep a point is in what is seen."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from scene_graphs.home import Home
from scene_graphs.layout import Array, Placed
from scene_graphs.meshes.furniture_mesh import furniture_meshes, home_meshes
from scene_graphs.meshes.mesh_primitives import Mesh

WALL = "wall"
"""The owner of a wall."""
UNSEEN = ("floor", "door", "window", "rug ", "ceiling ")
"""What begins with these is walked on or through, hangs high, or gives way."""
SOFT = frozenset({"pillowcase", "leaf", "young leaf", "blossom"})
"""Looks of what gives way."""


@dataclass(frozen=True)
class ConvexShape:
    """A solid bounded by planes."""

    owner: str
    """Object id, or `WALL`."""
    low: Array
    """(3,) least corner of the axis-aligned box around it."""
    high: Array
    normals: Array
    """(P, 3) unit, outwards."""
    offsets: Array
    """(P,) metres of each plane from the origin along its normal."""

    @property
    def thickness(self) -> float:
        """How far apart two of its sides are at the least (metres)."""
        return float(min(self.high - self.low))

    def depth(self, points: Array) -> Array:
        """How deep points (N, 3) are in it: positive inside, to the nearest side; not positive outside. (N,)."""
        return np.asarray((self.offsets - points @ self.normals.T).min(axis=1))


def convex_shapes(home: Home, least: float = 0.0) -> tuple[ConvexShape, ...]:
    """Walls and furniture of a home as they are drawn, but what is soft or thinner than `least` (metres)."""
    return tuple(
        shape for mesh in _seen(home_meshes(home)) for shape in _shapes(mesh) if shape.thickness >= max(least, 1e-6)
    )


def shapes_of(placed: Placed) -> tuple[ConvexShape, ...]:
    """A piece of furniture as it is drawn, but what is soft."""
    return tuple(shape for mesh in _seen(furniture_meshes(placed)) for shape in _shapes(mesh))


def _seen(meshes: Iterable[Mesh]) -> Iterator[Mesh]:
    return (mesh for mesh in meshes if not mesh.name.startswith(UNSEEN) and mesh.name.rpartition(":")[2] not in SOFT)


def _shapes(mesh: Mesh) -> Iterator[ConvexShape]:
    """The shapes of one mesh: those of its triangles that hang together."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    vertices, faces = mesh.vertices.astype(np.float64), mesh.faces
    links = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(len(vertices),) * 2)
    _, shape_of = connected_components(graph, directed=False)
    name = mesh.name.removeprefix("wall ")
    owner = name.partition(":")[0] if ":" in name else WALL
    for number in np.unique(shape_of[faces[:, 0]]):
        yield _bounded(owner, vertices[shape_of == number], vertices[faces[shape_of[faces[:, 0]] == number]])


def _bounded(owner: str, corners: Array, triangles: Array) -> ConvexShape:
    """A shape from its corners (V, 3) and triangles (F, 3, 3); of triangles in one plane, one is enough."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    normals = normals[sizes > 1e-12] / sizes[sizes > 1e-12, None]
    offsets = (normals * triangles[sizes > 1e-12, 0]).sum(axis=1)
    _, kept = np.unique(np.round(np.column_stack([normals, offsets]), 4), axis=0, return_index=True)
    return ConvexShape(owner, corners.min(axis=0), corners.max(axis=0), normals[kept], offsets[kept])
