"""From the handles of a pose to the rotations of 22 joints: inverse kinematics for legs and arms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.body.joint_limits import overbent, within
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import Limb, leg_rotations, two_bone
from motion_backend.procedural.arm_solver import SIDES, Arm, hanging_from
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

SPINE = ("spine1", "spine2", "spine3")
ROUNDED = 1.72
"""A spine bent by so many times what its pelvis tips keeps the neck where it was: its joints are at some height."""
EASED = 6
"""Frames before and after in which a pelvis tips back (see `hips_within`), or a trunk straightens (`head_clear`)."""
UNTWISTS = 3
"""So often a knee is swung back whose hip is turned beyond its range: a bent one swings about another line than its
thigh."""
HEAD = 0.10
"""Half a head (metres at 1.70 m)."""
STRAIGHTER = np.linspace(0.0, 1.5, 7)[:, None]
"""Shares of the bend of spine and neck that are tried to be taken back; with more than 1 they bend the other way."""


def solve(pose: Pose, skeleton: Skeleton) -> tuple[Array, Array]:
    """Handles of T frames to pelvis positions (T, 3) and local rotations (T, 22, 4)."""
    local = trunk_and_legs(pose, skeleton)
    frame = chest_frame(pose, skeleton)
    for index in (0, 1):
        for name, turned in Arm.of(pose, skeleton, index, frame).joints().items():
            local[:, INDEX[name]] = turned
    return pose.pelvis.copy(), rotations.continuous(local)


def trunk_and_legs(pose: Pose, skeleton: Skeleton) -> Array:
    """Local rotations (T, 22, 4) of all but the arms, which are stretched out to the sides."""
    local = np.tile(rotations.IDENTITY, (len(pose), len(skeleton.names), 1))
    local[:, INDEX["pelvis"]] = pose.hips
    third = rotations.rotvec_to_quat(pose.spine / 3)
    for name in SPINE:
        local[:, INDEX[name]] = third
    half = rotations.rotvec_to_quat(pose.head / 2)
    local[:, INDEX["neck"]] = local[:, INDEX["head"]] = within("neck", half)
    for index, (name, _) in enumerate(SIDES):
        _solve_leg(local, pose, skeleton, index, name)
    return local


def hips_within(pose: Pose, skeleton: Skeleton) -> Pose:
    """Frames in which no hip bends, stretches or spreads beyond its range: the pelvis tips and the spine bends in its
    place.

    Hips lie on the axis that the pelvis tips about, and near to the one it rolls about: legs and feet stay where they
    are.
    """
    needed = _beyond_hips(pose, skeleton)
    if not (needed > 0).any():
        return pose
    early = [_early(np.maximum(angle, 0.0)) for angle in needed]
    return _tipped(pose, np.stack([early[0] - early[1], np.zeros(len(pose)), early[2] - early[3]], axis=1), 1.0)


def folded_within(poses: Pose, skeleton: Skeleton) -> Pose:
    """N poses apart in which no hip bends beyond its range: the pelvis tips back, and the back is rounded so much more
    that the neck is where it was."""
    bent = np.maximum(_beyond_hips(poses, skeleton)[1], 0.0)
    return _tipped(poses, np.stack([-bent, 0 * bent, 0 * bent], axis=1), ROUNDED)


def _beyond_hips(pose: Pose, skeleton: Skeleton) -> Array:
    """How far hips stretch, bend, and spread to the left and right beyond their range, below 0 within it. (4, T)."""
    thighs = [leg_rotations(_leg(pose, skeleton, index, name))[0] for index, (name, _) in enumerate(SIDES)]
    local = rotations.compose(rotations.inverse(pose.hips), np.stack(thighs))
    left, right = (overbent(f"{name}_hip", turn) for (name, _), turn in zip(SIDES, local, strict=True))
    bent, stretched = np.minimum(left, right)[:, 0], np.maximum(left, right)[:, 0]
    return np.stack([stretched, -bent, left[:, 1], right[:, 1]])


def _tipped(pose: Pose, angles: Array, spine_share: float) -> Pose:
    """Frames with their pelvis tipped by rotation vectors (T, 3), and the spine bent back by such a share of it."""
    hips = rotations.compose(pose.hips, rotations.rotvec_to_quat(angles))
    return replace(pose, hips=hips, spine=pose.spine - spine_share * angles)


def head_clear(pose: Pose, solid: Obstacles, skeleton: Skeleton) -> Pose:
    """Frames in which no head is in a wall or a thing that spine and neck are bent into: they are bent the less."""
    heads = _heads(pose, skeleton)
    close = solid.near(heads.min(axis=0) - HEAD, heads.max(axis=0) + HEAD)
    if not len(close.owners):
        return pose
    room = HEAD * skeleton.scale
    at = np.flatnonzero(close.depth(heads) > -room)
    if not len(at):
        return pose
    tried = [close.depth(_heads(_straighter(pose.at(at), share), skeleton)) for share in STRAIGHTER]
    deep = np.maximum(np.stack(tried), -room)
    share = np.zeros(len(pose))
    # The least that brings the head out, or the farthest.
    share[at] = STRAIGHTER[np.argmin(deep, axis=0), 0]
    return _straighter(pose, _early(share)[:, None])


def _heads(pose: Pose, skeleton: Skeleton) -> Array:
    """Middles of T heads. (T, 3)."""
    turn, place = chest_frame(pose, skeleton)
    half = rotations.rotvec_to_quat(pose.head / 2)
    for name in ("neck", "head"):
        place = place + rotations.rotate(turn, skeleton.offsets[INDEX[name]])
        turn = rotations.compose(turn, half)
    return np.asarray(place + rotations.rotate(turn, 0.5 * skeleton.offsets[INDEX["head"]]))


def _straighter(pose: Pose, share: Array) -> Pose:
    """The pose with spine and neck bent the less by such a share (..., 1)."""
    return replace(pose, spine=(1 - share) * pose.spine, head=(1 - share) * pose.head)


def _early(angle: Array) -> Array:
    """Angles (T,) that are there some frames before they have to be, and come and go smoothly; the first and the last
    are as they have to be, since the body goes on from a segment's last frame in the next."""
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    eased = gaussian_filter1d(maximum_filter1d(angle, 2 * EASED + 1, mode="nearest"), EASED / 2, mode="nearest")
    at = np.arange(len(angle))
    return np.asarray(angle + smooth(np.minimum(at, at[::-1]) / (2 * EASED)) * (eased - angle))


