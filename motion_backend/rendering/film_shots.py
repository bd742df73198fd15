"""A motion as a film's shots: where to cut, and a camera that stands still and sees what is done until the next cut.

Views are scored by what can be told quickly, then looked through in that order: the first is taken in which nothing
hides the body for more than a moment.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import Motion, PhaseKind
from motion_backend.rendering.camera import FOV, YAWS, Shot, Sight, liking
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.motion_figures import Prop, around, home_props
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import wrap

if TYPE_CHECKING:
    from scene_graphs.home import Home

SHORTEST, LONGEST = 1.6, 7.0
"""Seconds a shot lasts."""
FARTHEST: Final = 3.2
"""Metres the body goes in one shot: who goes farther is followed by another camera."""
PITCHES: Final = (0.16, 0.34)
"""From above, in radians: near the eyes of who stands, and over low furniture."""
NEAREST: Final = 2.3
"""Metres from the middle of what is seen."""
FRAME: Final = 0.84
"""The share of a picture that all of a body keeps within."""
SAMPLES: Final = 5
"""Frames of a shot that are looked at."""
ALIKE: Final = 0.5
"""Radians; two cameras that differ by less look like a mistake and not like a cut."""
MARGIN: Final = 0.12
"""Metres around joints that skin and hair reach."""
FAR: Final = 0.08
"""What a metre of distance counts: faces are seen from near."""
REPEATED: Final = 0.6
"""What a jump cut counts."""
STEP: Final = 15
"""Frames between two places of a body that walls may not hide."""
TRIES: Final = 12
"""Views of a shot that are looked through."""
REACH: Final = 7.0
"""Metres around what is seen that are drawn."""


@dataclass(frozen=True)
class FilmShot:
    """Frames start to stop (exclusive), seen by one camera."""

    start: int
    stop: int
    camera: Camera
    scene: Sequence[Solid]
    """What it sees of the home."""


def film_shots(home: Home, motion: Motion, starts: Sequence[int], aspect: float) -> Iterator[FilmShot]:
    """The shots of a whole motion whose actions begin at these frames; pictures are `aspect` times as wide as high.

    Each is chosen when it is asked for, while the one before is being drawn.
    """
    director = _Director(home, motion, motion.joint_positions().astype(np.float64), tuple(home_props(home)), aspect)
    before = None
    for start, stop in _windows(motion, starts):
        shot = director.shot(start, stop, before)
        yield shot
        before = shot.camera


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


@dataclass(frozen=True)
class _Director:
    """What shots are chosen from."""

    home: Home
    motion: Motion
    joints: NDArray[np.float64]
    """Of the whole motion, in the world. (T, 22, 3)."""
    props: tuple[Prop, ...]
    aspect: float

    def shot(self, start: int, stop: int, before: Camera | None) -> FilmShot:
        """The best view, unlike the one before, in which the body is hidden for no more than a moment, else least."""
        bodies = Appearances.of(self.motion, start, stop, self.aspect)
        best, most = None, -np.inf
        for camera in self._views(start, stop, before)[:TRIES]:
            found = FilmShot(start, stop, camera, self._scene(camera, start, stop))
            shown = bodies.shown(found.scene, camera)
            if shown > most:
                best, most = found, shown
            if bodies.enough(shown):
                break
        assert best is not None
        return best

    def _views(self, start: int, stop: int, before: Camera | None) -> list[Camera]:
        """Cameras that have all of the body in the picture, best first: near, of its face, hands and feet."""
        frames = np.unique(np.linspace(start, stop - 1, SAMPLES).round().astype(int))
        poses = self.joints[frames]
        points = poses.reshape(-1, 3)
        x, y, z = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
        sight = Sight.at(self.home, (x, z), REACH)
        liked = liking(self.motion, Shot(int(frames[len(frames) // 2])))
        scored = []
        for pitch in PITCHES:
            for index, yaw in enumerate(YAWS.tolist()):
                camera = _fitted((x, y, z), yaw, pitch, points, self.aspect)
                score = float(liked[index]) + sight.score(camera, poses)
                score -= FAR * float(np.linalg.norm(np.subtract(camera.eye, (x, y, z))))
                score -= REPEATED * (before is not None and _alike(camera, before))
                scored.append((round(score, 6), camera))
        return [camera for _, camera in sorted(scored, key=lambda one: -one[0])]

    def _scene(self, camera: Camera, start: int, stop: int) -> Sequence[Solid]:
        """What is drawn of the home, open in front like a doll's house."""
        x, _, z = self.joints[(start + stop) // 2, 0].tolist()
        points = self.joints[start:stop:STEP].reshape(-1, 3)
        return around(self.props, camera, points, self.home.room_at((x, z)), REACH)


def _fitted(
    target: tuple[float, float, float], yaw: float, pitch: float, points: NDArray[np.float64], aspect: float
) -> Camera:
    """As near as all points, with the skin around them, stay well within the picture."""
    across, up, ahead = np.moveaxis((points - target) @ orbit(target, 1.0, yaw, pitch).axes.T, -1, 0)
    wide = np.tan(FOV / 2) * FRAME
    # A point is within the picture where its distance to the axis, with skin, is at most `wide` times its depth.
    asked = [(np.abs(up) + MARGIN) / wide - ahead, (np.abs(across) + MARGIN) / (wide * aspect) - ahead, MARGIN - ahead]
    return orbit(target, max(NEAREST, float(np.max(asked))), yaw, pitch, FOV)


def _alike(one: Camera, other: Camera) -> bool:
    yaws = [float(np.arctan2(*np.subtract(c.eye, c.target)[[0, 2]])) for c in (one, other)]
    return abs(float(wrap(np.array(yaws[0] - yaws[1])))) < ALIKE
