"""Where every joint of a motion is, worked out once for all that is measured."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from motion_backend import rotations
from motion_backend.body import capsules
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX


@dataclass(frozen=True)
class Kinematics:
    """World positions (T, 22, 3) and rotations (T, 22, 4) of a motion."""

    motion: Motion
    positions: Array
    world: Array

    @staticmethod
    def of(motion: Motion) -> Kinematics:
        """Forward kinematics of a motion."""
        positions, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
        return Kinematics(motion, positions.astype(np.float64), world)

    @cached_property
    def soles(self) -> Array:
        """Heel, toe tip, inner and outer edge of the left and the right sole. (T, 2, 4, 3)."""
        skeleton = self.motion.skeleton
        feet, toes = _both("ankle"), _both("foot")
        corners = capsules.SOLE * skeleton.scale
        found = self.positions[:, feet, None] + rotations.rotate(self.world[:, feet, None], corners)
        # The tip of the toes turns with the toe joint, not with the ankle.
        ball = skeleton.offsets[INDEX["left_foot"]]
        found[:, :, 1] = self.positions[:, toes] + rotations.rotate(self.world[:, toes], corners[1] - ball)
        return np.asarray(found)

    @cached_property
    def capsules(self) -> tuple[Array, Array, Array]:
        """Ends of all capsules, (T, 15, 3) twice, and their radii (15,)."""
        return capsules.placed(self.motion.skeleton, self.positions, self.world)


def _both(joint: str) -> list[int]:
    return [INDEX[f"left_{joint}"], INDEX[f"right_{joint}"]]
