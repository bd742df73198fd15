"""From a mesh to what a body can use: the seats, mattresses and tops of a piece, and few boxes for all the rest.

The paper voxelises and segments meshes for surfaces to sit, lie and put hands on (SIMS 4.1). Here a mesh becomes cells
(`voxelization`), what the piece is for is looked for on them (`planar_faces`), and every layer of what is
left is covered with rectangles.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from scene_graphs.boxes import MAX_PARTS, THINNEST, Part, Point3
from scene_graphs.furniture import canonical, typical_size
from scene_graphs.furniture_shapes import parts
from scene_graphs.geometry.planar_faces import EVEN, KINDS, RISEN, Block, FlatFace, Mask, blocks, flat_faces
from scene_graphs.geometry.voxelization import Voxels, voxelise

TALL: Final = 0.30
"""What stands this high above a seat, in metres, is a back wherever it stands; at a side and lower it is an arm."""
SLIM: Final = 0.13
"""What stands on the floor and is no wider, in metres, is a leg."""
_STRUCTURE: Final = frozenset({"seat", "mattress", "top", "panel", "doors", "shelf", "drawers", "base"})
_LIKENESS: Final = (0.85, 0.6, 0.4, 0.2)
"""What share of their cells two layers must have in common to be one, tried in turn until the boxes are few enough."""
_FEW: Final = 32
_PASSES: Final = 3
_MAX_BOXES: Final = 256
"""A heap of loose triangles would take thousands."""
_ASIDE: Final = 0.08
"""Share of its size that a seat must lie off the middle of what rises, to have a front."""
_CRUMB: Final = 0.15
"""Corners of pillows that are shorter are left out."""


def shape_of(vertices: ArrayLike, faces: ArrayLike, category: str) -> tuple[Part, ...]:
    """The boxes a mesh is made of, vertices (N, 3) and faces (M, 3), in the piece's own frame.

    That is the frame of `Placed`: metres, Y up, origin at the bottom centre, front +Z. The "seat", "mattress" or "top"
    parts that fit the category come first; boxes for the rest follow, true to about 3 cm and hollow where the mesh is.
    At most `MAX_PARTS`. Empty for lamps, plants, pictures, screens and rugs, whose parametric form says more.
    LayoutError for what is no mesh.
    """
    voxels, role = voxelise(vertices, faces), surface_role(category)
    if role is None:
        return ()
    flat = flat_faces(voxels, role) if role in KINDS else []
    rest = voxels.solid.copy()
    for face in flat:
        rest[face.block.x0 : face.block.x1, face.layers, face.block.z0 : face.block.z1] = False
    boxes = _boxes(voxels, rest, _LIKENESS[0])
    for likeness in _LIKENESS[1:]:
        if len(boxes) > _FEW:
            boxes = min(boxes, _boxes(voxels, rest, likeness), key=len)
    found = [Part(_role(*corners, flat), *corners) for corners in boxes]
    kept = [part for part in found if not (part.is_soft and max(part.size) < _CRUMB)]
    kept.sort(key=lambda part: -part.size[0] * part.size[1] * part.size[2])
    return tuple(_tidy(part) for part in (*(face.part for face in flat), *kept)[:MAX_PARTS])


def front_of_mesh(vertices: ArrayLike, faces: ArrayLike, category: str) -> float | None:
    """The yaw, a multiple of a quarter turn, that the front of a seat or bed has in the frame of its mesh.

    It looks from what rises behind the face to the face; a corner sofa whose
    wings are alike keeps +Z. None for other categories, and where nothing rises or it does on all sides alike.
    """
    role = surface_role(category)
    if role not in ("seat", "mattress"):
        return None
    voxels = voxelise(vertices, faces)
    flat = flat_faces(voxels, role)
    if not flat:
        return None
    start = int(np.ceil((flat[0].part.top + RISEN - voxels.origin[1]) / voxels.cell[1]))
    risen = np.argwhere(voxels.solid[:, start:].any(axis=1))
    if not len(risen):
        return None
    sat_on = np.zeros(voxels.solid.shape[::2], dtype=bool)
    for face in flat:
        sat_on[face.block.cells] = True
    # As shares of width and depth: a long sofa with one arm looks away from its back all the same.
    x, z = (np.argwhere(sat_on).mean(axis=0) - risen.mean(axis=0)) / sat_on.shape
    if max(abs(x), abs(z)) < _ASIDE:
        return None
    if abs(z) > 0.6 * abs(x):
        return 0.0 if z > 0 else -pi
    return pi / 2 if x > 0 else -pi / 2


def surface_role(category: str) -> str | None:
    """What a body uses a category by: "seat", "mattress", "top", or "panel" for storage and the like; None for decor.

    It is the role its parametric form has.
    """
    roles = {part.role for part in parts(canonical(category), typical_size(category))}
    if not roles & _STRUCTURE:
        return None
    return next((role for role in KINDS if role in roles), "panel")


def _boxes(voxels: Voxels, rest: Mask, likeness: float) -> list[tuple[Point3, Point3]]:
    """Corners of boxes that cover cells (X, Y, Z). What they leave out by more than a cell is covered once more."""
    left, found = rest.copy(), []
    for _ in range(_PASSES):
        for block, start, end in list(_stacks(left, likeness)):
            share = rest[block.x0 : block.x1, start:end, block.z0 : block.z1].mean(axis=(0, 2))
            filled = start + np.flatnonzero(share >= 0.5 * share.max())
            found.append(_corners(voxels, block, int(filled[0]), int(filled[-1]) + 1))
            if len(found) == _MAX_BOXES:
                return found
            near = block.grown(1)
            left[near.x0 : near.x1, max(filled[0] - 1, 0) : filled[-1] + 2, near.z0 : near.z1] = False
    return found


def _stacks(rest: Mask, likeness: float) -> Iterator[tuple[Block, int, int]]:
    """Rectangles of cells with their first layer and the one after their last: layers with much in common are one, and
    what stands on its like is one with it."""
    layers = rest.transpose(1, 0, 2)
    standing: dict[Block, int] = {}
    start = 0
    for end in range(1, len(layers) + 1):
        if end < len(layers) and _in_common(layers[start], layers[end]) >= likeness:
            continue
        plan = layers[start:end].mean(axis=0) >= 0.5
        here = list(blocks(plan, hole=2.0, margin=1))
        yield from ((block, standing.pop(block), start) for block in [*standing] if block not in here)
        standing = {block: standing.get(block, start) for block in here}
        start = end
    yield from ((block, first, len(layers)) for block, first in standing.items())


def _in_common(first: Mask, second: Mask) -> float:
    together = np.count_nonzero(first | second)
    return np.count_nonzero(first & second) / together if together else 1.0


def _corners(voxels: Voxels, block: Block, start: int, end: int) -> tuple[Point3, Point3]:
    low, high = voxels.bounds((slice(block.x0, block.x1), slice(start, end), slice(block.z0, block.z1)))
    (x0, y0, z0), (x1, y1, z1) = low.tolist(), high.tolist()
    return (x0, y0, z0), (x1, y1, z1)


def _role(low: Point3, high: Point3, flat: list[FlatFace]) -> str:
    """What a box is to the faces of its piece."""
    slim = low[1] < SLIM and max(high[0] - low[0], high[2] - low[2]) <= SLIM
    if not flat or flat[0].part.role == "top":
        return "leg" if slim and flat and high[1] <= flat[0].part.top else "panel"
    middle = ((low[0] + high[0]) / 2, (low[2] + high[2]) / 2)
    face = min((face.part for face in flat), key=lambda part: max(_beyond(part, middle)))
    rise, (aside, behind) = high[1] - face.top, _beyond(face, middle)
    if rise <= RISEN:
        on_top = face.role == "mattress" and low[1] > face.top - EVEN and max(aside, behind) < 0
        return "pillow" if on_top else "leg" if slim else "base"
    if face.role == "mattress":
        on_top = rise <= KINDS["mattress"].strewn + EVEN and low[1] > face.top - EVEN and max(aside, behind) < 0
        return "pillow" if on_top else "headboard"
    is_aside = aside > behind or middle[1] > face.center[2]
    return "arm" if is_aside and rise < TALL else "back"


def _beyond(part: Part, middle: tuple[float, float]) -> tuple[float, float]:
    """How far a point [x, z] lies outside a part along x and along z; negative inside."""
    return (
        abs(middle[0] - part.center[0]) - part.size[0] / 2,
        abs(middle[1] - part.center[2]) - part.size[2] / 2,
    )


def _tidy(part: Part) -> Part:
    """To a tenth of a millimetre, and nowhere too thin to be kept."""
    low = [round(value, 4) for value in part.low]
    high = [round(max(value, start + THINNEST), 4) for value, start in zip(part.high, low, strict=True)]
    return Part(part.role, (low[0], low[1], low[2]), (high[0], high[1], high[2]))
