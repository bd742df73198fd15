"""Pictures of motions: the mannequin in its poses, the home around it, and rows of them over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend.mannequin import build_mannequin
from motion_backend.raster import Camera, orbit
from motion_backend.rendering import Image, Solid, render
from motion_backend.skinning import skin

if TYPE_CHECKING:
    from scene_graphs.homes import Home

    from motion_backend.motion import Motion

WALL_PREFIXES = ("wall", "door", "window", "ceiling", "frame")
"""How the names of meshes begin that may stand between the camera and the body."""


def body_solids(motion: Motion, frames: Sequence[int], opacity: float = 1.0) -> list[Solid]:
    """The mannequin at some frames of a motion."""
    mesh = build_mannequin(motion.skeleton)
    chosen = np.asarray(frames)
    vertices, normals = skin(mesh, motion.skeleton, motion.root_positions[chosen], motion.local_rotations[chosen])
    return [Solid(v, mesh.faces, mesh.face_colors, n, opacity=opacity) for v, n in zip(vertices, normals, strict=True)]


def home_solids(home: Home) -> list[tuple[str, Solid]]:
    """Everything of a home that can be drawn, with its name."""
    from scene_graphs.furnishing import home_meshes

    return [(mesh.name, Solid(mesh.vertices, mesh.faces, mesh.color[:3])) for mesh in home_meshes(home)]


def around(named: Sequence[tuple[str, Solid]], camera: Camera, reach: float = 4.5) -> list[Solid]:
    """What is within reach of the camera's target, with the walls in front of it cut open."""
    target = np.asarray(camera.target)
    distance = float(np.linalg.norm(target - camera.eye))
    shown = []
    for name, solid in named:
        low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
        gap = np.maximum(np.maximum(low - target, target - high), 0.0)
        if np.hypot(gap[0], gap[2]) > reach:
            continue
        shown.append(replace(solid, cut=distance - 0.5) if name.startswith(WALL_PREFIXES) else solid)
    return shown


def contact_sheet(
    motion: Motion,
    path: Path | str,
    home: Home | None = None,
    frames: int = 12,
    yaw: float = 0.8,
    size: tuple[int, int] = (240, 320),
) -> Path:
    """Draw evenly spaced frames of a motion, left to right and top to bottom, and save them as a PNG.

    `yaw` is where the camera stands around the body, in the world: 0 looks at the face of a body that faces +Z.
    """
    chosen = np.linspace(0, len(motion) - 1, frames).round().astype(int)
    named = [] if home is None else home_solids(home)
    pictures = []
    for frame in chosen:
        x, y, z = (float(v) for v in motion.root_positions[frame])
        camera = orbit((x, max(0.35, 0.9 * y), z), 4.2, yaw, 0.25, fov=0.58)
        pictures.append(render([*body_solids(motion, [frame]), *around(named, camera)], camera, size))
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
