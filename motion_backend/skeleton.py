"""The body's skeleton: 22 joints with SMPL's names and parents, and offsets of our own.

Rest pose is a T-pose facing +Z: Y up, left is +X. Offsets are metres from the parent joint.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations

JOINTS = (
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle",
    "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
)  # fmt: skip
PARENTS = (-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19)
INDEX = {name: index for index, name in enumerate(JOINTS)}
REFERENCE_HEIGHT = 1.70
MIN_HEIGHT, MAX_HEIGHT = 1.1, 2.2
"""Metres; a child of five or six, and whom doors still let through."""


def other_side(name: str) -> str:
    """The joint on the other side of the body: left_knee of right_knee; those in the middle are their own."""
    side, _, rest = name.partition("_")
    return {"left": f"right_{rest}", "right": f"left_{rest}"}.get(side, name)


_OFFSETS = {
    "pelvis": (0.0, 0.0, 0.0),
    "left_hip": (0.088, 0.0, 0.0),
    "spine1": (0.0, 0.11, 0.0),
    "left_knee": (0.0, -0.4165, 0.0),
    "spine2": (0.0, 0.12, 0.0),
    "left_ankle": (0.0, -0.418, 0.0),
    "spine3": (0.0, 0.12, 0.0),
    "left_foot": (0.0, -0.035, 0.12),
    "neck": (0.0, 0.20, 0.0),
    "left_collar": (0.05, 0.13, 0.0),
    "head": (0.0, 0.09, 0.0),
    "left_shoulder": (0.130, 0.005, 0.0),
    "left_elbow": (0.292, 0.0, 0.0),
    "left_wrist": (0.248, 0.0, 0.0),
}
SEATED_REST, LYING_REST, HAND_REST = 0.09, 0.10, 0.06
"""Rest offsets: pelvis above a seat, pelvis above a mattress, wrist off what its hand lies on (metres, any body)."""
ARM_LENGTH = 0.54
"""Shoulder to wrist of a stretched arm (metres at 1.70 m)."""
ANKLE_HEIGHT = 0.066
"""Ankle above the sole, at the reference height."""


@dataclass(frozen=True)
class Skeleton:
    """Joint names, parents and rest offsets; bones never change length."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: NDArray[np.float64]
    """(J, 3) metres from the parent joint in the rest pose."""

    @cached_property
    def rest_positions(self) -> NDArray[np.float64]:
        """Joint positions of the T-pose with the pelvis at the origin. (J, 3)."""
        positions = np.zeros_like(self.offsets)
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                positions[joint] = positions[parent] + self.offsets[joint]
        return positions

    @cached_property
    def _levels(self) -> tuple[tuple[list[int], list[int]], ...]:
        """Joints that are equally far from the pelvis, which is first, and their parents: those are turned together."""
        depths = [0] * len(self.parents)
        for joint, parent in enumerate(self.parents[1:], start=1):
            depths[joint] = depths[parent] + 1
        levels = [[j for j, depth in enumerate(depths) if depth == level] for level in range(1, max(depths) + 1)]
        return tuple((joints, [self.parents[joint] for joint in joints]) for joints in levels)

    @property
    def scale(self) -> float:
        """Size against the reference body of 1.70 m."""
        return float(-self.offsets[INDEX["left_knee"], 1] / 0.4165)

    @property
    def ankle_height(self) -> float:
        """Ankle above the sole when standing flat."""
        return ANKLE_HEIGHT * self.scale

    @property
    def standing_height(self) -> float:
        """Pelvis above the floor with straight legs."""
        leg = self.offsets[INDEX["left_knee"], 1] + self.offsets[INDEX["left_ankle"], 1]
        return float(-leg + self.ankle_height)

    def forward_kinematics(
        self, root_positions: NDArray[np.floating], local_rotations: NDArray[np.floating]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        """World positions (T, J, 3) and rotations (T, J, 4) from pelvis positions and local rotations."""
        frames = len(root_positions)
        positions = np.empty((frames, len(self.parents), 3))
        world = np.empty((frames, len(self.parents), 4))
        local = np.asarray(local_rotations, dtype=np.float64)
        positions[:, 0], world[:, 0] = root_positions, local[:, 0]
        for joints, parents in self._levels:
            above = world[:, parents]
            world[:, joints] = rotations.compose(above, local[:, joints])
            positions[:, joints] = positions[:, parents] + rotations.rotate(above, self.offsets[joints])
        return positions.astype(np.float32), world


def build_skeleton(height: float = REFERENCE_HEIGHT) -> Skeleton:
    """The skeleton of a body of that height (metres), every bone scaled alike."""
    if not MIN_HEIGHT <= height <= MAX_HEIGHT:
        raise ValueError(f"character.height must lie between {MIN_HEIGHT} and {MAX_HEIGHT} metres, got {height}")
    offsets = np.zeros((len(JOINTS), 3))
    for name, offset in _OFFSETS.items():
        offsets[INDEX[name]] = offset
        if name.startswith("left_"):
            offsets[INDEX["right_" + name[5:]]] = (-offset[0], offset[1], offset[2])
    return Skeleton(JOINTS, PARENTS, offsets * (height / REFERENCE_HEIGHT))
