"""Hands that go round head, hips and thighs and stay over the floor; arms that keep clear of what is beside a seat."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.inverse_kinematics import two_bone
from motion_backend.procedural.arm_solver import SIDES, Arm
from motion_backend.procedural.collision_avoidance.hand_collision import eased
from motion_backend.procedural.held_poses import UP, Seat
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

ALONG, WIDE = (0.0, 0.07, 0.13, -0.12), np.array([0.028, 0.024, 0.024, 0.034])
"""Points of an arm: how far beyond the wrist, and half as wide as it is there (metres at 1.70 m)."""
THIGH, HIPS, HEAD = 0.068, 0.09, 0.09
"""Half as wide as a thigh, the hips and a head (metres at 1.70 m)."""
GIVES: Final = 0.015
"""So deep a hand may press into the body (metres at 1.70 m)."""
ELBOW: Final = 0.05
"""Half as wide as an elbow is, with some room (metres at 1.70 m)."""
FROM_BEHIND: Final = 0.2
"""An elbow so far behind where it is farthest aside comes in backwards (radians)."""
HIP: Final = 0.055
"""From the middle of the pelvis to the ends of the bar that hips are (metres at 1.70 m)."""
HEAD_BAR, THIGH_BAR = (0.03, 0.09), (0.06, 0.37)
"""Ends of the bars that a head and a thigh are: above the head's joint, and down from the hip (metres at 1.70 m)."""
MOVED: Final = 1e-4
"""A hand pushed by less than this (metres) stays."""
NO_SWING: Final = 1e-6
"""An elbow nearer to the line from shoulder to wrist than its root cannot swing (metres²)."""
SMOOTHED: Final = 2.0
"""Width of the bell that the turn of an elbow is smoothed by (frames)."""
LED: Final = 7
"""Frames in which a way round grows out of where a hand begins, and comes to where it is to be."""


def hands_round_body(pose: Pose, skeleton: Skeleton) -> Pose:
    """T frames in which hands that would go through the own head, hips or thighs, or the floor, go round them.

    The first and last frame stay.
    """
    frame = chest_frame(pose, skeleton)
    sideways, ahead = (rotations.rotate(pose.hips, np.array(axis)) for axis in ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]))
    scale, wide = skeleton.scale, skeleton.scale * WIDE
    thick = scale * (THIGH - GIVES)
    hips = (pose.pelvis - HIP * scale * sideways, pose.pelvis + HIP * scale * sideways)
    head = _head(pose, skeleton, frame)
    thighs = [_thigh(pose, skeleton, index, name) for index, (name, _) in enumerate(SIDES)]
    ends = smooth(np.minimum(np.arange(len(pose)), np.arange(len(pose))[::-1]) / LED)[:, None]
    reach, reaching = pose.reach.copy(), pose.reaching.copy()
    for index, (_, side) in enumerate(SIDES):
        arm = Arm.of(pose, skeleton, index, frame)
        hand = arm.hand(arm.limb)
        outwards = side * sideways
        points = np.stack([arm.wrist + beyond * scale * (hand if beyond > 0 else arm.limb.lower) for beyond in ALONG])
        ways = [_way_out(points, wide, hips, outwards + 0.5 * ahead, scale * (HIPS - GIVES))]
        ways.append(_way_out(points, wide, head, outwards, scale * (HEAD - GIVES)))
        ways += [_way_out(points, wide, (low, knee), front + outwards, thick) for low, knee, front in thighs]
        ways.append(np.maximum(wide[:, None, None] - points[..., 1:2], 0.0) * UP)
        every = np.concatenate(ways)  # (K, T, 3)
        push = every[np.argmax(np.sum(every**2, axis=2), axis=0), np.arange(len(pose))]
        if not push.any():
            continue
        push = eased(push) * ends
        moved = np.linalg.norm(push, axis=1) > MOVED
        reach[moved, index] = (arm.wrist + push)[moved]
        reaching[moved, index] = 1.0
    return replace(pose, reach=reach, reaching=reaching)


def _head(pose: Pose, skeleton: Skeleton, frame: tuple[Array, Array]) -> tuple[Array, Array]:
    """Both ends of the middle line of a head. (T, 3) each."""
    neck = rotations.compose(frame[0], rotations.rotvec_to_quat(pose.head / 2))
    joint = frame[1] + rotations.rotate(frame[0], skeleton.offsets[INDEX["neck"]])
    joint = joint + rotations.rotate(neck, skeleton.offsets[INDEX["head"]])
    up = rotations.rotate(frame[0], UP)
    low, high = HEAD_BAR
    return joint + low * skeleton.scale * up, joint + high * skeleton.scale * up


