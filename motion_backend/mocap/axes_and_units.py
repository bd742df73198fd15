"""What a file does not say: which way is up, which way the body faces, and how long a unit is.

Told by the body where its joints' names are known (joint_map.py), else by its size; every guess is noted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.mocap.clip import Bones, ClipError
from motion_backend.mocap.joint_map import JointMap, joint_places
from motion_backend.rotations import Array

UNITS = (
    ("metres", 1.0, 0.45, 1.3),
    ("centimetres", 0.01, 0.45, 1.3),
    ("millimetres", 0.001, 0.45, 1.3),
    ("CMU's unit, 0.45 inches", 0.0254 / 0.45, 0.62, 1.1),
    ("inches", 0.0254, 0.62, 1.1),
)
"""Name, metres, and the legs (hip to ankle, metres) that a body of this unit may have."""
USUAL_LEG = 0.833
"""Metres, hip to ankle: the mean of CMU's subjects."""
_LEG_SHARE = 0.49
"""Of a body's height."""
_SAMPLES = 60
_SURE = 0.7
"""Cosine between body and axis from which the body tells what is up."""
_Y = np.array([0.0, 1.0, 0.0])


class Pose(NamedTuple):
    """A motion on its way into our axes."""

    bones: Bones
    root_positions: Array
    local_rotations: Array
    tpose: Array
    notes: tuple[str, ...]


class Axes(NamedTuple):
    """Where the file's axes lie: rows of a proper rotation are our X, Y and Z in the file's frame."""

    matrix: Array

    def turn(self, vectors: Array) -> Array:
        """Vectors of the file in our axes. (..., 3)."""
        return np.asarray(vectors @ self.matrix.T)

    def turn_rotations(self, quaternions: Array) -> Array:
        """C R Cᵀ, as quaternions. (..., 4)."""
        return np.concatenate([self.turn(quaternions[..., :3]), quaternions[..., 3:]], axis=-1)

    @property
    def same(self) -> bool:
        """Whether they are ours already."""
        return bool((self.matrix == np.eye(3)).all())


Z_UP_FACING_X = Axes(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
"""(x, y, z) to (y, z, x)."""
Y_UP_FACING_X = Axes(np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))
"""(x, y, z) to (-z, y, x)."""


def unit_of(bones: Bones, given: JointMap | None = None) -> tuple[float, str]:
    """Metres a unit of the file, and why."""
    joints = joint_places(bones.names, given)
    rest = _rest(bones)
    if joints is None:
        leg = _LEG_SHARE * float(np.ptp(rest, axis=0).max())
        what = f"a skeleton {np.ptp(rest, axis=0).max():.4g} units large"
    else:
        chain = [joints[f"left_{part}"] for part in ("hip", "knee", "ankle")]
        leg = float(np.linalg.norm(np.diff(rest[chain], axis=0), axis=1).sum())
        what = f"legs of {leg:.4g} units"
    for name, metres, shortest, longest in UNITS:
        if shortest <= leg * metres <= longest:
            return metres, f"lengths taken as {name} (x {metres:.6g}), as {what} tell"
    if leg <= 0.0:
        raise ClipError("the skeleton has legs without length, so that its unit cannot be told")
    return USUAL_LEG / leg, f"lengths x {USUAL_LEG / leg:.6g}, as {what} fit no unit: legs made {USUAL_LEG} m long"


def to_our_axes(bones: Bones, root_positions: Array, local_rotations: Array, given: JointMap | None = None) -> Pose:
    """Y up, resting upright and facing +Z, from whatever axes the file has."""
    joints = joint_places(bones.names, given)
    if joints is None:
        note = "joint names of no family known: taken as Y up, facing +Z"
        return Pose(bones, root_positions, local_rotations, _at_rest(bones), (note,))
    rest = _standing_axes(_rest(bones), joints)
    up = _moving_up(bones, root_positions, local_rotations, joints)
    if rest is None:
        axes = _axes_of(_Y if up is None else up)
    else:
        axes = rest if up is None or up @ rest.matrix[1] > 0 else _axes_of(up)
    notes: list[str] = []
    if not axes.same:
        words = [_words(axis) for axis in axes.matrix]
        notes.append(f"axes turned: its {words[0]} is our +X, {words[1]} our +Y, {words[2]} our +Z")
        bones = Bones(bones.names, bones.parents, axes.turn(bones.offsets))
        root_positions, local_rotations = axes.turn(root_positions), axes.turn_rotations(local_rotations)
    tpose = _at_rest(bones)
    if rest is None:
        tpose = _best_stand(bones, local_rotations, joints)
        notes.append("the skeleton rests in no pose of a body: where it stands straightest is its rest pose")
    elif not (rest.matrix == axes.matrix).all():
        tpose[0] = rotations.matrix_to_quat(rest.matrix @ axes.matrix.T)
        notes.append("the skeleton rests in other axes than it moves in: its rest pose is stood up")
    return Pose(bones, root_positions, local_rotations, tpose, tuple(notes))


