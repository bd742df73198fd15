"""A home as films show it: open in front, on a base, on a studio's ground."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.rendering.camera import Sight
from motion_backend.rendering.motion_figures import Prop, around, home_props
from motion_backend.rendering.rasterizer import Camera, Point3
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import Array

if TYPE_CHECKING:
    from scene_graphs.home import Home

REACH: Final = 7.0
"""Metres around what is seen that are drawn."""
STEP: Final = 15
"""Frames between two places of a body that walls may not hide."""
GROUND: Final = 12.0
"""Metres to every side of what is seen; farther off all is haze."""
GROUND_COLOR: Final = (0.76, 0.75, 0.73)


@dataclass(frozen=True)
class FilmSet:
    """What may be in the pictures of a film besides the body."""

    home: Home
    props: tuple[Prop, ...]
    base: Solid
    low: float
    """The height of the ground (metres)."""

    @staticmethod
    def of(home: Home, but: Collection[str] = ()) -> FilmSet:
        """A home on its base, `but` for the meshes of these names."""
        from scene_graphs.meshes.interior_mesh import base_mesh

        mesh = base_mesh(home)
        base = Solid(mesh.vertices, mesh.faces, mesh.color, outside=True)
        return FilmSet(home, tuple(home_props(home, but)), base, float(mesh.vertices[:, 1].min()))

    def seen(self, camera: Camera, joints: Array) -> Sequence[Solid]:
        """What a camera sees of it, open in front of a body whose joints in some frames are (T, 22, 3): who has gone
        out by a door is seen through that."""
        x, _, z = joints[len(joints) // 2, 0].tolist()
        some = joints[::STEP].reshape(-1, 3)
        within = self.home.on_floor(some[:, [0, 2]])
        points = some[within] if within.any() else some
        shown = around(self.props, camera, points, self.home.room_at((x, z)), REACH)
        return [*shown, self.base, self._ground(camera)]

    def sight(self, place: Point3) -> Sight:
        """What hides a body at a place."""
        return Sight.at(self.home, (place[0], place[2]), REACH)

    def _ground(self, camera: Camera) -> Solid:
        x, _, z = camera.target
        corners = [(x + a * GROUND, self.low, z + b * GROUND) for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
        return Solid(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]), GROUND_COLOR, outside=True)
