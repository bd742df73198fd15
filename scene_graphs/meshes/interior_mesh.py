"""Floors, walls with their openings, doors and windows of a home."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import shapely

from scene_graphs.home import HANDLE_HEIGHT, HANDLE_IN, Home, Wall
from scene_graphs.layout import Array, Opening
from scene_graphs.meshes import materials as m
from scene_graphs.meshes.materials import Material
from scene_graphs.meshes.mesh_primitives import Mesh, Shape, block, flat, merge

THICKNESS = 0.06
"""Of a wall, outwards from the room's outline: two rooms' walls fill the gap between them."""
STUMP = 0.10
"""Metres that are left of a wall which is cut to be looked over: less than hides a foot."""
BASE_BEYOND, BASE_HEIGHT, BASE_TOP = 0.14, 0.16, -0.008
"""Metres that what a home stands on reaches beyond its rooms, how high it is, and where its top is."""
PLANK, PLANK_LENGTH, TILE = 0.19, 1.7, 0.6
_FLOORS: dict[str, tuple[Material, ...]] = {
    "bedroom": tuple(
        Material("oak floor", (r, g, b, 1.0), 0.7) for r, g, b in ((0.80, 0.68, 0.53), (0.77, 0.65, 0.50))
    ),
    "living_room": tuple(
        Material("ash floor", (r, g, b, 1.0), 0.7) for r, g, b in ((0.74, 0.61, 0.46), (0.71, 0.58, 0.43))
    ),
    "dining_room": tuple(
        Material("tiles", (r, g, b, 1.0), 0.5) for r, g, b in ((0.85, 0.82, 0.77), (0.81, 0.78, 0.73))
    ),
    "study": tuple(
        Material("walnut floor", (r, g, b, 1.0), 0.65) for r, g, b in ((0.62, 0.48, 0.36), (0.59, 0.45, 0.33))
    ),
}
_OTHER_FLOOR = tuple(Material("floor", (g, g, g, 1.0), 0.8) for g in (0.80, 0.77))
_PAINTS = (
    Material("wall paint", (0.94, 0.92, 0.88, 1.0), 0.95),
    Material("wall paint", (0.89, 0.92, 0.90, 1.0), 0.95),
    Material("wall paint", (0.90, 0.91, 0.94, 1.0), 0.95),
    Material("wall paint", (0.95, 0.91, 0.88, 1.0), 0.95),
)
_CUT = Material("cut wall", (0.36, 0.34, 0.33, 1.0), 0.9)
_BASE = Material("base", (0.80, 0.78, 0.75, 1.0), 0.9)
_FRAME = Material("door frame", (0.97, 0.96, 0.94, 1.0), 0.6)
LEAF = Material("door leaf", (0.80, 0.66, 0.50, 1.0), 0.6)
LEAF_OUT = (0.012, 0.05)
"""Between which distances outwards the leaf of a door is (metres)."""
CURTAIN_BELOW, CURTAIN_ABOVE, CURTAIN_OUT = 0.06, 0.11, 0.05
"""How far curtains hang below their window and over it, and before the wall (metres)."""
CURTAIN_FABRICS = tuple(m.FABRICS[index] for index in (4, 0, 2))


def floor_meshes(home: Home) -> Iterator[Mesh]:
    """Every room's floor as planks or tiles in two tones, and a threshold in every doorway."""
    for index, room in enumerate(home.rooms):
        yield from _floor(home, index, np.asarray(room.layout.floor_polygon))
    for number, doorway in enumerate(home.doorways):
        start, along, across, length = _frame(doorway)
        sill = start + np.array([[0, -0.08], [0, 0.08], [length, 0.08], [length, -0.08]]) @ np.stack([along, across])
        yield _mesh(f"floor threshold {number}", m.WOODS[0], [flat(sill, 0.002)])


def wide_floor_meshes(home: Home, index: int, beyond: float) -> Iterator[Mesh]:
    """A rectangular floor like that of a room, which reaches so many metres beyond it to every side."""
    outline = np.asarray(home.rooms[index].layout.floor_polygon)
    (x0, z0), (x1, z1) = outline.min(axis=0) - beyond, outline.max(axis=0) + beyond
    yield from _floor(home, index, np.array([(x0, z0), (x1, z0), (x1, z1), (x0, z1)]))


def _floor(home: Home, index: int, outline: Array) -> Iterator[Mesh]:
    """The floor of a room within an outline."""
    room = home.rooms[index]
    kind = room.layout.room_type
    boards = _tiles(outline) if kind == "dining_room" else _planks(outline)
    shapes: tuple[list[Shape], list[Shape]] = ([], [])
    for tone, corners in boards:
        shapes[tone].append(flat(room.pose.to_home(corners)))
    for material, pieces in zip(_FLOORS.get(kind, _OTHER_FLOOR), shapes, strict=True):
        if pieces:
            yield _mesh(f"floor {index}", material, pieces)


