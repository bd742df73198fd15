"""From the handles of a pose to the rotations of 22 joints: inverse kinematics for legs and arms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.body.joint_limits import aside_within, overbent
from motion_backend.inverse_kinematics import Limb, arm_rotations, leg_rotations, two_bone
from motion_backend.procedural.pose import Pose
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

SIDES = (("left", 1), ("right", -1))


SPINE = ("spine1", "spine2", "spine3")


WRIST_ASIDE, WRIST_BEND, FOREARM_ROLL = (-0.25, 0.25), (-1.30, 1.15), 1.32
"""How far a left hand turns and bends against the forearm, and either rolls about it (radians)."""


SHRUG = 0.45
"""How far a raised arm lifts the collar bone (radians)."""
EASED = 6
"""Frames before and after in which a pelvis tips back (see `hips_within`)."""


def solve(pose: Pose, skeleton: Skeleton) -> tuple[Array, Array]:
    """Handles of T frames to pelvis positions (T, 3) and local rotations (T, 22, 4)."""
    local = trunk_and_legs(pose, skeleton)
    frame = chest_frame(pose, skeleton)
    for index, (name, side) in enumerate(SIDES):
        _solve_arm(local, pose, skeleton, (index, name, side), frame)
    return pose.pelvis.copy(), rotations.continuous(local)


def trunk_and_legs(pose: Pose, skeleton: Skeleton) -> Array:
    """Local rotations (T, 22, 4) of all but the arms, which are stretched out to the sides."""
    local = np.tile(rotations.IDENTITY, (len(pose), len(skeleton.names), 1))
    local[:, INDEX["pelvis"]] = pose.hips
    third = rotations.rotvec_to_quat(pose.spine / 3)
    for name in SPINE:
        local[:, INDEX[name]] = third
    half = rotations.rotvec_to_quat(pose.head / 2)
    local[:, INDEX["neck"]] = local[:, INDEX["head"]] = half
    for index, (name, _) in enumerate(SIDES):
        _solve_leg(local, pose, skeleton, index, name)
    return local


def hips_within(pose: Pose, skeleton: Skeleton) -> Pose:
    """Frames in which no hip bends beyond its range: the pelvis tips back and the spine bends in its place.

    Hips lie on the axis that the pelvis tips about, so that legs and feet stay where they are.
    """
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    most = np.zeros(len(pose))
    for index, (name, _) in enumerate(SIDES):
        thigh, _ = leg_rotations(_leg(pose, skeleton, index, name))
        bent = overbent(f"{name}_hip", rotations.compose(rotations.inverse(pose.hips), thigh))
        most = np.maximum(most, -bent)
    if not most.any():
        return pose
    back = gaussian_filter1d(maximum_filter1d(most, 2 * EASED + 1, mode="nearest"), EASED / 2, mode="nearest")
    tipped = np.zeros((len(pose), 3))
    tipped[:, 0] = back
    hips = rotations.compose(pose.hips, rotations.rotvec_to_quat(-tipped))
    return replace(pose, hips=hips, spine=pose.spine + tipped)


def chest_frame(pose: Pose, skeleton: Skeleton) -> tuple[Array, Array]:
    """World rotation (T, 4) and position (T, 3) of spine3, the frame that arms hang in."""
    third = rotations.rotvec_to_quat(pose.spine / 3)
    rotation, position = pose.hips, pose.pelvis
    for name in SPINE:
        position = position + rotations.rotate(rotation, skeleton.offsets[INDEX[name]])
        rotation = rotations.compose(rotation, third)
    return rotation, position


def _leg(pose: Pose, skeleton: Skeleton, index: int, name: str) -> Limb:
    offsets = skeleton.offsets
    hip = pose.pelvis + rotations.rotate(pose.hips, offsets[INDEX[f"{name}_hip"]])
    lengths = (-float(offsets[INDEX[f"{name}_knee"], 1]), -float(offsets[INDEX[f"{name}_ankle"], 1]))
    return two_bone(hip, pose.ankles[:, index], pose.knees[:, index], lengths)


def _solve_leg(local: Array, pose: Pose, skeleton: Skeleton, index: int, name: str) -> None:
    thigh, shin = leg_rotations(_leg(pose, skeleton, index, name))
    local[:, INDEX[f"{name}_hip"]] = rotations.compose(rotations.inverse(pose.hips), thigh)
    local[:, INDEX[f"{name}_knee"]] = rotations.compose(rotations.inverse(thigh), shin)
    foot = rotations.compose(rotations.inverse(shin), pose.feet[:, index])
    local[:, INDEX[f"{name}_ankle"]] = aside_within(f"{name}_ankle", foot)
    local[:, INDEX[f"{name}_foot"]] = rotations.axis_to_quat("x", -pose.toes[:, index])


def _solve_arm(
    local: Array, pose: Pose, skeleton: Skeleton, which: tuple[int, str, int], frame: tuple[Array, Array]
) -> None:
    index, name, side = which
    chest, _ = frame
    arm, collar, _ = limb_of_arm(pose, skeleton, which, frame)
    upper, lower = arm_rotations(arm, side)
    local[:, INDEX[f"{name}_collar"]] = collar
    clavicle = rotations.compose(chest, collar)
    local[:, INDEX[f"{name}_shoulder"]] = rotations.compose(rotations.inverse(clavicle), upper)
    local[:, INDEX[f"{name}_elbow"]] = rotations.compose(rotations.inverse(upper), lower)
    if pose.pressing[:, index].any():
        local[:, INDEX[f"{name}_wrist"]] = wrist_rotations(lower, pose.palms[:, index], pose.pressing[:, index], side)


def wrist_rotations(lower: Array, palms: Array, pressing: Array, side: int) -> Array:
    """Local rotations (..., 4) of a wrist on a forearm (..., 4) that wants a hand (..., 4), as far as it presses."""
    bend = _within_reach(rotations.compose(rotations.inverse(lower), palms), side)
    press = rotations.rotvec_to_quat(rotations.quat_to_rotvec(bend) * pressing[..., None])
    return _within_reach(press, side)


def _within_reach(wrist: Array, side: int) -> Array:
    """A wrist's rotation limited to what wrist and forearm can do: the forearm rolls, then the hand bends. (..., 4)."""
    roll = rotations.wrap(2 * np.arctan2(wrist[..., 0], wrist[..., 3]))
    twist = rotations.axis_to_quat("x", roll)
    swing = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(twist), wrist))
    low, high = np.sort(side * np.array([WRIST_ASIDE, WRIST_BEND]), axis=1).T
    swing[..., 1:] = np.clip(swing[..., 1:], low, high)
    twist = rotations.axis_to_quat("x", np.clip(roll, -FOREARM_ROLL, FOREARM_ROLL))
    return rotations.compose(twist, rotations.rotvec_to_quat(swing))


