"""DeepMimic's JSON and AMP's npy: two ways of the same body to keep motions.

AMP's skeleton motions: .npy files that hold one pickled dictionary, read without unpickling.

Z up, facing +X, left +Y, metres; local or world rotations xyzw of named joints.

DeepMimic: JSON text with one row of 44 numbers a frame, for the one body the format is made for.

Y up, facing +X, left -Z; quaternions wxyz; knees and elbows are hinges about the body's right. A row begins with the
seconds to the next one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.axes_and_units import Y_UP_FACING_X, Z_UP_FACING_X
from motion_backend.mocap.clip import MAX_FRAMES, Clip, ClipError, make_bones, make_clip, unit_quaternions
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.readers.safe_numpy import npy_header
from motion_backend.mocap.readers.safe_pickle import read_pickled
from motion_backend.mocap.resampling import resampled_positions, resampled_rotations, uniform_times
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.rotations import Array
from scene_graphs.errors import FieldPath
from scene_graphs.loaders.scene_source import parse_json


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
        raise ClipError("it holds plain numbers", "an .npy motion is one dictionary with a skeleton_tree")
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


WIDTH = 44
_BODY = (
    ("root", -1, (0.0, 0.0, 0.0), 4),
    ("chest", 0, (0.0, 0.236, 0.0), 4),
    ("neck", 1, (0.0, 0.224, 0.0), 4),
    ("right_hip", 0, (0.0, 0.0, 0.085), 4),
    ("right_knee", 3, (0.0, -0.422, 0.0), 1),
    ("right_ankle", 4, (0.0, -0.410, 0.0), 4),
    ("right_shoulder", 1, (-0.024, 0.244, 0.183), 4),
    ("right_elbow", 6, (0.0, -0.275, 0.0), 1),
    ("left_hip", 0, (0.0, 0.0, -0.085), 4),
    ("left_knee", 8, (0.0, -0.422, 0.0), 1),
    ("left_ankle", 9, (0.0, -0.410, 0.0), 4),
    ("left_shoulder", 1, (-0.024, 0.244, -0.183), 4),
    ("left_elbow", 11, (0.0, -0.275, 0.0), 1),
    ("right_wrist", 7, (0.0, -0.259, 0.0), 0),
    ("left_wrist", 12, (0.0, -0.259, 0.0), 0),
)
"""Joint, parent, offset in the format's axes (metres, to the millimetre) and numbers in a row, in the rows' order."""


def read_deepmimic_clip(text: str, name: str) -> Clip:
    """The clip in a DeepMimic text. ClipError says what is wrong with it."""
    rows = _rows(text, name)
    steps = rows[:-1, 0]
    if not (steps > 0).all():
        raise ClipError("the first number of each row but the last must be the seconds to the next, above zero")
    names, parents, offsets, widths = zip(*_BODY, strict=True)
    bones, order = make_bones(names, parents, Y_UP_FACING_X.turn(np.array(offsets)))
    turns = np.empty((len(rows), len(names), 4))
    column = 4
    for joint, width in enumerate(widths):
        turns[:, order.index(joint)] = _turns(rows[:, column : column + width])
        column += width
    turns, odd = unit_quaternions(Y_UP_FACING_X.turn_rotations(turns))
    roots = Y_UP_FACING_X.turn(rows[:, 1:4])
    notes = ["axes turned: its -Z is our +X, +Y our +Y, +X our +Z", "the format's own body; wrists do not move", *odd]
    if np.ptp(steps) > 0.01 * steps.mean():
        times = np.concatenate([[0.0], np.cumsum(steps)])
        wanted = uniform_times(times, 1 / float(np.median(steps)))
        roots, turns = resampled_positions(times, roots, wanted), resampled_rotations(times, turns, wanted)
        notes.append("frames of unequal length resampled")
    tpose = t_posed(bones, np.tile(rotations.IDENTITY, (len(names), 1)))
    return make_clip(name, bones, roots, turns, tpose, 1 / float(np.median(steps)), "deepmimic", notes)


def _rows(text: str, name: str) -> Array:
    read = parse_json(text, FieldPath((name,)))
    rows = read.get("Frames") if isinstance(read, dict) else None
    if not isinstance(rows, list) or not all(isinstance(row, list) for row in rows):
        raise ClipError('a DeepMimic motion is an object whose "Frames" are lists of numbers')
    if not 2 <= len(rows) <= MAX_FRAMES:
        raise ClipError(f"it has {len(rows)} frames", f"a clip has 2 to {MAX_FRAMES}")
    wrong = next((number for number, row in enumerate(rows) if len(row) != WIDTH), None)
    if wrong is not None:
        raise ClipError(f"Frames[{wrong}] has {len(rows[wrong])} numbers; {WIDTH} are wanted")
    try:
        table = np.array(rows, dtype=np.float64).reshape(len(rows), WIDTH)
    except (TypeError, ValueError) as error:
        raise ClipError(f"Frames hold something that is not a number: {error}") from error
    if not np.isfinite(table).all():
        raise ClipError(f"Frames[{np.argwhere(~np.isfinite(table))[0][0]}] holds a number that is not finite")
    return table


def _turns(values: Array) -> Array:
    """Rotations in the format's axes: a quaternion wxyz, an angle about Z, or none. (T, 4 | 1 | 0) to (T, 4)."""
    if values.shape[1] == 4:
        return np.roll(values, -1, axis=1)
    if values.shape[1] == 1:
        return rotations.rotvec_to_quat(values * np.array([0.0, 0.0, 1.0]))
    return np.tile(rotations.IDENTITY, (len(values), 1))
