"""Colours of wood, fabric and the rest, and which a piece gets: chosen by its kind and size, so sets match.

What one piece of furniture is drawn on: shapes collected by material, then one mesh a material.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple
from zlib import crc32

import numpy as np

from scene_graphs.layout import Placed, Point3
from scene_graphs.meshes.mesh_primitives import Color, Mesh, Shape, merge


class Material(NamedTuple):
    """A look: name, sRGB colour and how rough it is."""

    name: str
    color: Color
    roughness: float = 0.8


def _paint(name: str, code: str, roughness: float = 0.8, alpha: float = 1.0) -> Material:
    red, green, blue = (int(code[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return Material(name, (round(red, 4), round(green, 4), round(blue, 4), alpha), roughness)


WOODS = (_paint("oak", "c39c6b", 0.6), _paint("walnut", "8a6244", 0.55), _paint("birch", "d9c3a0", 0.65))
CARCASSES = (*WOODS, _paint("white lacquer", "ece8e1", 0.45))
"""For wardrobes, cabinets and dressers."""
STEEL = _paint("steel", "c9cdd0", 0.35)
FRONTS = {
    "refrigerator": STEEL,
    "dishwasher": STEEL,
    "kitchen_counter": CARCASSES[3],
    "kitchen_cabinet": CARCASSES[3],
}
"""Of what stands side by side in a kitchen, whatever its size."""
FABRICS = (
    _paint("sage fabric", "8fa58f", 0.95),
    _paint("terracotta fabric", "c07a5c", 0.95),
    _paint("denim fabric", "5f7896", 0.95),
    _paint("mustard fabric", "cda04f", 0.95),
    _paint("stone fabric", "a9a196", 0.95),
    _paint("teal fabric", "4f7f80", 0.95),
    _paint("plum fabric", "86627a", 0.95),
)
SEAT_FABRICS = (FABRICS[0], FABRICS[2], FABRICS[4], FABRICS[5])
"""Quieter ones, for sofas."""
BLANKETS = (FABRICS[2], FABRICS[0], FABRICS[1], FABRICS[6], _paint("sand blanket", "c9b79c", 0.95))
RUGS = (_paint("cream rug", "d8cdb8", 1.0), _paint("blue rug", "93a5b3", 1.0), _paint("clay rug", "c49a84", 1.0))
BORDERS = (
    _paint("brown border", "a58a6c", 1.0),
    _paint("navy border", "5c7083", 1.0),
    _paint("red border", "99604f", 1.0),
)
SPINES = (
    _paint("red spine", "a4483f"),
    _paint("blue spine", "3f5d7d"),
    _paint("green spine", "5b7a58"),
    _paint("ochre spine", "c8994a"),
    _paint("ivory spine", "e3d9c3"),
)
LINEN = _paint("linen", "efece4", 0.95)
PILLOW = _paint("pillowcase", "f7f5f0", 0.95)
DARK_FABRIC = _paint("charcoal fabric", "4b5058", 0.9)
METAL = _paint("dark metal", "3c3f43", 0.4)
BRASS = _paint("brass", "b08d4c", 0.35)
LAMPSHADE = _paint("lampshade", "f6e6bd", 0.9)
CERAMIC = _paint("ceramic", "d8d2c8", 0.4)
TERRACOTTA = _paint("terracotta", "b9714f", 0.85)
LEAVES = (_paint("leaf", "5d8a4c", 0.8), _paint("young leaf", "7fa862", 0.8))
BLOSSOM = _paint("blossom", "d98c8c", 0.8)
BLACK = _paint("black frame", "2a2a2c", 0.5)
SCREEN = _paint("screen", "15181c", 0.2)
GLASS = _paint("mirror glass", "c4d4da", 0.1)
PANE = _paint("window pane", "bfdcea", 0.1, alpha=0.35)
WHITE = _paint("white paint", "f3f1ec", 0.7)
CANVASES = (_paint("warm canvas", "e9d7b9"), _paint("cool canvas", "c9d8dd"), _paint("blush canvas", "ecd3c6"))
INKS = (_paint("ink", "39506b"), _paint("sun", "d9803f"), _paint("moss", "6f8a5e"))


def pick(choices: tuple[Material, ...], category: str, size: Point3, salt: str = "") -> Material:
    """One of several, the same for pieces of one category and size."""
    return choices[crc32(f"{salt}{category}{size}".encode()) % len(choices)]


_PREFIX = {
    "picture": "wall ",
    "clock": "wall ",
    "wall_shelf": "wall ",
    "wall_lamp": "wall ",
    "curtain": "window ",
    "ceiling_lamp": "ceiling ",
    "pendant_lamp": "ceiling ",
    "rug": "rug ",
}
"""Put before the names of what hangs on something, so that it goes where a viewer hides walls or ceilings."""


@dataclass
class Canvas:
    """Collects shapes of one piece by material, in the piece's own frame."""

    placed: Placed
    shapes: dict[Material, list[Shape]] = field(default_factory=dict)

    def add(self, material: Material, *shapes: Shape) -> None:
        """Draw shapes in a material."""
        self.shapes.setdefault(material, []).extend(shapes)

    def pick(self, choices: tuple[Material, ...], salt: str = "") -> Material:
        """The piece's own of several materials."""
        return pick(choices, self.placed.category, self.placed.size, salt)

    @property
    def wood(self) -> Material:
        """The wood this piece is of."""
        return self.pick(WOODS)

    def meshes(self) -> list[Mesh]:
        """Everything drawn, one mesh a material, where the piece stands."""
        made = []
        for material, shapes in self.shapes.items():
            vertices, faces = merge(shapes)
            world = self.placed.to_world(vertices).astype(np.float32)
            name = f"{_PREFIX.get(self.placed.category, '')}{self.placed.id}:{material.name}"
            made.append(Mesh(name, world, faces, material.color, material.roughness))
        return made