def wall_meshes(home: Home) -> Iterator[Mesh]:
    """Every wall at full height with its openings cut out, door leaves, window frames, panes and curtains."""
    outlines = [shapely.Polygon(home.room_polygon(index)) for index in range(len(home.rooms))]
    for number, wall in enumerate(home.walls):
        start, end = (np.asarray(point, dtype=float) for point in wall.segment)
        middle = (start + end) / 2
        room = int(np.argmin([outline.exterior.distance(shapely.Point(middle)) for outline in outlines]))
        side = _Side(wall, outlines[room])
        yield _mesh(f"wall {number}", _PAINTS[room % len(_PAINTS)], list(side.slabs()))
        for count, opening in enumerate(wall.openings):
            yield from _fill(home, side, opening, f"{number}.{count}", room)


def stump_meshes(home: Home) -> Iterator[Mesh]:
    """What is left of every wall, in their order, where it is cut near the floor to be looked over; doorways stay."""
    outlines = [shapely.Polygon(home.room_polygon(index)) for index in range(len(home.rooms))]
    for number, wall in enumerate(home.walls):
        middle = shapely.Point(np.mean(np.asarray(wall.segment, dtype=float), axis=0))
        outline = min(outlines, key=lambda one: one.exterior.distance(middle))
        yield _mesh(f"stump {number}", _CUT, list(_Side(wall, outline).slabs(STUMP)))


def base_mesh(home: Home) -> Mesh:
    """What a home stands on: a slab under all rooms that reaches a little beyond the walls, its top a hair below
    floors."""
    outlines = [shapely.Polygon(home.room_polygon(index)) for index in range(len(home.rooms))]
    whole = shapely.union_all([one.buffer(BASE_BEYOND, join_style="mitre") for one in outlines])
    shapes: list[Shape] = []
    for part in shapely.get_parts(whole):
        ring = np.asarray(part.exterior.coords)
        shapes.append(flat(ring[:-1], BASE_TOP))
        shapes += [_upright(start, end, -BASE_HEIGHT, BASE_TOP) for start, end in pairwise(ring)]
    return _mesh("base", _BASE, shapes)


def _upright(start: Array, end: Array, low: float, high: float) -> Shape:
    """A rectangle that stands on a line [x, z]."""
    corners = [(*start, low), (*end, low), (*end, high), (*start, high)]
    return np.array([(x, y, z) for x, z, y in corners]), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


class _Side:
    """A wall seen from its room: boxes are given along it, in height, and outwards."""

    def __init__(self, wall: Wall, outline: shapely.Polygon) -> None:
        self.wall = wall
        self.start, end = (np.asarray(point, dtype=float) for point in wall.segment)
        self.length = float(np.linalg.norm(end - self.start))
        self.along = (end - self.start) / self.length
        normal = np.array([-self.along[1], self.along[0]])
        inside = outline.contains(shapely.Point((self.start + end) / 2 + 0.02 * normal))
        self.out = -normal if inside else normal

    def box(self, along: tuple[float, float], heights: tuple[float, float], out: tuple[float, float]) -> Shape:
        """A box in the wall's own measures, as a shape in the home."""
        vertices, faces = block((along[0], heights[0], out[0]), (along[1], heights[1], out[1]))
        plan = self.start + vertices[:, :1] * self.along + vertices[:, 2:] * self.out
        mirrored = self.along[0] * self.out[1] < self.along[1] * self.out[0]
        if mirrored:
            faces = faces[:, ::-1]
        return np.stack([plan[:, 0], vertices[:, 1], plan[:, 1]], axis=1), faces

    def span(self, opening: Opening) -> tuple[float, float]:
        """Where an opening begins and ends along the wall."""
        places = sorted(float((np.asarray(point) - self.start) @ self.along) for point in opening.segment)
        return (max(places[0], 0.0), min(places[1], self.length))

    def slabs(self, height: float = np.inf) -> Iterator[Shape]:
        """The wall, up to a height, with holes where its openings are; its ends reach round the corners."""
        top = min(self.wall.height, height)
        spans = sorted((self.span(opening), opening) for opening in self.wall.openings)
        stops = [-THICKNESS, *(place for span, _ in spans for place in span), self.length + THICKNESS]
        for left, right in list(pairwise(stops))[::2]:
            if right - left > 1e-6:
                yield self.box((left, right), (0.0, top), (0.0, THICKNESS))
        for span, opening in spans:
            if opening.bottom > 0.01:
                yield self.box(span, (0.0, min(opening.bottom, top)), (0.0, THICKNESS))
            if top - opening.top > 0.01:
                yield self.box(span, (opening.top, top), (0.0, THICKNESS))


