"""How deep what is seen of a body is in what is seen of a home: the mannequin's skin in drawn furniture and walls.

The body of `penetration` is 15 capsules and its furniture is boxes; here both are what a film shows. It is sampled:
some frames a second, and every third point of the skin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from motion_backend.body import capsules
from motion_backend.body.mannequin_mesh import build_mannequin
from motion_backend.body.skinning import SkinnedMesh, skin
from motion_backend.metrics.penetration import CLEARLY_IN, cushion, lies
from motion_backend.motion import Action, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, PARENTS, Skeleton

EVERY: Final = 10
"""One frame of so many is looked at,"""
POINTS: Final = 3
"""and one point of the skin of so many, which are about a centimetre apart."""
THIN: Final = 2 * CLEARLY_IN
"""Nothing is clearly inside what is thinner than this (metres)."""


class Shape(Protocol):
    """A solid of the home (scene_graphs/meshes/convex_shapes.py)."""

    @property
    def owner(self) -> str:
        """Object id, or that it is a wall."""
        ...

    @property
    def low(self) -> Array:
        """(3,) least corner of the box around it."""
        ...

    @property
    def high(self) -> Array:
        """(3,) greatest corner."""
        ...

    def depth(self, points: Array) -> Array:
        """How deep points (N, 3) are in it. (N,)."""
        ...


@dataclass(frozen=True)
class SkinDepth:
    """How deep the skin was in the frames that were looked at."""

    depths: Array
    """(F,) metres, cushion allowed for; 0 where nothing is inside anything."""

    @property
    def share(self) -> float:
        """Of the frames, those in which it is deeper than 2 cm."""
        return float((self.depths > CLEARLY_IN).mean()) if len(self.depths) else 0.0

    @property
    def most(self) -> float:
        """Metres."""
        return float(self.depths.max(initial=0.0))


def skin_penetration(motion: Motion, action: Action | None, shapes: Sequence[Shape]) -> SkinDepth:
    """Depth of the deepest point of the skin in every tenth frame; who sits or lies may sink into what is used."""
    frames = slice(min(EVERY // 2, len(motion) - 1), None, EVERY)
    sampled = _sampled_skin(motion.skeleton)
    points = skin(sampled, motion.skeleton, motion.root_positions[frames], motion.local_rotations[frames])[0]
    bodies = _bodies_of(sampled)
    low, high = points.min(axis=1), points.max(axis=1)  # (F, 3)
    deepest = np.zeros(len(points))
    for shape in shapes:
        for frame in np.flatnonzero(((low < shape.high) & (high > shape.low)).all(axis=1)):
            own = points[frame]
            inside = np.flatnonzero(((own > shape.low) & (own < shape.high)).all(axis=1))
            if len(inside):
                allowed = _allowed(action, shape.owner, lies(motion))[bodies[inside]]
                deepest[frame] = max(deepest[frame], (shape.depth(own[inside].astype(np.float64)) - allowed).max())
    return SkinDepth(deepest)


def _allowed(action: Action | None, owner: str, lying: bool) -> Array:
    """How deep each of the 15 bodies may be in a piece. (15,) metres."""
    return np.array([cushion(action, owner, body.name, lying) for body in capsules.BODIES])


@lru_cache(maxsize=8)
def _sample_of(height: float) -> SkinnedMesh:
    from motion_backend.skeleton import build_skeleton

    mesh = build_mannequin(build_skeleton(height))
    every = slice(None, None, POINTS)
    return replace(
        mesh,
        vertices=mesh.vertices[every],
        normals=mesh.normals[every],
        joints=mesh.joints[every],
        weights=mesh.weights[every],
        faces=mesh.faces[:0],
        face_materials=mesh.face_materials[:0],
    )


def _sampled_skin(skeleton: Skeleton) -> SkinnedMesh:
    return _sample_of(round(skeleton.scale * 1.70, 6))


def _bodies_of(mesh: SkinnedMesh) -> NDArray[np.int64]:
    """Which of the 15 bodies each point of the skin is of: that of its joint, or of the nearest above it. (V,)."""
    own = {INDEX[body.joint]: number for number, body in enumerate(capsules.BODIES)}
    carried = [own.get(joint, -1) for joint in range(len(JOINTS))]
    for joint, parent in enumerate(PARENTS):
        if carried[joint] < 0:
            carried[joint] = carried[parent]
    strongest = mesh.joints[np.arange(len(mesh.joints)), mesh.weights.argmax(axis=1)]
    return np.asarray(np.array(carried)[strongest])
