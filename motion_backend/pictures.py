"""Pictures of motions: the mannequin in its poses, the home around it, and rows of them over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend.mannequin import build_mannequin
from motion_backend.raster import Camera, orbit
from motion_backend.rendering import Image, Solid, render
from motion_backend.skinning import skin
from motion_backend.walls import Side

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from scene_graphs.homes import Home

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
    from scene_graphs.furnishing import home_meshes

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


def contact_sheet(
    motion: Motion,
    home: Home | None = None,
    frames: int = 12,
    path: Path | str = "contact-sheet.png",
    yaw: float = 0.8,
    size: tuple[int, int] = (240, 320),
) -> Path:
    """Draw evenly spaced frames of a motion, left to right and top to bottom, and save them as a PNG.

    `yaw` is where the camera stands around the body, in the world: 0 looks at the face of a body that faces +Z.
    """
    chosen = np.linspace(0, len(motion) - 1, frames).round().astype(int)
    props = [] if home is None else home_props(home)
    joints = motion.joint_positions()
    pictures = []
    for frame in chosen:
        x, y, z = (float(v) for v in motion.root_positions[frame])
        camera = orbit((x, max(0.35, 0.9 * y), z), 4.2, yaw, 0.25, fov=0.58)
        room = None if home is None else home.room_at((x, z))
        solids = around(props, camera, joints[frame], room)
        pictures.append(render([*body_solids(motion, [frame]), *solids], camera, size))
    return save_png(tile(pictures, columns=min(frames, 6)), path)


def tile(pictures: Sequence[Image], columns: int) -> Image:
    """Pictures of one size side by side, white where the last row ends early."""
    missing = [np.full_like(pictures[0], 255)] * (-len(pictures) % columns)
    cells = [*pictures, *missing]
    return np.concatenate([np.concatenate(cells[i : i + columns], axis=1) for i in range(0, len(cells), columns)])


def save_png(picture: NDArray[np.uint8], path: Path | str) -> Path:
    """Write a picture; the folder must be there."""
    from matplotlib.image import imsave

    imsave(path, picture)
    return Path(path)