def _fill(home: Home, side: _Side, opening: Opening, name: str, room: int) -> Iterator[Mesh]:
    """A frame round an opening; a closed door to the outside, a window with curtains, nothing in a doorway."""
    left, right = side.span(opening)
    low, high = opening.bottom, min(opening.top, side.wall.height - 0.02)
    rim, proud = 0.05, (-0.015, THICKNESS + 0.004)
    yield _mesh(
        f"{'window' if low > 0.1 else 'door'} frame {name}",
        _FRAME,
        [
            side.box((left - rim, left), (low, high + rim), proud),
            side.box((right, right + rim), (low, high + rim), proud),
            side.box((left, right), (high, high + rim), proud),
        ],
    )
    if low > 0.1:
        yield from _window(side, (left, right), (low, high), name, CURTAIN_FABRICS[room % len(CURTAIN_FABRICS)])
    elif not home.leads_on(opening):
        yield _mesh(f"door leaf {name}", LEAF, [side.box((left, right), (0.005, high), LEAF_OUT)])
        grip, y = right - HANDLE_IN, HANDLE_HEIGHT
        handle = [side.box((grip - 0.065, grip + 0.065), (y - 0.01, y + 0.01), (-0.045, -0.03))]
        handle.append(side.box((grip + 0.045, grip + 0.065), (y - 0.015, y + 0.015), (-0.045, 0.012)))
        yield _mesh(f"door handle {name}", m.METAL, handle)


def _window(
    side: _Side, span: tuple[float, float], heights: tuple[float, float], name: str, fabric: Material
) -> Iterator[Mesh]:
    (left, right), (low, high) = span, heights
    middle, bar = (left + right) / 2, 0.02
    frame = [
        side.box((middle - bar, middle + bar), (low, high), (0.015, 0.05)),
        side.box((left, right), (low + 0.62 * (high - low) - bar, low + 0.62 * (high - low) + bar), (0.015, 0.05)),
        side.box((left - 0.08, right + 0.08), (low - 0.03, low), (-0.07, THICKNESS)),
    ]
    yield _mesh(f"window bars {name}", _FRAME, frame)
    yield _mesh(f"window pane {name}", m.PANE, [side.box((left, right), (low, high), (0.028, 0.036))])
    # Beside a window in a corner there is less room for them.
    rod_ends = (max(left - 0.3, 0.0), min(right + 0.3, side.length))
    rod = side.box(rod_ends, (high + 0.1, high + 0.12), (-0.06, -0.04))
    yield _mesh(f"window rod {name}", m.METAL, [rod])
    folds = []
    for begin in (max(left - 0.26, 0.0), min(right - 0.02, side.length - 0.284)):
        for fold in range(4):
            x, depth = begin + 0.07 * fold, -CURTAIN_OUT + 0.016 * (fold % 2)
            heights = (low - CURTAIN_BELOW, high + CURTAIN_ABOVE)
            folds.append(side.box((x, x + 0.074), heights, (depth - 0.014, depth + 0.006)))
    yield _mesh(f"window curtain {name}", fabric, folds)


def _planks(outline: Array) -> Iterator[tuple[int, Array]]:
    """Rows of boards along the longer side of a room, laid in half bond, with the tone of each."""
    (x0, z0), (x1, z1) = outline.min(axis=0), outline.max(axis=0)
    swap = (z1 - z0) > (x1 - x0)
    length, depth = (z1 - z0, x1 - x0) if swap else (x1 - x0, z1 - z0)
    for row, v in enumerate(np.arange(0.0, depth, PLANK)):
        first = -PLANK_LENGTH * ((row * 0.37) % 1.0)
        for column, u in enumerate(np.arange(first, length, PLANK_LENGTH)):
            low, high = (u, v), (u + PLANK_LENGTH, v + PLANK)
            corners = (low[0], low[1], high[0], high[1]) if not swap else (low[1], low[0], high[1], high[0])
            piece = shapely.box(x0 + corners[0], z0 + corners[1], x0 + corners[2], z0 + corners[3])
            yield from _cut(piece, outline, (row * 7 + column * 5) % 3 % 2)


def _tiles(outline: Array) -> Iterator[tuple[int, Array]]:
    (x0, z0), (x1, z1) = outline.min(axis=0), outline.max(axis=0)
    for i, x in enumerate(np.arange(x0, x1, TILE)):
        for j, z in enumerate(np.arange(z0, z1, TILE)):
            yield from _cut(shapely.box(x, z, x + TILE, z + TILE), outline, (i + j) % 2)


def _cut(piece: shapely.Polygon, outline: Array, tone: int) -> Iterator[tuple[int, Array]]:
    """What of a board lies within the room."""
    inside = shapely.intersection(piece, shapely.Polygon(outline))
    for part in shapely.get_parts(inside):
        if isinstance(part, shapely.Polygon) and part.area > 1e-5:
            yield tone, np.asarray(part.exterior.coords)[:-1]


def _frame(opening: Opening) -> tuple[Array, Array, Array, float]:
    start, end = (np.asarray(point, dtype=float) for point in opening.segment)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    return start, along, np.array([-along[1], along[0]]), length


def _mesh(name: str, material: Material, shapes: list[Shape]) -> Mesh:
    vertices, faces = merge(shapes)
    return Mesh(name, vertices.astype(np.float32), faces.astype(np.int32), material.color, material.roughness)
