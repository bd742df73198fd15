"""Where to look: the frames that tell what a stretch of motion does, and a camera that sees them well in the home."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import Motion, Skill
from motion_backend.rendering.hand_deed import HANDS, Blow, from_hanging
from motion_backend.rendering.rasterizer import Camera, orbit
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from motion_backend.walls import Side
from scene_graphs.layout import Placed
from scene_graphs.meshes.furniture_mesh import parts_of

if TYPE_CHECKING:
    from scene_graphs.home import Home


HUNG = frozenset({"ceiling_lamp", "pendant_lamp"})
"""Furniture that hangs from a ceiling, which no picture has, and goes with it where it is before a body."""
FOV = 0.62
PITCH = 0.36
"""About 20 degrees from above."""
YAWS = np.linspace(-np.pi, np.pi, 16, endpoint=False)
CURTAIN = 0.20
"""How far into a room what hangs before a window may reach (metres)."""
STRIDE = 0.62
"""Metres the root goes between two poses of a walk in one picture."""
SEEN = [INDEX[n] for n in ("pelvis", "head", "spine3", "left_knee", "right_knee", "left_foot", "right_foot")]
"""Joints that a picture should show, with the hands."""
HIDDEN, BLOCKED, AT_WINDOW, INDOORS = 2.5, 3.0, 2.0, 0.3
"""What counts how much: a body that is hidden, an eye within furniture, a curtain, an eye in the body's room."""
HELD = 0.15
"""And to have what is held on the camera's side of the body."""
WORKED_AT = 0.12
"""What a body is as near to is part of what it does (metres)."""
CLOSE = 0.4
"""Metres in front of an eye that are free of furniture."""
NEAR_HAND, IN_IT, ABOVE_HAND = 0.25, 0.08, 0.08
"""Metres from a wrist at most to the side of what it touches, from before and from within, and by which that goes on
above it: what a hand lies on or in does not stand before it."""
FLAT = 0.35
"""The cosine between a front and a look at it up to which it is the better seen, the straighter it is looked at."""
BESIDE = np.radians(80.0)
"""How far round from straight before a front one sees it yet, and the profile of who stands at it."""
FRONT = 2.0
"""What it counts to see that well the front of what is touched."""


@dataclass(frozen=True)
class Shot:
    """The frame a picture shows and the frames it hints at."""

    frame: int
    ghosts: tuple[int, ...] = ()
    touch: tuple[int, int] | None = None
    """The frame in which something is touched, and the wrist that does it."""


