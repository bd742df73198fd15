"""Closed pieces of a body's surface, each a field and a material, cut into triangles and put together as one mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from motion_backend.body.implicit_surface import Faces, Field, gradient, to_triangles
from motion_backend.body.skin_weights import Weights, dense
from motion_backend.body.skinning import Material, SkinnedMesh, strongest_four
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS, other_side

Box = tuple[tuple[float, float, float], tuple[float, float, float]]
COVERED = 0.006
"""Metres below another piece's surface from which a vertex counts as out of sight."""
_OTHER_SIDE = [JOINTS.index(other_side(name)) for name in JOINTS]
_FLIP = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True)
class Piece:
    """One closed surface of one material: its field, the box it lies in, and how fine it is cut."""

    material: Material
    field: Field
    box: Box
    cell: tuple[float, float, float]
    weigh: Callable[[Array], Weights]
    two_sided: bool = False
    """Modelled on the left and mirrored to the right."""


@dataclass(frozen=True)
class Cut:
    """A piece as triangles."""

    material: Material
    vertices: Array
    """(V, 3)."""
    normals: Array
    """(V, 3) unit."""
    faces: Faces
    """(F, 3)."""
    weights: Array
    """(V, J)."""

    def mirrored(self) -> Cut:
        """The same on the other side."""
        flipped = self.weights[:, _OTHER_SIDE]
        return Cut(self.material, self.vertices * _FLIP, self.normals * _FLIP, self.faces[:, ::-1], flipped)


def assembled(cuts: Sequence[Cut]) -> SkinnedMesh:
    """One mesh of several pieces; faces sorted by material, in the order in which these come first."""
    materials = tuple(dict.fromkeys(cut.material for cut in cuts))
    starts = np.cumsum([0, *(len(cut.vertices) for cut in cuts)])
    faces = np.concatenate([cut.faces + start for cut, start in zip(cuts, starts, strict=False)])
    looks = np.concatenate([np.full(len(cut.faces), materials.index(cut.material)) for cut in cuts])
    joints, shares = strongest_four(np.concatenate([cut.weights for cut in cuts]))
    order = np.argsort(looks, kind="stable")
    return SkinnedMesh(
        vertices=np.concatenate([cut.vertices for cut in cuts]).astype(np.float32),
        normals=np.concatenate([cut.normals for cut in cuts]).astype(np.float32),
        faces=faces[order].astype(np.uint32),
        joints=joints,
        weights=shares,
        materials=materials,
        face_materials=looks[order].astype(np.uint8),
    )


def cut_all(pieces: Sequence[Piece]) -> list[Cut]:
    """Pieces as triangles, without what other pieces cover."""
    cuts = []
    for piece in pieces:
        points, triangles = to_triangles(piece.field, *piece.box, piece.cell)
        covers = [other for other in pieces if other is not piece]
        points, triangles = _without_hidden(points, triangles, covers)
        slope = gradient(piece.field, points)
        slope /= np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-9)
        one = Cut(piece.material, points, slope, triangles, dense(piece.weigh(points), len(points)))
        cuts += [one, one.mirrored()] if piece.two_sided else [one]
    return cuts


def _without_hidden(points: Array, faces: Faces, covers: list[Piece]) -> tuple[Array, Faces]:
    """What other pieces do not cover: no one sees the arm inside the sleeve."""
    deep = np.zeros(len(points), dtype=bool)
    for cover in covers:
        near = np.flatnonzero(((points > cover.box[0]) & (points < cover.box[1])).all(axis=1) & ~deep)
        deep[near] = cover.field(points[near]) < -COVERED
    faces = faces[~deep[faces].all(axis=1)]
    used, renumbered = np.unique(faces, return_inverse=True)
    return points[used], renumbered.reshape(-1, 3)
