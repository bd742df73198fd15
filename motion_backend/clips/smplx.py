"""AMASS and SMPL-X archives (npz): axis-angle poses and a path, without the body model.

The model's own shape is not used: its joints stand on bones of our lengths. AMASS is Z up, some others Y up; which it
is, the body itself tells.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.clips.clip import Array, Clip, ClipError, make_bones, make_clip
from motion_backend.skeleton import JOINTS, PARENTS, build_skeleton

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
        raise ClipError(f"poses need {_BODY} numbers a frame or more, three a joint; there are {poses.shape[1]}")
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
