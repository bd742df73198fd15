"""What the parts of a body weigh, and where its centre of mass is.

Shares and centres are those of Zatsiorsky and Seluyanov as adjusted to joint centres by P. de Leva, Journal of
Biomechanics 29 (1996) 1223-1230, table 4, the mean of its women and men. Its three parts of the trunk meet at the navel
and at the tip of the breastbone, 0.16 and 0.37 m above the hips of a body of 1.70 m: each is carried by the joint of
ours that is nearest below its centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motion_backend import rotations
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Segment:
    """A rigid part of the body: the joint that carries it, its share of the mass, its centre in the joint's frame."""

    joint: str
    share: float
    centre: Vector
    """Metres at 1.70 m."""


def _pair(joint: str, share: float, centre: Vector) -> tuple[Segment, Segment]:
    mirrored = (-centre[0], centre[1], centre[2])
    return Segment(f"left_{joint}", share, centre), Segment(f"right_{joint}", share, mirrored)


SEGMENTS = (
    Segment("pelvis", 0.1182, (0.0, 0.073, 0.0)),
    Segment("spine2", 0.1549, (0.0, 0.043, 0.0)),
    Segment("spine3", 0.1571, (0.0, 0.130, 0.0)),
    Segment("head", 0.0681, (0.0, 0.050, 0.010)),
    *_pair("shoulder", 0.0263, (0.168, 0.0, 0.0)),
    *_pair("elbow", 0.0150, (0.113, 0.0, 0.0)),
    *_pair("wrist", 0.0058, (0.066, 0.0, 0.0)),
    *_pair("hip", 0.1447, (0.0, -0.160, 0.0)),
    *_pair("knee", 0.0457, (0.0, -0.183, 0.0)),
    *_pair("ankle", 0.0133, (0.0, -0.035, 0.048)),
)
_CARRIERS = [INDEX[segment.joint] for segment in SEGMENTS]
_CENTRES = np.array([segment.centre for segment in SEGMENTS])
_SHARES = np.array([segment.share for segment in SEGMENTS])
_SHARES = _SHARES / _SHARES.sum()
"""The printed shares leave 0.01 % over."""


def centres_of_mass(skeleton: Skeleton, positions: Array, world: Array) -> Array:
    """Centre of mass of a body in T frames. World positions (T, 22, 3) and rotations (T, 22, 4) to (T, 3) metres."""
    placed = positions[:, _CARRIERS] + rotations.rotate(world[:, _CARRIERS], _CENTRES * skeleton.scale)
    return np.asarray(np.einsum("tsx,s->tx", placed, _SHARES))
