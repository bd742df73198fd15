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
    root, local = history.root_positions[-1:], history.local_rotations[-1:]
    positions, world = skeleton.forward_kinematics(root, local)
    places, turns = positions[0].astype(np.float64), world[0]
    pose = Pose(
        pelvis=root[0],
        hips=turns[INDEX["pelvis"]],
        spine=_bend(local[0], SPINE),
        head=_bend(local[0], ("neck", "head")),
        ankles=np.stack([places[INDEX[f"{side}_ankle"]] for side, _ in SIDES]),
        feet=np.stack([turns[INDEX[f"{side}_ankle"]] for side, _ in SIDES]),
        toes=-rotations.quat_to_rotvec(np.stack([local[0, INDEX[f"{side}_foot"]] for side, _ in SIDES]))[:, 0],
        knees=np.stack([_pole(places, f"{side}_hip", f"{side}_knee", f"{side}_ankle") for side, _ in SIDES]),
        arms=np.zeros((2, 3)),
        elbows=np.zeros((2, 3)),
        reach=np.stack([places[INDEX[f"{side}_wrist"]] for side, _ in SIDES]),
        reaching=np.zeros(2),
        palms=np.stack([turns[INDEX[f"{side}_wrist"]] for side, _ in SIDES]),
        pressing=np.zeros(2),
        planted=np.array(history.contacts[-1]).reshape(2, 2).max(axis=1),
    )
    return replace(pose, **_arms(pose, places, skeleton))


def _arms(pose: Pose, places: Array, skeleton: Skeleton) -> dict[str, Array]:
    """Wrists from the shoulders, in arm lengths, and where elbows point, both in the chest's frame."""
    chest, at = (frames[0] for frames in chest_frame(pose.repeat(1), skeleton))
    arms, elbows = [], []
    for side, _ in SIDES:
        rest = skeleton.offsets[INDEX[f"{side}_collar"]] + skeleton.offsets[INDEX[f"{side}_shoulder"]]
        span = sum(abs(float(skeleton.offsets[INDEX[f"{side}_{joint}"], 0])) for joint in ("elbow", "wrist"))
        wrist = rotations.rotate(rotations.inverse(chest), places[INDEX[f"{side}_wrist"]] - at) - rest
        arms.append(wrist / span)
        pole = _pole(places, f"{side}_shoulder", f"{side}_elbow", f"{side}_wrist")
        elbows.append(rotations.rotate(rotations.inverse(chest), pole))
    return {"arms": np.stack(arms), "elbows": np.stack(elbows)}


def _bend(local: Array, joints: tuple[str, ...]) -> Array:
    """What some joints turn together, as a rotation vector. (3,)."""
    turn = rotations.IDENTITY
    for joint in joints:
        turn = rotations.compose(turn, local[INDEX[joint]])
    return rotations.quat_to_rotvec(turn)


def _pole(places: Array, start: str, middle: str, end: str) -> Array:
    """The unit direction in which a limb is bent; ahead and down where it is straight. (3,)."""
    first, joint, last = places[INDEX[start]], places[INDEX[middle]], places[INDEX[end]]
    along = rotations.normalize(last - first)
    out = joint - first - ((joint - first) @ along) * along
    if float(np.linalg.norm(out)) > STRAIGHT:
        return rotations.normalize(out)
    ahead = np.array([0.0, 0.0, 1.0])
    return rotations.normalize(ahead - (ahead @ along) * along)


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