def choose_frames(motion: Motion, joints: NDArray[np.floating], start: int, stop: int, skill: Skill) -> Shot:
    """What to show of frames start to stop (exclusive); joints are the motion's world positions (T, 22, 3)."""
    if skill is Skill.LOCO:
        return _along_the_way(motion.root_positions, start, stop)
    if skill is Skill.TOUCH:
        blow = Blow.of(np.asarray(joints, dtype=np.float64), start, stop)
        return _at_full_reach(joints, start, stop) if blow is None else _at_height(joints, blow)
    height = joints[start:stop, INDEX["head"], 1]
    left = np.abs(height - np.median(height[-8:]))  # metres the head has yet to go down or up
    if left.max() < 0.1:
        return Shot((start + stop) // 2)
    ghosts = tuple(start + int(np.flatnonzero(left > share * left.max())[-1]) for share in (0.85, 0.4))
    settled = start + int(np.flatnonzero(left > 0.03 * left.max())[-1])
    return Shot((settled + 2 * (stop - 1)) // 3, ghosts)


def _along_the_way(roots: NDArray[np.floating], start: int, stop: int) -> Shot:
    steps = np.linalg.norm(np.diff(roots[start:stop, [0, 2]], axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    if way[-1] < STRIDE:
        return Shot(start + (stop - start) // 2)
    middle = way[-1] / 2
    poses = [middle + k * STRIDE for k in (-2, -1, 1, 2) if 0.0 <= middle + k * STRIDE <= way[-1]]
    frames = [start + int(np.searchsorted(way, at)) for at in (middle, *poses)]
    frames = [min(frame, stop - 1) for frame in frames]
    return Shot(frames[0], tuple(sorted(set(frames[1:]))))


def _at_height(joints: NDArray[np.floating], blow: Blow) -> Shot:
    """A blow where its hand is the higher of drawn and there, with a ghost of the other: nobody sees one in a hand that
    lies where it hit."""
    low, high = sorted((blow.drawn, blow.hit), key=lambda frame: float(joints[frame, blow.hand, 1]))
    return Shot(high, (low,), (blow.hit, blow.hand))


def _at_full_reach(joints: NDArray[np.floating], start: int, stop: int) -> Shot:
    scores = from_hanging(np.asarray(joints[start:stop]))  # (frames, hands)
    score = scores.max(axis=1)
    longest = np.flatnonzero(score > score.max() - 0.08)
    frame = int(longest[len(longest) // 2])
    touch = start + frame, HANDS[int(scores[frame].argmax())]
    pelvis = joints[start:stop, 0][:, [0, 2]]
    away = np.flatnonzero(np.linalg.norm(pelvis[:frame] - pelvis[frame], axis=1) > STRIDE)
    return Shot(start + frame, (start + int(away[-1]),) if len(away) else (), touch)


def choose_camera(
    home: Home | None,
    motion: Motion,
    joints: NDArray[np.floating],
    shot: Shot,
    aspect: float,
    held: NDArray[np.floating] | None = None,
) -> Camera:
    """A camera about 20 degrees above with all poses in the picture, no furniture in the way, the face in view and the
    front of what is touched; of two like ones the one before which what is `held` there (N, 3) lies nearer than the
    body."""
    poses = np.asarray(joints[[shot.frame, *shot.ghosts]], dtype=np.float64)
    low, high = poses.min(axis=(0, 1)), poses.max(axis=(0, 1)) + np.array([0, 0.12, 0])
    low[1] = min(low[1], 0.0)
    x, y, z = (float(v) for v in (low + high) / 2)
    half_width = 0.5 * float(np.hypot(high[0] - low[0], high[2] - low[2])) + 0.3
    half_height = 0.5 * float(high[1] - low[1]) + 0.15
    distance = max(half_height, half_width / aspect) / np.tan(FOV / 2) + 0.5 * half_width
    distance = max(distance, 3.0)
    cameras = [orbit((x, y, z), distance, float(yaw), PITCH, FOV) for yaw in YAWS]
    wanted = liking(motion, shot)
    if held is not None and len(held):
        aside = held.mean(axis=0) - joints[shot.frame, INDEX["spine3"]]
        wanted += HELD * np.cos(YAWS - np.arctan2(aside[0], aside[2]))
    if home is not None:
        sight = Sight.at(home, (x, z), distance + 1.0)
        wanted += [sight.score(camera, poses[:1]) for camera in cameras]
        front = None if shot.touch is None else sight.front(np.asarray(joints[shot.touch], dtype=np.float64))
        if front is not None:
            wanted += [FRONT * front.seen(camera) for camera in cameras]
    return cameras[int(np.argmax(np.round(wanted, 4)))]


@dataclass(frozen=True)
class Front:
    """What a hand touches that stands up before it: the door of a cabinet, a wall."""

    place: Array
    """Of the hand. (3,)."""
    outward: Array
    """From it to where one sees it. (3,)."""

    def seen(self, camera: Camera) -> float:
        """How well a camera sees it: 1 for well, 0 for edgewise, less from behind."""
        way = np.asarray(camera.eye) - self.place
        return float(np.clip(way @ self.outward / np.linalg.norm(way) / FLAT, -1.0, 1.0))

    @property
    def beside(self) -> tuple[float, float]:
        """Yaws from which it and the face of who stands at it are seen."""
        before = float(np.arctan2(self.outward[0], self.outward[2]))
        return before - BESIDE, before + BESIDE


@dataclass(frozen=True)
class Sight:
    """What around a place of a home hides a body there from cameras, or is in their own way."""

    home: Home
    room: int | None
    """That of the place."""
    pieces: tuple[Placed, ...]
    """Furniture,"""
    near: Boxes
    """and its parts."""
    sides: tuple[Side, ...]
    """Walls,"""
    against: tuple[tuple[Side, ...], ...]
    """and those that each piece stands tall against."""

    @staticmethod
    def at(home: Home, place: tuple[float, float], reach: float, body: Array | None = None) -> Sight:
        """Around a place [x, z], with the furniture within reach (metres); what joints (N, 3) of a `body` are at stays
        where a wall behind it is left away."""
        there = (o for o in home.objects if o.category not in HUNG)  # which is left away before a body
        near = tuple(o for o in there if np.hypot(o.position[0] - place[0], o.position[2] - place[1]) < reach)
        sides = tuple(side for wall in home.walls if (side := Side.of(wall, home)) is not None)
        against = tuple(
            () if body is not None and is_at(placed, body) else tuple(side for side in sides if side.bears(placed))
            for placed in near
        )
        return Sight(home, home.room_at(place), near, Boxes.of(near), sides, against)

    def score(self, camera: Camera, poses: Array) -> float:
        """How well a camera shows poses (P, 22, 3), whichever side of them it sees."""
        eye = np.asarray(camera.eye)
        seen = 1.0 - self.hidden(camera, poses[:, [*SEEN, *HANDS]].reshape(-1, 3))
        score = HIDDEN * seen + INDOORS * self.indoors(camera) - BLOCKED * self.blocked(camera)
        return score - AT_WINDOW * self._at_a_window(eye)

    def hidden(self, camera: Camera, points: Array) -> float:
        """The share of points (N, 3) that furniture hides from a camera: what stands tall against a wall that the
        camera looks through is left away with it."""
        eye = np.asarray(camera.eye)
        gone = [any(not side.faces(eye[[0, 2]]) for side in walls) for walls in self.against]
        return float(self.near.but(np.flatnonzero(gone)).hide(eye, points).mean())

    def shows(self, camera: Camera, corners: Array, side: Side) -> float:
        """How much of an opening a camera sees: the share of its corners (N, 3) that no furniture hides, counted by
        how straight it is looked at; none of it from behind its wall."""
        eye = np.asarray(camera.eye)
        if not side.faces(eye[[0, 2]]):
            return 0.0
        across = float(camera.axes[2][[0, 2]] @ side.outward)
        free = 1.0 - self.hidden(camera, corners)
        return free * float(np.sqrt(np.clip(abs(across), 0.0, 1.0)))

    def front(self, hand: Array) -> Front | None:
        """What a hand (3,) touches, if that stands up before it."""
        here = hand[[0, 2]]
        walls = [(side.distance(here), -np.insert(side.outward, 1, 0.0)) for side in self.sides if side.faces(here)]
        tall = [
            _side_of(one, hand)
            for one in self.pieces
            if one.position[1] < hand[1] < one.position[1] + one.size[1] - ABOVE_HAND
        ]
        away, outward = min([*tall, *walls], key=lambda one: one[0], default=(np.inf, np.zeros(3)))
        return Front(hand, outward) if away < NEAR_HAND else None

    def blocked(self, camera: Camera) -> bool:
        """Whether the eye is within furniture, or right before some."""
        return self.hidden(camera, np.asarray(camera.eye) + CLOSE * camera.axes[2:]) > 0

    def indoors(self, camera: Camera) -> bool:
        """Whether the eye is in the room of the place."""
        return self.room is not None and self.home.room_at((camera.eye[0], camera.eye[2])) == self.room

    def _at_a_window(self, eye: Array) -> bool:
        """Whether it is so near to a wall, on its room's side, that curtains may hang before it."""
        return any(side.faces(eye[[0, 2]]) and side.distance(eye[[0, 2]]) < CURTAIN for side in self.sides)


def is_at(placed: Placed, points: NDArray[np.floating]) -> bool:
    """Whether any of the points (N, 3) of a body are at a piece of furniture."""
    here, half = placed.to_local(points.astype(np.float64)), np.array(placed.size) / 2
    away = np.maximum(np.abs(here - [0.0, half[1], 0.0]) - half, 0.0)
    return bool(np.linalg.norm(away, axis=1).min() < WORKED_AT)


def _side_of(placed: Placed, hand: Array) -> tuple[float, Array]:
    """How far before the nearest side of a piece of furniture a hand (3,) is, infinitely far where it is in it, and
    which way that side looks. (3,)."""
    here = placed.to_local(hand) * [1.0, 0.0, 1.0]
    out = np.abs(here) - np.array([placed.size[0], np.inf, placed.size[2]]) / 2
    side = np.arange(3) == out.argmax()
    outward = placed.to_world(side * np.sign(here)) - np.asarray(placed.position)
    return np.inf if out.max() < -IN_IT else float(np.linalg.norm(np.maximum(out, 0.0))), outward


def liking(motion: Motion, shot: Shot, yaws: Array = YAWS) -> Array:
    """How much each yaw shows of the body: three-quarter views of a face, long sides of who lies or walks. (N,)."""
    turn = motion.local_rotations[shot.frame, 0].astype(np.float64)
    ahead, up = rotations.rotate(turn, np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]))
    if abs(up[1]) < 0.5:
        along = np.arctan2(up[0], up[2])
        return np.asarray(np.abs(np.sin(yaws - along)) * 0.6)
    facing = np.arctan2(ahead[0], ahead[2])
    best = 1.2 if shot.ghosts else 0.8
    return np.asarray(np.cos(np.abs(rotations.wrap(yaws - facing)) - best) * 0.6)


def outermost(points: Array) -> Array:
    """Those of some points (N, 3) between which all others lie: what holds these in its picture holds all. (M, 3)."""
    from scipy.spatial import ConvexHull

    return np.asarray(points[ConvexHull(points, qhull_options="QJ").vertices])


def visible_share(objects: Sequence[Placed], eye: tuple[float, float, float], points: Array) -> float:
    """The share of points (N, 3) that no part of the objects hides from the eye."""
    return float(1.0 - Boxes.of(objects).hide(np.asarray(eye), points).mean())


@dataclass(frozen=True)
class Boxes:
    """The parts of furniture as boxes, each in the frame of its piece."""

    low: Array
    high: Array
    """(B, 1, 3) each."""
    origin: Array
    """Where the pieces stand. (B, 3)."""
    turn: Array
    """Their frames: a vector v of the home is turn @ v. (B, 3, 3)."""
    piece: NDArray[np.integer]
    """The number of the piece of each. (B,)."""

    @staticmethod
    def of(objects: Sequence[Placed]) -> Boxes:
        """All parts of some pieces."""
        numbered = [(number, part) for number, placed in enumerate(objects) for part in parts_of(placed)]
        parts = [(objects[number], part) for number, part in numbered]
        cos, sin = (np.array([wave(placed.yaw) for placed, _ in parts]) for wave in (np.cos, np.sin))
        turn = np.zeros((len(parts), 3, 3))
        turn[:, 0, 0], turn[:, 0, 2], turn[:, 2, 0], turn[:, 2, 2], turn[:, 1, 1] = cos, -sin, sin, cos, 1.0
        low = np.array([part.low for _, part in parts]).reshape(-1, 1, 3)
        high = np.array([part.high for _, part in parts]).reshape(-1, 1, 3)
        origin = np.array([placed.position for placed, _ in parts]).reshape(-1, 3)
        return Boxes(low, high, origin, turn, np.array([number for number, _ in numbered], dtype=np.int64))

    def but(self, pieces: NDArray[np.integer]) -> Boxes:
        """The same without those of some pieces."""
        left = ~np.isin(self.piece, pieces)
        return Boxes(self.low[left], self.high[left], self.origin[left], self.turn[left], self.piece[left])

    def wider(self, metres: float) -> Boxes:
        """The same, by so much to every side."""
        return replace(self, low=self.low - metres, high=self.high + metres)

    def hide(self, eye: Array, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Which points (N, 3) lie behind any of them, seen from an eye. (N,)."""
        start = np.einsum("bij,bj->bi", self.turn, eye - self.origin)[:, None]
        ray = np.einsum("bij,nj->bni", self.turn, points - eye)
        ray = np.where(np.abs(ray) < 1e-9, 1e-9, ray)
        first, last = (self.low - start) / ray, (self.high - start) / ray  # (boxes, points, 3)
        enter, leave = np.minimum(first, last).max(axis=-1), np.maximum(first, last).min(axis=-1)
        # A hand on a table is not hidden by it: what ends within the last hundredths does not count.
        return np.asarray(((enter < leave) & (leave > 0) & (enter < 0.97)).any(axis=0))