def chest_frame(pose: Pose, skeleton: Skeleton) -> tuple[Array, Array]:
    """World rotation (T, 4) and position (T, 3) of spine3, the frame that arms hang in."""
    third = rotations.rotvec_to_quat(pose.spine / 3)
    rotation, position = pose.hips, pose.pelvis
    for name in SPINE:
        position = position + rotations.rotate(rotation, skeleton.offsets[INDEX[name]])
        rotation = rotations.compose(rotation, third)
    return rotation, position


def _leg(pose: Pose, skeleton: Skeleton, index: int, name: str) -> Limb:
    """The leg with its foot where it is and its knee to where it points, as far as the hip turns about its bone."""
    offsets = skeleton.offsets
    hip = pose.pelvis + rotations.rotate(pose.hips, offsets[INDEX[f"{name}_hip"]])
    lengths = (-float(offsets[INDEX[f"{name}_knee"], 1]), -float(offsets[INDEX[f"{name}_ankle"], 1]))
    ankle, pole = pose.ankles[:, index], pose.knees[:, index]
    leg, along = two_bone(hip, ankle, pole, lengths), rotations.normalize(ankle - hip)
    for _ in range(UNTWISTS):
        thigh, _ = leg_rotations(leg)
        twisted = overbent(f"{name}_hip", rotations.compose(rotations.inverse(pose.hips), thigh))[:, 2:]
        if not twisted.any():
            break
        # The more a knee is bent, the less its thigh turns as it swings.
        swung = SIDES[index][1] * twisted * np.maximum(rotations.dot(leg.upper, along), 0.0)
        pole = rotations.rotate(rotations.rotvec_to_quat(swung * along), rotations.cross(along, leg.hinge))
        leg = two_bone(hip, ankle, pole, lengths)
    return leg


def _solve_leg(local: Array, pose: Pose, skeleton: Skeleton, index: int, name: str) -> None:
    thigh, shin = leg_rotations(_leg(pose, skeleton, index, name))
    local[:, INDEX[f"{name}_hip"]] = rotations.compose(rotations.inverse(pose.hips), thigh)
    local[:, INDEX[f"{name}_knee"]] = rotations.compose(rotations.inverse(thigh), shin)
    foot = rotations.compose(rotations.inverse(shin), pose.feet[:, index])
    local[:, INDEX[f"{name}_ankle"]] = within(f"{name}_ankle", foot, loaded=pose.planted[:, index] > 0)
    local[:, INDEX[f"{name}_foot"]] = rotations.axis_to_quat("x", -pose.toes[:, index])


def all_released(pose: Pose, skeleton: Skeleton) -> Pose:
    """T frames with their wrists held from the chest alone, no longer tied to places in the world."""
    frame = chest_frame(pose, skeleton)
    arms = pose.arms.copy()
    for index in (0, 1):
        arm = Arm.of(pose, skeleton, index, frame)
        local = arm.in_chest(arm.wrist - frame[1]) - hanging_from(skeleton, index)
        arms[:, index] = local / sum(arm.lengths)
    return replace(pose, arms=arms, reaching=np.zeros_like(pose.reaching))


def released(pose: Pose, skeleton: Skeleton) -> Pose:
    """A single pose so."""
    return all_released(pose.repeat(1), skeleton).at(0)