def _at_rest(bones: Bones) -> Array:
    return np.tile(rotations.IDENTITY, (len(bones.names), 1))


def _rest(bones: Bones) -> Array:
    """Joint positions of the pose without rotations. (J, 3)."""
    positions = bones.offsets.copy()
    positions[0] = 0.0
    for joint, parent in enumerate(bones.parents[1:], start=1):
        positions[joint] += positions[parent]
    return positions


def _upwards(positions: Array, joints: dict[str, int]) -> Array:
    """Unit vectors from between the ankles to the head. (T, J, 3) to (T, 3)."""
    feet = positions[:, [joints["left_ankle"], joints["right_ankle"]]].mean(axis=1)
    return rotations.normalize(positions[:, _top(joints)] - feet)


def _top(joints: dict[str, int]) -> int:
    return joints.get("head", joints.get("neck", joints["left_shoulder"]))


def _downwards(positions: Array, joints: dict[str, int]) -> Array:
    """Unit vectors down thighs, shins and trunk. (T, J, 3) to (T, 5, 3)."""
    legs = [[joints[f"{side}_{part}"] for part in ("hip", "knee", "ankle")] for side in ("left", "right")]
    parts = [np.diff(positions[:, leg], axis=1) for leg in legs]
    parts.append(positions[:, legs[0][:1]] - positions[:, [_top(joints)]])
    return rotations.normalize(np.concatenate(parts, axis=1))


def _standing_axes(rest: Array, joints: dict[str, int]) -> Axes | None:
    """The axes of a rest pose in which a body stands; None where it does not."""
    upwards = _upwards(rest[None], joints)[0]
    if not (_downwards(rest[None], joints)[0] @ upwards < -_SURE).all():
        return None
    up = _nearest_axis(upwards)
    across = rest[joints["left_hip"]] - rest[joints["right_hip"]]
    left = _nearest_axis(across - (across @ up) * up)
    return Axes(np.stack([left, up, np.cross(left, up)]))


def _moving_up(bones: Bones, roots: Array, turns: Array, joints: dict[str, int]) -> Array | None:
    """The axis along which the body stands on the ground while it moves; None where it mostly lies or crawls."""
    step = max(1, len(roots) // _SAMPLES)
    positions, _ = bones.forward_kinematics(roots[::step], turns[::step])
    mean = _upwards(positions, joints).mean(axis=0)
    up = _nearest_axis(mean)
    legs = positions[:, [joints[f"left_{part}"] for part in ("hip", "knee", "ankle")]]
    leg = float(np.linalg.norm(np.diff(legs, axis=1), axis=-1).sum(axis=1).mean())
    height = float((roots @ up).mean())
    return up if mean @ up > _SURE and 0.5 * leg < height < 1.5 * leg else None


def _axes_of(up: Array) -> Axes:
    """Our axes in a file of which only its up is known: its X stays ours unless that is up."""
    left = np.eye(3)[0] if up[0] == 0 else np.eye(3)[1]
    return Axes(np.stack([left, up, np.cross(left, up)]))


def _best_stand(bones: Bones, turns: Array, joints: dict[str, int]) -> Array:
    """Local rotations (J, 4) of the frame with the straightest legs and trunk, turned to face +Z."""
    positions, _ = bones.forward_kinematics(np.zeros((len(turns), 3)), turns)
    down = _downwards(positions, joints)[..., 1].sum(axis=1)
    best = int(down.argmin())
    across = positions[best, joints["left_hip"]] - positions[best, joints["right_hip"]]
    pose = np.array(turns[best])
    pose[0] = rotations.compose(rotations.yaw_to_quat(np.arctan2(across[2], across[0])), pose[0])
    return pose


def _nearest_axis(vector: Array) -> Array:
    axis: Array = np.zeros(3)
    largest = int(np.abs(vector).argmax())
    axis[largest] = 1.0 if vector[largest] >= 0 else -1.0
    return axis


def _words(axis: Array) -> str:
    largest = int(np.abs(axis).argmax())
    return f"{'+' if axis[largest] > 0 else '-'}{'XYZ'[largest]}"
