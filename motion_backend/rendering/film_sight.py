"""Whether a camera really sees a body, or furniture, lamps and walls hide it, and how good a picture that makes: by
what is nearest in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import skin
from motion_backend.motion import FPS, Motion, PhaseKind
from motion_backend.props import PropTrack, prop_points
from motion_backend.rendering.film_cuts import Framing, Subject
from motion_backend.rendering.rasterizer import Camera, Real
from motion_backend.rendering.renderer import Solid, nearest_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

HEIGHT: Final = 120
"""Pixels of the picture that is looked at."""
EVERY: Final = {Subject.BODY: 8, Subject.FACE: 16, Subject.HANDS: 16}
"""Frames between two looks; from near little happens."""
SPARSE: Final = 3
"""Of how many vertices one is asked whether it is seen."""
SLACK: Final = {Subject.BODY: 0.06, Subject.FACE: 0.06, Subject.HANDS: 0.015}
"""Metres that a body may be behind what hides it: it sinks into cushions, and pixels are large; a hand round a corner
is hidden by it."""
NEAREST: Final = 0.06
"""Metres before the eye from which on anything is seen."""
ASKED: Final = {Subject.BODY: (0.4, 0.5), Subject.FACE: (0.0, 0.7), Subject.HANDS: (0.0, 0.25)}
"""The shares of the near side of a body, and of its head or of its hands, from which they count as shown: who sits
behind a table is."""
COVERED: Final = 0.25
"""The same of a head whose face does something: the hands of who weeps are before it."""
ENOUGH: Final = 0.96
"""The share of looks in which it is."""
HALF_HIDDEN: Final = 0.6
"""The same, if that is the price for a face."""
HANDED: Final = 0.5
"""How much of the hands that do something is to be seen, as a share of what is seen of them with nothing before."""
FACED: Final = {Subject.BODY: 0.20, Subject.FACE: 0.30, Subject.HANDS: 0.20}
"""How much of a face is to be seen, as a share of what is seen of it from the front: a profile is 0.4."""
FRONT: Final = 0.40
"""How far forward the skin of a face looks, at least: the cosine."""
STRAIGHT, ENOUGH_FACE, BESIDE_DEED = 0.8, 0.75, 0.45
"""The share of a face's skin that is seen from the front, foreshortened; what of that is enough, and what is
where hands do something."""
LOOKS: Final = 4
"""Bodies at which faces and hands are looked at, about."""
FACE_SLACK: Final = 0.03
"""Metres that a face may be behind what hides it."""
STANDS: Final = 0.3
"""The share of looks in which nobody walks from which on a face must be seen."""
CROWDED: Final = 0.12
"""The share of a picture that may be of what is much nearer than the body: a wall, the back of a screen."""
MUCH: Final = 0.6
"""From which share of the way to the body on nothing is much nearer."""
APPEALS: Final = (2.0, 1.2, 1.2)
"""What it counts to see all of the near side of a body, of its head or hands, and of what is held."""
TO_FACE, TO_DEED = 3.0, 2.5
"""What it counts to see all of a face that must be seen, and of the hands that do what is done."""
VEILED: Final = 3.0
"""What it counts to have all of a body behind things for a second: behind a thin lamp is a fourth of it."""
VOID: Final = 8.0
"""What it counts to have nothing but what is outside of a home in the picture."""
BEFORE: Final = 0.86
"""Up to which share of the way to the body something is in the foreground,"""
LOW, TALL = 0.3, 0.8
"""from which height on (metres), and from which wholly: a rug is not, a bed hardly, a wardrobe is."""
FOREGROUND: Final = 14.0
"""What it counts to have nothing but foreground in the picture."""
RING: Final = (1.15, 2.3)
"""From how many radii of a head on, and up to how many, what is behind it is looked at,"""
CHIN: Final = 0.4
"""and how many below its middle."""
JUMP: Final = 0.08
"""The share of its distance by which one thing is nearer than what is beside it: there is an edge between them."""
CLUTTERED: Final = 0.2
"""The share of edges about a head from which on it is in a clutter: a lampshade stands on it like a hat."""
CLUTTER: Final = 0.9
"""What that counts."""
LEGS: Final = tuple(INDEX[f"{side}_{name}"] for side in ("left", "right") for name in ("hip", "knee", "ankle", "foot"))
"""What crowds a picture of a face as furniture does, at any distance: the knees of who sleeps curled up."""


@dataclass(frozen=True)
class Look:
    """What a camera shows of some bodies."""

    shown: float
    """The share of frames in which enough of the body and its part is seen; less where the picture is crowded."""
    appeal: float
    """How much of them is seen, in what surroundings: counts as the scores of `camera` do."""
    faced: bool = True
    """Whether the face is seen where it must be."""
    handed: bool = True
    """Whether the hands are seen that do something."""

    @property
    def rank(self) -> tuple[bool, ...]:
        """What of two views decides before all else: one without the face, or the hand that does what is done, is taken
        only where there is none with it."""
        half, both = self.shown >= HALF_HIDDEN, self.faced and self.handed
        return self.enough and both, half and both, half and self.faced, self.enough

    @property
    def enough(self) -> bool:
        """Whether the bodies are hidden for no more than a moment."""
        return self.shown >= ENOUGH


@dataclass(frozen=True)
class Appearances:
    """Bodies of some frames of a motion, as a camera may see them."""

    vertices: NDArray[np.float32]
    """(T, V, 3)."""
    normals: NDArray[np.float32]
    """(T, V, 3)."""
    areas: Array
    """How much skin is around each vertex. (V,)."""
    part: NDArray[np.bool_]
    """Which vertices are the head's, or of hands that are looked at the hands'. (V,)."""
    head: NDArray[np.bool_]
    """Which vertices are the head's. (V,)."""
    legs: NDArray[np.bool_]
    """Which vertices are the legs'. (V,)."""
    aspect: float
    """How many times pictures are as wide as high."""
    faces: NDArray[np.integer]
    """(F, 3) triangles of the body."""
    subject: Subject = Subject.BODY
    face: NDArray[np.bool_] | None = None
    """Which vertices look forward from a head. (V,); None for a body whose face nobody asks for."""
    watched: NDArray[np.bool_] | None = None
    """In which frames the face must be seen. (T,)."""
    hand: NDArray[np.bool_] | None = None
    """Which vertices are the hands' that do what is done. (V,)."""
    doing: NDArray[np.bool_] | None = None
    """In which frames they do. (T,)."""
    held: tuple[Array, ...] = ()
    """Points of what is in the hands, (N, 3) each, of as many frames; N may be none."""
    of_face: bool = False
    """Whether it is a deed of the face."""
    profile: bool = False
    """Whether a face is asked for no more than in profile, beside what it looks at."""

    @staticmethod
    def of(motion: Motion, framing: Framing, aspect: float, props: Sequence[PropTrack] = ()) -> Appearances:
        """The bodies of some frames of a motion, with what they hold."""
        frames, mesh = np.arange(framing.start, framing.stop, EVERY[framing.subject]), build_mannequin(motion.skeleton)
        vertices, normals = skin(mesh, motion.skeleton, motion.root_positions[frames], motion.local_rotations[frames])
        corners = mesh.vertices[mesh.faces].astype(np.float64)
        whole = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        areas = np.zeros(len(mesh.vertices))
        np.add.at(areas, mesh.faces, whole[:, None])
        part = np.isin(mesh.joints[:, 0], framing.hands if framing.subject is Subject.HANDS else INDEX["head"])
        head, legs = (np.isin(mesh.joints[:, 0], joints) for joints in (INDEX["head"], LEGS))
        held = tuple(prop_points(props, frame) for frame in frames.tolist()) if props else ()
        hand, doing = _doing(mesh.joints[:, 0], framing, frames)
        return Appearances(
            vertices, normals, areas, part, head, legs, aspect, mesh.faces, framing.subject,
            head & (mesh.normals[:, 2] > FRONT), _watched(motion, framing, frames), hand, doing, held, framing.of_face,
        )  # fmt: skip

    @cached_property
    def size(self) -> tuple[int, int]:
        """Pixels of a picture that is looked at."""
        return round(HEIGHT * self.aspect), HEIGHT

    @cached_property
    def most(self) -> float:
        """The appeal of the best picture that there may be of them."""
        body, part, held = APPEALS
        parts = [held * any(len(points) for points in self.held)]
        parts += [TO_FACE * _is_asked(self.face, self.watched), TO_DEED * _is_asked(self.hand, self.doing)]
        return body + part + sum(parts)

    def look(self, scene: Sequence[Solid], camera: Camera) -> Look:
        """What a camera shows of the bodies in a home."""
        return self._picture(scene, camera).look()

    def shares(self, scene: Sequence[Solid], camera: Camera) -> Array:
        """How much of each body's near side, and of its part's, is in the picture with nothing before it. (T, 2).

        What is looked at from near other limbs may hide as well.
        """
        return self._picture(scene, camera).shares

    def _picture(self, scene: Sequence[Solid], camera: Camera) -> _Picture:
        return _Picture(self, camera, *nearest_of(scene, camera, self.size))


