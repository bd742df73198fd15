"""What an arm is in, and the ways out: furniture and the floor, the own trunk, head and legs, the other arm.

Every place of an arm is a mixture of its elbow, its wrist and the way its hand points (`Contacts.of`), so that whoever
moves these three knows how far the place goes with them.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body import capsules
from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.self_collision import closest
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import trunk_and_legs
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH, INDEX, Skeleton

PLACES: Final = np.array(
    [[0.7, 0.0, 0.0], [1.0, 0.0, 0.0], [0.6, 0.4, 0.0], [0.25, 0.75, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.08],
     [0.0, 1.0, 0.14]]
)  # fmt: skip
"""Where an arm is looked at among furniture: shares of the ways from shoulder to elbow and to wrist, and metres along
the hand (at 1.70 m), from the upper arm to the fingertips."""
THICK: Final = np.array([0.042, 0.042, 0.034, 0.034, 0.034, 0.030, 0.024])
"""Radii of an arm at these places (metres at 1.70 m)."""
AT_FOREARM, AT_HAND = 3, 4
"""The first of them that are nearer to the hand than to the elbow, and that are the hand's."""
GIVES: Final = 0.012
"""So deep parts of one body may be in each other: flesh gives (metres at 1.70 m)."""
UPWARDS: Final = np.array([0.0, 0.0, 0.06, 0.12, 0.12, 0.12, 0.12])
"""A way out upwards may be this much longer than the nearest way out sideways: hands rest on things (metres)."""
ALONG: Final = 1e-9
"""A line that goes less than this along an axis is square to it (metres)."""
AHEAD: Final = {"pelvis": 0.5, "torso": 0.5, "head": 0.0, "thigh": 1.0, "shin": 1.0, "foot": 1.0}
"""How much an arm deep in a part of the body goes round its front, against round its side."""
OWN: Final = tuple(index for index, body in enumerate(capsules.BODIES) if body.name.split("_")[-1] in AHEAD)
"""The capsules of the body but the arms."""
_BONES: Final = [body for body in capsules.BODIES if body.name in ("left_upper_arm", "left_lower_arm", "left_hand")]


class Bars(NamedTuple):
    """Round bars in T frames, that an arm is not to be in."""

    start: Array
    """(T, B, 3)."""
    end: Array
    radii: Array
    """(B,) metres."""
    round: Array
    """The way in which an arm goes round them that is in their middle. (T, B, 3)."""
    share: Array
    """Of the way out, that the arm itself goes. (B,)."""

    def at(self, frames: NDArray[np.intp]) -> Bars:
        """The same in some frames."""
        return self._replace(start=self.start[frames], end=self.end[frames], round=self.round[frames])

    def beside(self, other: Bars) -> Bars:
        """These and others, in the same frames."""
        return Bars(*(np.concatenate(pair, axis=min(pair[0].ndim - 1, 1)) for pair in zip(self, other, strict=True)))


class Contacts(NamedTuple):
    """M places of an arm that are in something, in any of its frames."""

    frames: NDArray[np.intp]
    """(M,)."""
    of: Array
    """What each is of: of the ways from the shoulder to elbow and to wrist, and of the hand. (M, 3)."""
    out: Array
    """The way out. (M, 3) metres."""

    def depth(self, frames: int) -> Array:
        """The longest of the ways out in each of so many frames. (T,) metres."""
        deepest = np.zeros(frames)
        np.maximum.at(deepest, self.frames, rotations.length(self.out)[:, 0])
        return deepest


def own_bars(pose: Pose, skeleton: Skeleton) -> tuple[Bars, Bars]:
    """Trunk, head and legs of T frames, as the left and as the right arm goes round them."""
    positions, world = skeleton.forward_kinematics(pose.pelvis, trunk_and_legs(pose, skeleton))
    start, end, radii = (part[..., OWN, :] if part.ndim > 1 else part[list(OWN)] for part in
                         capsules.placed(skeleton, positions.astype(np.float64), world))  # fmt: skip
    turns = world[:, [INDEX[capsules.BODIES[one].joint] for one in OWN]]
    ahead = np.array([AHEAD[capsules.BODIES[one].name.split("_")[-1]] for one in OWN])
    ways = [np.stack([np.full(len(OWN), side), np.zeros(len(OWN)), ahead], axis=1) for side in (1.0, -1.0)]
    left, right = (Bars(start, end, radii, rotations.rotate(turns, way), np.ones(len(OWN))) for way in ways)
    return left, right


