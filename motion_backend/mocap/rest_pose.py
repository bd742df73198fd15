"""Our body in a source's poses: world rotations carried over from joint to joint, without lengths.

`R_ours(t) = R_source(t) · R_source_rest⁻¹ · R_ours_rest` for every joint that the source has; of the others those of
the trunk turn between the ones beside them, the rest follow their parent. Our rest is posed like the source's first,
limb by limb, so that limbs point the same way whether its rest is a T-pose, arms hanging, or something between.

The T-pose of a source skeleton: arms along ±X, legs straight down, from a rest pose that may differ from it.

Limbs that are already within ten degrees stay as they are; what hangs on a limb goes along rigidly, as a foot does
that is straight for a leg set at an angle (Acclaim).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.clip import Bones, ClipError
from motion_backend.mocap.joint_map import JointMap, joint_places
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, PARENTS, Skeleton

LIMBS = tuple(
    (f"{side}_{upper}", f"{side}_{lower}")
    for side in ("left", "right")
    for upper, lower in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))
)
"""Bones whose direction is carried over exactly: the joint that turns each, and its far end."""
_MIN_BONE_LENGTH = 0.02
"""Metres under which a bone of the source points nowhere in particular."""
TRUNK = ("pelvis", "spine1", "spine2", "spine3", "neck", "head")
SURE_BEND = 0.1
"""Mean sine of a limb's bend from which its plane can be told."""
SURE_AXIS = 0.8
"""How much of its bending is about one axis, for it to be a hinge."""
MAX_ROLL = 1.2
"""Radians beyond which a limb does not bend as ours do but the wrong way, as knees in a bad fit of markers."""
MIN_FLAT = 4
UPRIGHT = 0.8
"""Share of a leg's length that a hip is above the ankle when one stands."""
MAX_PITCH, MAX_TILT = 0.3, 0.6
"""Radians by which a standing sole may seem to point up or down, or lean to a side, and still be taken for flat."""
_UP = np.array([0.0, 1.0, 0.0])
_BONES = {
    f"{side}_{joint}": np.array(bone)
    for side, sign in (("left", 1.0), ("right", -1.0))
    for joint, bone in (("hip", (0.0, -1.0, 0.0)), ("shoulder", (sign, 0.0, 0.0)))
}


class Rest(NamedTuple):
    """The pose in which the source and our body are compared."""

    source: Array
    """(J, 4) world rotations of the source's joints."""
    ours: Array
    """(22, 4) world rotations of our joints in the same pose."""
    trunk: Array
    """(3,) from between the source's hips to between its shoulders."""


class Source(NamedTuple):
    """What a source's body does: world positions (T, J, 3) and rotations (T, J, 4), and the names' places."""

    positions: Array
    turns: Array
    places: dict[str, int]
    """Our joint name to the source's joint."""

    def at(self, *joints: str) -> Array:
        """Positions of our joints as the source has them. (T, len(joints), 3)."""
        return self.positions[:, [self.places[joint] for joint in joints]]


