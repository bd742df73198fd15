"""What of a piece swings, slides or lights up: doors, drawers, shades, screens, and what is behind and in them.

All of it is in the piece's own frame. It stands a hair before what is drawn of the piece at rest, which it hides.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Final, Literal

import numpy as np

from scene_graphs.furniture_shapes import Part, form_of, parts_of
from scene_graphs.layout import Placed, Point3
from scene_graphs.meshes import materials as m
from scene_graphs.meshes.interior_mesh import CURTAIN_FABRICS, LEAF
from scene_graphs.meshes.mesh_details import FRONT, HANDLE, Front, front_material, fronts, screen_face, shade
from scene_graphs.meshes.mesh_primitives import Shape, block, cylinder

Rgb = tuple[float, float, float]
Painted = tuple[Rgb, Shape]
"""A shape and its colour, sRGB; what is brighter than 1 shines by itself."""
Kind = Literal["front", "light"]
SWING: Final = np.radians(88.0)
"""How far a door opens."""
PULLED, MAX_PULLED = 0.65, 0.34
"""How far a drawer comes out: a share of the depth of its piece, and at most so many metres."""
BEFORE: Final = 0.001
"""How far what hides something stands before it (metres)."""
WARM, COLD_LIGHT = (1.9, 1.62, 1.18), (1.15, 1.2, 1.25)
"""Of a shade that is lit, and of the inside of a refrigerator."""
DARK, BOARD = (0.13, 0.11, 0.10), (0.42, 0.36, 0.30)
THINGS: Final = ((0.45, 0.30, 0.28), (0.33, 0.40, 0.47), (0.50, 0.46, 0.36))
FOOD: Final = ((1.0, 0.55, 0.35), (0.55, 0.85, 0.40), (1.05, 0.95, 0.55), (0.95, 0.35, 0.35))
"""Of the inside of other pieces, of the boards in it, and of what lies on these; in a refrigerator."""
SKY, SUN, HILLS = (0.75, 1.25, 1.75), (1.9, 1.6, 0.6), ((0.45, 1.15, 0.55), (0.20, 0.70, 0.50))
"""What a screen shows."""
ROOM_DOOR, CURTAINS = "room_door", "curtain_pair"
"""What doors and curtains of rooms are called, as pieces of their own."""
HALL_WALL, HALL_SIDE = (0.93, 0.89, 0.81), (0.86, 0.82, 0.75)
HALL_FLOOR, SKIRTING = (0.62, 0.55, 0.48), (0.97, 0.96, 0.94)
"""Of the hall outside a door: the wall ahead, those at its ends, what one treads on, and the foot of its walls."""
HALL_HEIGHT, SKIRTED = 2.9, 0.09
"""Of its walls, and of their foot (metres)."""
FOLD: Final = 0.07
"""Of a curtain (metres)."""
FLAME, WATER = (0.55, 0.85, 1.9), (0.95, 1.25, 1.45)


@dataclass(frozen=True)
class Moving:
    """Something that moves as a whole, about a point or along a way, once its mechanism opens."""

    pivot: Point3
    """Its origin, when all is closed."""
    painted: tuple[Painted, ...]
    """About that."""
    turn: float = 0.0
    """About +Y, once all is open (radians)."""
    way: Point3 = (0.0, 0.0, 0.0)
    """From there, once all is open (metres)."""


@dataclass(frozen=True)
class Mechanism:
    """What of a piece is opened, or lit, by itself."""

    kind: Kind
    low: Point3
    high: Point3
    """Between which a hand is laid on it."""
    moving: tuple[Moving, ...]
    drawn: bool = False
    """Whether it is moved when it is shut, as curtains are."""
    leaf: tuple[float, float] = (0.0, 0.0)
    """From where to where along x what swings or slides, the last of `moving`, reaches from its pivot."""
    grip: Point3 | None = None
    """Where a hand takes hold of that, when it is shut."""
    always: bool = False
    """Whether it is drawn shut as well: what is drawn of the piece at rest is then left out."""


@lru_cache(maxsize=512)
def mechanisms(placed: Placed) -> tuple[Mechanism, ...]:
    """All of a piece; none where nothing of it moves or lights."""
    if placed.category == ROOM_DOOR:
        return (_room_door(placed),)
    if placed.category == CURTAINS:
        return (_curtains(placed),)
    found: list[Mechanism] = []
    for part in parts_of(placed):
        found += [_opening(placed, part, front) for front in fronts(placed.category, part)]
        lit = tuple(_lit(placed, part))
        if lit:
            found.append(Mechanism("light", part.low, part.high, (Moving(part.center, _about(part.center, lit)),)))
    return tuple(found)


def _room_door(placed: Placed) -> Mechanism:
    """A door of a room, which opens inwards, and the hall behind it."""
    leaf, handle, hall = placed.shape
    (x0, y0, _), (x1, _, z1) = leaf.low, leaf.high
    hinge, turn = (x0, -SWING) if handle.center[0] > leaf.center[0] else (x1, SWING)
    pivot = (hinge, y0, z1)
    board = (
        (_rgb(LEAF.color), block(leaf.low, leaf.high)),
        (_rgb(m.METAL.color), block(handle.low, handle.high)),
    )
    swings = Moving(pivot, _moved(board, (-pivot[0], -pivot[1], -pivot[2])), turn)
    behind = Moving((0.0, 0.0, 0.0), tuple(_hall(hall, (x0, x1))))
    grip = (handle.center[0], handle.center[1], z1)
    reach = (x0 - hinge, x1 - hinge)
    return Mechanism("front", leaf.low, leaf.high, (behind, swings), leaf=reach, grip=grip, always=True)


def _hall(hall: Part, door: tuple[float, float]) -> Iterator[Painted]:
    """What is seen past an open door, from the room alone: from outside, where a film cuts the wall away, it would hide
    who is filmed."""
    (x0, _, z0), (x1, _, z1) = hall.low, hall.high
    tread, ends = BEFORE, (SKIRTED, HALL_HEIGHT)
    yield HALL_FLOOR, _quad((x0, tread, z1), (x1, tread, z1), (x1, tread, z0), (x0, tread, z0))
    yield HALL_FLOOR, _quad((door[0], tread, 0.0), (door[1], tread, 0.0), (door[1], tread, z1), (door[0], tread, z1))
    for color, side, (low, high) in (
        (HALL_WALL, HALL_SIDE, ends), (SKIRTING, SKIRTING, (0.0, SKIRTED)),
    ):  # fmt: skip
        yield color, _quad((x0, low, z0), (x1, low, z0), (x1, high, z0), (x0, high, z0))
        yield side, _quad((x0, low, z1), (x0, low, z0), (x0, high, z0), (x0, high, z1))
        yield side, _quad((x1, low, z0), (x1, low, z1), (x1, high, z1), (x1, high, z0))


def _quad(*corners: Point3) -> Shape:
    """A rectangle that is seen from where its corners go round counter-clockwise."""
    return np.array(corners), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def _curtains(placed: Placed) -> Mechanism:
    """Folds that are drawn before a window from both sides; open, they are within those that always hang there."""
    w, h, d = placed.size
    color = _rgb(CURTAIN_FABRICS[int(placed.id.partition("/")[0]) % len(CURTAIN_FABRICS)].color)
    folds = []
    count = int(np.ceil((w / 2 - 0.02) / FOLD))
    for side in (-1.0, 1.0):
        for number in range(count):
            bunched = side * (w / 2 + 0.05 + FOLD * (number % 3))
            spread = side * min((number + 0.5) * FOLD, w / 2)
            folds.append(Moving((bunched, 0.0, d), ((color, _fold(h)),), way=(spread - bunched, 0.0, 0.0)))
    return Mechanism("front", (-w / 2, 0.0, 0.0), (w / 2, h, d), tuple(folds), drawn=True)


def _fold(height: float) -> Shape:
    """One of a curtain, that is seen from +Z alone: it hides nobody where the wall before it is cut away."""
    half = FOLD / 2 + 0.002
    plan = [(-half, -0.016), (0.0, 0.006), (half, -0.016)]
    corners = [(x, y, z) for x, z in plan for y in (0.0, height)]
    faces = [(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)]
    return np.array(corners), np.array(faces, dtype=np.int32)


def _opening(placed: Placed, part: Part, front: Front) -> Mechanism:
    """A door or a drawer, and the inside that is seen when it is open."""
    (x0, y0, _), (x1, y1, z1) = front.low, front.high
    face = z1 + HANDLE + BEFORE  # before the handle that is drawn of it closed
    pivot = ((x0 + x1) / 2 if front.slides else front.hinge, y0, face + BEFORE)
    shift = (-pivot[0], -pivot[1], -z1)
    color = front_material(placed).color[:3]
    board = [(_rgb(color), front.board), (_rgb(m.METAL.color), front.handle)]
    inside = _inside(placed, (x0, y0, z1 - FRONT), (x1, y1, face))
    middle = ((x0 + x1) / 2, y0, face)
    hole = Moving(middle, _about(middle, inside))
    if front.slides:
        out = min(PULLED * part.size[2], MAX_PULLED)
        board += _tray(front, out, _rgb(color))
        leaf = Moving(pivot, _moved(board, shift), way=(0.0, 0.0, out))
    else:
        leaf = Moving(pivot, _moved(board, shift), turn=-SWING if front.hinge == x0 else SWING)
    (hx0, hy0, _), (hx1, hy1, _) = front.handle[0].min(axis=0).tolist(), front.handle[0].max(axis=0).tolist()
    grip, reach = ((hx0 + hx1) / 2, (hy0 + hy1) / 2, z1), (x0 - pivot[0], x1 - pivot[0])
    return Mechanism("front", front.low, front.high, (hole, leaf), leaf=reach, grip=grip)


def _tray(front: Front, out: float, color: Rgb) -> Iterator[Painted]:
    """What of a drawer comes out behind its front: two sides, and the dark between them."""
    (x0, y0, z0), (x1, y1, _) = front.low, front.high
    top, side = y0 + 0.75 * (y1 - y0), 0.012
    for left in (x0 + 0.01, x1 - 0.01 - side):
        yield color, block((left, y0 + 0.01, z0 - out), (left + side, top, z0))
    yield DARK, block((x0 + 0.01 + side, y0 + 0.01, z0 - out), (x1 - 0.01 - side, top - 0.02, z0))


def _inside(placed: Placed, low: Point3, high: Point3) -> tuple[Painted, ...]:
    """What is seen where a front was: the dark, or a lit refrigerator, with boards and things on them."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    lit = placed.category == "refrigerator"
    found: list[Painted] = [(COLD_LIGHT if lit else DARK, block(low, high))]
    count = int((y1 - y0) / 0.32)
    paints = FOOD if lit else THINGS
    for number in range(count):
        y, room = y0 + (number + 0.5) * (y1 - y0) / count, (y1 - y0) / count / (1 + (number + 1 == count))
        found.append(((0.62, 0.68, 0.72) if lit else BOARD, block((x0, y - 0.008, z0), (x1, y + 0.008, z1 + BEFORE))))
        for place in range(int((x1 - x0) / 0.13)):
            tall = min((0.11, 0.17, 0.07, 0.14)[(number + 3 * place) % 4], room - 0.03)
            x = x0 + 0.035 + 0.13 * place
            goods = block((x, y + 0.008, z0), (x + 0.08, y + 0.008 + tall, z1 + BEFORE))
            found.append((paints[(2 * number + place) % len(paints)], goods))
    return tuple(found)


