"""Pictures of motions: the mannequin in its poses and the home around it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import PLAIN, Role
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import face_track
from motion_backend.body.skinning import SkinnedMesh, skin
from motion_backend.props import PropTrack, prop_tracks
from motion_backend.rendering.camera import HUNG, Boxes
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import Array
from motion_backend.walls import Side

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from scene_graphs.home import Home
    from scene_graphs.layout import Placed

HUNG_FREE: Final = 0.2
"""Metres about the lines from an eye to a body within which nothing hangs."""
HANGS: Final = "ceiling "
"""Before the names of what hangs from a ceiling."""
ON_WALLS, SHADOWLESS = ("wall", "door", "window"), ("wall", "door", "window", "ceiling")
"""How the names of meshes begin that are a wall, in one or on one, and of those that would darken a whole room."""


WORKED_AT = 0.12
"""What a body is as near to is part of what it does (metres)."""
REACH = 4.5
"""What is farther from the body, or from what a camera looks at, is of no picture of it (metres)."""


@dataclass(frozen=True)
class Acting:
    """Somebody acting a motion, ready to be drawn at any of its frames."""

    motion: Motion
    mesh: SkinnedMesh
    face: NDArray[np.floating]
    """Shares of what the face does. (T, K)."""
    props: tuple[PropTrack, ...] = ()
    """What is in the hands."""

    @staticmethod
    def of(motion: Motion, role: Role = PLAIN) -> Acting:
        """A motion with a look, a face and what is in the hands."""
        mesh, face = build_character(motion.skeleton, role.look), face_track(motion, role)
        return Acting(motion, mesh, face, prop_tracks(motion, role))

    def solids(self, frames: Sequence[int], opacity: float = 1.0, but: Collection[PropTrack] = ()) -> list[Solid]:
        """The body at some frames, each with what it holds and what lies about, `but` for some of that."""
        mesh, motion, chosen = self.mesh, self.motion, np.asarray(frames)
        poses = (motion.root_positions[chosen], motion.local_rotations[chosen])
        vertices, normals = skin(mesh, motion.skeleton, *poses, self.face[chosen])
        bodies = [
            _Triangles(points, turned, mesh.faces, mesh.face_colors)
            for points, turned in zip(vertices, normals, strict=True)
        ]
        shown = [track for track in self.props if all(track is not one for one in but)]
        whole = [_joined([body, *self._held(frame, shown)]) for frame, body in zip(frames, bodies, strict=True)]
        return [Solid(all_.vertices, all_.faces, all_.colors, all_.normals, opacity=opacity) for all_ in whole]

    def lying(self, start: int, stop: int) -> list[PropTrack]:
        """What lies somewhere from one frame to another and is not touched."""
        return [track for track in self.props if track.lies(start, stop)]

    def _held(self, frame: int, tracks: Sequence[PropTrack]) -> list[_Triangles]:
        """What is in the hands at a frame, or lies near."""
        found = []
        for track in tracks:
            now = frame - track.start
            if not 0 <= now < len(track.positions):
                continue
            away = np.linalg.norm(track.positions[now] - self.motion.root_positions[frame])
            if track.is_held(frame) or away < REACH:
                shape = track.shape
                moved = shape.moved(track.positions[now], track.turns[now], float(track.sizes[now]))
                found.append(_Triangles(*moved, shape.faces, shape.colors))
        return found


def lying_solids(tracks: Sequence[PropTrack], frame: int, camera: Camera, reach: float = REACH) -> list[Solid]:
    """What lies within reach of a camera's target at a frame."""
    found = []
    for track in tracks:
        now, shape = frame - track.start, track.shape
        if np.linalg.norm(track.positions[now] - np.asarray(camera.target)) < reach:
            vertices, normals = shape.moved(track.positions[now], track.turns[now], float(track.sizes[now]))
            found.append(Solid(vertices, shape.faces, shape.colors, normals))
    return found


class _Triangles(NamedTuple):
    """Vertices and normals (V, 3), faces (F, 3) and their colours (F, 3)."""

    vertices: NDArray[np.floating]
    normals: NDArray[np.floating]
    faces: NDArray[np.integer]
    colors: NDArray[np.floating]


def _joined(parts: Sequence[_Triangles]) -> _Triangles:
    """Several as one."""
    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    vertices, normals, colors = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("vertices", "normals", "colors")
    )
    return _Triangles(vertices, normals, np.concatenate(faces).astype(np.uint32), colors)


def body_solids(motion: Motion, frames: Sequence[int], opacity: float = 1.0, role: Role = PLAIN) -> list[Solid]:
    """The body at some frames of a motion."""
    return Acting.of(motion, role).solids(frames, opacity)


