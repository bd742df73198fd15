"""A clip: recorded or keyed motion of any skeleton, already in our axes and metres.

Y up, the T-pose faces +Z, left is +X; quaternions xyzw. Every reader ends in `make_clip`, the one place where the
parts are checked. Joint 0 is the root and parents come before their children.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.rotations import Array
from scene_graphs.errors import UserError

MAX_FRAMES = 200_000
MAX_JOINTS = 512
MAX_TURNS = 6_000_000
"""Joints times frames of all clips of one file: 192 MB of quaternions."""
MIN_FPS, MAX_FPS = 1.0, 1000.0
"""Frames a second."""
MAX_COORDINATE = 1e4
"""Metres: no joint lies farther from the origin or its parent."""
_OFF_UNIT = 0.01
"""By which a quaternion's length may be off without a word."""


class ClipError(UserError):
    """A motion file cannot be read or used; the message says what is wrong with it and what to do."""

    joint = " "


@dataclass(frozen=True)
class Bones:
    """The joints of a source skeleton."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    """-1 for joint 0, the root; else smaller than the joint's own index."""
    offsets: Array
    """(J, 3) metres from the parent joint, in the parent's frame; zero for the root."""

    def index(self, name: str) -> int:
        """The place of a joint. ClipError if there is none of that name."""
        if name not in self.names:
            raise ClipError(f"no joint is named {name!r}", f"there are {', '.join(self.names)}")
        return self.names.index(name)

    @cached_property
    def generations(self) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], ...]:
        """Joints below the root by how far below it, each with their parents."""
        depth = [0] * len(self.parents)
        for joint, parent in enumerate(self.parents[1:], start=1):
            depth[joint] = depth[parent] + 1
        levels = [np.flatnonzero(np.array(depth) == level) for level in range(1, max(depth) + 1)]
        return tuple((level, np.array(self.parents)[level]) for level in levels)

    def forward_kinematics(self, root_positions: Array, local_rotations: Array) -> tuple[Array, Array]:
        """World positions (T, J, 3) and rotations (T, J, 4)."""
        positions = np.empty((len(root_positions), len(self.parents), 3))
        world = np.empty((len(root_positions), len(self.parents), 4))
        positions[:, 0], world[:, 0] = root_positions, local_rotations[:, 0]
        for joints, parents in self.generations:
            above = world[:, parents]  # (T, joints, 4)
            world[:, joints] = rotations.compose(above, local_rotations[:, joints])
            positions[:, joints] = positions[:, parents] + rotations.rotate(above, self.offsets[joints])
        return positions, world


@dataclass(frozen=True)
class Clip:
    """One motion of one source skeleton. T frames, J joints."""

    name: str
    bones: Bones
    root_positions: Array
    """(T, 3) the root joint in the world, metres."""
    local_rotations: Array
    """(T, J, 4) each joint in its parent's frame, the root in the world's; neighbours in time share a hemisphere."""
    tpose: Array
    """(J, 4) local rotations of the skeleton's T-pose: upright, facing +Z, arms along ±X and legs straight down, each
    within ten degrees; of a skeleton whose joints' names are of no family its rest pose."""
    fps: float
    source: str
    """The format it was read from: a key of `readers.FORMATS`."""
    notes: tuple[str, ...] = ()
    """Every conversion, guess and drop, in words."""

    def __len__(self) -> int:
        return len(self.root_positions)

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self) / self.fps

    def forward_kinematics(self) -> tuple[Array, Array]:
        """World positions (T, J, 3) and rotations (T, J, 4)."""
        return self.bones.forward_kinematics(self.root_positions, self.local_rotations)

    def joint_positions(self) -> Array:
        """World positions. (T, J, 3)."""
        return self.forward_kinematics()[0]

    def tpose_kinematics(self) -> tuple[Array, Array]:
        """Positions (J, 3) and world rotations (J, 4) of the T-pose, the root at the origin."""
        positions, world = self.bones.forward_kinematics(np.zeros((1, 3)), self.tpose[None])
        return positions[0], world[0]

    def part(self, start: int, stop: int) -> Clip:
        """Frames start to stop (exclusive), at least two."""
        if not 0 <= start <= stop - 2 <= len(self) - 2:
            raise ClipError(f"{self.name} has {len(self)} frames; {start} to {stop} are not two or more of them")
        window = slice(start, stop)
        return replace(self, root_positions=self.root_positions[window], local_rotations=self.local_rotations[window])