def _lit(placed: Placed, part: Part) -> Iterator[Painted]:
    """What shines, burns or runs in a part of a piece that is switched on."""
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    match part.role:
        case "shade":
            around = Part(part.role, (x0 - BEFORE, y0 - BEFORE, z0 - BEFORE), (x1 + BEFORE, y1 + BEFORE, z1 + BEFORE))
            yield WARM, shade(form_of(placed.category), around)
        case "screen":
            yield from _picture(*screen_face(part))
        case "spout":
            basin = min(one.top for one in parts_of(placed))
            yield WATER, cylinder((x0, basin, z1 - 0.02), (x1, y0, z1), 8)
        case "hob":
            radius = 0.10 * min(x1 - x0, z1 - z0)
            for x, z in product((0.27, 0.73), (0.72,)):
                x, z = x0 + x * (x1 - x0), z0 + z * (z1 - z0)
                yield FLAME, cylinder((x - radius, y1, z - radius), (x + radius, y1 + 0.03, z + radius), 12, 0.6)


def _picture(low: Point3, high: Point3) -> Iterator[Painted]:
    """Hills under a sun, on a screen that faces +Z."""
    (x0, y0, _), (x1, y1, z) = low, high
    w, h = x1 - x0, y1 - y0
    for number, (color, (left, right), (bottom, top)) in enumerate((
        (SKY, (0.0, 1.0), (0.0, 1.0)),
        (SUN, (0.66, 0.66 + 0.2 * h / w), (0.62, 0.82)),
        (HILLS[0], (0.0, 1.0), (0.0, 0.34)),
        (HILLS[1], (0.0, 0.55), (0.0, 0.52)),
    )):  # fmt: skip
        front = z + (2 + number) * BEFORE
        yield color, block((x0 + left * w, y0 + bottom * h, z), (x0 + right * w, y0 + top * h, front))


def _rgb(color: tuple[float, ...]) -> Rgb:
    return (color[0], color[1], color[2])


def _about(origin: Point3, painted: tuple[Painted, ...]) -> tuple[Painted, ...]:
    return _moved(painted, (-origin[0], -origin[1], -origin[2]))


def _moved(painted: Iterable[Painted], by: Point3) -> tuple[Painted, ...]:
    return tuple((color, (vertices + np.array(by), faces)) for color, (vertices, faces) in painted)
