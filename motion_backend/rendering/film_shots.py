"""A motion as a film's shots: where to cut, and a camera that stands still and sees what is done until the next cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import Motion, PhaseKind
from motion_backend.rendering.camera import FOV, HANDS, SEEN, Shot, at_a_window, liking, visible_share
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rotations import wrap
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home
    from scene_graphs.layout import Placed

SHORTEST, LONGEST = 1.6, 7.0
"""Seconds a shot lasts."""
FARTHEST: Final = 3.2
"""Metres the body goes in one shot: who goes farther is followed by another camera."""
YAWS: Final = np.linspace(-np.pi, np.pi, 16, endpoint=False)
PITCHES: Final = (0.16, 0.34)
"""From above, in radians: near the eyes of who stands, and over low furniture."""
NEAREST: Final = 2.3
"""Metres from the middle of what is seen."""
BACK: Final = 1.06
"""How much farther away the next camera is tried where a body does not fit."""
FRAME: Final = 0.84
"""The share of a picture that all of a body keeps within."""
SAMPLES: Final = 5
"""Frames of a shot that are looked at."""
CLOSE: Final = 0.4
"""Metres in front of an eye that are free of furniture."""
ALIKE: Final = 0.5
"""Radians; two cameras that differ by less look like a mistake and not like a cut."""
MARGIN: Final = 0.12
"""Metres around joints that skin and hair reach."""
FAR: Final = 0.08
"""What a metre of distance counts: faces are seen from near."""
BLOCKED, HIDDEN, AT_WINDOW, REPEATED, INDOORS = 3.0, 2.5, 2.0, 0.6, 0.3
"""What counts how much: an eye within furniture, a body that is hidden, a curtain, a jump cut, an eye in the room."""


@dataclass(frozen=True)
class FilmShot:
    """Frames start to stop (exclusive), seen by one camera."""

    start: int
    stop: int
    camera: Camera


def film_shots(home: Home, motion: Motion, starts: Sequence[int], aspect: float) -> list[FilmShot]:
    """The shots of a whole motion whose actions begin at these frames; pictures are `aspect` times as wide as high."""
    joints = motion.joint_positions().astype(np.float64)
    shots: list[FilmShot] = []
    for start, stop in _windows(motion, starts):
        before = shots[-1].camera if shots else None
        shots.append(FilmShot(start, stop, _camera(home, motion, joints, (start, stop), aspect, before)))
    return shots


def _windows(motion: Motion, starts: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Frames between cuts: at every action, where walking ends, and where one shot would be too long or go too far."""
    shortest = round(SHORTEST * motion.fps)
    walks = [p for p in motion.phases if p.kind is PhaseKind.WALK]
    edges = sorted({0, len(motion), *starts, *(p.start for p in walks), *(p.stop for p in walks)})
    cuts = [0]
    for edge in edges[1:-1]:
        if min(edge - cuts[-1], len(motion) - edge) >= shortest:
            cuts.append(edge)
    for start, stop in pairwise([*cuts, len(motion)]):
        pieces = np.linspace(start, stop, _pieces(motion, start, stop) + 1).round().astype(int)
        yield from pairwise(pieces.tolist())


def _pieces(motion: Motion, start: int, stop: int) -> int:
    steps = np.linalg.norm(np.diff(motion.root_positions[start:stop, [0, 2]], axis=0), axis=1)
    wanted = max((stop - start) / motion.fps / LONGEST, float(steps.sum()) / FARTHEST)
    return max(1, min(int(np.ceil(wanted)), int((stop - start) / motion.fps / SHORTEST)))


def _camera(
    home: Home,
    motion: Motion,
    joints: NDArray[np.float64],
    window: tuple[int, int],
    aspect: float,
    before: Camera | None,
) -> Camera:
    """The camera that sees most of a body, its face and hands, from the room it is in, and unlike the one before."""
    frames = np.unique(np.linspace(window[0], window[1] - 1, SAMPLES).round().astype(int))
    points = joints[frames].reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = ((low + high) / 2).tolist()
    near = [o for o in home.objects if np.hypot(o.position[0] - x, o.position[2] - z) < 6.0]
    room = home.room_at((x, z))
    sides = [side for wall in home.walls if (side := Side.of(wall, home)) is not None]
    shown = liking(motion, Shot(int(frames[len(frames) // 2])))
    best, most = None, -np.inf
    for pitch in PITCHES:
        for index, yaw in enumerate(YAWS.tolist()):
            camera = _fitted((x, y, z), yaw, pitch, points, aspect)
            eye = np.asarray(camera.eye)
            seen = np.mean([visible_share(near, camera.eye, joints[frame, SEEN + HANDS]) for frame in frames])
            score = float(shown[index]) + HIDDEN * float(seen)
            score += INDOORS * (room is not None and home.room_at((camera.eye[0], camera.eye[2])) == room)
            score -= AT_WINDOW * at_a_window(sides, eye) + BLOCKED * _blocked(near, camera)
            score -= FAR * float(np.linalg.norm(eye - np.array([x, y, z])))
            score -= REPEATED * (before is not None and _alike(camera, before))
            if score > most + 1e-6:
                best, most = camera, score
    assert best is not None
    return best


def _fitted(
    target: tuple[float, float, float], yaw: float, pitch: float, points: NDArray[np.float64], aspect: float
) -> Camera:
    """As near as all points, with the skin around them, stay well within the picture."""
    distance = NEAREST
    while True:
        camera = orbit(target, distance, yaw, pitch, FOV)
        viewed = camera.view(points)
        depth = viewed[:, 2]
        high = depth * np.tan(FOV / 2) * FRAME - MARGIN
        wide = depth * np.tan(FOV / 2) * FRAME * aspect - MARGIN
        if depth.min() > MARGIN and (np.abs(viewed[:, 1]) <= high).all() and (np.abs(viewed[:, 0]) <= wide).all():
            return camera
        distance *= BACK


def _blocked(objects: Sequence[Placed], camera: Camera) -> bool:
    """Whether an eye is within a piece of furniture, or so near to it that it fills the picture."""
    return visible_share(objects, camera.eye, np.asarray(camera.eye)[None] + CLOSE * camera.axes[2:]) < 1


def _alike(one: Camera, other: Camera) -> bool:
    yaws = [float(np.arctan2(*np.subtract(c.eye, c.target)[[0, 2]])) for c in (one, other)]
    return abs(float(wrap(np.array(yaws[0] - yaws[1])))) < ALIKE