def _thigh(pose: Pose, skeleton: Skeleton, index: int, name: str) -> tuple[Array, Array, Array]:
    """Both ends of a thigh and the way out of its front. (T, 3) each."""
    offsets, scale = skeleton.offsets, skeleton.scale
    hip = pose.pelvis + rotations.rotate(pose.hips, offsets[INDEX[f"{name}_hip"]])
    lengths = (-float(offsets[INDEX[f"{name}_knee"], 1]), -float(offsets[INDEX[f"{name}_ankle"], 1]))
    leg = two_bone(hip, pose.ankles[:, index], pose.knees[:, index], lengths)
    start, end = THIGH_BAR
    return hip + start * scale * leg.upper, hip + end * scale * leg.upper, rotations.cross(leg.upper, leg.hinge)


def _way_out(points: Array, wide: Array, bar: tuple[Array, Array], towards: Array, radius: float) -> Array:
    """The way of the arm's points, (P, T, 3), so `wide`, out of a bar; none for those that are not in it.

    It is half-way between straight away from the bar's axis and `towards` (T, 3).
    """
    start, along = bar[0], bar[1] - bar[0]
    share = np.clip(rotations.dot(points - start, along) / rotations.dot(along, along), 0.0, 1.0)
    away = points - start - share * along
    clear = np.broadcast_to(radius + wide[:, None, None], (*points.shape[:2], 1))
    near = rotations.length(away)[..., 0] < clear[..., 0]
    out = np.zeros_like(points)
    if not near.any():
        return out
    axis = rotations.normalize(along)
    across = rotations.normalize(towards - rotations.dot(towards, axis) * axis)
    across, away, clear = np.broadcast_to(across, points.shape)[near], away[near], clear[near]
    way = rotations.normalize(across + away / clear)
    there = rotations.dot(way, away)
    far = -there + np.sqrt(np.maximum(there**2 + clear**2 - rotations.dot(away, away), 0.0))
    out[near] = far * way
    return out


def arms_inside(pose: Pose, seat: Seat, room: tuple[float, float], skeleton: Skeleton, share: Array) -> Pose:
    """T frames whose arms come no farther aside of a seat than there is room: wrists come in, elbows turn forwards.

    `room` is from the middle of the seat to its left and right (metres), `share` (T,) how much of that is done.
    """
    frame, forwards = chest_frame(pose, skeleton), np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)])
    for index, (_, side) in enumerate(SIDES):
        if room[index] < np.inf:
            outwards = side * rotations.cross(UP, forwards)
            wall = outwards, room[index] - ELBOW * skeleton.scale + float(seat.pelvis @ outwards)
            pose = _wrist_inside(pose, index, Arm.of(pose, skeleton, index, frame), wall, share)
            pose = _elbow_inside(pose, index, Arm.of(pose, skeleton, index, frame), wall, (share, forwards))
    return pose


def _wrist_inside(pose: Pose, index: int, arm: Arm, wall: tuple[Array, float], share: Array) -> Pose:
    """A wrist that nothing holds comes in until it is no farther along wall[0] than wall[1]."""
    over = np.maximum(arm.wrist @ wall[0] - wall[1], 0.0) * (1 - pose.reaching[:, index]) * share
    arms = pose.arms.copy()
    arms[:, index] -= arm.in_chest(over[:, None] * wall[0]) / sum(arm.lengths)
    return replace(pose, arms=arms)


def _elbow_inside(pose: Pose, index: int, arm: Arm, wall: tuple[Array, float], how: tuple[Array, Array]) -> Pose:
    """An elbow goes round the line from shoulder to wrist, forwards, until it is inside the same wall; one that points
    well backwards goes farther back."""
    from scipy.ndimage import gaussian_filter1d

    share, forwards = how
    axis, out = rotations.normalize(arm.wrist - arm.shoulder), arm.elbow - arm.shoulder
    pole = out - rotations.dot(out, axis) * axis
    aside = wall[0] - rotations.dot(wall[0], axis) * axis
    swing = rotations.length(pole)[:, 0] * rotations.length(aside)[:, 0]
    aside = rotations.normalize(aside)
    ahead = rotations.cross(aside, axis)
    ahead = ahead * np.where(ahead @ (forwards - UP) < 0, -1.0, 1.0)[:, None]
    least = np.arccos(np.clip((wall[1] - (arm.elbow - pole) @ wall[0]) / np.maximum(swing, NO_SWING), -1.0, 1.0))
    angle = np.arctan2(np.sum(pole * ahead, axis=1), np.sum(pole * aside, axis=1))
    turn = np.where(angle < -FROM_BEHIND, np.minimum(-least - angle, 0.0), np.maximum(least - angle, 0.0))
    turn = gaussian_filter1d(turn * share, SMOOTHED, mode="nearest")
    turned = (angle + turn)[:, None]
    elbows = pose.elbows.copy()
    elbows[:, index] = arm.in_chest(np.cos(turned) * aside + np.sin(turned) * ahead)
    return replace(pose, elbows=elbows)
