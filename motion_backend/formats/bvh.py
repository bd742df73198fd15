"""Motions as BVH, written and read: a hierarchy of offsets, then three Euler angles a joint and frame.

Lengths are centimetres unless told, as most tools expect; Y up; angles are degrees, R = Rz · Rx · Ry, an order that
keeps the heading of a standing body clear of gimbal lock.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.skeleton import JOINTS, Skeleton

Array = NDArray[np.float64]

CENTIMETRE = 0.01
_END_SITES = {
    "head": (0.0, 0.16, 0.0),
    "left_foot": (0.0, 0.0, 0.07),
    "right_foot": (0.0, 0.0, 0.07),
    "left_wrist": (0.17, 0.0, 0.0),
    "right_wrist": (-0.17, 0.0, 0.0),
}
"""Tips of the reference body, metres from the last joint: crown, toes, fingers."""


def bvh_text(motion: Motion, unit: float = CENTIMETRE) -> str:
    """The whole file; joint positions read back agree to less than 0.01 mm."""
    skeleton = motion.skeleton
    order: list[int] = []
    lines = ["HIERARCHY", *_hierarchy(skeleton, 0, "", unit, order), "MOTION"]
    lines += [f"Frames: {len(motion)}", f"Frame Time: {1.0 / motion.fps:.8f}"]
    angles = quats_to_zxy(motion.local_rotations[:, order].astype(np.float64))  # (T, J, 3)
    angles = np.unwrap(angles, axis=0)
    table = np.concatenate(
        [motion.root_positions / unit, np.degrees(angles).reshape(len(motion), -1)], axis=1, dtype=np.float64
    )
    row = " ".join(["%.5f"] * table.shape[1])
    return "\n".join([*lines, *(row % tuple(frame) for frame in table.tolist())]) + "\n"


def write_bvh(motion: Motion, path: Path | str) -> None:
    """Save the text, in centimetres."""
    Path(path).write_bytes(bvh_bytes(motion))


def bvh_bytes(motion: Motion) -> bytes:
    """The text in centimetres."""
    return bvh_text(motion).encode()


def _hierarchy(skeleton: Skeleton, joint: int, indent: str, unit: float, order: list[int]) -> list[str]:
    """Lines of a joint and all below it; `order` collects joints as they appear."""
    order.append(joint)
    name, parent = skeleton.names[joint], skeleton.parents[joint]
    turns = "Zrotation Xrotation Yrotation"
    channels = f"3 {turns}" if parent >= 0 else f"6 Xposition Yposition Zposition {turns}"
    inner = indent + "  "
    lines = [f"{indent}{'JOINT' if parent >= 0 else 'ROOT'} {name}", f"{indent}{{"]
    lines += [f"{inner}OFFSET {_triple(skeleton.offsets[joint] / unit)}", f"{inner}CHANNELS {channels}"]
    children = [child for child, above in enumerate(skeleton.parents) if above == joint]
    for child in children:
        lines += _hierarchy(skeleton, child, inner, unit, order)
    if not children:
        tip = np.asarray(_END_SITES.get(name, (0.0, 0.0, 0.0))) * skeleton.scale / unit
        lines += [f"{inner}End Site", f"{inner}{{", f"{inner}  OFFSET {_triple(tip)}", f"{inner}}}"]
    return [*lines, f"{indent}}}"]


def _triple(values: Array) -> str:
    return " ".join(f"{v:.6f}" for v in values)


def quats_to_zxy(q: Array) -> Array:
    """Angles (z, x, y) with R = Rz(z) · Rx(x) · Ry(y), radians. (..., 4) to (..., 3)."""
    m = rotations.quat_to_matrix(rotations.normalize(q))
    x = np.arcsin(np.clip(m[..., 2, 1], -1.0, 1.0))
    locked = np.abs(m[..., 2, 1]) > 1 - 1e-9
    z = np.where(locked, np.arctan2(m[..., 1, 0], m[..., 0, 0]), np.arctan2(-m[..., 0, 1], m[..., 1, 1]))
    y = np.where(locked, 0.0, np.arctan2(-m[..., 2, 0], m[..., 2, 2]))
    return np.stack([z, x, y], axis=-1)


@dataclass
class _Reader:
    """What the hierarchy says, joint by joint, as it is read."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[tuple[float, float, float]] = field(default_factory=list)
    channels: list[list[str]] = field(default_factory=list)

    def read(self, lines: list[str]) -> None:
        """Take in the lines of the hierarchy."""
        stack: list[int] = []
        joint = -1
        for line in lines:
            match line.split():
                case ["ROOT" | "JOINT", *words]:
                    joint = len(self.names)
                    self.names.append(" ".join(words))
                    self.parents.append(stack[-1] if stack else -1)
                    self.offsets.append((0.0, 0.0, 0.0))
                    self.channels.append([])
                case ["End", *_]:
                    joint = -1
                case ["{"]:
                    stack.append(joint)
                case ["}"] if stack:
                    stack.pop()
                case ["OFFSET", x, y, z]:
                    if joint >= 0:
                        self.offsets[joint] = (float(x), float(y), float(z))
                case ["CHANNELS", _, *channels] if joint >= 0:
                    self.channels[joint] = channels
                case []:
                    pass
                case _:
                    raise ValueError(f"not a line of a BVH hierarchy: {line.strip()!r}")


