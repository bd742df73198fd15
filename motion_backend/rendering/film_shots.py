"""A motion as a film's shots: a camera that stands still and sees what is done until the next cut, near or far.

Views are scored by what can be told quickly, then looked through in that order: the first is taken in which nothing
hides what it is about for more than a moment. What is seen from near stands between two parts of one shot of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion
from motion_backend.rendering.camera import FOV, YAWS, Shot, liking
from motion_backend.rendering.film_cuts import Cut, Framing, Subject, film_cuts
from motion_backend.rendering.film_entrance import Entrance
from motion_backend.rendering.film_set import FilmSet
from motion_backend.rendering.film_sight import Appearances
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import Array, wrap
from motion_backend.skeleton import INDEX

if TYPE_CHECKING:
    from scene_graphs.home import Home

PITCHES: Final = (0.16, 0.34)
"""From above, in radians: near the eyes of who stands, and over low furniture."""
CLOSE_PITCHES: Final = (0.06, 0.30, 0.60, 0.95)
"""The same from near: who lies is looked at from higher up."""
NEAREST: Final = 2.3
"""Metres from the middle of what is seen."""
CLOSEST: Final = {Subject.FACE: 1.25, Subject.HANDS: 1.2}
"""The same from near."""
NO_LONGER_NEAR: Final = 2.6
"""Metres from which on a look from near shows no more than one of the whole: who stoops moves head and hand far."""
FRAME: Final = 0.84
"""The share of a picture that all of a body keeps within."""
SAMPLES: Final = 5
"""Frames of a shot that are looked at."""
ALIKE: Final = 0.5
"""Radians; two cameras that differ by less look like a mistake and not like a cut."""
MARGIN: Final = 0.12
"""Metres around joints that skin and hair reach."""
FINGERS, CROWN = 0.17, 0.16
"""Metres that a hand reaches beyond its wrist, and a head beyond its joint."""
FAR: Final = 0.08
"""What a metre of distance counts: faces are seen from near."""
REPEATED: Final = 0.6
"""What a jump cut counts."""
REVERSED: Final = 0.4
"""What it counts to go on from the other side, where who went to the right goes to the left."""
SIDE: Final = 0.3
"""From how much of a body's turn across the picture on it has a side."""
FACED, WIDEST = 1.2, 1.2
"""What it counts to see a face, best at a quarter turned, and the turn in radians from which it is none."""
WIDEST_NEAR: Final = {Subject.FACE: WIDEST, Subject.HANDS: 2.0}
"""The turn from which nothing is looked at from near: of a face nothing is seen, of a hand a back before it."""
ALONG: Final = 0.8
"""What it counts to look along an arm, of which then nothing is seen."""
FROM_INSIDE: Final = 1.0
"""What it counts to be in the room, from near."""
AT_DOOR: Final = 3.0
"""What it counts in the first shot to see the door by which somebody comes in."""
TRIES: Final = 12
"""Views of a shot that are looked through."""


@dataclass(frozen=True)
class FilmShot:
    """Frames start to stop (exclusive), seen by one camera."""

    start: int
    stop: int
    camera: Camera
    scene: Sequence[Solid]
    """What it sees of the home; the same object for all parts of one shot."""
    subject: Subject = Subject.BODY


def film_shots(
    home: Home, motion: Motion, starts: Sequence[int], aspect: float, role: Role = PLAIN
) -> Iterator[FilmShot]:
    """The shots of a whole motion whose actions begin at these frames; pictures are `aspect` times as wide as high.

    Each is chosen when it is asked for, while the one before is being drawn. The role says where moods change.
    """
    positions, turns = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    joints = positions.astype(np.float64)
    director = _Director(motion, joints, turns, FilmSet.of(home), aspect)
    before: Camera | None = None
    for cut in film_cuts(motion, joints, starts, role):
        whole = director.shot(cut.start, cut.stop, before)
        for part in _parts(cut, whole, director):
            yield part
            before = part.camera


