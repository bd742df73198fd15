"""An arm solved from its handles: where its wrist is to be, where its elbow points, how its hand lies.

Everybody who looks at arms, to lay hands on things or to keep them out of things, looks at this one.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.joint_limits import within
from motion_backend.inverse_kinematics import Limb, arm_rotations, two_bone
from motion_backend.procedural.pose import Pose
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

SIDES: Final = (("left", 1), ("right", -1))
WRIST_ASIDE, WRIST_BEND, FOREARM_ROLL = (-0.25, 0.25), (-1.30, 1.15), 1.32
"""How far a left hand turns and bends against the forearm, and either rolls about it (radians)."""
TURNED_OVER = 2.4
"""From such a turn on (radians) a hand is to lie the other way round."""
SHRUG = 0.45
"""How far a raised arm lifts the collar bone (radians)."""


class Arm(NamedTuple):
    """The left (0) or right (1) arm of T frames."""

    which: int
    limb: Limb
    lengths: tuple[float, float]
    """Of upper arm and forearm (metres)."""
    shoulder: Array
    """(T, 3) world."""
    chest: Array
    """World rotation. (T, 4)."""
    collar: Array
    """Local rotation. (T, 4)."""
    palm: Array
    """World rotation that its hand is to have, (T, 4),"""
    pressing: Array
    """as far as this says. (T,)."""

    @staticmethod
    def of(pose: Pose, skeleton: Skeleton, index: int, frame: tuple[Array, Array]) -> Arm:
        """The arm of T frames whose chest is in that `chest_frame`."""
        name, side = SIDES[index]
        chest, chest_position = frame
        offsets = skeleton.offsets
        lengths = (abs(float(offsets[INDEX[f"{name}_elbow"], 0])), abs(float(offsets[INDEX[f"{name}_wrist"], 0])))
        span = sum(lengths)
        rest = chest_position + rotations.rotate(chest, hanging_from(skeleton, index))
        weight = pose.reaching[:, index, None]
        wanted = rest + rotations.rotate(chest, pose.arms[:, index] * span)
        target = wanted + weight * (pose.reach[:, index] - wanted)
        # Raising the arm lifts the collar bone with it, as a shoulder does.
        up = rotations.rotate(rotations.inverse(chest), target - rest)[:, 1] / span
        collar = rotations.axis_to_quat("z", side * SHRUG * np.clip(up, 0.0, 1.0))
        joint = chest_position + rotations.rotate(chest, offsets[INDEX[f"{name}_collar"]])
        shoulder = joint + rotations.rotate(rotations.compose(chest, collar), offsets[INDEX[f"{name}_shoulder"]])
        limb = two_bone(shoulder, target, rotations.rotate(chest, pose.elbows[:, index]), lengths)
        return Arm(index, limb, lengths, shoulder, chest, collar, pose.palms[:, index], pose.pressing[:, index])

    @property
    def name(self) -> str:
        """left or right."""
        return SIDES[self.which][0]

    @property
    def side(self) -> int:
        """1 left, -1 right."""
        return SIDES[self.which][1]

    @property
    def elbow(self) -> Array:
        """(T, 3) world."""
        return np.asarray(self.shoulder + self.lengths[0] * self.limb.upper)

    @property
    def way(self) -> Array:
        """From shoulder to wrist. (T, 3)."""
        return np.asarray(self.lengths[0] * self.limb.upper + self.lengths[1] * self.limb.lower)

    @property
    def wrist(self) -> Array:
        """(T, 3) world."""
        return np.asarray(self.shoulder + self.way)

    @property
    def clavicle(self) -> Array:
        """World rotation. (T, 4)."""
        return rotations.compose(self.chest, self.collar)

    def part(self, frames: NDArray[np.intp]) -> Arm:
        """The same arm over some of its frames."""
        parts = (each[frames] for each in self[3:])
        return Arm(self.which, Limb(*(bone[frames] for bone in self.limb)), self.lengths, *parts)

    def hand(self, limb: Limb) -> Array:
        """Where its fingers point, with its bones (T, 3) or (T, A, 3): along the forearm unless the hand is laid on
        something."""
        if not self.pressing.any():
            return limb.lower
        palm, pressing = self.palm, self.pressing
        if limb.upper.ndim > 2:
            palm, pressing = palm[:, None], pressing[:, None]
        _, forearm = arm_rotations(limb, self.side)
        turned = rotations.compose(forearm, wrist_rotations(forearm, palm, pressing, self.side))
        return rotations.rotate(turned, np.array([float(self.side), 0.0, 0.0]))

    def in_chest(self, vectors: Array) -> Array:
        """World vectors (T, 3) in the chest's frame."""
        return rotations.rotate(rotations.inverse(self.chest), vectors)

    def joints(self) -> dict[str, Array]:
        """Local rotations (T, 4) of collar, shoulder, elbow and wrist, by joint."""
        upper, lower = arm_rotations(self.limb, self.side)
        return {
            f"{self.name}_collar": self.collar,
            f"{self.name}_shoulder": rotations.compose(rotations.inverse(self.clavicle), upper),
            f"{self.name}_elbow": rotations.compose(rotations.inverse(upper), lower),
            f"{self.name}_wrist": within(
                f"{self.name}_wrist", wrist_rotations(lower, self.palm, self.pressing, self.side)
            )
            if self.pressing.any()
            else np.tile(rotations.IDENTITY, (len(lower), 1)),
        }


def hanging_from(skeleton: Skeleton, index: int) -> Array:
    """Where a shoulder is in the chest's frame while its collar bone is not lifted: `Pose.arms` are from there. (3,)"""
    name = SIDES[index][0]
    return np.asarray(skeleton.offsets[INDEX[f"{name}_collar"]] + skeleton.offsets[INDEX[f"{name}_shoulder"]])


def wrist_rotations(lower: Array, palms: Array, pressing: Array, side: int) -> Array:
    """Local rotations (..., 4) of a wrist on a forearm (..., 4) that wants a hand (..., 4), as far as it presses."""
    bend = _within_reach(rotations.compose(rotations.inverse(lower), palms), side)
    press = rotations.rotvec_to_quat(rotations.quat_to_rotvec(bend) * pressing[..., None])
    return _within_reach(press, side)


def _within_reach(wrist: Array, side: int) -> Array:
    """A wrist's rotation limited to what wrist and forearm can do: the forearm rolls, then the hand bends. (..., 4)."""
    roll = rotations.wrap(2 * np.arctan2(wrist[..., 0], wrist[..., 3]))
    twist = rotations.axis_to_quat("x", roll)
    swing = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(twist), wrist))
    swing = swing * _not_turned_over(rotations.length(swing))
    low, high = np.sort(side * np.array([WRIST_ASIDE, WRIST_BEND]), axis=1).T
    swing[..., 1:] = np.clip(swing[..., 1:], low, high)
    rolled = np.clip(roll, -FOREARM_ROLL, FOREARM_ROLL) * _not_turned_over(np.abs(roll))
    twist = rotations.axis_to_quat("x", rolled)
    return rotations.compose(twist, rotations.rotvec_to_quat(swing))


def _not_turned_over(angle: Array) -> Array:
    """What is done of a turn that no wrist can do (radians): at half a turn neither way is the nearer one, and a hand
    that chose would flip from one to the other."""
    return np.asarray(np.clip((np.pi - angle) / (np.pi - TURNED_OVER), 0.0, 1.0))
