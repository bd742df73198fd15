"""The last pass over the arms of a segment: out of what is solid, then no joint of them faster than people's are.

Each pass before it is smooth by itself, their sum need not be.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS, Posture
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.collision_avoidance.elbow_collision import elbows_clear
from motion_backend.procedural.collision_avoidance.hand_collision import hands_clear
from motion_backend.procedural.pose import Pose, concatenate, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.touch.hand_captions import steadies, with_both_hands
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

SINKS: Final = 0.03
"""How deep arms sink into what is lain on (metres)."""
FASTEST: Final = 12.0
"""Of a shoulder, an elbow and a wrist (radians a second): people walk, sit and reach with half of it."""
TRIES: Final = ((8, 2.5), (12, 4.0), (18, 6.0), (26, 9.0))
"""Frames before and after a joint is too fast in which its arm is smoothed, and the width of the bell: as little as
will do."""
LAID_FROM: Final = 0.6
"""A hand that presses more than this lies on something, and the more it does, the more its wrist stays there."""


class Around(NamedTuple):
    """What a body does in a segment, and among what."""

    part: Part
    posture: Posture
    under: str | None
    """What it rests on or gets onto: an object's id."""
    solid: Obstacles

    @property
    def touching(self) -> str | None:
        """The hands that are on things on purpose."""
        if self.part.kind is PartKind.REACH:
            caption = self.part.action.caption
            return "both" if with_both_hands(caption) or steadies(caption) else self.part.action.hand
        return None if self.posture is Posture.STANDING else "both"

    @property
    def met_by_elbows(self) -> Obstacles:
        """Who lies sinks in a little; who sits is among what arms rest on, so that only shoulders are minded."""
        if self.posture is Posture.STANDING:
            return self.solid
        if self.posture is Posture.LYING:
            return self.solid.sunk_into(self.under, SINKS)
        return self.solid.only(np.zeros(len(self.solid.owners), dtype=bool))


def arms_clear(pose: Pose, start: Pose, around: Around, skeleton: Skeleton) -> Pose:
    """A segment of T frames, begun in the single pose `start`, with its arms out of what is solid and none too fast."""
    pose = hands_clear(pose, skeleton, around.solid, around.touching)
    pose = elbows_clear(pose, skeleton, around.met_by_elbows)
    return _slowed(pose, start, skeleton)


class _Turning(NamedTuple):
    """An arm as its joints turn it, with the frame before the segment first."""

    arm: Arm
    joints: Array
    """Local rotations of shoulder, elbow and wrist. (1 + T, 3, 4)."""

    @staticmethod
    def of(pose: Pose, skeleton: Skeleton, index: int) -> _Turning:
        arm = Arm.of(pose, skeleton, index, chest_frame(pose, skeleton))
        local = arm.joints()
        joints = [local[f"{arm.name}_{joint}"] for joint in ("shoulder", "elbow", "wrist")]
        return _Turning(arm, rotations.continuous(np.stack(joints, axis=1)))

    def too_fast(self) -> NDArray[np.intp]:
        """Frames into which a joint turns faster than it may."""
        turns = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(self.joints[:-1]), self.joints[1:]))
        return np.flatnonzero(np.linalg.norm(turns, axis=-1).max(axis=1) > FASTEST / FPS) + 1


def _slowed(pose: Pose, start: Pose, skeleton: Skeleton) -> Pose:
    """The same segment with each arm smoothed about where a joint of it is too fast, the seam before it included."""
    whole = concatenate([start.repeat(1), pose])
    for index in (0, 1):
        begun = whole
        for reach, width in TRIES:
            turning = _Turning.of(whole, skeleton, index)
            fast = turning.too_fast()
            if not len(fast):
                break
            # Of the arm as it was: smoothing twice would wander off.
            about = _near(fast, len(whole), reach)
            whole = _posed(whole, begun, about, _Turning.of(begun, skeleton, index), width, skeleton)
    return whole.at(slice(1, None))


def _near(fast: NDArray[np.intp], frames: int, reach: int) -> Array:
    """How much frames are about those that are too fast: 1 there, 0 from `reach` frames on. (frames,)."""
    away = np.abs(np.arange(frames)[:, None] - fast).min(axis=1)
    return smooth(2 * (1 - away / reach))


def _posed(pose: Pose, begun: Pose, about: Array, turning: _Turning, width: float, skeleton: Skeleton) -> Pose:
    """An arm turned by the joints it has in `begun`, smoothed by a bell of so many frames as much as `about` says;
    the first frame stays, and a hand that lies on something stays there."""
    from scipy.ndimage import gaussian_filter1d

    arm, joints = turning
    bell = rotations.normalize(gaussian_filter1d(joints, width, axis=0, mode="nearest"))
    off = rotations.quat_to_rotvec(rotations.compose(joints[0], rotations.inverse(bell[0])))
    fade = 1 - smooth(np.arange(len(joints)) / (2 * width))
    bell = rotations.compose(rotations.rotvec_to_quat(fade[:, None, None] * off), bell)
    shoulder, elbow, wrist = np.moveaxis(rotations.slerp(joints, bell, about[:, None]), 1, 0)
    upper = rotations.compose(arm.clavicle, shoulder)
    lower = rotations.compose(upper, elbow)
    out = np.array([float(arm.side), 0.0, 0.0])
    bones = [size * rotations.rotate(turn, out) for size, turn in zip(arm.lengths, (upper, lower), strict=True)]
    laid = begun.reaching[:, arm.which] * np.clip((arm.pressing - LAID_FROM) / (1 - LAID_FROM), 0.0, 1.0)
    place = arm.shoulder + bones[0] + bones[1]
    place = place + laid[:, None] * (arm.wrist - place)
    hinge = rotations.rotate(upper, np.array([0.0, -float(arm.side), 0.0]))
    pole = arm.in_chest(rotations.cross(rotations.normalize(place - arm.shoulder), hinge))
    rest = arm.in_chest(place - arm.shoulder) + _lifted(arm, skeleton)
    changed = {
        "arms": rest / sum(arm.lengths),
        "elbows": pole,
        "reach": place,
        "palms": rotations.compose(lower, wrist),
        "pressing": np.where(arm.pressing > 0, 1.0, 0.0),
    }
    return _with(pose, arm.which, about > 0, changed)


def _lifted(arm: Arm, skeleton: Skeleton) -> Array:
    """From where the shoulder hangs to where its collar bone has lifted it, in the chest's frame. (T, 3)."""
    bone = skeleton.offsets[skeleton.names.index(f"{arm.name}_shoulder")]
    return np.asarray(rotations.rotate(arm.collar, bone) - bone)


def _with(pose: Pose, index: int, frames: NDArray[np.bool_], changed: dict[str, Array]) -> Pose:
    """The same with handles of one arm changed in some frames."""
    handles = {name: getattr(pose, name).copy() for name in changed}
    for name, values in changed.items():
        handles[name][frames, index] = values[frames]
    return replace(pose, **handles)