def _parts(cut: Cut, whole: FilmShot, director: _Director) -> Iterator[FilmShot]:
    """A shot of the whole, with what is worth it seen from near, if any camera sees that."""
    close = director.close_up(cut.close, whole.camera) if cut.close is not None else None
    if close is None:
        yield whole
        return
    for start, stop in ((cut.start, close.start), (close.stop, cut.stop)):
        if start == close.stop:
            yield close
        if stop > start:
            yield FilmShot(start, stop, whole.camera, whole.scene)


@dataclass(frozen=True)
class _Director:
    """What shots are chosen from."""

    motion: Motion
    joints: Array
    """Of the whole motion, in the world. (T, 22, 3)."""
    turns: Array
    """Their rotations. (T, 22, 4)."""
    set: FilmSet
    aspect: float

    def shot(self, start: int, stop: int, before: Camera | None) -> FilmShot:
        """The best view, unlike the one before, in which the body is hidden for no more than a moment, else least."""
        return self._best(Framing(start, stop), self._views(start, stop, before))[0]

    def close_up(self, close: Framing, before: Camera) -> FilmShot | None:
        """The same from near; None where something hides it from all cameras, or is in the way of all."""
        views = self._near(close, before)
        if not views:
            return None
        shot, enough = self._best(close, views)
        return shot if enough else None

    def _best(self, framing: Framing, views: Sequence[Camera]) -> tuple[FilmShot, bool]:
        """The first of some views that shows enough, else the one that shows most; and whether it is enough."""
        start, stop = framing.start, framing.stop
        bodies = Appearances.of(self.motion, framing, self.aspect)
        best, most = None, -np.inf
        for camera in views[:TRIES]:
            scene = self.set.seen(camera, self.joints[start:stop])
            found = FilmShot(start, stop, camera, scene, framing.subject)
            shown = bodies.shown(found.scene, camera)
            if shown > most:
                best, most = found, shown
            if bodies.enough(shown):
                break
        assert best is not None
        return best, bodies.enough(most)

    def _views(self, start: int, stop: int, before: Camera | None) -> list[Camera]:
        """Cameras that have all of the body in the picture, best first: near, of its face, hands and feet."""
        frames = _sampled(start, stop)
        poses = self.joints[frames]
        entrance = Entrance.of(self.set.home, self.motion) if start == 0 else None
        points = poses.reshape(-1, 3)
        if entrance is not None:
            points = np.concatenate([points, entrance.corners])
        sight = self.set.sight(_middle(points))
        liked = liking(self.motion, Shot(int(frames[len(frames) // 2])))
        scored = []
        for pitch in PITCHES:
            for index, yaw in enumerate(YAWS.tolist()):
                camera = _fitted(yaw, pitch, points, self.aspect, NEAREST)
                score = float(liked[index]) + sight.score(camera, poses)
                score -= FAR * _distance(camera)
                if entrance is not None:
                    score += AT_DOOR * sight.shows(camera, entrance.corners, entrance.side)
                scored.append((score - self._broken(camera, before, start), camera))
        return _sorted(scored)

    def _near(self, close: Framing, before: Camera) -> list[Camera]:
        """Cameras near a face, a quarter turned, or beside an arm that touches, with whose head and
        shoulders it is, best first; none is in furniture."""
        frames = _sampled(close.start, close.stop)
        poses, turns = self.joints[frames], self.turns[frames]
        hands = (
            poses[:, list(close.hands)].reshape(-1, 3) if close.subject is Subject.FACE else _arms(poses, close.hands)
        )
        # A hand without the one whose it is tells nothing of who does it, and how.
        points = np.concatenate([_head(poses, turns), hands])
        ahead = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))
        sight = self.set.sight(_middle(points))
        scored = []
        for pitch in CLOSE_PITCHES:
            for yaw in YAWS.tolist():
                camera = _fitted(yaw, pitch, points, self.aspect, CLOSEST[close.subject])
                if sight.blocked(camera) or _distance(camera) > NO_LONGER_NEAR:
                    continue
                towards = -camera.axes[2]
                if float(np.mean(_turns(ahead, towards))) > WIDEST_NEAR[close.subject]:
                    continue
                score = sight.score(camera, poses) + FROM_INSIDE * sight.indoors(camera) - 0.3 * pitch
                score += _faces(ahead, towards) * (1.0 if close.subject is Subject.FACE else 0.4)
                if close.subject is Subject.HANDS:
                    score -= ALONG * max(abs(float(arm @ towards)) for arm in _directions(poses, close.hands))
                scored.append((score - self._broken(camera, before, close.start), camera))
        return _sorted(scored)

    def _broken(self, camera: Camera, before: Camera | None, frame: int) -> float:
        """What the rules of cutting count against a camera: no jump from nearly the same place, nobody turns round."""
        if before is None:
            return 0.0
        ahead = rotations.rotate(self.turns[frame, 0], np.array([0.0, 0.0, 1.0]))
        now, then = (float(ahead @ one.axes[0]) for one in (camera, before))
        turned = min(abs(now), abs(then)) > SIDE and now * then < 0
        return REPEATED * _alike(camera, before) + REVERSED * turned


def _sampled(start: int, stop: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(start, stop - 1, SAMPLES).round().astype(np.int64))


def _middle(points: Array) -> tuple[float, float, float]:
    x, y, z = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    return x, y, z


def _sorted(scored: Sequence[tuple[float, Camera]]) -> list[Camera]:
    return [camera for _, camera in sorted(((round(score, 6), one) for score, one in scored), key=lambda two: -two[0])]


def _head(poses: Array, turns: Array) -> Array:
    """Crown, neck and shoulders. (N, 3)."""
    up = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 1.0, 0.0]))
    crown = poses[:, INDEX["head"]] + CROWN * up
    names = ("neck", "left_shoulder", "right_shoulder")
    return np.concatenate([crown, poses[:, [INDEX[name] for name in names]].reshape(-1, 3)])


