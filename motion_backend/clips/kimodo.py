"""Kimodo archives (npz): where 30 joints are and how they are turned in the world. Y up, facing +Z, metres, 30 fps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.clips.clip import MAX_FRAMES, Clip, ClipError, make_bones, make_clip
from motion_backend.clips.tposes import t_posed

FPS: Final = 30.0
_TRUNK: Final = (
    ("Hips", None),
    ("Spine1", "Hips"),
    ("Spine2", "Spine1"),
    ("Chest", "Spine2"),
    ("Neck1", "Chest"),
    ("Neck2", "Neck1"),
    ("Head", "Neck2"),
    ("Jaw", "Head"),
    ("LeftEye", "Head"),
    ("RightEye", "Head"),
)
_ARM: Final = (
    ("Shoulder", "Chest"),
    ("Arm", "Shoulder"),
    ("ForeArm", "Arm"),
    ("Hand", "ForeArm"),
    ("HandThumbEnd", "Hand"),
    ("HandMiddleEnd", "Hand"),
)
_LEG: Final = (("Leg", "Hips"), ("Shin", "Leg"), ("Foot", "Shin"), ("ToeBase", "Foot"))


def _joints() -> list[tuple[str, str | None]]:
    """Every joint and its parent, in the archive's order."""
    joints: list[tuple[str, str | None]] = list(_TRUNK)
    for limb in (_ARM, _LEG):
        for side in ("Left", "Right"):
            joints += [(side + name, above if above in ("Chest", "Hips") else side + above) for name, above in limb]
    return joints


def is_kimodo(names: Mapping[str, Any]) -> bool:
    """Whether an archive with these arrays is one."""
    return names.keys() >= {"posed_joints", "global_rot_mats"}


def read_kimodo_clip(arrays: Mapping[str, NDArray[Any]], name: str) -> Clip:
    """The clip in the arrays of an archive. ClipError says what is wrong with them."""
    joints = _joints()
    names = [joint for joint, _ in joints]
    parents = [-1 if above is None else names.index(above) for _, above in joints]
    positions, turned = arrays["posed_joints"], arrays["global_rot_mats"]
    frames = len(positions) if positions.ndim else 0
    if positions.shape != (frames, len(names), 3) or turned.shape != (frames, len(names), 3, 3) or not frames:
        raise ClipError(
            f"posed_joints and global_rot_mats must be (T, {len(names)}, 3) and (T, {len(names)}, 3, 3), "
            f"not {positions.shape} and {turned.shape}"
        )
    if frames > MAX_FRAMES or positions.dtype.kind != "f" or turned.dtype.kind != "f":
        raise ClipError(f"posed_joints and global_rot_mats must be floats of at most {MAX_FRAMES} frames")
    matrices = turned.astype(np.float64)
    square = np.einsum("tjik,tjil->tjkl", matrices, matrices)
    if not (np.abs(square - np.eye(3)) < 0.05).all() or not (np.linalg.det(matrices) > 0).all():
        raise ClipError("global_rot_mats hold a matrix that is no rotation")
    world = rotations.matrix_to_quat(matrices)
    local, offsets = world.copy(), np.zeros((len(names), 3))
    for joint, parent in enumerate(parents):
        if parent >= 0:
            back = rotations.inverse(world[:, parent])
            local[:, joint] = rotations.compose(back, world[:, joint])
            between = positions[:, joint].astype(np.float64) - positions[:, parent]
            offsets[joint] = rotations.rotate(back, between).mean(axis=0)
    bones, order = make_bones(names, parents, offsets)
    tpose = t_posed(bones, np.tile(rotations.IDENTITY, (len(names), 1)))
    notes = ("30 frames a second: the format does not say",)
    return make_clip(name, bones, positions[:, 0], local[:, order], tpose, FPS, "kimodo", notes)