def released(pose: Pose, skeleton: Skeleton) -> Pose:
    """The same single pose with its wrists held from the chest alone, no longer tied to places in the world."""
    one = pose.repeat(1)
    frame = chest_frame(one, skeleton)
    arms = pose.arms.copy()
    for index, (name, side) in enumerate(SIDES):
        limb, _, shoulder = limb_of_arm(one, skeleton, (index, name, side), frame)
        lengths = [abs(float(skeleton.offsets[INDEX[f"{name}_{joint}"], 0])) for joint in ("elbow", "wrist")]
        wrist = shoulder[0] + lengths[0] * limb.upper[0] + lengths[1] * limb.lower[0]
        rest = skeleton.offsets[INDEX[f"{name}_collar"]] + skeleton.offsets[INDEX[f"{name}_shoulder"]]
        local = rotations.rotate(rotations.inverse(frame[0][0]), wrist - frame[1][0]) - rest
        arms[index] = local / sum(lengths)
    return replace(pose, arms=arms, reaching=np.zeros(2))


def limb_of_arm(
    pose: Pose, skeleton: Skeleton, which: tuple[int, str, int], frame: tuple[Array, Array]
) -> tuple[Limb, Array, Array]:
    """The solved arm, its collar's local rotation and where its shoulder joint is."""
    index, name, side = which
    chest, chest_position = frame
    offsets = skeleton.offsets
    lengths = (abs(float(offsets[INDEX[f"{name}_elbow"], 0])), abs(float(offsets[INDEX[f"{name}_wrist"], 0])))
    span = sum(lengths)
    rest = chest_position + rotations.rotate(
        chest, offsets[INDEX[f"{name}_collar"]] + offsets[INDEX[f"{name}_shoulder"]]
    )
    weight = pose.reaching[:, index, None]
    wanted = rest + rotations.rotate(chest, pose.arms[:, index] * span)
    target = wanted + weight * (pose.reach[:, index] - wanted)
    # Raising the arm lifts the collar bone with it, as a shoulder does.
    up = rotations.rotate(rotations.inverse(chest), target - rest)[:, 1] / span
    collar = rotations.axis_to_quat("z", side * SHRUG * np.clip(up, 0.0, 1.0))
    clavicle = rotations.compose(chest, collar)
    joint = chest_position + rotations.rotate(chest, offsets[INDEX[f"{name}_collar"]])
    shoulder = joint + rotations.rotate(clavicle, offsets[INDEX[f"{name}_shoulder"]])
    pole = rotations.rotate(chest, pose.elbows[:, index])
    return two_bone(shoulder, target, pole, lengths), collar, shoulder