@dataclass(frozen=True)
class Borne:
    """A piece of furniture that stands tall against walls."""

    placed: Placed
    walls: tuple[Side, ...]

    def is_behind(self, eye: Array) -> bool:
        """Whether an eye (3,) is beyond one of the walls."""
        return any(not side.faces(eye[[0, 2]]) for side in self.walls)

    def is_worked_at(self, points: NDArray[np.floating]) -> bool:
        """Whether any of the points (N, 3) of a body are at it."""
        here, half = self.placed.to_local(points.astype(np.float64)), np.array(self.placed.size) / 2
        away = np.maximum(np.abs(here - [0.0, half[1], 0.0]) - half, 0.0)
        return bool(np.linalg.norm(away, axis=1).min() < WORKED_AT)


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
    stump: Solid | None = None
    """What is left of a wall where it would stand in the way."""
    borne: Borne | None = None
    """What it is part of, if that stands tall against a wall."""
    hung: Boxes | None = None
    """What it is part of, if that hangs from the ceiling."""

    def stands_before(self, camera: Camera, points: NDArray[np.floating], room: int | None) -> bool:
        """Whether a camera leaves it away to see points (N, 3) in a room, as a doll's house is open in front."""
        eye = np.asarray(camera.eye)
        if self.hung is not None and self.hung.hide(eye, points).any():
            return True
        if self.side is not None and self.side.crosses(eye[[0, 2]], points[:, [0, 2]]):
            return True
        if self.borne is not None and self.borne.is_behind(eye):
            return not self.borne.is_worked_at(points)
        if self.room == room:
            return self.side is not None and not self.side.faces(eye[[0, 2]])
        nearer = (np.asarray(camera.target) - (self.low + self.high) / 2) @ camera.axes[2]
        return bool(nearer > 0 and self.high[1] > 0.1)


def home_props(home: Home, but: Collection[str] = ()) -> list[Prop]:
    """Everything of a home that can be drawn `but` meshes of these names; walls, what hangs on them and lamps under
    the ceiling cast no shadow."""
    from scene_graphs.meshes.furniture_mesh import home_meshes
    from scene_graphs.meshes.interior_mesh import stump_meshes

    stumps = {
        mesh.name.replace("stump", "wall"): Solid(mesh.vertices, mesh.faces, mesh.color, casts=False, outside=True)
        for mesh in stump_meshes(home)
    }
    sides = [side for wall in home.walls if (side := Side.of(wall, home)) is not None]
    against = ((placed, tuple(side for side in sides if side.bears(placed))) for placed in home.objects)
    borne = {placed.id: Borne(placed, walls) for placed, walls in against if walls}
    hung = {placed.id: Boxes.of((placed,)).wider(HUNG_FREE) for placed in home.objects if placed.category in HUNG}
    props = []
    for mesh in (one for one in home_meshes(home) if one.name not in but):
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        middle = (float(low[0] + high[0]) / 2, float(low[2] + high[2]) / 2)
        hangs = bool(sides) and mesh.name.startswith(ON_WALLS)
        side = min(sides, key=lambda side: side.distance(np.array(middle))) if hangs else None
        opacity = 0.25 if mesh.color[3] < 1 else 1.0
        casts = not mesh.name.startswith(SHADOWLESS)
        solid = Solid(mesh.vertices, mesh.faces, mesh.color, opacity=opacity, casts=casts)
        room = side.room if side else home.room_at(middle)
        name = mesh.name.removeprefix(HANGS).partition(":")[0]
        props.append(
            Prop(mesh.name, solid, low, high, room, side, stumps.get(mesh.name), borne.get(name), hung.get(name))
        )
    return props


def around(
    props: Sequence[Prop],
    camera: Camera,
    points: NDArray[np.floating],
    room: int | None = None,
    reach: float = REACH,
) -> list[Solid]:
    """What is within reach of the camera's target, without what stands before the points (N, 3) of a body in a room:
    of a wall the foot is left, and what stands tall against it goes with it, unless the body is at that."""
    shown = []
    for prop in within_reach(props, camera, reach):
        if not prop.stands_before(camera, points, room):
            shown.append(prop.solid)
        elif prop.stump is not None:
            shown.append(prop.stump)
    return shown


def within_reach(props: Sequence[Prop], camera: Camera, reach: float) -> list[Prop]:
    """What is, at least in part, no farther from a camera's target."""
    target = np.asarray(camera.target)
    gaps = (np.maximum(np.maximum(prop.low - target, target - prop.high), 0.0) for prop in props)
    return [prop for prop, gap in zip(props, gaps, strict=True) if np.hypot(gap[0], gap[2]) <= reach]


def save_png(picture: NDArray[np.uint8], path: Path | str) -> Path:
    """Write a picture; the folder must be there."""
    from matplotlib.image import imsave

    imsave(path, picture)
    return Path(path)