def read_bvh(text: str, unit: float = CENTIMETRE) -> Motion:
    """A motion from BVH text in any channel order; `unit` is its length unit in metres.

    Joints with our names come back in our order, others as the file has them. Contacts and keyframes, which BVH does
    not hold, are zero. ValueError tells what is wrong with the text.
    """
    head, found, tail = text.partition("MOTION")
    if not found or not head.lstrip().startswith("HIERARCHY"):
        raise ValueError("a BVH text has a HIERARCHY and then a MOTION section")
    reader = _Reader()
    reader.read(head.lstrip().removeprefix("HIERARCHY").replace("{", "\n{\n").replace("}", "\n}\n").splitlines())
    counts = re.match(r"\s*Frames:\s*(\d+)\s*Frame Time:\s*([\d.eE+-]+)", tail)
    if counts is None or not reader.names:
        raise ValueError("a BVH text names its joints, then says Frames: and Frame Time:")
    frames, step = int(counts[1]), float(counts[2])
    width = sum(len(c) for c in reader.channels)
    values = np.array(tail[counts.end() :].split(), dtype=np.float64)
    if len(values) != frames * width:
        raise ValueError(f"{frames} frames of {width} channels need {frames * width} numbers, there are {len(values)}")
    return _to_motion(reader, values.reshape(frames, width), unit, round(1.0 / step))


def _to_motion(reader: _Reader, table: Array, unit: float, fps: int) -> Motion:
    frames = len(table)
    turns = np.tile(rotations.IDENTITY, (frames, len(reader.names), 1))
    root = np.tile(np.asarray(reader.offsets[0]), (frames, 1))
    column = 0
    for joint, channels in enumerate(reader.channels):
        for channel in channels:
            axis = "XYZ".index(channel[0])
            if channel.endswith("rotation"):
                turn = rotations.rotvec_to_quat(np.radians(table[:, column, None]) * np.eye(3)[axis])
                turns[:, joint] = rotations.compose(turns[:, joint], turn)
            elif joint == 0:
                root[:, axis] = table[:, column]
            column += 1
    order = _our_order(reader.names)
    place = {old: new for new, old in enumerate(order)}
    skeleton = Skeleton(
        tuple(reader.names[j] for j in order),
        tuple(place[reader.parents[j]] if reader.parents[j] >= 0 else -1 for j in order),
        np.asarray([reader.offsets[j] for j in order]) * unit,
    )
    return Motion(
        root_positions=(root * unit).astype(np.float32),
        local_rotations=rotations.continuous(turns[:, order]).astype(np.float32),
        contacts=np.zeros((frames, 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(frames, dtype=np.int32),
        fps=fps,
    )


def _our_order(names: list[str]) -> list[int]:
    if sorted(names) == sorted(JOINTS):
        return [names.index(name) for name in JOINTS]
    return list(range(len(names)))
