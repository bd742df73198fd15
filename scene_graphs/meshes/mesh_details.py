"""Small things that make furniture look used: books on shelves, leaves in pots, pictures in frames.

Each varies with the piece it belongs to and with nothing else, so a home always looks the same.

Doors and drawers of storage have gaps between them and handles on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from zlib import crc32

import numpy as np

from scene_graphs.furniture_shapes import Part, form_of
from scene_graphs.layout import Placed, Point3
from scene_graphs.meshes import materials as m
from scene_graphs.meshes.materials import Canvas, Material
from scene_graphs.meshes.mesh_primitives import Shape, blade, block, cylinder

Shapes = dict[Material, list[Shape]]


def books(shelf: Part, headroom: float, placed: Placed) -> Shapes:
    """A row of books on a board, with a gap here and there and now and then a jar."""
    rng = _generator(placed, shelf.top)
    (x, _, z0), (x1, y, z1) = shelf.low, shelf.high
    deepest = z1 - z0 - 0.05
    found: Shapes = {}
    if headroom < 0.16 or deepest < 0.08:
        return found
    x, end = x + 0.02, x1 - 0.03
    while x < end - 0.05:
        if rng.random() < 0.12:
            x += float(rng.uniform(0.08, 0.22))
            continue
        if rng.random() < 0.06 and x < end - 0.16:
            jar = cylinder((x + 0.02, y, z0 + 0.05), (x + 0.14, y + 0.7 * headroom, z0 + 0.17), 10, 0.7)
            found.setdefault(m.CERAMIC, []).append(jar)
            x += 0.18
            continue
        wide, tall = float(rng.uniform(0.03, 0.06)), headroom * float(rng.uniform(0.6, 0.86))
        deep = min(deepest, float(rng.uniform(0.15, 0.21)))
        spine = m.SPINES[int(rng.integers(len(m.SPINES)))]
        found.setdefault(spine, []).append(block((x, y, z0 + 0.01), (min(x + wide, end), y + tall, z0 + 0.01 + deep)))
        x += wide + 0.003
    return found


def foliage(part: Part, placed: Placed) -> Shapes:
    """Leaves that rise from the pot and bend outward to the edge of the part."""
    rng = _generator(placed, 0.0)
    found: Shapes = {material: [] for material in m.LEAVES}
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    reach = np.array([(x1 - x0) / 2, 1.0, (z1 - z0) / 2])
    for number in range(26):
        turn = number * 2.4 + float(rng.uniform(-0.3, 0.3))
        rise = float(rng.uniform(0.1, 1.0))
        out = (1.02 - 0.75 * rise) * float(rng.uniform(0.75, 1.0))
        root = np.array([0.03 * np.sin(turn), y0 + 0.25 * rise * (y1 - y0), 0.03 * np.cos(turn)])
        tip = np.array([out * np.sin(turn), y0 + (0.25 + 0.72 * rise) * (y1 - y0), out * np.cos(turn)])
        tip[[0, 2]] *= reach[[0, 2]]
        width = 0.22 * float(np.linalg.norm(tip - root)) + 0.03
        found[m.LEAVES[number % 2]].append(blade(root, tip, width))
    return found


def stalks(part: Part, placed: Placed) -> Shapes:
    """A few stalks with blossoms."""
    rng = _generator(placed, 0.0)
    (x0, y0, _), (x1, y1, _) = part.low, part.high
    found: Shapes = {m.LEAVES[0]: [], m.BLOSSOM: []}
    for number in range(7):
        turn, out = number * 0.9, (x1 - x0) / 2 * float(rng.uniform(0.3, 0.85))
        tip = np.array([out * np.sin(turn), y1 - 0.25 * (y1 - y0) * float(rng.random()) - 0.02, out * np.cos(turn)])
        found[m.LEAVES[0]].append(blade(np.array([0.0, y0 - 0.05, 0.0]), tip, 0.012))
        low, high = tip - 0.018, tip + 0.018
        blossom = block((low[0], low[1], low[2]), (high[0], high[1], high[2]), 0.014)
        found[m.BLOSSOM].append(blossom)
    return found


def painting(part: Part, placed: Placed) -> Shapes:
    """A frame around an abstract landscape: a ground, a sun, a hill."""
    rng = _generator(placed, 0.0)
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    frame = (m.BLACK, m.WOODS[0], m.WHITE)[int(rng.integers(3))]
    edge, w, h = 0.03, x1 - x0, y1 - y0
    canvas = (x0 + edge, y0 + edge, z0), (x1 - edge, y1 - edge, z1 - 0.012)
    found: Shapes = {frame: [], m.CANVASES[int(rng.integers(len(m.CANVASES)))]: [block(*canvas)]}
    for low, high in (
        ((x0, y0, z0), (x1, y0 + edge, z1)),
        ((x0, y1 - edge, z0), (x1, y1, z1)),
        ((x0, y0 + edge, z0), (x0 + edge, y1 - edge, z1)),
        ((x1 - edge, y0 + edge, z0), (x1, y1 - edge, z1)),
    ):
        found[frame].append(block(low, high))
    front = z1 - 0.012
    hill = float(rng.uniform(0.25, 0.5)) * h
    found[m.INKS[2]] = [block((x0 + edge, y0 + edge, front - 0.002), (x1 - edge, y0 + hill, front + 0.002))]
    left, wide = x0 + edge + float(rng.uniform(0.0, 0.3)) * w, 0.45 * w
    found[m.INKS[0]] = [block((left, y0 + edge, front - 0.002), (left + wide, y0 + 0.6 * hill, front + 0.004))]
    sun = float(rng.uniform(0.25, 0.7)) * w + x0
    top, size = y0 + 0.75 * h, 0.09 * min(w, h) + 0.02
    found[m.INKS[1]] = [block((sun, top - size, front - 0.002), (sun + 2 * size, top + size, front + 0.003), 0.02)]
    return found


def _generator(placed: Placed, height: float) -> np.random.Generator:
    return np.random.default_rng(crc32(f"{placed.category}{placed.size}{placed.id}{height:.2f}".encode()))


FRONT, HANDLE = 0.016, 0.012
"""How thick the board of a door or drawer is, and how far its handle stands out, in metres."""


@dataclass(frozen=True)
class Front:
    """A door or a drawer of a closed body: a board between two corners, in the frame of its piece."""

    low: Point3
    high: Point3
    slides: bool
    """Whether it is pulled out; else it swings."""
    hinge: float
    """The x of the side about which it swings."""
    handle: Shape

    @property
    def board(self) -> Shape:
        """Without its handle."""
        return block(self.low, self.high, 0.006)


def drawers(canvas: Canvas, part: Part) -> None:
    """A body with a front a drawer, each with a handle."""
    _draw(canvas, part)


def doors(canvas: Canvas, part: Part) -> None:
    """Doors half a metre wide; low pieces have knobs, tall ones bars for handles."""
    _draw(canvas, part)


def _draw(canvas: Canvas, part: Part) -> None:
    """A body and its fronts, which reach to the part's own front; handles stand out a little."""
    material = front_material(canvas.placed)
    canvas.add(material, block(part.low, (part.high[0], part.high[1], part.high[2] - FRONT)))
    for front in fronts(canvas.placed.category, part):
        canvas.add(material, front.board)
        canvas.add(m.METAL, front.handle)