def other_arm(arm: Arm, hand: Array) -> Bars:
    """The bars that an arm of T frames is for the other one, which goes over a left arm and under a right one; either
    goes half the way."""
    start, end = bones(arm, hand)
    radii = np.array([bone.radius for bone in _BONES]) * _scale(arm)
    over = rotations.rotate(arm.chest, np.array([0.0, 0.0, float(arm.side)]))
    return Bars(start, end, radii, np.broadcast_to(over[:, None], start.shape), np.full(len(radii), 0.5))


def bones(arm: Arm, hand: Array) -> tuple[Array, Array]:
    """Both ends of upper arm, forearm and hand without their round ends; `hand` is where it points. (T, 3, 3) twice."""
    return places(arm, hand, _ends(arm)[0]), places(arm, hand, _ends(arm)[1])


def places(arm: Arm, hand: Array, of: Array) -> Array:
    """Where places of an arm are, (K, 3) or (T, K, 3) as `Contacts.of` has them. (T, K, 3) world."""
    ways = np.stack([arm.elbow - arm.shoulder, arm.wrist - arm.shoulder, hand], axis=1)
    return np.asarray(arm.shoulder[:, None] + of @ ways)


def in_bars(arm: Arm, hand: Array, bars: Bars) -> Contacts:
    """Where an arm of T frames is in bars: bone for bone and bar for bar the two places that are nearest."""
    start, end = bones(arm, hand)
    thick = np.array([bone.radius for bone in _BONES])[:, None] - GIVES
    clear = thick * _scale(arm) + bars.radii
    long = rotations.length(end[:1] - start[:1]) + rotations.length(bars.end[:1] - bars.start[:1])[..., 0]
    between = 0.5 * ((start + end)[:, :, None] - (bars.start + bars.end)[:, None])
    frame, bone, bar = np.nonzero(rotations.length(between)[..., 0] < clear + 0.5 * long)
    line = bars.start[frame, bar], bars.end[frame, bar]
    share, away = closest(start[frame, bone], end[frame, bone], *line)
    met = np.flatnonzero(rotations.length(away)[:, 0] < clear[bone, bar])
    frame, bone, bar, share, away = frame[met], bone[met], bar[met], share[met], away[met]
    axis, aside = rotations.normalize(line[1][met] - line[0][met]), bars.round[frame, bar]
    aside = rotations.normalize(aside - rotations.dot(aside, axis) * axis)
    low, high = (ends[bone] for ends in _ends(arm))
    out = bars.share[bar][:, None] * _out_of_bar(away, aside, clear[bone, bar][:, None])
    return Contacts(frame, low + share * (high - low), out)


def _out_of_bar(away: Array, aside: Array, clear: Array) -> Array:
    """The ways out of bars whose axes are so far away (N, 3): straight, and the deeper the more to the given side."""
    share = rotations.length(away) / clear
    way = rotations.normalize(away / clear + (1 - share) * aside)
    there = rotations.dot(way, away)
    far = -there + np.sqrt(np.maximum(there**2 + clear**2 - rotations.dot(away, away), 0.0))
    return np.asarray(far * way)


