"""Motions as BVH: a hierarchy of offsets, then three Euler angles a joint and frame.

Lengths are centimetres unless told, as most tools expect; Y up; angles are degrees, R = Rz · Rx · Ry, an order that
keeps the heading of a standing body clear of gimbal lock.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

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
