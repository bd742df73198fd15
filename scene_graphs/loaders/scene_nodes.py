"""The tree of a scene file: named nodes with triangles; which are furniture, which the building, and which nobody can
name.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import canonical, categories_of
from scene_graphs.layout import Array
from scene_graphs.loaders.furniture_names import furniture_named, words_of

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


Building = Literal["floor", "wall", "ceiling", "door", "window", "other"]
_BUILDING: Final[dict[str, Building]] = {
    **dict.fromkeys(("floor", "floors", "flooring", "ground"), "floor"),
    **dict.fromkeys(("wall", "walls", "baseboard", "skirting", "moulding", "molding"), "wall"),
    **dict.fromkeys(("ceiling", "roof"), "ceiling"),
    **dict.fromkeys(("door", "doors", "doorway", "doorframe", "doorjamb"), "door"),
    **dict.fromkeys(("window", "windows", "windowsill"), "window"),
    **dict.fromkeys(("stairs", "railing", "pillar", "column", "beam"), "other"),
}
_SHELLS: Final = frozenset({"room", "house", "building", "apartment", "flat", "shell"})
_PARTS: Final = frozenset(
    ("seat", "drawer", "drawers", "shelf", "shelves", "mirror", "light", "counter", "countertop", "cabinet")
)
"""Words that name furniture on their own, and a part of it inside a piece with a name."""
_TOUCHING: Final = 0.02


@dataclass(frozen=True, eq=False)
class Piece:
    """A piece of furniture, its triangles in the file's frame."""

    name: str
    category: str
    mesh: Triangles
    turn: Array
    """(3, 3) how the axes of its node lie in the scene."""
    is_labelled: bool = False
    on: str | None = None
    """The name of the piece whose node holds it."""

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """The lowest and highest coordinates. (3,) each."""
        return self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)


@dataclass
class Finds:
    """What the nodes of a scene are."""

    pieces: list[Piece] = field(default_factory=list)
    building: list[tuple[Building, Triangles]] = field(default_factory=list)
    loose: list[tuple[str, Triangles]] = field(default_factory=list)
    """Names and triangles that nothing says what they are."""


def find_pieces(nodes: Iterable[Node]) -> Finds:
    """Furniture is the outermost node whose label or name says what it is, with all that no other piece below claims.

    A node is only a group if it draws nothing but several pieces of its own kind that stand apart ("Chairs" over four
    chairs). A label makes a piece wherever it stands.
    """
    found = Finds()
    for node in nodes:
        below = _finds(node)
        found.pieces += below.pieces
        found.building += below.building
        found.loose += below.loose
    return found


def _finds(node: Node) -> Finds:
    found = find_pieces(node.children)
    if len(node.own.corners):
        found.loose.append((node.name, node.own))
    category = canonical(words_of(node.label)) if node.label else furniture_named(node.name)
    kind = _building_named(node.label or node.name)
    if category and not (node.label and kind):
        return _furniture(node, category, found)
    if kind is not None:
        found.building += [(kind, mesh) for _, mesh in found.loose]
        found.loose = []
    elif len(node.own.corners) and words_of(node.name).rpartition("_")[2] in _SHELLS:
        found.loose.pop()
        found.building.append(("wall", node.own))
    return found


def _furniture(node: Node, category: str, found: Finds) -> Finds:
    """The piece a node is, with everything below it that has no name of its own."""
    same = [piece for piece in found.pieces if _is_same(piece, category)]
    if not found.loose and len(same) > 1 and _stand_apart(same):
        return found
    parts = [piece for piece in found.pieces if not piece.is_labelled and (_is_part(piece) or piece in same)]
    mesh = joined([m for _, m in found.loose] + [m for _, m in found.building] + [piece.mesh for piece in parts])
    others = [piece for piece in found.pieces if piece not in parts]
    if not len(mesh.corners):
        return Finds(others)
    piece = Piece(node.name, category, mesh, node.turn, node.label is not None)
    return Finds([piece, *(_put_on(other, node.name) for other in others)])


def _building_named(name: str) -> Building | None:
    words = words_of(name).split("_")
    return _BUILDING.get(words[-1]) or (_BUILDING.get(words[0]) if words[0] not in ("floor", "ground") else None)


def _is_same(piece: Piece, category: str) -> bool:
    return not piece.is_labelled and bool(categories_of(piece.category) & categories_of(category))


def _is_part(piece: Piece) -> bool:
    return words_of(piece.name).rpartition("_")[2] in _PARTS


def _put_on(piece: Piece, name: str) -> Piece:
    return piece if piece.on else Piece(piece.name, piece.category, piece.mesh, piece.turn, piece.is_labelled, name)


def _stand_apart(pieces: list[Piece]) -> bool:
    """Whether no two of the pieces' boxes touch."""
    lows, highs = np.array([piece.bounds for piece in pieces[:100]]).swapaxes(0, 1)  # (pieces, 3)
    apart = (highs[:, None] + _TOUCHING < lows).any(axis=-1)  # (pieces, pieces): below it along some axis
    return bool((apart | apart.T | np.eye(len(lows), dtype=bool)).all())
