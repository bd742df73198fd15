"""BVH: a hierarchy of offsets, then Euler angles a joint and frame, in any channel order, axes and unit.

The format names neither unit nor up axis, and many files begin with a T-pose: what is found out and what is dropped
is noted on the clip.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.formats.bvh import CENTIMETRE
from motion_backend.mocap.axes_and_units import to_our_axes, unit_of
from motion_backend.mocap.clip import (
    MAX_FRAMES,
    MAX_JOINTS,
    MAX_TURNS,
    Bones,
    Clip,
    ClipError,
    make_bones,
    make_clip,
)
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.resampling import without_stray_frames
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS, Skeleton

SLIGHT = 0.005
"""Metres by which a bone may seem to stretch without a word."""
_AT_ONCE: Final = 4096
"""Frames turned at once: on the way there angles take several times the room of the rotations."""
_CHANNELS: Final = {
    f"{axis}{kind}": (kind, index) for index, axis in enumerate("XYZ") for kind in ("position", "rotation")
}


@dataclass
class Hierarchy:
    """What the first section of the text says, joint by joint."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[tuple[float, ...]] = field(default_factory=list)
    channels: list[tuple[str, ...]] = field(default_factory=list)

    @property
    def width(self) -> int:
        """Numbers a frame."""
        return sum(len(channels) for channels in self.channels)


@dataclass(frozen=True)
class BvhText:
    """A BVH text as it stands: file units, degrees."""

    hierarchy: Hierarchy
    step: float
    """Seconds a frame."""
    table: Array
    """(T, channels)."""

    def columns(self, joint: int) -> slice:
        """The columns of a joint."""
        start = sum(len(channels) for channels in self.hierarchy.channels[:joint])
        return slice(start, start + len(self.hierarchy.channels[joint]))


def read_bvh_clip(text: str, name: str, joints: JointMap | None = None) -> Clip:
    """The clip in a BVH text; joints that are named by no family tell unit and axes by the map given.

    ClipError says what is wrong with it.
    """
    read = parse_bvh(text)
    bones, order = bvh_bones(read.hierarchy)
    roots, turns, notes = bvh_channels(read, bones, order)
    unit, why = unit_of(bones, joints)
    notes.append(why)
    bones = replace(bones, offsets=bones.offsets * unit)
    pose = to_our_axes(bones, roots * unit, turns, joints)
    tpose = t_posed(pose.bones, pose.tpose, joints)
    notes += pose.notes
    clip = make_clip(name, pose.bones, pose.root_positions, pose.local_rotations, tpose, 1.0 / read.step, "bvh", notes)
    return without_stray_frames(clip, joints)