def _arms(poses: Array, hands: Sequence[int]) -> Array:
    """Half of the forearm, wrist and fingers of each hand. (N, 3)."""
    wrists = poses[:, list(hands)]  # (P, H, 3)
    forearms = (poses[:, [hand - 2 for hand in hands]] + wrists) / 2
    fingers = wrists + FINGERS * np.stack(_directions(poses, hands))
    return np.concatenate([forearms, wrists, fingers]).reshape(-1, 3)


def _directions(poses: Array, hands: Sequence[int]) -> list[Array]:
    """Which way each forearm points, in the mean. (3,) each."""
    ways = [(poses[:, hand] - poses[:, hand - 2]).mean(axis=0) for hand in hands]
    return [way / max(float(np.linalg.norm(way)), 1e-9) for way in ways]


def _faces(ahead: Array, towards: Array) -> float:
    """How well a face that looks `ahead` (P, 3) is seen from where `towards` (3,) points to."""
    turn = _turns(ahead, towards)
    return FACED * float(np.mean(np.where(turn < WIDEST, np.cos(turn - 0.5), -1.0)))


def _turns(ahead: Array, towards: Array) -> Array:
    """The angles between where a face looks in some frames and one direction, radians. (P,)."""
    return np.asarray(np.arccos(np.clip(ahead @ towards, -1.0, 1.0)))


def _fitted(yaw: float, pitch: float, points: Array, aspect: float, nearest: float) -> Camera:
    """As near as all points (N, 3), with the skin around them, stay well within the picture."""
    target = _middle(points)
    across, up, ahead = np.moveaxis((points - target) @ orbit(target, 1.0, yaw, pitch).axes.T, -1, 0)
    wide = np.tan(FOV / 2) * FRAME
    # A point is within the picture where its distance to the axis, with skin, is at most `wide` times its depth.
    asked = [(np.abs(up) + MARGIN) / wide - ahead, (np.abs(across) + MARGIN) / (wide * aspect) - ahead, MARGIN - ahead]
    return orbit(target, max(nearest, float(np.max(asked))), yaw, pitch, FOV)


def _distance(camera: Camera) -> float:
    return float(np.linalg.norm(np.subtract(camera.eye, camera.target)))


def _alike(one: Camera, other: Camera) -> bool:
    yaws = [float(np.arctan2(*np.subtract(c.eye, c.target)[[0, 2]])) for c in (one, other)]
    return abs(float(wrap(np.array(yaws[0] - yaws[1])))) < ALIKE
