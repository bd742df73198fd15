"""AMASS, SMPL-X and Kimodo archives (npz): poses of SMPL's joints.

Kimodo: where 30 joints are and how they are turned in the world. Y up, facing +Z, metres, 30 fps.

AMASS and SMPL-X archives (npz): axis-angle poses and a path, without the body model.

The model's own shape is not used: its joints stand on bones of our lengths. AMASS is Z up, some others Y up; which it
is, the body itself tells.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.clip import MAX_FRAMES, Clip, ClipError, make_bones, make_clip
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.rotations import Array
from motion_backend.skeleton import JOINTS, PARENTS, build_skeleton

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


RATES: Final = ("mocap_framerate", "mocap_frame_rate", "fps")
_BODY: Final = 3 * len(JOINTS)
_PARTS: Final = ("root_orient", "pose_body")
_Z_TO_Y_UP: Final = rotations.rotvec_to_quat(np.array([-np.pi / 2, 0.0, 0.0]))


def is_smplx(names: Mapping[str, Any]) -> bool:
    """Whether an archive with these arrays is one."""
    return "trans" in names and ("poses" in names or names.keys() >= set(_PARTS))


def read_smplx_clip(arrays: Mapping[str, NDArray[Any]], name: str) -> Clip:
    """The clip in the arrays of an archive. ClipError says what is wrong with them."""
    poses = _poses(arrays)
    trans = np.asarray(arrays["trans"], dtype=np.float64)
    if trans.shape != (len(poses), 3):
        raise ClipError(f"trans must be of shape ({len(poses)}, 3), one row a pose, not {trans.shape}")
    fps = _rate(arrays)
    skeleton = build_skeleton()
    bones, order = make_bones(JOINTS, PARENTS, skeleton.offsets)
    vectors = poses[:, :_BODY].reshape(len(poses), -1, 3)[:, order]
    turns = rotations.rotvec_to_quat(vectors)
    notes = ["the body model's shape is not used: bones of our own lengths", "trans taken as the pelvis's path"]
    if poses.shape[1] > _BODY:
        notes.append(f"{poses.shape[1] // 3 - len(JOINTS)} joints of hands and face left out")
    if _is_z_up(turns[:, 0]):
        notes.append("Z up, turned to Y up")
        trans = rotations.rotate(_Z_TO_Y_UP, trans)
        turns[:, 0] = rotations.compose(_Z_TO_Y_UP, turns[:, 0])
    tpose = np.tile(rotations.IDENTITY, (len(JOINTS), 1))
    return make_clip(name, bones, trans, turns, tpose, fps, "smplx", notes)


def _poses(arrays: Mapping[str, NDArray[Any]]) -> Array:
    """Axis-angle rotations. (T, 3 J), J at least 22."""
    parts = [arrays["poses"]] if "poses" in arrays else [arrays[part] for part in _PARTS]
    try:
        poses = np.concatenate([np.asarray(part, dtype=np.float64).reshape(len(part), -1) for part in parts], axis=1)
    except (TypeError, ValueError) as error:
        raise ClipError(f"poses must be numbers, one row a frame: {error}") from error
    if poses.shape[1] < _BODY or poses.shape[1] % 3:
        raise ClipError(f"poses need {_BODY} numbers a frame or more, three a joint", f"there are {poses.shape[1]}")
    if not np.isfinite(poses).all():
        wrong = np.argwhere(~np.isfinite(poses))[0][0]
        raise ClipError(f"poses hold a number that is not finite, first in frame {wrong}")
    return poses


def _rate(arrays: Mapping[str, NDArray[Any]]) -> float:
    found = next((arrays[key] for key in RATES if key in arrays), None)
    if found is None or found.size != 1 or found.dtype.kind not in "iuf":
        raise ClipError(f"the archive must say its frames a second, as one of {', '.join(RATES)}")
    return float(found.reshape(()))


def _is_z_up(root: Array) -> bool:
    """AMASS unless the body, whose own up is Y, mostly stands along Y. root: (T, 4)."""
    up = rotations.rotate(root, np.array([0.0, 1.0, 0.0])).mean(axis=0)
    return bool(up[1] < 0.7)