def shortest_turn(a: Array, b: Array) -> Array:
    """The least rotation from unit vectors a to b. (..., 3) twice to (..., 4)."""
    half = np.concatenate([rotations.cross(a, b), 1.0 + np.sum(a * b, axis=-1, keepdims=True)], axis=-1)
    opposite = half[..., 3:] < 1e-9
    helper = np.where(np.abs(a[..., :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    aside = np.concatenate([rotations.normalize(rotations.cross(a, helper)), np.zeros_like(half[..., 3:])], axis=-1)
    return rotations.normalize(np.where(opposite, aside, half))


def common_rest(positions: Array, turns: Array, joints: JointMap, places: dict[str, int], body: Skeleton) -> Rest:
    """Our body posed like the source's rest, and that rest turned to face +Z.

    positions, turns: (J, 3), (J, 4) of the source at rest.
    """
    across = positions[places["left_hip"]] - positions[places["right_hip"]]
    if np.hypot(across[0], across[2]) < 1e-6:
        raise ClipError("the rest pose has both hips in one place, so that left and right cannot be told")
    square = rotations.yaw_to_quat(np.arctan2(across[2], across[0]))
    found = rotations.rotate(square, positions)
    ours = np.tile(rotations.IDENTITY, (len(JOINTS), 1))
    for joint, parent in enumerate(PARENTS):
        name = JOINTS[joint]
        far = dict(LIMBS).get(name)
        if name.endswith(("elbow", "wrist", "knee")):
            ours[joint] = ours[parent]
        if far is not None:
            bone = found[places[far]] - found[places[name]]
            if np.linalg.norm(bone) < _MIN_BONE_LENGTH:
                raise ClipError(f"the bone from {joints[name]!r} to {joints[far]!r} has no length")
            rest = rotations.rotate(ours[joint], rotations.normalize(body.offsets[INDEX[far]]))
            ours[joint] = rotations.compose(shortest_turn(rest, rotations.normalize(bone)), ours[joint])
        elif name.endswith("ankle") and name.replace("ankle", "foot") in joints:
            # Soles lie flat at rest whatever a bone from ankle to toes says: only where they point is taken over.
            toes = found[places[name.replace("ankle", "foot")]] - found[places[name]]
            if np.hypot(toes[0], toes[2]) > _MIN_BONE_LENGTH:
                ours[joint] = rotations.yaw_to_quat(np.arctan2(toes[0], toes[2]))
        elif name.endswith("foot"):
            ours[joint] = ours[parent]
    hips, shoulders = ([places[f"{side}_{end}"] for side in ("left", "right")] for end in ("hip", "shoulder"))
    trunk = found[shoulders].mean(axis=0) - found[hips].mean(axis=0)
    return Rest(rotations.compose(square, turns), ours, trunk)


def carry_over(source: Source, rest: Rest) -> Array:
    """World rotations of our 22 joints. (T, 22, 4)."""
    known = [joint for joint, name in enumerate(JOINTS) if name in source.places]
    places = [source.places[JOINTS[joint]] for joint in known]
    change = rotations.compose(rotations.inverse(rest.source[places]), rest.ours[known])
    world = np.empty((len(source.turns), len(JOINTS), 4))
    world[:, known] = rotations.compose(source.turns[:, places], change)
    for joint, parent in enumerate(PARENTS):
        if joint not in known:
            since_parent = rotations.compose(rotations.inverse(rest.ours[parent]), rest.ours[joint])
            bent = _bent_between(world, source.places, JOINTS[joint])
            world[:, joint] = rotations.compose(world[:, parent], since_parent) if bent is None else bent
    return world


def _bent_between(world: Array, places: dict[str, int], name: str) -> Array | None:
    """A joint of the trunk that the source lacks, on its even way from the one below that it has to the one above.

    A head turns the neck, not the chest. None where there is no such joint. (T, 4).
    """
    part = next((part for part in (TRUNK[:4], TRUNK[3:]) if name in part[1:-1]), ())
    above = [joint for joint in part[part.index(name) + 1 :] if joint in places] if part else []
    if not above:
        return None
    lower = max(place for place, joint in enumerate(part[: part.index(name)]) if place == 0 or joint in places)
    share = (part.index(name) - lower) / (part.index(above[0]) - lower)
    return rotations.slerp(world[:, INDEX[part[lower]]], world[:, INDEX[above[0]]], np.full(len(world), share))


def rolled_to_hinges(source: Source, rest: Rest, world: Array) -> Rest:
    """The rest with thighs and upper arms rolled about themselves so that knees and elbows bend as hinges of ours.

    Which way a rest pose has its elbows, nobody can see while arms are straight; how they bend tells.
    world: (T, 22, 4) ours as carried over with the rest.
    """
    ours = rest.ours.copy()
    for upper, middle in LIMBS[::2]:
        far = dict(LIMBS)[middle]
        ends = source.at(upper, middle, far)
        # The hinge is at right angles to both bones, and its length the sine of the bend: weak bends weigh little.
        along = rotations.normalize(np.diff(ends, axis=1))
        normal = rotations.cross(along[:, 0], along[:, 1])
        hinges = rotations.rotate(rotations.inverse(world[:, INDEX[upper]]), normal)
        hinge, wanted = hinges.mean(axis=0), _hinge_axis(upper)
        bone = rotations.normalize(_BONES[upper])
        hinge = hinge - (hinge @ bone) * bone
        size = np.linalg.norm(hinge)
        if size < SURE_BEND or size < SURE_AXIS * np.linalg.norm(hinges, axis=1).mean():
            continue
        angle = np.arctan2(rotations.cross(wanted, hinge) @ bone, wanted @ hinge)
        if abs(angle) > MAX_ROLL:
            continue
        ours[INDEX[upper]] = rotations.compose(ours[INDEX[upper]], rotations.rotvec_to_quat(angle * bone))
    return rest._replace(ours=ours)


def with_flat_feet(source: Source, rest: Rest, world: Array, leg: float, fps: float) -> Rest:
    """The rest with soles turned so that feet that stand lie flat.

    A rest with legs apart tells nothing of its soles: they may be level, or square to the shanks. Standing ones tell.
    world: (T, 22, 4) ours as carried over with the rest. leg: metres from hip to ankle at the source's present size.
    """
    ours = rest.ours.copy()
    for joint in ("ankle", "foot"):
        ups: dict[str, Array] = {}
        for side in ("left", "right"):
            ankle, turns = source.at(f"{side}_ankle")[:, 0], world[:, INDEX[f"{side}_ankle"]]
            tall = source.at(f"{side}_hip")[:, 0, 1] - ankle[:, 1] > UPRIGHT * leg
            flat = tall & _flat_frames(ankle, turns, fps)
            if flat.sum() >= MIN_FLAT:
                found = rotations.rotate(rotations.inverse(world[flat, INDEX[f"{side}_{joint}"]]), _UP)
                ups[side] = np.median(found, axis=0)
        for side, other in (("left", "right"), ("right", "left")):
            if not ups:
                continue
            # A foot that never rests is taken to be the other's image.
            up = ups[side] if side in ups else ups[other] * [-1.0, 1.0, 1.0]
            if abs(np.arctan2(up[2], up[1])) < MAX_PITCH and abs(np.arctan2(up[0], up[1])) < MAX_TILT:
                place = INDEX[f"{side}_{joint}"]
                ours[place] = rotations.compose(ours[place], shortest_turn(_UP, rotations.normalize(up)))
    return rest._replace(ours=ours)


def _flat_frames(ankle: Array, turns: Array, fps: float) -> NDArray[np.bool_]:
    """When an ankle is as low as it comes, still, and does not turn. (T, 3), (T, 4) to (T,)."""
    if len(ankle) < 2:
        return np.zeros(len(ankle), dtype=np.bool_)
    speed = np.linalg.norm(np.gradient(ankle, axis=0), axis=-1) * fps
    spin = np.linalg.norm(np.gradient(rotations.rotate(turns, np.array([0.0, 0.0, 1.0])), axis=0), axis=-1) * fps
    low = ankle[:, 1] < np.percentile(ankle[:, 1], 5.0) + 0.03
    return np.asarray(low & (speed < 0.25) & (spin < 1.0))


def _hinge_axis(upper: str) -> Array:
    """About which a bent limb has turned, upper bone to lower, in the frame of the upper."""
    if upper.endswith("hip"):
        return np.array([1.0, 0.0, 0.0])
    return np.array([0.0, -1.0 if upper.startswith("left") else 1.0, 0.0])


def world_to_local(world: Array) -> Array:
    """Each joint in its parent's frame. (T, 22, 4)."""
    above = world[:, list(PARENTS[1:])]
    return np.concatenate([world[:, :1], rotations.compose(rotations.inverse(above), world[:, 1:])], axis=1)


def placed(skeleton: Skeleton, pelvis: Array, world: Array) -> Array:
    """Joint positions from world rotations. (T, 22, 3)."""
    positions = np.empty((len(pelvis), len(JOINTS), 3))
    positions[:, 0] = pelvis
    bones = rotations.rotate(world[:, PARENTS[1:]], skeleton.offsets[1:])
    for joint, parent in enumerate(PARENTS[1:], start=1):
        positions[:, joint] = positions[:, parent] + bones[:, joint - 1]
    return positions


CLOSE: Final = np.cos(np.radians(10.0))
_DOWN: Final = np.array([0.0, -1.0, 0.0])
_SEGMENTS: Final = (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))


def t_posed(bones: Bones, rest: Array, given: JointMap | None = None) -> Array:
    """Local rotations (J, 4) of the T-pose; the rest pose where neither the map given nor a family names its joints."""
    pose = rest.copy()
    positions, world = _at_origin(bones, pose)
    for upper, lower, wanted in _limbs(bones, given):
        along = rotations.normalize(positions[lower] - positions[upper])
        if along.any() and along @ wanted < CLOSE:
            turned = rotations.compose(_shortest_turn(along, wanted), world[upper])
            above = bones.parents[upper]
            before = world[above] if above >= 0 else rotations.IDENTITY
            pose[upper] = rotations.compose(rotations.inverse(before), turned)
            positions, world = _at_origin(bones, pose)
    return pose


def is_t_pose(bones: Bones, pose: Array, given: JointMap | None = None) -> bool:
    """Whether every limb is near a T-pose's; False where neither the map given nor a family names its joints."""
    positions, _ = _at_origin(bones, pose)
    close = [
        bool(rotations.normalize(positions[lower] - positions[upper]) @ wanted >= CLOSE)
        for upper, lower, wanted in _limbs(bones, given)
    ]
    return bool(close) and all(close)


def _limbs(bones: Bones, given: JointMap | None) -> Iterator[tuple[int, int, Array]]:
    """Upper and lower joint of each limb's bones, from the trunk outwards, and where it points in a T-pose."""
    joints = joint_places(bones.names, given)
    if joints is None:
        return
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for upper, lower in _SEGMENTS:
            wanted = _DOWN if upper in ("hip", "knee") else np.array([sign, 0.0, 0.0])
            yield joints[f"{side}_{upper}"], joints[f"{side}_{lower}"], wanted


def _at_origin(bones: Bones, pose: Array) -> tuple[Array, Array]:
    positions, world = bones.forward_kinematics(np.zeros((1, 3)), pose[None])
    return positions[0], world[0]


def _shortest_turn(a: Array, b: Array) -> Array:
    """The least rotation from unit vector a to b, which are not opposite."""
    half = np.concatenate([np.cross(a, b), [1.0 + a @ b]])
    return rotations.normalize(half) if half[3] > 1e-6 else rotations.rotvec_to_quat(np.array([0.0, 0.0, np.pi]))
