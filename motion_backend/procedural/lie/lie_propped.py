"""Lying with the trunk raised: on both elbows, or on a side with the head in a hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.arm_solver import SIDES, Arm
from motion_backend.procedural.held_poses import UP, bend, shoulders
from motion_backend.procedural.lie.lie_keys import HeadInHand, Propped
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.skeleton import INDEX, Skeleton

SHOULDER: Final = np.array([0.18, 0.135, 0.0])
UPPER_ARM, FOREARM, ARM = 0.292, 0.248, 0.54
"""A left shoulder in the chest's frame, and lengths (metres)."""
ELBOW, WRIST = 0.04, 0.045
"""Elbow and wrist of a forearm that lies, above what it lies on (metres)."""
STRAIGHT: Final = 0.99
"""The share of an upper arm that stands under its shoulder at most."""
BENDS: Final = np.linspace(0.0, 0.9, 46)
"""Forward bends of the trunk on the elbows that are tried (radians)."""
RAISES: Final = np.linspace(0.2, 0.75, 56)
"""Side bends of the trunk off the left side that are tried (radians)."""


def on_both_elbows(pose: Pose, height: float, skeleton: Skeleton, row: Propped) -> Pose:
    """On the back with the trunk raised on the elbows; `height` is that of the mattress in the world."""
    pose = _sat_up(pose, height, skeleton, row)
    return propped(replace(pose, head=pose.head + bend(row.head_pitch_rad)), height, skeleton, row)


def propped(pose: Pose, height: float, skeleton: Skeleton, row: Propped) -> Pose:
    """On the elbows: they stand on the mattress (`height` in the world) under the shoulders, the forearms lie ahead."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    back = rotations.inverse(chest)
    ahead = rotations.normalize(rotations.rotate(pose.hips, np.array([0.0, -1.0, 0.0])) * [1.0, 0.0, 1.0])
    aside = rotations.rotate(pose.hips, np.array([1.0, 0.0, 0.0]))
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, side in enumerate((1.0, -1.0)):
        mirror = np.array([side, 1.0, 1.0])
        shoulder = place + rotations.rotate(chest, SHOULDER * mirror * skeleton.scale)
        drop = min(shoulder[1] - height - ELBOW, STRAIGHT * UPPER_ARM * skeleton.scale)
        apart = np.sqrt((UPPER_ARM * skeleton.scale) ** 2 - drop**2)
        elbow = shoulder + apart * (row.elbow_aside_share * side * aside + row.elbow_ahead_share * ahead)
        elbow[1] = shoulder[1] - drop
        along = rotations.normalize(ahead - row.forearm_inwards_share * side * aside)
        wrist = elbow + FOREARM * skeleton.scale * along
        wrist[1] = height + WRIST
        arms[index] = rotations.rotate(back, wrist - shoulder) / (ARM * skeleton.scale)
        elbows[index] = rotations.rotate(back, elbow - 0.5 * (wrist + shoulder))
        x = rotations.normalize(along * [1.0, 0.0, 1.0]) * side
        up = np.array([0.0, 1.0, 0.0])
        palms[index] = rotations.basis_to_quat(x, up, rotations.cross(x, up))
    return replace(pose, arms=arms, elbows=elbows, palms=palms, pressing=np.ones(2), reaching=np.zeros(2))


def _sat_up(pose: Pose, height: float, skeleton: Skeleton, row: Propped) -> Pose:
    """The trunk raised until an upper arm stands upright under its shoulder; the pelvis tips back under it."""
    back = rotations.rotvec_to_quat(np.array([row.hips_back_rad, 0.0, 0.0]))
    pose = replace(pose, hips=rotations.compose(pose.hips, back))
    aside = pose.spine * [0.0, 1.0, 1.0]
    tries = replace(pose.repeat(len(BENDS)), spine=aside + np.stack([bend(float(forward)) for forward in BENDS]))
    heights = shoulders(tries, skeleton)[:, :, 1].mean(axis=1)
    best = int(np.argmin(np.abs(heights - height - row.shoulder_height_m * skeleton.scale)))
    return replace(pose, spine=tries.spine[best])


def head_in_hand(pose: Pose, below: int, height: float, skeleton: Skeleton, row: HeadInHand) -> Pose:
    """On a side, the head in the hand below (0 left, 1 right), whose elbow stands on the mattress.

    The trunk is bent up until the elbow is low enough under the hand.
    """
    pitch = row.spine_pitch_rad + float(pose.spine[0])
    down = SIDES[below][1]
    head = bend(row.head_pitch_rad, row.head_side_rad * down, row.head_turn_rad * down)
    up = rotations.rotvec_to_quat(np.array([0.0, 0.0, row.hips_up_rad * down]))
    tries = replace(
        replace(pose, head=head, hips=rotations.compose(pose.hips, up)).repeat(len(RAISES)),
        spine=np.stack([bend(pitch, float(side) * down, row.spine_turn_rad * down) for side in RAISES]),
        head=np.repeat(
            bend(row.head_pitch_rad, row.head_side_rad * down, row.head_turn_rad * down)[None], len(RAISES), 0
        ),
    )
    held = _holding_head(tries, below, skeleton, row)
    elbows = Arm.of(held, skeleton, below, chest_frame(held, skeleton)).elbow[:, 1]
    return held.at(int(np.argmin(np.abs(elbows - height - ELBOW))))


def _holding_head(pose: Pose, below: int, skeleton: Skeleton, row: HeadInHand) -> Pose:
    """T poses with that palm against the side of the head and its elbow under it."""
    chest, place = chest_frame(pose, skeleton)
    mirror = np.array([float(SIDES[below][1]), 1.0, 1.0])
    half = rotations.rotvec_to_quat(pose.head / 2)
    neck = rotations.compose(chest, half)
    head = rotations.compose(neck, half)
    joint = place + rotations.rotate(chest, skeleton.offsets[INDEX["neck"]])
    joint = joint + rotations.rotate(neck, skeleton.offsets[INDEX["head"]])
    wrist = joint + rotations.rotate(head, np.array(row.wrist_m) * mirror * skeleton.scale)
    shoulder = place + rotations.rotate(chest, SHOULDER * mirror * skeleton.scale)
    back = rotations.inverse(chest)
    front = rotations.rotate(pose.hips, np.array([0.0, 0.0, 1.0]))
    arms, elbows, palms = pose.arms.copy(), pose.elbows.copy(), pose.palms.copy()
    arms[:, below] = rotations.rotate(back, wrist - shoulder) / (ARM * skeleton.scale)
    elbows[:, below] = rotations.rotate(back, row.elbow_ahead_ratio * front - UP)
    x = rotations.normalize(np.array(row.fingers_direction) * mirror) * mirror[0]
    outwards = np.array(row.back_direction) * mirror
    y = rotations.normalize(outwards - (outwards @ x) * x)
    palms[:, below] = rotations.compose(head, rotations.basis_to_quat(x, y, rotations.cross(x, y)))
    return replace(pose, arms=arms, elbows=elbows, palms=palms)
