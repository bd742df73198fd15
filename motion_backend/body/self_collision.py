"""How deep the parts of one body are in each other: arms in trunk, head and legs, and limbs in each other."""

from __future__ import annotations

from functools import cache

import numpy as np

from motion_backend.body import capsules
from motion_backend.rotations import Array, dot
from motion_backend.skeleton import Skeleton

_ARM, _LEG = ("upper_arm", "lower_arm", "hand"), ("thigh", "shin", "foot")
_TRUNK = ("pelvis", "torso", "head")


@cache
def pairs() -> tuple[tuple[str, str], ...]:
    """The capsules that must not be in each other; those that share a joint always are, and are left out.

    Each arm with trunk, head and both legs, the arms with each other, and the legs with each other.
    """
    arms = {side: [f"{side}_{part}" for part in _ARM] for side in ("left", "right")}
    legs = {side: [f"{side}_{part}" for part in _LEG] for side in ("left", "right")}
    every_arm, every_leg = arms["left"] + arms["right"], legs["left"] + legs["right"]
    found = [(arm, other) for arm in every_arm for other in (*_TRUNK, *every_leg)]
    found += [(left, right) for left in arms["left"] for right in arms["right"]]
    found += [(left, right) for left in legs["left"] for right in legs["right"]]
    return tuple(found)


def overlaps(skeleton: Skeleton, positions: Array, world: Array) -> Array:
    """Depth of each of P `pairs` in each other, 0 where they are apart. (T, 22, 3), (T, 22, 4) to (T, P) metres."""
    start, end, radii = capsules.placed(skeleton, positions, world)
    names = [body.name for body in capsules.BODIES]
    one, other = np.array([[names.index(name) for name in pair] for pair in pairs()]).T
    _, apart = closest(start[:, one], end[:, one], start[:, other], end[:, other])
    return np.asarray(np.maximum(radii[one] + radii[other] - np.linalg.norm(apart, axis=-1), 0.0))


def self_penetration(skeleton: Skeleton, positions: Array, world: Array) -> Array:
    """Depth of the deepest pair of each frame. (T,) metres."""
    return np.asarray(overlaps(skeleton, positions, world).max(axis=1, initial=0.0))


def deepest_pair(skeleton: Skeleton, positions: Array, world: Array) -> tuple[str, str]:
    """The two parts that are deepest in each other in any frame."""
    return pairs()[int(overlaps(skeleton, positions, world).max(axis=0).argmax())]


def closest(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array]:
    """Where on the segment ab it is nearest to cd, as a share (..., 1), and the way there from cd (..., 3) (Ericson,
    Real-Time Collision Detection, 5.1.9)."""
    first, second, between = b - a, d - c, a - c
    ff, ss, fs = (dot(u, v) for u, v in ((first, first), (second, second), (first, second)))
    fb, sb = dot(first, between), dot(second, between)
    on_first = np.clip((fs * sb - fb * ss) / np.maximum(ff * ss - fs**2, 1e-12), 0.0, 1.0)
    on_second = (fs * on_first + sb) / ss
    held = np.clip(on_second, 0.0, 1.0)
    on_first = np.where(held == on_second, on_first, np.clip((fs * held - fb) / ff, 0.0, 1.0))
    return on_first, np.asarray(between + on_first * first - held * second)
