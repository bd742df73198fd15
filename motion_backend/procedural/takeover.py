"""Going on from where another backend left the body: its pose as handles, and what handles cannot say faded out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import History
from motion_backend.motion import FPS, Motion
from motion_backend.procedural.arm_solver import SIDES
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import SPINE, chest_frame, solve
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

FADES = 0.4
"""Seconds in which what the handles of a pose cannot say of a body is gone."""
STRAIGHT = 1e-3
"""A limb bent by less (of its length) has no direction that it bends to."""


def pose_of(history: History, skeleton: Skeleton) -> Pose:
    """The handles of a body in its last frame; a single pose."""
    contacts = np.array(history.contacts[-1:], dtype=np.float64)
    return poses_of(history.root_positions[-1:], history.local_rotations[-1:], contacts, skeleton).at(0)


def poses_of(root: Array, local: Array, contacts: Array, skeleton: Skeleton) -> Pose:
    """The handles of a body in T frames: pelvis (T, 3), local rotations (T, 22, 4), contacts (T, 4)."""
    positions, turns = skeleton.forward_kinematics(root, local)
    places = positions.astype(np.float64)
    pairs = {part: [INDEX[f"{side}_{part}"] for side, _ in SIDES] for part in ("ankle", "foot", "wrist")}
    pose = Pose(
        pelvis=np.asarray(root, dtype=np.float64),
        hips=turns[:, INDEX["pelvis"]],
        spine=_bend(local, SPINE),
        head=_bend(local, ("neck", "head")),
        ankles=places[:, pairs["ankle"]],
        feet=turns[:, pairs["ankle"]],
        toes=-rotations.quat_to_rotvec(local[:, pairs["foot"]])[..., 0],
        knees=_poles(places, "hip", "knee", "ankle"),
        arms=np.zeros((len(root), 2, 3)),
        elbows=np.zeros((len(root), 2, 3)),
        reach=places[:, pairs["wrist"]],
        reaching=np.zeros((len(root), 2)),
        palms=turns[:, pairs["wrist"]],
        pressing=np.zeros((len(root), 2)),
        planted=np.asarray(contacts).reshape(-1, 2, 2).max(axis=2),
    )
    return replace(pose, **_arms(pose, places, skeleton))


def _arms(pose: Pose, places: Array, skeleton: Skeleton) -> dict[str, Array]:
    """Wrists from the shoulders, in arm lengths, and where elbows point, both in the chest's frame. (T, 2, 3) each."""
    chest, at = chest_frame(pose, skeleton)
    back = rotations.inverse(chest)[:, None]
    rest, span = (
        np.array([of(side) for side, _ in SIDES])
        for of in (
            lambda side: skeleton.offsets[INDEX[f"{side}_collar"]] + skeleton.offsets[INDEX[f"{side}_shoulder"]],
            lambda side: sum(abs(float(skeleton.offsets[INDEX[f"{side}_{joint}"], 0])) for joint in ("elbow", "wrist")),
        )
    )
    wrists = rotations.rotate(back, pose.reach - at[:, None]) - rest
    poles = rotations.rotate(back, _poles(places, "shoulder", "elbow", "wrist"))
    return {"arms": wrists / span[:, None], "elbows": poles}


def _bend(local: Array, joints: tuple[str, ...]) -> Array:
    """What some joints turn together, as rotation vectors. (T, 3)."""
    turn = np.broadcast_to(rotations.IDENTITY, local[:, 0].shape)
    for joint in joints:
        turn = rotations.compose(turn, local[:, INDEX[joint]])
    return rotations.quat_to_rotvec(turn)


def _poles(places: Array, start: str, middle: str, end: str) -> Array:
    """The unit directions in which both limbs are bent; ahead and down where one is straight. (T, 2, 3)."""
    first, joint, last = (places[:, [INDEX[f"{side}_{part}"] for side, _ in SIDES]] for part in (start, middle, end))
    along = rotations.normalize(last - first)
    out = joint - first - rotations.dot(joint - first, along) * along
    ahead = np.array([0.0, 0.0, 1.0])
    straight = rotations.length(out) <= STRAIGHT
    return rotations.normalize(np.where(straight, ahead - rotations.dot(ahead, along) * along, out))


def eased_from(history: History, motion: Motion, skeleton: Skeleton) -> Motion:
    """A motion that sets out from the handles of `pose_of`, begun in exactly the frame before it (inertialisation)."""
    if not len(motion):
        return motion
    start, turned = solve(pose_of(history, skeleton).repeat(1), skeleton)
    fade = 1 - smooth(np.arange(1, len(motion) + 1) / (FADES * FPS))
    away = history.root_positions[-1] - start[0]
    missing = rotations.compose(history.local_rotations[-1], rotations.inverse(turned[0]))
    turns = rotations.rotvec_to_quat(fade[:, None, None] * rotations.quat_to_rotvec(missing))
    local = rotations.continuous(rotations.compose(turns, motion.local_rotations.astype(np.float64)))
    root = motion.root_positions + fade[:, None] * away
    return replace(motion, root_positions=root.astype(np.float32), local_rotations=local.astype(np.float32))