@dataclass(frozen=True)
class _Picture:
    """Some bodies in a home as a camera sees them."""

    bodies: Appearances
    camera: Camera
    near: Real
    """How near what is nearest of the home is, minus infinity for nothing. (height, width)."""
    inside: NDArray[np.bool_]
    """Where that is not outside of it. (height, width)."""
    drawn: dict[int, tuple[NDArray[np.float32], NDArray[np.int32]]] = field(default_factory=dict)
    """Those that were drawn into it; see `_with_body`."""

    def look(self) -> Look:
        """What it shows of the bodies."""
        bodies, camera, shares = self.bodies, self.camera, self.shares
        asked = (0.0, COVERED) if bodies.of_face else ASKED[bodies.subject]
        seen = (shares >= asked).all(axis=1)
        before = float((self.near > 1.0 / (MUCH * np.linalg.norm(np.subtract(camera.eye, camera.target)))).mean())
        if bodies.subject is Subject.FACE:
            before += self._legs_share()
        shown = float(np.mean(seen)) - max(before - CROWDED, 0.0)
        body, part, held = APPEALS
        appeal = float(shares.mean(axis=0) @ (body, part)) + held * self._held_share()
        appeal -= FOREGROUND * self._foreground() + CLUTTER * self._clutter()
        appeal -= VOID * float((~self.inside).mean()) + VEILED * self._veiled()
        deed = self._deed_share()
        handed = deed is None or deed >= HANDED
        appeal += TO_DEED * (deed or 0.0)
        face = self._face_share()
        if face is None:
            return Look(shown, appeal, handed=handed)
        profile = bodies.profile or (bodies.doing is not None and bodies.doing.any())
        enough = BESIDE_DEED if profile else ENOUGH_FACE
        return Look(shown, appeal + TO_FACE * min(face / enough, 1.0), face >= FACED[bodies.subject], handed)

    @cached_property
    def shares(self) -> Array:
        """As `Appearances.shares`."""
        bodies, camera = self.bodies, self.camera
        shares = np.zeros((len(bodies.vertices), 2))
        for frame, (points, normals) in enumerate(zip(bodies.vertices, bodies.normals, strict=True)):
            some, eye = points[::SPARSE], np.asarray(camera.eye, dtype=np.float32)
            turned = np.einsum("vk,vk->v", normals[::SPARSE], eye - some) > 0
            before = self.near if bodies.subject is Subject.BODY else self._with_body(frame)[0]
            seen = self._seen(before, some[turned].astype(np.float64), SLACK[bodies.subject])
            area, own = bodies.areas[::SPARSE][turned], bodies.part[::SPARSE][turned]
            for part, weights in enumerate((area, area * own)):
                shares[frame, part] = weights @ seen / max(weights.sum(), 1e-9)
        return shares

    def _with_body(self, frame: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """How near what is nearest is with a body too, and which triangle of the body it is, or -1.
        (height, width) each."""
        from motion_backend.rendering.depth_buffer import draw_body

        if frame not in self.drawn:
            best, nearest = self.near.astype(np.float32), np.full(self.near.shape, -1, dtype=np.int32)
            viewed = self.camera.view(self.bodies.vertices[frame].astype(np.float64))
            points = self.camera.project(viewed, self.bodies.size)
            if points[:, 2].min() > 0:
                draw_body(points, self.bodies.faces, nearest, best)
            self.drawn[frame] = best, nearest
        return self.drawn[frame]

    def _legs_share(self) -> float:
        """The share of the pictures that legs fill, in the mean."""
        legs = np.append(self.bodies.legs[self.bodies.faces].all(axis=1), False)
        frames = range(len(self.bodies.vertices))
        return float(np.mean([legs[self._with_body(frame)[1]].mean() for frame in frames]))

    def _face_share(self) -> float | None:
        """How much of the face is seen in the mean of the frames in which it must be, as a share of what is from the
        front; None where it need not."""
        bodies = self.bodies
        if bodies.face is None or bodies.watched is None or not bodies.watched.any():
            return None
        weights, found = bodies.areas[bodies.face], []
        for frame in _some(bodies.watched):
            own = bodies.vertices[frame][bodies.face].astype(np.float64)
            towards = np.asarray(self.camera.eye) - own
            cosine = np.einsum("vk,vk->v", bodies.normals[frame][bodies.face], towards)
            cosine /= np.linalg.norm(towards, axis=1)
            seen = self._seen(self._with_body(frame)[0], own, FACE_SLACK)
            found.append(float((weights * np.clip(cosine, 0.0, 1.0)) @ seen / weights.sum()) / STRAIGHT)
        return float(np.mean(found))

    def _deed_share(self) -> float | None:
        """How much of the hands that do what is done is seen, with the body and all else that may be before them; None
        where none does anything."""
        bodies = self.bodies
        if bodies.hand is None or bodies.doing is None or not bodies.hand.any() or not bodies.doing.any():
            return None
        found = []
        for frame in _some(bodies.doing):
            own = bodies.vertices[frame][bodies.hand].astype(np.float64)
            found.append(float(self._seen(self._with_body(frame)[0], own, SLACK[Subject.HANDS]).mean()))
        # Of a hand that nothing hides the half that is turned away is.
        return min(2.0 * float(np.mean(found)), 1.0)

    def _veiled(self) -> float:
        """How much of a body things hide in the worst second."""
        return _worst(
            [
                1.0 - float(self._seen(self.near, points[::SPARSE].astype(np.float64), SLACK[Subject.BODY]).mean())
                for points in self.bodies.vertices
            ],
            EVERY[self.bodies.subject],
        )

    def _held_share(self) -> float:
        """How much of what is held is in the picture with nothing before it, in the mean and in the worst second; none
        where nothing is held."""
        shares = [
            float(self._seen(self._with_body(frame)[0], held, SLACK[Subject.HANDS]).mean())
            for frame, held in enumerate(self.bodies.held)
            if len(held)
        ]
        if not shares:
            return 0.0
        return (
            float(np.mean(shares)) + 1.0 - _worst([1.0 - share for share in shares], EVERY[self.bodies.subject])
        ) / 2

    def _seen(self, before: Real, points: Array, slack: float) -> NDArray[np.bool_]:
        """Which points (N, 3) of a home are in the picture, and not so far behind what is nearest. (N,)."""
        viewed = self.camera.view(points)
        viewed[:, 2] = np.maximum(viewed[:, 2] - slack, NEAREST)
        width, height = self.bodies.size
        x, y, nearness = np.moveaxis(self.camera.project(viewed, (width, height)), -1, 0)
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        column, row = (np.clip(value, 0, most - 1).astype(int) for value, most in ((x, width), (y, height)))
        return np.asarray(inside & (before[row, column] <= nearness))

    def _foreground(self) -> float:
        """The share of the picture that things between camera and body fill, those that stand high."""
        (width, height), camera = self.bodies.size, self.camera
        middle = camera.view(self.bodies.vertices.reshape(-1, 3).mean(axis=0, dtype=np.float64))[2]
        nearer = self.near > 1.0 / (BEFORE * max(float(middle), NEAREST))
        if not nearer.any():
            return 0.0
        rows, _ = np.nonzero(nearer)
        slope = (0.5 * height - rows - 0.5) * 2.0 * np.tan(0.5 * camera.fov) / height
        tall = camera.eye[1] + (slope * camera.axes[1, 1] + camera.axes[2, 1]) / self.near[nearer]
        return float(np.clip((tall - LOW) / (TALL - LOW), 0.0, 1.0).sum()) / (width * height)

    def _clutter(self) -> float:
        """How many edges of things there are about the head, beside and above it: 0 for none, 1 for a clutter."""
        (width, height), camera, vertices = self.bodies.size, self.camera, self.bodies.vertices
        distance = 1.0 / np.maximum(self.near, 1e-3)
        edges = np.zeros(self.near.shape, dtype=bool)
        edges[:, 1:] |= np.abs(np.diff(distance, axis=1)) > JUMP * np.minimum(distance[:, 1:], distance[:, :-1])
        edges[1:] |= np.abs(np.diff(distance, axis=0)) > JUMP * np.minimum(distance[1:], distance[:-1])
        found = []
        for points in vertices[:: max(len(vertices) // 3, 1)]:
            head = points[self.bodies.head].astype(np.float64)
            middle, radius = head.mean(axis=0), float(np.ptp(head[:, 1])) / 2
            x, y, nearness = camera.project(
                np.maximum(camera.view(middle), [-np.inf, -np.inf, NEAREST]), (width, height)
            )
            radius *= height / (2.0 * np.tan(0.5 * camera.fov)) * nearness
            across, down = np.arange(width) + 0.5 - x, np.arange(height)[:, None] + 0.5 - y
            away = np.hypot(across, down) / radius
            ring = (away > RING[0]) & (away < RING[1]) & (down < CHIN * radius)
            found.append(float(edges[ring].mean()) if ring.any() else 0.0)
        return min(float(np.mean(found)) / CLUTTERED, 1.0)


def _is_asked(part: NDArray[np.bool_] | None, when: NDArray[np.bool_] | None) -> bool:
    """Whether a part (V,) is to be seen in any frames (T,)."""
    return part is not None and when is not None and bool(part.any() and when.any())


def _some(wanted: NDArray[np.bool_]) -> list[int]:
    """A few of the frames that are wanted (T,)."""
    found: list[int] = np.flatnonzero(wanted)[:: max(1, wanted.sum() // LOOKS)].tolist()
    return found


def _worst(hidden: Sequence[float], every: int) -> float:
    """How much is hidden in the worst second, of how much is in looks that are so many frames apart."""
    long = max(1, min(len(hidden), round(FPS / every)))
    return float(np.convolve(hidden, np.full(long, 1.0 / long), "valid").max())


def _watched(motion: Motion, framing: Framing, frames: NDArray[np.integer]) -> NDArray[np.bool_]:
    """In which frames nobody walks, or hands do what it is about; in none where that is but a moment. (T,)."""
    walks = [(frames >= p.start) & (frames < p.stop) for p in motion.phases if p.kind is PhaseKind.WALK]
    first, stop = framing.deed or (0, 0)
    watched = ~np.any([np.zeros(len(frames), dtype=bool), *walks], axis=0) | ((frames >= first) & (frames < stop))
    return watched if watched.mean() >= STANDS else np.zeros(len(frames), dtype=bool)


def _doing(
    joints: NDArray[np.integer], framing: Framing, frames: NDArray[np.integer]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which vertices, by their joints (V,), are the hands' that do what is done, and in which frames. (V,) and (T,)."""
    doing = np.zeros(len(frames), dtype=bool)
    if framing.deed is not None:
        first, stop = framing.deed
        doing = (frames >= first) & (frames < stop)
        doing[np.abs(frames - (first + stop) // 2).argmin()] = True
    return np.isin(joints, framing.hands), doing
