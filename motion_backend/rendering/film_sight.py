"""Whether a camera really sees a body, or furniture, lamps and walls hide it: by what is nearest in the picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import skin
from motion_backend.motion import Motion
from motion_backend.rendering.film_cuts import Framing, Subject
from motion_backend.rendering.rasterizer import Camera, Real
from motion_backend.rendering.renderer import Solid, nearness_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

HEIGHT: Final = 120
"""Pixels of the picture that is looked at."""
EVERY: Final = {Subject.BODY: 6, Subject.FACE: 16, Subject.HANDS: 16}
"""Frames between two looks; from near little happens."""
SLACK: Final = {Subject.BODY: 0.06, Subject.FACE: 0.06, Subject.HANDS: 0.015}
"""Metres that a body may be behind what hides it: it sinks into cushions, and pixels are large; a hand round a corner
is hidden by it."""
NEAREST: Final = 0.06
"""Metres before the eye from which on anything is seen."""
ASKED: Final = {Subject.BODY: (0.4, 0.5), Subject.FACE: (0.0, 0.7), Subject.HANDS: (0.0, 0.25)}
"""The shares of the near side of a body, and of its head or of its hands, from which they count as shown: who sits
behind a table is."""
ENOUGH: Final = 0.96
"""The share of looks in which it is."""
CROWDED: Final = 0.12
"""The share of a picture that may be of what is much nearer than the body: a wall, the back of a screen."""
MUCH: Final = 0.6
"""From which share of the way to the body on nothing is much nearer."""
LEGS: Final = tuple(INDEX[f"{side}_{name}"] for side in ("left", "right") for name in ("hip", "knee", "ankle", "foot"))
"""What crowds a picture of a face as furniture does, at any distance: the knees of who sleeps curled up."""


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
    legs: NDArray[np.bool_]
    """Which vertices are the legs'. (V,)."""
    aspect: float
    """How many times pictures are as wide as high."""
    faces: NDArray[np.integer]
    """(F, 3) triangles of the body."""
    subject: Subject = Subject.BODY

    @staticmethod
    def of(motion: Motion, framing: Framing, aspect: float) -> Appearances:
        """The bodies of some frames of a motion."""
        frames, mesh = np.arange(framing.start, framing.stop, EVERY[framing.subject]), build_mannequin(motion.skeleton)
        vertices, normals = skin(mesh, motion.skeleton, motion.root_positions[frames], motion.local_rotations[frames])
        corners = mesh.vertices[mesh.faces].astype(np.float64)
        whole = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        areas = np.zeros(len(mesh.vertices))
        np.add.at(areas, mesh.faces, whole[:, None])
        part = np.isin(mesh.joints[:, 0], framing.hands if framing.subject is Subject.HANDS else INDEX["head"])
        legs = np.isin(mesh.joints[:, 0], LEGS)
        return Appearances(vertices, normals, areas, part, legs, aspect, mesh.faces, framing.subject)

    @cached_property
    def size(self) -> tuple[int, int]:
        """Pixels of a picture that is looked at."""
        return round(HEIGHT * self.aspect), HEIGHT

    def near(self, scene: Sequence[Solid], camera: Camera) -> Real:
        """How near what is nearest of a home is, minus infinity for nothing. (height, width)."""
        width, height = self.size
        return nearness_of(scene, camera, self.size) if scene else np.full((height, width), -np.inf)

    def shares(self, scene: Sequence[Solid], camera: Camera) -> Array:
        """How much of each body's near side, and of its part's, is in the picture with nothing before it. (T, 2).

        What is looked at from near other limbs may hide as well.
        """
        return self._shares(self.near(scene, camera), camera)

    def _shares(self, near: Real, camera: Camera) -> Array:
        width, height = self.size
        shares = np.zeros((len(self.vertices), 2))
        for frame, (points, normals) in enumerate(zip(self.vertices, self.normals, strict=True)):
            turned = np.einsum("vk,vk->v", normals, np.asarray(camera.eye, dtype=np.float32) - points) > 0
            viewed = camera.view(points[turned].astype(np.float64))
            viewed[:, 2] = np.maximum(viewed[:, 2] - SLACK[self.subject], NEAREST)
            x, y, nearness = np.moveaxis(camera.project(viewed, self.size), -1, 0)
            inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
            column, row = (np.clip(value, 0, most - 1).astype(int) for value, most in ((x, width), (y, height)))
            before = near if self.subject is Subject.BODY else self._with_body(near, points, camera)[0]
            seen = inside & (before[row, column] <= nearness)
            for part, weights in enumerate((self.areas[turned], self.areas[turned] * self.part[turned])):
                shares[frame, part] = weights @ seen / max(weights.sum(), 1e-9)
        return shares

    def _with_body(
        self, near: Real, points: NDArray[np.float32], camera: Camera
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """How near what is nearest is with a body (V, 3) too, and which triangle of the body it is, or -1.
        (height, width) each."""
        from motion_backend.rendering.depth_buffer import draw_body

        best, nearest = near.astype(np.float32), np.full(near.shape, -1, dtype=np.int32)
        drawn = camera.project(camera.view(points.astype(np.float64)), self.size)
        if drawn[:, 2].min() > 0:
            draw_body(drawn, self.faces, nearest, best)
        return best, nearest

    def _legs_share(self, near: Real, camera: Camera) -> float:
        """The share of the pictures that legs fill, in the mean."""
        legs = np.append(self.legs[self.faces].all(axis=1), False)
        return float(np.mean([legs[self._with_body(near, points, camera)[1]].mean() for points in self.vertices]))

    def shown(self, scene: Sequence[Solid], camera: Camera) -> float:
        """The share of frames in which enough of the body and its part is seen; less where what is much nearer fills
        the picture, or legs that of a face."""
        near = self.near(scene, camera)
        seen = (self._shares(near, camera) >= ASKED[self.subject]).all(axis=1)
        before = float((near > 1.0 / (MUCH * np.linalg.norm(np.subtract(camera.eye, camera.target)))).mean())
        if self.subject is Subject.FACE:
            before += self._legs_share(near, camera)
        return float(np.mean(seen)) - max(before - CROWDED, 0.0)

    @staticmethod
    def enough(shown: float) -> bool:
        """Whether a body is hidden for no more than a moment."""
        return shown >= ENOUGH
