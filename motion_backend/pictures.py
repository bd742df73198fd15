"""Pictures of motions: the mannequin in its poses, the home around it, and rows of them over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend.mannequin import build_mannequin
from motion_backend.raster import Camera, orbit
from motion_backend.rendering import Image, Solid, render
from motion_backend.skinning import skin

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from scene_graphs.homes import Home

WALL_PREFIXES = ("wall", "door", "window", "ceiling", "frame")
"""How the names of meshes begin that may stand between the camera and the body."""


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
    """The room its middle lies in."""

    @property
    def is_wall(self) -> bool:
        """Whether it may be cut open to look inside."""
        return self.name.startswith(WALL_PREFIXES)


def home_props(home: Home) -> list[Prop]:
    """Everything of a home that can be drawn."""
    from scene_graphs.furnishing import home_meshes

    props = []
    for mesh in home_meshes(home):
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        middle = (float(low[0] + high[0]) / 2, float(low[2] + high[2]) / 2)
        solid = Solid(mesh.vertices, mesh.faces, mesh.color, opacity=0.25 if mesh.color[3] < 1 else 1.0)
        props.append(Prop(mesh.name, solid, low, high, home.room_at(middle)))
    return props


def around(props: Sequence[Prop], camera: Camera, room: int | None = None, reach: float = 4.5) -> list[Solid]:
    """What is within reach of the camera's target, cut open where walls or other rooms' things are before the room."""
    target = np.asarray(camera.target)
    distance = float(np.linalg.norm(target - camera.eye))
    shown = []
    for prop in props:
        gap = np.maximum(np.maximum(prop.low - target, target - prop.high), 0.0)
        if np.hypot(gap[0], gap[2]) > reach:
            continue
        in_the_way = prop.is_wall or (room is not None and prop.room != room and prop.high[1] > 0.1)
        shown.append(replace(prop.solid, cut=distance - 0.5) if in_the_way else prop.solid)
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
    pictures = []
    for frame in chosen:
        x, y, z = (float(v) for v in motion.root_positions[frame])
        camera = orbit((x, max(0.35, 0.9 * y), z), 4.2, yaw, 0.25, fov=0.58)
        room = None if home is None else home.room_at((x, z))
        pictures.append(render([*body_solids(motion, [frame]), *around(props, camera, room)], camera, size))
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