def front_material(placed: Placed) -> Material:
    """Of the doors and drawers of a piece, and of the body behind them."""
    return m.FRONTS.get(placed.category) or m.pick(m.CARCASSES, placed.category, placed.size)


def fronts(category: str, part: Part) -> list[Front]:
    """The doors or drawers of a part that is a closed body; none of one that is not."""
    width, tall = part.size[0], form_of(category) == "tall_storage"
    match part.role:
        case "drawers":
            rows, columns = max(1, round(part.size[1] / 0.2)), 2 if width > 0.8 else 1
        case "doors" if tall:
            rows, columns = 2 if category == "refrigerator" else 1, max(1, round(width / 0.5))
        case "doors":
            rows, columns = 3 if category == "dresser" else 1, max(2, round(width / 0.55))
        case _:
            return []
    slides = part.role == "drawers" or category == "dresser"
    (x0, y0, _), (x1, y1, z1) = part.low, part.high
    xs, ys = np.linspace(x0, x1, columns + 1), np.linspace(y0, y1, rows + 1)
    found = []
    for column in range(columns):
        for row in range(rows):
            low = (float(xs[column]) + 0.005, float(ys[row]) + 0.005, z1 - FRONT)
            high = (float(xs[column + 1]) - 0.005, float(ys[row + 1]) - 0.005, z1)
            opens_right = column % 2 == 0 and columns > 1
            handle = _bar(low, high, opens_right) if tall else _knob(low, high)
            found.append(Front(low, high, slides, low[0] if opens_right else high[0], handle))
    return found


def _knob(low: Point3, high: Point3) -> Shape:
    x, y = (low[0] + high[0]) / 2, high[1] - min(0.06, 0.35 * (high[1] - low[1]))
    return block((x - 0.05, y - 0.006, high[2]), (x + 0.05, y + 0.006, high[2] + HANDLE))


def _bar(low: Point3, high: Point3, opens_right: bool) -> Shape:
    x = high[0] - 0.04 if opens_right else low[0] + 0.04
    y = low[1] + min(0.5 * (high[1] - low[1]), 1.0)
    return block((x - 0.008, y - 0.12, high[2]), (x + 0.008, y + 0.12, high[2] + HANDLE))


def shade(form: str, part: Part) -> Shape:
    """The shade of a lamp: flat and wider below under a ceiling, else narrower above."""
    segments, taper = (20, 1.25) if form == "ceiling_lamp" else (18, 0.72)
    return cylinder(part.low, part.high, segments, taper)


def screen_face(part: Part) -> tuple[Point3, Point3]:
    """Two corners of what lights up of a screen, within its rim."""
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    return (x0 + 0.02, y0 + 0.03, z0), (x1 - 0.02, y1 - 0.02, z1)
