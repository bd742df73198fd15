"""What one piece of furniture is drawn on: shapes collected by material, then one mesh a material."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from scene_graphs.layouts import Placed
from scene_graphs.looks import materials as m
from scene_graphs.looks.materials import Material
from scene_graphs.looks.shapes import Mesh, Shape, merge

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
        return m.pick(choices, self.placed.category, self.placed.size, salt)

    @property
    def wood(self) -> Material:
        """The wood this piece is of."""
        return self.pick(m.WOODS)

    def meshes(self) -> list[Mesh]:
        """Everything drawn, one mesh a material, where the piece stands."""
        made = []
        for material, shapes in self.shapes.items():
            vertices, faces = merge(shapes)
            world = self.placed.to_world(vertices).astype(np.float32)
            name = f"{_PREFIX.get(self.placed.category, '')}{self.placed.id}:{material.name}"
            made.append(Mesh(name, world, faces, material.color, material.roughness))
        return made