def make_bones(names: Sequence[str], parents: Sequence[int], offsets: Any) -> tuple[Bones, list[int]]:
    """Checked bones with every parent before its children, and where each came from. ClipError if it is no tree."""
    count = len(names)
    if not 1 <= count <= MAX_JOINTS:
        raise ClipError(f"a skeleton has 1 to {MAX_JOINTS} joints, this one has {count}")
    if len(parents) != count:
        raise ClipError(f"{count} joints need as many parents, there are {len(parents)}")
    if len(set(names)) < count:
        twice = next(name for name in names if list(names).count(name) > 1)
        raise ClipError(f"two joints are named {twice!r}", "give each its own name")
    order = _tree_order(names, parents)
    place = {old: new for new, old in enumerate(order)}
    lengths = _numbers(offsets, (count, 3), "the joint offsets")[order]
    lengths[0] = 0.0
    if np.abs(lengths).max() > MAX_COORDINATE:
        raise ClipError(f"a bone is {np.abs(lengths).max():.3g} m long", "are the units right?")
    if count > 1 and not lengths.any():
        raise ClipError("every joint offset is zero: the file holds no skeleton", "name one that goes with it")
    above = tuple(place[parents[old]] if parents[old] >= 0 else -1 for old in order)
    return Bones(tuple(names[old] for old in order), above, lengths), order


def make_clip(
    name: str,
    bones: Bones,
    root_positions: Any,
    local_rotations: Any,
    tpose: Any,
    fps: float,
    source: str,
    notes: Sequence[str] = (),
) -> Clip:
    """A checked clip: finite numbers, unit quaternions, two frames at least, sizes in bounds. ClipError otherwise."""
    frames, joints = len(root_positions), len(bones.names)
    if not 2 <= frames <= MAX_FRAMES:
        raise ClipError(f"{name} has {frames} frame{'s' * (frames != 1)}", f"a clip has 2 to {MAX_FRAMES}")
    if frames * joints > MAX_TURNS:
        raise ClipError(f"{name} has {frames} frames of {joints} joints", "cut it into shorter clips")
    if not MIN_FPS <= fps <= MAX_FPS:
        raise ClipError(f"{name} has {fps:.4g} frames a second; {MIN_FPS:g} to {MAX_FPS:g} can be read")
    roots = _numbers(root_positions, (frames, 3), f"{name}: root positions")
    if np.abs(roots).max() > MAX_COORDINATE:
        raise ClipError(f"{name}: the root comes {np.abs(roots).max():.3g} m from the origin", "are the units right?")
    turns, odd = unit_quaternions(_numbers(local_rotations, (frames, joints, 4), f"{name}: rotations"))
    rest, _ = unit_quaternions(_numbers(tpose, (joints, 4), f"{name}: T-pose"))
    rate = _round_rate(fps)
    return Clip(name, bones, roots, rotations.continuous(turns), rest, rate, source, (*notes, *odd))


def unit_quaternions(quaternions: Array) -> tuple[Array, tuple[str, ...]]:
    """Quaternions (..., 4) brought to unit length, with a note where one was off. ClipError if one is far off."""
    lengths = np.sqrt(np.einsum("...i,...i->...", quaternions, quaternions))[..., None]
    wrong = float(lengths.flat[np.abs(lengths - 1).argmax()])
    if not 0.5 < wrong < 2.0:
        raise ClipError(f"a rotation is a quaternion of length {wrong:.3g}", "they must be of unit length")
    odd = (f"quaternions brought to unit length: one was {wrong:.3g} long",) if abs(wrong - 1) > _OFF_UNIT else ()
    return np.asarray(quaternions / lengths), odd


def _tree_order(names: Sequence[str], parents: Sequence[int]) -> list[int]:
    """Joints with the root first and every parent before its children, otherwise as they were."""
    count = len(names)
    roots = [joint for joint, parent in enumerate(parents) if parent < 0]
    if any(parent >= count for parent in parents):
        raise ClipError(f"a joint names parent {max(parents)}, there are {count} joints")
    if len(roots) > 1:
        raise ClipError(
            f"{names[roots[0]]!r} and {names[roots[1]]!r} are both roots", "a clip has one skeleton with one"
        )
    children: list[list[int]] = [[] for _ in names]
    for joint, parent in enumerate(parents):
        if parent >= 0:
            children[parent].append(joint)
    order, waiting = [], list(roots)
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting.extend(reversed(children[joint]))
    if len(order) < count:
        lost = names[min(set(range(count)) - set(order))]
        raise ClipError(f"the skeleton is no tree: {lost!r} is among its own parents")
    return order


def _numbers(values: Any, shape: tuple[int, ...], what: str) -> Array:
    array = np.array(values, dtype=np.float64)
    if array.shape != shape:
        raise ClipError(f"{what} must be of shape {shape}, not {array.shape}")
    if not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0].tolist()
        raise ClipError(f"{what} hold a number that is not finite, first at {where}")
    return array


def _round_rate(fps: float) -> float:
    """A whole rate where the file wrote its frame time with few digits: 1 / 0.0083333 is 120."""
    whole = round(fps)
    return float(whole) if abs(fps - whole) < 5e-4 * fps else float(fps)
