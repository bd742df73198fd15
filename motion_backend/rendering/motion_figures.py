"""Pictures of motions: the mannequin in its poses and the home around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import skin
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Solid
from motion_backend.walls import Side

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from scene_graphs.home import Home

ON_WALLS, SHADOWLESS = ("wall", "door", "window"), ("wall", "door", "window", "ceiling")
"""How the names of meshes begin that are a wall, in one or on one, and of those that would darken a whole room."""


def body_solids(motion: Motion, frames: Sequence[int], opacity: float = 1.0) -> list[Solid]:
    """The mannequin at some frames of a motion."""
    mesh = build_mannequin(motion.skeleton)
    chosen = np.asarray(frames)
    vertices, normals = skin(mesh, motion.skeleton, motion.root_positions[chosen], motion.local_rotations[chosen])
    return [Solid(v, mesh.faces, mesh.face_colors, n, opacity=opacity) for v, n in zip(vertices, normals, strict=True)]


@dataclass(frozen=True)
class Prop:
    """One mesh of a home, ready to draw."""

    name: str
    solid: Solid
    low: NDArray[np.floating]
    high: NDArray[np.floating]
    """Corners of its box. (3,) each."""
    room: int | None
    """The room its middle lies in, or that its wall bounds."""
    side: Side | None = None
    """The wall it is part of."""

    def stands_before(self, camera: Camera, points: NDArray[np.floating], room: int | None) -> bool:
        """Whether a camera leaves it away to see points (N, 3) in a room, as a doll's house is open in front."""
        eye = np.asarray(camera.eye)
        if self.side is not None and self.side.crosses(eye[[0, 2]], points[:, [0, 2]]):
            return True
        if self.room == room:
            return self.side is not None and not self.side.faces(eye[[0, 2]])
        nearer = (np.asarray(camera.target) - (self.low + self.high) / 2) @ camera.axes[2]
        return bool(nearer > 0 and self.high[1] > 0.1)


def home_props(home: Home) -> list[Prop]:
    """Everything of a home that can be drawn; walls, what hangs on them and lamps under the ceiling cast no shadow."""
    from scene_graphs.meshes.furniture_mesh import home_meshes

    sides = [side for wall in home.walls if (side := Side.of(wall, home)) is not None]
    props = []
    for mesh in home_meshes(home):
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        middle = (float(low[0] + high[0]) / 2, float(low[2] + high[2]) / 2)
        hangs = bool(sides) and mesh.name.startswith(ON_WALLS)
        side = min(sides, key=lambda side: side.distance(np.array(middle))) if hangs else None
        opacity = 0.25 if mesh.color[3] < 1 else 1.0
        casts = not mesh.name.startswith(SHADOWLESS)
        solid = Solid(mesh.vertices, mesh.faces, mesh.color, opacity=opacity, casts=casts)
        props.append(Prop(mesh.name, solid, low, high, side.room if side else home.room_at(middle), side))
    return props


def around(
    props: Sequence[Prop],
    camera: Camera,
    points: NDArray[np.floating],
    room: int | None = None,
    reach: float = 4.5,
) -> list[Solid]:
    """What is within reach of the camera's target, without what stands before the points (N, 3) of a body in a room."""
    target = np.asarray(camera.target)
    shown = []
    for prop in props:
        gap = np.maximum(np.maximum(prop.low - target, target - prop.high), 0.0)
        if np.hypot(gap[0], gap[2]) <= reach and not prop.stands_before(camera, points, room):
            shown.append(prop.solid)
    return shown


def save_png(picture: NDArray[np.uint8], path: Path | str) -> Path:
    """Write a picture; the folder must be there."""
    from matplotlib.image import imsave

    imsave(path, picture)
    return Path(path)
