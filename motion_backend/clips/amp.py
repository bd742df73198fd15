"""AMP's skeleton motions: .npy files that hold one pickled dictionary, read without unpickling.

Z up, facing +X, left +Y, metres; local or world rotations xyzw of named joints.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from motion_backend import rotations
from motion_backend.clips.arrays import npy_header
from motion_backend.clips.clip import Array, Clip, ClipError, make_bones, make_clip
from motion_backend.clips.mapping import JointMap
from motion_backend.clips.orienting import Z_UP_FACING_X
from motion_backend.clips.tposes import t_posed
from motion_backend.clips.unpickled import read_pickled


def read_amp_clip(data: bytes, name: str, joints: JointMap | None = None) -> Clip:
    """The clip in the bytes of such a file. ClipError says what is wrong with them."""
    read = read_pickled(_pickle_in(data))
    tree = read.get("skeleton_tree") if isinstance(read, dict) else None
    if not isinstance(tree, dict):
        raise ClipError("an .npy motion is one dictionary with a skeleton_tree; this is none")
    names = _names(tree.get("node_names"))
    parents = _array(tree, "parent_indices")
    if parents.shape != (len(names),) or parents.dtype.kind not in "iu":
        raise ClipError(f"parent_indices must be {len(names)} whole numbers, one a name")
    offsets = _floats(tree, "local_translation")
    if offsets.shape != (len(names), 3):
        raise ClipError(f"local_translation must be of shape ({len(names)}, 3), not {offsets.shape}")
    turns, roots = _floats(read, "rotation"), _floats(read, "root_translation")
    if turns.ndim != 3:
        raise ClipError("it holds one pose, not a motion: rotation must be of shape (T, J, 4)")
    if turns.shape != (len(roots), len(names), 4) or roots.shape != (len(roots), 3):
        raise ClipError(
            f"rotation and root_translation must be of shapes (T, {len(names)}, 4) and (T, 3), "
            f"not {turns.shape} and {roots.shape}"
        )
    bones, order = make_bones(names, parents.tolist(), Z_UP_FACING_X.turn(offsets))
    turns = Z_UP_FACING_X.turn_rotations(turns)[:, order]
    notes = ["Z up, turned to Y up: its +Y is our +X, +Z our +Y, +X our +Z"]
    if not read.get("is_local", True):
        turns = _local(turns, bones.parents)
        notes.append("world rotations made local")
    rate = read.get("fps")
    if not isinstance(rate, int | float | np.ndarray | np.number) or np.size(rate) != 1:
        raise ClipError("fps must be one number, the frames a second")
    tpose = t_posed(bones, np.tile(rotations.IDENTITY, (len(names), 1)), joints)
    fps = float(np.reshape(rate, ()))
    return make_clip(name, bones, Z_UP_FACING_X.turn(roots), turns, tpose, fps, "amp", notes)


def _pickle_in(data: bytes) -> bytes:
    """What follows the header of an .npy file that holds one object."""
    header = npy_header(data)
    if header.descr != "|O" or header.shape != ():
        raise ClipError("it holds plain numbers; an .npy motion is one dictionary with a skeleton_tree")
    return data[header.start :]


def _local(world: Array, parents: tuple[int, ...]) -> Array:
    """Each joint in its parent's frame. (T, J, 4)."""
    local = world.copy()
    for joint, parent in enumerate(parents[1:], start=1):
        local[:, joint] = rotations.compose(rotations.inverse(world[:, parent]), world[:, joint])
    return local


def _names(found: Any) -> list[str]:
    """Joint names from a list, or an array of texts bare or under "arr"."""
    found = found.get("arr") if isinstance(found, dict) else found
    if not isinstance(found, list | np.ndarray) or not all(isinstance(joint, str) for joint in found):
        raise ClipError("node_names must be a list of texts")
    return [str(joint) for joint in found]


def _array(read: dict[str, Any], key: str) -> np.ndarray[Any, np.dtype[Any]]:
    """An array, bare or under "arr"."""
    found = read.get(key)
    found = found.get("arr") if isinstance(found, dict) else found
    if not isinstance(found, np.ndarray):
        raise ClipError(f"it must hold {key!r}, as an array")
    return found


def _floats(read: dict[str, Any], key: str) -> Array:
    found = _array(read, key)
    if found.dtype.kind not in "fiu":
        raise ClipError(f"{key} must be numbers")
    return found.astype(np.float64)