def in_things(arm: Arm, hand: Array, obstacles: Obstacles, floor: float, laid: Array) -> Contacts:
    """Where an arm of T frames is deepest in boxes, or below a height: about its elbow, and about its hand, which is in
    nothing as far as it is `laid` on something (T,)."""
    points = places(arm, hand, PLACES)
    frames, count = points.shape[:2]
    flat, origin = points.reshape(-1, 3), np.repeat(arm.shoulder, count, axis=0)
    thick, upwards = (np.tile(each, frames)[:, None] for each in (_scale(arm) * THICK, UPWARDS))
    out, wide = np.zeros_like(flat), np.sqrt(2) * thick
    low, high = np.minimum(flat, origin) - wide, np.maximum(flat, origin) + wide
    close = obstacles.near(low.min(axis=0), high.max(axis=0))
    for index, span in enumerate(close.spans):
        about = np.all((close.centers[index] + span >= low) & (close.centers[index] - span <= high), axis=1)
        met = np.flatnonzero(about | out.any(axis=1))
        if len(met):
            box = _Box(close.centers[index], close.halves[index], float(close.yaws[index]))
            out[met] += _out_of_box(flat[met] + out[met], origin[met], thick[met], upwards[met], box)
    out[:, 1] += np.maximum(floor + thick[:, 0] - flat[:, 1] - out[:, 1], 0.0)
    ways = out.reshape(points.shape)
    ways[:, AT_HAND:] *= (1 - laid)[:, None, None]
    far = rotations.length(ways)[..., 0]
    deepest = np.stack([far[:, :AT_FOREARM].argmax(axis=1), AT_FOREARM + far[:, AT_FOREARM:].argmax(axis=1)], axis=1)
    frame, which = np.nonzero(np.take_along_axis(far, deepest, axis=1))
    place = deepest[frame, which]
    return Contacts(frame, PLACES[place], ways[frame, place])


class _Box(NamedTuple):
    """One of the boxes of `Obstacles`."""

    center: Array
    half: Array
    yaw: float


def _out_of_box(points: Array, origin: Array, thick: Array, upwards: Array, box: _Box) -> Array:
    """Up out of a box, or back to the side the arm came from: through a wardrobe is no way out of it. (N, 3)."""
    turn = rotations.yaw_to_quat(box.yaw)
    local, source = (rotations.rotate(rotations.inverse(turn), some - box.center) for some in (points, origin))
    half = box.half + thick
    inside = (np.abs(local) < half).all(axis=1) | _crosses(source, local, box.half)
    out = np.zeros_like(local)
    if not inside.any():
        return out
    side = np.sign(source[:, [0, 2]])
    across = half[:, [0, 2]] - side * local[:, [0, 2]]
    entered = np.abs(source[:, [0, 2]]) > box.half[[0, 2]]
    across = np.where(entered | ~entered.any(axis=1, keepdims=True), across, np.inf)
    axis = np.argmin(across, axis=1)
    distance = across[np.arange(len(across)), axis]
    up = half[:, 1] - local[:, 1]
    rises = inside & (up < distance + upwards[:, 0])
    out[rises, 1] = up[rises]
    aside = np.flatnonzero(inside & ~rises)
    out[aside, 2 * axis[aside]] = (side[np.arange(len(side)), axis] * distance)[aside]
    return np.asarray(rotations.rotate(turn, out))


def _crosses(start: Array, end: Array, half: Array) -> NDArray[np.bool_]:
    """Whether the line from shoulder to point passes through a box about the origin: a thin wall is no gap. (N,)."""
    way = end - start
    way = np.where(np.abs(way) < ALONG, ALONG, way)
    first, second = (-half - start) / way, (half - start) / way
    enters = np.minimum(first, second).max(axis=1)
    leaves = np.maximum(first, second).min(axis=1)
    return np.asarray((enters < leaves) & (enters > 0) & (enters < 1))


def _ends(arm: Arm) -> tuple[Array, Array]:
    """Both ends of the middle lines of an arm's bones, as `Contacts.of` has places. (3, 3) twice."""
    upper, lower, hand = ((bone.start[0] * _scale(arm), bone.end[0] * _scale(arm)) for bone in _BONES)
    first, second = arm.lengths
    low, high = (
        np.array([[upper[end] / first, 0.0, 0.0], [1 - lower[end] / second, lower[end] / second, 0.0],
                  [0.0, 1.0, hand[end]]])
        for end in (0, 1)
    )  # fmt: skip
    return low, high


def _scale(arm: Arm) -> float:
    return sum(arm.lengths) / ARM_LENGTH
