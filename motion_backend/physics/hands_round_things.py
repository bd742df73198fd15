"""Hands that a plan swings close by a board on their way to a touch are drawn back until they are past it.

A simulated hand is some centimetres behind its plan then: it would meet the board, and stay on its other side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.capsules import BODIES, Capsule
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import arm_rotations, two_bone
from motion_backend.motion import FPS
from motion_backend.physics.mjcf_character import SIDES
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

SWINGS: Final = 0.8
"""A hand that is quicker than this (m/s) swings."""
RESTS: Final = 0.1
"""A hand that is slower than this (m/s) rests: what it is at then is what it is to touch."""
NEAR: Final = 0.05
"""A hand this near to a thing (metres at 1.70 m) is at it, or in its swing too near."""
CLEAR: Final = 0.07
"""How far off a hand is that was drawn back (metres at 1.70 m)."""
BACK: Final = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
"""Shares of the way to the shoulder by which it is drawn back, the least that helps."""
EASES: Final = 5
"""Frames before and after in which that comes and goes."""


def hands_round_things(
    roots: Array, local: Array, reaching: NDArray[np.bool_], skeleton: Skeleton, things: Obstacles
) -> Array:
    """Local rotations (T, 22, 4) whose hands pass nothing on their way, of pelvises (T, 3) and rotations as planned;
    only where the body reaches for something (T,), and in the frames beside that."""
    if not reaching.any():
        return local
    positions, world = skeleton.forward_kinematics(roots, local)
    found = np.array(local)
    for side, sign in SIDES:
        shoulder, elbow, wrist = (INDEX[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
        at, middle, hand = (positions[:, joint].astype(np.float64) for joint in (shoulder, elbow, wrist))
        speed = np.linalg.norm(np.gradient(hand, axis=0), axis=-1) * FPS
        arm = _Arm(side, skeleton, things)
        rests, swings = np.flatnonzero(reaching & (speed < RESTS)), np.flatnonzero(reaching & (speed > SWINGS))
        arm = arm.but_what_is_at(middle[rests], hand[rests], world[rests, wrist])
        frames = swings[arm.depth(middle[swings], hand[swings], world[swings, wrist]) > -NEAR * skeleton.scale]
        if not len(frames):
            continue
        needed = np.zeros(len(roots))
        needed[frames] = arm.back(at[frames], middle[frames], hand[frames], world[frames, wrist])
        back = eased(needed, EASES) * _begun(reaching)
        frames = np.flatnonzero(back)
        limb = two_bone(
            at[frames], _drawn(at, hand, back[:, None])[frames], (middle - at)[frames], bones(skeleton, side)
        )
        upper, lower = arm_rotations(limb, int(sign))
        found[frames, shoulder] = rotations.compose(rotations.inverse(world[frames, INDEX[f"{side}_collar"]]), upper)
        found[frames, elbow] = rotations.compose(rotations.inverse(upper), lower)
        found[frames, wrist] = rotations.compose(rotations.inverse(lower), world[frames, wrist])
    return found


def _begun(reaching: NDArray[np.bool_]) -> Array:
    """From 0 where reaching begins to 1 some frames later (T,): the body is where it was until then. (T,)."""
    frames = np.arange(len(reaching))
    begins = reaching & ~np.concatenate([[False], reaching[:-1]])
    since = frames - np.maximum.accumulate(np.where(begins, frames, 0))
    share = np.minimum(since / EASES, 1.0)
    return np.asarray(np.where(np.maximum.accumulate(reaching), share**2 * (3 - 2 * share), 0.0))


@dataclass(frozen=True)
class _Arm:
    """A forearm and a hand among things."""

    side: str
    skeleton: Skeleton
    things: Obstacles

    def depth(self, elbow: Array, wrist: Array, turn: Array) -> Array:
        """How deep the outer half of the forearm, or the hand, is in anything (metres; negative: how far off); places
        (T, 3), the hand's turn (T, 4). (T,)."""
        each = self._in_each(elbow, wrist, turn)
        return np.asarray(each.max(axis=0)) if len(each) else np.full(len(wrist), -np.inf)

    def but_what_is_at(self, elbow: Array, wrist: Array, turn: Array) -> _Arm:
        """The same without what it is at in any of some frames."""
        at = np.asarray((self._in_each(elbow, wrist, turn) > -NEAR * self.skeleton.scale).any(axis=1))
        return replace(self, things=self.things.only(~at))

    def _in_each(self, elbow: Array, wrist: Array, turn: Array) -> Array:
        """(N, T) for N things."""
        scale = self.skeleton.scale
        fore, palm = (_CAPSULES[f"{self.side}_{name}"] for name in ("lower_arm", "hand"))
        start, end = (rotations.rotate(turn, np.array(one) * scale) for one in (palm.start, palm.end))
        places = [(elbow + share * (wrist - elbow), fore.radius) for share in (0.5, 0.75, 1.0)]
        places += [(wrist + start + share * (end - start), palm.radius) for share in (0.0, 0.5, 1.0)]
        count = len(self.things.owners)
        deep = [
            [self.things.inside(points, index) + radius * scale for points, radius in places] for index in range(count)
        ]
        return np.asarray(np.array(deep).reshape(count, len(places), len(wrist)).max(axis=1))

    def back(self, shoulder: Array, elbow: Array, wrist: Array, turn: Array) -> Array:
        """By which share of the way to the shoulder a hand is to be drawn back to be clear of things. (T,)."""
        depths, most = [], -CLEAR * self.skeleton.scale
        lengths = bones(self.skeleton, self.side)
        for share in BACK:
            target = _drawn(shoulder, wrist, share)
            limb = two_bone(shoulder, target, elbow - shoulder, lengths)
            depths.append(self.depth(shoulder + lengths[0] * limb.upper, target, turn))
        clear = np.array(depths) <= most
        best = np.where(clear.any(axis=0), clear.argmax(axis=0), np.argmin(depths, axis=0))
        return np.asarray(np.array(BACK)[best])


_CAPSULES: Final[dict[str, Capsule]] = {capsule.name: capsule for capsule in BODIES}


def _drawn(shoulder: Array, wrist: Array, share: float | Array) -> Array:
    return np.asarray(wrist + share * (shoulder - wrist))


def bones(skeleton: Skeleton, side: str) -> tuple[float, float]:
    """Lengths of an upper arm and a forearm (metres)."""
    upper, lower = (float(np.linalg.norm(skeleton.offsets[INDEX[f"{side}_{joint}"]])) for joint in ("elbow", "wrist"))
    return upper, lower


def eased(needed: Array, frames: int) -> Array:
    """As much as is needed in every frame (T,), or more: it comes and goes smoothly within so many frames."""
    padded = np.pad(needed, 2 * frames)
    most = np.lib.stride_tricks.sliding_window_view(padded, 2 * frames + 1).max(axis=1)
    bell = np.hanning(2 * frames + 3)[1:-1]
    return np.asarray(np.convolve(most, bell / bell.sum(), "valid"))
