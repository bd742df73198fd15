"""A home as films show it: without the walls before a body, where its room goes on instead, on a studio's ground."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.rendering.camera import Sight
from motion_backend.rendering.motion_figures import Prop, home_props, within_reach
from motion_backend.rendering.rasterizer import Camera, Point3
from motion_backend.rendering.renderer import Solid
from motion_backend.rendering.set_extension import SetExtension
from motion_backend.rotations import Array
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home

REACH: Final = 7.0
"""Metres around what is seen that are drawn."""
STEP: Final = 15
"""Frames between two places of a body that walls may not hide."""
GROUND: Final = 12.0
"""Metres to every side of what is seen; farther off all is haze."""
IN_WALL: Final = 0.15
"""Metres from the line of a wall up to which something is in it."""
UNDER: Final = 0.1
"""Metres below a ceiling up to which an eye looks at it from below."""
GROUND_COLOR: Final = (0.76, 0.75, 0.73)


@dataclass(frozen=True)
class FilmSet:
    """What may be in the pictures of a film besides the body."""

    home: Home
    props: tuple[Prop, ...]
    base: Solid
    low: float
    """The height of the ground (metres)."""
    extensions: dict[int, SetExtension] = field(default_factory=dict)
    """Those of rooms that were seen."""

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
        some = joints[::STEP].reshape(-1, 3)
        within = self.home.on_floor(some[:, [0, 2]])
        places = some[within] if within.any() else some
        rooms = [self._room_of(pose) for pose in (joints[len(joints) // 2], *joints[::STEP])]
        room, used = next((one for one in rooms if one is not None), None), {*rooms}
        near = within_reach(self.props, camera, REACH)
        left_away = [prop.stands_before(camera, places, room) for prop in near]
        shown = [prop for prop, gone in zip(near, left_away, strict=True) if not gone]
        walls = [prop for prop, gone in zip(near, left_away, strict=True) if gone and prop.name.startswith("wall")]
        beyond: list[Solid] = []
        if room is not None:
            gaps = [prop for prop in walls if prop.side is not None and prop.side.room == room]
            sides = [prop.side for prop in gaps if prop.side is not None]
            # Floors and rugs of a room behind a gap would be an island in what goes on there.
            shown = [prop for prop in shown if prop.room in used or prop.side or not _is_behind(prop, sides)]
            extension = self._extension(room)
            if gaps:
                beyond += extension.beyond(sides, gaps[0].solid.color)
            if camera.eye[1] < extension.height - UNDER:
                beyond.append(extension.ceiling(sides))
        return [*(prop.solid for prop in shown), *beyond, self.base, self._ground(camera)]

    def is_beyond(self, camera: Camera, place: Array) -> bool:
        """Whether a camera stands on the far side of the wall in which there is a place (3,)."""
        eye, here = np.asarray(camera.eye)[[0, 2]], place[[0, 2]]
        sides = (prop.side for prop in self.props if prop.side is not None)
        return any(side.distance(here) < IN_WALL and not side.faces(eye) for side in sides)

    def _room_of(self, pose: Array) -> int | None:
        """The room in which a body (22, 3) is."""
        x, _, z = pose[0].tolist()
        return self.home.room_at((x, z))

    def _extension(self, room: int) -> SetExtension:
        if room not in self.extensions:
            self.extensions[room] = SetExtension.of(self.home, room)
        return self.extensions[room]

    def sight(self, place: Point3, poses: Array) -> Sight:
        """What hides a body at a place, in some poses (P, 22, 3)."""
        return Sight.at(self.home, (place[0], place[2]), REACH, poses.reshape(-1, 3))

    def _ground(self, camera: Camera) -> Solid:
        x, _, z = camera.target
        corners = [(x + a * GROUND, self.low, z + b * GROUND) for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
        return Solid(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]), GROUND_COLOR, outside=True)


def _is_behind(prop: Prop, gaps: Sequence[Side]) -> bool:
    """Whether the middle of something lies beyond one of some walls."""
    middle = ((prop.low + prop.high) / 2)[[0, 2]]
    return any(not side.faces(middle) for side in gaps)
