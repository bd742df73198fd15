"""Stepping up to what is touched: one foot goes ahead as the body bends to it, and back as it rises.

The numbers are rows of data/transitions/reach.toml.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.held_poses import UP
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.touch.hand_placement import Depth
from motion_backend.procedural.touch.reach_keys import StepIn
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

ALONG: Final = np.linspace(0.0, 1.0, 4)[:, None]
"""Where along a foot it is looked for room."""


@dataclass(frozen=True)
class Step:
    """A foot's way."""

    index: int
    """0 left, 1 right."""
    way: Array
    """(3,) metres on the floor."""

    def taken(self, pose: Pose) -> Pose:
        """A single pose with the foot there."""
        ankles = pose.ankles.copy()
        ankles[self.index] += self.way
        return replace(pose, ankles=ankles)


def step_before(
    start: Pose, feet: tuple[int, ...], skeleton: Skeleton, depth: Depth, row: StepIn, rng: np.random.Generator
) -> Step:
    """A step by chance with one of the feet (0 left, 1 right), as far as its toes have room; no way at all where they
    have none.

    `depth` says how deep points (N, 3) are in furniture.
    """
    index, wanted = int(rng.choice(feet)), float(rng.uniform(row.least_m, row.most_m)) * skeleton.scale
    ahead = rotations.rotate(rotations.yaw_to_quat(yaw_of(start.hips)), np.array([0.0, 0.0, 1.0]))
    ankle = start.ankles[index]
    for way in (wanted, row.least_m * skeleton.scale):
        sole = ankle * [1.0, 0.5, 1.0] + ALONG * (way + row.toes_m * skeleton.scale) * ahead
        if float(depth(sole).max()) < -row.room_m:
            return Step(index, way * ahead)
    return Step(index, np.zeros(3))


def stepped(whole: Pose, lengths: tuple[int, int, int], step: Step, row: StepIn) -> Pose:
    """T frames of a touch in which a foot steps; `lengths` are those of coming, doing and leaving (frames)."""
    if not step.way.any():
        return whole
    come, do, leave = lengths
    at = np.arange(1, len(whole) + 1)
    there = _share(at, come, row.comes_from_share, row.comes_to_share)
    back = _share(at - come - do, leave, row.goes_from_share, row.goes_to_share)
    lifted = 4 * (there * (1 - there) + back * (1 - back))
    ankles, planted = whole.ankles.copy(), whole.planted.copy()
    ankles[:, step.index] += (there - back)[:, None] * step.way + row.lift_m * lifted[:, None] * UP
    in_the_air = (there > 0) & (there < 1) | (back > 0) & (back < 1)
    planted[in_the_air, step.index] = 0.0
    return replace(whole, ankles=ankles, planted=planted)


def _share(at: NDArray[np.integer], length: int, begins: float, ends: float) -> Array:
    return smooth((at / length - begins) / (ends - begins))


def shifted(start: Pose, step: Step, row: StepIn) -> Pose:
    """A single pose with the pelvis gone along with a step."""
    return replace(start, pelvis=start.pelvis + row.pelvis_share * step.way)