def read_bvh(text: str, unit: float = CENTIMETRE) -> Motion:
    """A motion from BVH text in any channel order; `unit` is its length unit in metres, its axes are ours.

    Joints with our names come back in our order, others as the file has them. Contacts and keyframes, which BVH does
    not hold, are zero. ValueError tells what is wrong with the text.
    """
    read = parse_bvh(text)
    bones, places = bvh_bones(read.hierarchy)
    roots, turns, _ = bvh_channels(read, bones, places)
    order = _our_order(list(bones.names))
    place = {old: new for new, old in enumerate(order)}
    skeleton = Skeleton(
        tuple(bones.names[joint] for joint in order),
        tuple(place[bones.parents[joint]] if bones.parents[joint] >= 0 else -1 for joint in order),
        bones.offsets[order] * unit,
    )
    return Motion(
        root_positions=(roots * unit).astype(np.float32),
        local_rotations=rotations.continuous(turns[:, order]).astype(np.float32),
        contacts=np.zeros((len(roots), 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(roots), dtype=np.int32),
        fps=round(1.0 / read.step),
    )


def _our_order(names: list[str]) -> list[int]:
    if sorted(names) == sorted(JOINTS):
        return [names.index(name) for name in JOINTS]
    return list(range(len(names)))


def bvh_bones(hierarchy: Hierarchy) -> tuple[Bones, list[int]]:
    """Bones in file units, and where each stands in the file."""
    return make_bones(hierarchy.names, hierarchy.parents, np.array(hierarchy.offsets).reshape(-1, 3))


def parse_bvh(text: str) -> BvhText:
    """Both sections of the text. ClipError says what is wrong with it."""
    head, found, tail = text.partition("MOTION")
    if not found or not head.lstrip("\ufeff \t\r\n").startswith("HIERARCHY"):
        raise ClipError("a BVH text has a HIERARCHY and then a MOTION section")
    hierarchy = parse_hierarchy(head)
    counts = re.match(r"\s*Frames:\s*(\d{1,9})\s*Frame\s+Time:\s*([-+.\deE]{1,40})", tail)
    if counts is None or not hierarchy.names:
        raise ClipError("a BVH text names its joints, then says Frames: and Frame Time:")
    frames, step = int(counts[1]), _number(counts[2], "Frame Time")
    if not step > 0.0:
        raise ClipError(f"Frame Time must be above zero seconds, got {counts[2]}")
    if frames > MAX_FRAMES or frames * len(hierarchy.names) > MAX_TURNS:
        raise ClipError(f"{frames} frames of {len(hierarchy.names)} joints are too many", "cut it into shorter files")
    values = all_numbers(tail[counts.end() :], "the MOTION section")
    if len(values) != frames * hierarchy.width:
        raise ClipError(
            f"{frames} frames of {hierarchy.width} channels need {frames * hierarchy.width} numbers, there "
            f"are {len(values)}",
            "is the file cut off?",
        )
    return BvhText(hierarchy, step, values.reshape(frames, hierarchy.width))


def parse_hierarchy(text: str) -> Hierarchy:
    """The joints of the first section; end sites are left out. ClipError says which line is wrong."""
    read = Hierarchy()
    stack: list[int] = []
    joint = -1
    body = text.lstrip("\ufeff \t\r\n").removeprefix("HIERARCHY").replace("{", "\n{\n").replace("}", "\n}\n")
    for line in body.splitlines():
        match line.split():
            case ["ROOT" | "JOINT", *words]:
                joint = len(read.names)
                if joint >= MAX_JOINTS:
                    raise ClipError(f"the hierarchy has more than {MAX_JOINTS} joints")
                read.names.append(" ".join(words) or f"joint {joint}")
                read.parents.append(stack[-1] if stack else -1)
                read.offsets.append((0.0, 0.0, 0.0))
                read.channels.append(())
            case ["End", *_]:
                joint = -1
            case ["{"]:
                stack.append(joint)
            case ["}"] if stack:
                stack.pop()
            case ["OFFSET", x, y, z]:
                if joint >= 0:
                    read.offsets[joint] = tuple(_number(word, f"OFFSET of {read.names[joint]}") for word in (x, y, z))
            case ["CHANNELS", count, *channels] if joint >= 0:
                read.channels[joint] = _checked_channels(count, channels, read.names[joint])
            case []:
                pass
            case _:
                raise ClipError(f"not a line of a BVH hierarchy: {line.strip()[:60]!r}")
    if stack:
        raise ClipError("the hierarchy does not close all its braces")
    return read


def all_numbers(text: str, what: str) -> Array:
    """The numbers of a text with nothing but blanks between them."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise ClipError(f"{what} holds something that is not a number") from error


def euler_to_quat(angles: Array, axes: tuple[int, ...]) -> Array:
    """Turns about those axes (0 X, 1 Y, 2 Z), the last applied first. (..., n) radians to (..., 4)."""
    turned = np.zeros((*angles.shape[:-1], 4))
    turned[..., 3] = 1.0
    for place, axis in enumerate(axes):
        half = 0.5 * angles[..., place]
        sine, cosine = np.sin(half)[..., None], np.cos(half)[..., None]
        # (v, w) · (s·e, c) = (c·v + s·w·e + s·v×e, c·w − s·v·e)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        aside = np.zeros_like(turned)
        aside[..., axis], aside[..., 3] = turned[..., 3], -turned[..., axis]
        aside[..., first], aside[..., second] = turned[..., second], -turned[..., first]
        turned = cosine * turned + sine * aside
    return turned


def bvh_channels(read: BvhText, bones: Bones, order: list[int]) -> tuple[Array, Array, list[str]]:
    """Root positions in file units (T, 3), rotations (T, J, 4) and notes; joints as in `bones`."""
    frames = len(read.table)
    roots = np.tile(np.array(read.hierarchy.offsets[order[0]], dtype=np.float64), (frames, 1))
    turns = np.tile(rotations.IDENTITY, (frames, len(order), 1))
    alike: dict[tuple[int, ...], list[tuple[int, list[int]]]] = {}
    stretched = []
    for place, joint in enumerate(order):
        start = read.columns(joint).start
        kinds = [(*_CHANNELS[channel], start + index) for index, channel in enumerate(read.hierarchy.channels[joint])]
        spins = [(axis, column) for kind, axis, column in kinds if kind == "rotation"]
        alike.setdefault(tuple(axis for axis, _ in spins), []).append((place, [column for _, column in spins]))
        for kind, axis, column in kinds:
            if kind == "position" and place == 0:
                roots[:, axis] = read.table[:, column]
            elif kind == "position" and np.ptp(read.table[:, column]) > SLIGHT * max(1e-9, np.ptp(bones.offsets)):
                stretched.append(bones.names[place])
    for axes, joints in alike.items():
        if axes:
            columns = np.array([column for _, column in joints])  # (joints, angles)
            places = [place for place, _ in joints]
            for start in range(0, frames, _AT_ONCE):
                part = slice(start, start + _AT_ONCE)
                turns[part, places] = euler_to_quat(np.radians(read.table[part, columns]), axes)
    notes = [f"translations of {len(set(stretched))} joints dropped: bones keep their length"] if stretched else []
    return roots, turns, notes


def _checked_channels(count: str, channels: list[str], name: str) -> tuple[str, ...]:
    if count != str(len(channels)) or len(set(channels)) < len(channels) or not set(channels) <= _CHANNELS.keys():
        raise ClipError(f"{name}: CHANNELS must be their number and then as many of {', '.join(_CHANNELS)}, each once")
    return tuple(channels)


def _number(word: str, what: str) -> float:
    try:
        return float(word)
    except ValueError as error:
        raise ClipError(f"{what} must be a number, got {word[:20]!r}") from error
