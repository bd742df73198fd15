"""What is left between a made body and its goals, taken away: the pelvis onto its seat, the hand onto its thing.

The last centimetres are inverse kinematics, as the paper's are; what they amount to is told, and what is too far from
its goal is not brought there but refused.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.diffusion.motion_features import twist
from motion_backend.inverse_kinematics import two_bone
from motion_backend.mocap.rest_pose import world_to_local
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, PARENTS, Skeleton
from motion_backend.walk_generator import Frames

OVER: Final = 24
"""Frames over which what is left to a goal is taken away, and after which a hand is free again."""
ARMS: Final = {
    side: [INDEX[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist")] for side in ("left", "right")
}
"""What bends for a wrist."""
OF_ARMS: Final = [INDEX[f"{side}_{joint}"] for side in ARMS for joint in ("collar", "shoulder", "elbow", "wrist")]
"""Joints that a caption's arms are laid over."""

CARRIED: Final = [INDEX["spine3"], INDEX["head"]]
"""What tells a carriage."""
LEANS: Final = ("spine1", "spine2", "spine3")
NODS: Final = ("neck", "head")
"""Joints that share in it."""
LASTING: Final = 7.0
"""Width of the bell (frames) that takes a stride out of a carriage."""


def eased(values: Array) -> Array:
    """Shares from 0 to 1, smooth at both ends."""
    share = np.clip(values, 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))


def pelvis_brought(frames: Frames, away: Array, over: int = OVER) -> Frames:
    """Frames that end `away` (3,) from where they ended; feet that stand are for the foot lock."""
    count = len(frames)
    share = eased(np.arange(1, count + 1) / min(over, count) - max(count - over, 0) / min(over, count))
    return Frames(frames.root + share[:, None] * away, frames.local)


def wrist_brought(frames: Frames, skeleton: Skeleton, side: str, shift: Array) -> Frames:
    """Frames whose wrist is moved by (T, 3) in the world: the elbow bends in its plane, the hand keeps its turn."""
    positions, world = skeleton.forward_kinematics(frames.root, frames.local)
    shoulder, elbow, wrist = (positions[:, joint].astype(np.float64) for joint in ARMS[side])
    lengths = tuple(float(np.linalg.norm(skeleton.offsets[joint])) for joint in ARMS[side][1:])
    limb = two_bone(shoulder, wrist + shift, elbow - shoulder, (lengths[0], lengths[1]))
    turned = world.copy()
    for joint, before, after in (
        (ARMS[side][0], elbow - shoulder, limb.upper),
        (ARMS[side][1], wrist - elbow, limb.lower),
    ):
        turned[:, joint] = rotations.compose(_shortest(rotations.normalize(before), after), world[:, joint])
    return Frames(frames.root, rotations.continuous(world_to_local(turned)))


def held_shares(at: NDArray[np.int64], due: int, hold: int, over: int = OVER) -> Array:
    """How far a hand is at its goal in frames `at` (N,): it comes, stays from `due` on, and leaves. (N,)."""
    return np.minimum(eased(1 - (due - at) / over), eased(1 - (at - due - hold) / over))


def with_arms_of(frames: Frames, others: Array, share: Array) -> Frames:
    """Frames whose arms, by shares (T,), turn in their shoulders as those of local rotations (T, 22, 4)."""
    local = frames.local.copy()
    local[:, OF_ARMS] = rotations.slerp(frames.local[:, OF_ARMS], others[:, OF_ARMS], share[:, None])
    return Frames(frames.root, rotations.continuous(local))


def with_carriage_of(frames: Frames, others: Frames, share: Array) -> Frames:
    """Frames whose trunk and head are bent, by shares (T,), as those of others are against where they head for.

    What goes with a stride is their own: only what lasts longer, how a body leans, looks and sways, is the others'.
    """
    own, wanted = (_carriage(one) for one in (frames, others))
    yaw = rotations.yaw_to_quat(_yaws(frames))
    world = _worlds(frames)
    leans = rotations.compose(wanted[:, 0], rotations.inverse(own[:, 0]))
    nods = rotations.compose(rotations.compose(wanted[:, 1], rotations.inverse(own[:, 1])), rotations.inverse(leans))
    for turns, joints in ((leans, LEANS), (nods, NODS)):
        bend = share[:, None] * rotations.quat_to_rotvec(turns) / len(joints)
        bend = rotations.rotate(yaw, bend)
        for joint in joints:
            above = below(INDEX[joint])
            world[:, above] = rotations.compose(rotations.rotvec_to_quat(bend)[:, None], world[:, above])
    return Frames(frames.root, rotations.continuous(world_to_local(world)))


def below(joint: int) -> list[int]:
    """A joint and all that hang on it."""
    found = [joint]
    for index, parent in enumerate(PARENTS):
        if parent in found:
            found.append(index)
    return found


def _carriage(frames: Frames) -> Array:
    """How chest and head are turned against where the pelvis looks, without what goes with a stride. (T, 2, 4)."""
    from scipy.ndimage import gaussian_filter1d

    turned = rotations.compose(rotations.yaw_to_quat(-_yaws(frames))[:, None], _worlds(frames)[:, CARRIED])
    smooth = gaussian_filter1d(rotations.continuous(turned), LASTING, axis=0, mode="nearest")
    return rotations.normalize(np.asarray(smooth))


def _yaws(frames: Frames) -> Array:
    """Of the pelvis, continuous. (T,)."""
    return np.asarray(np.unwrap(twist(frames.local[:, 0])))


def _worlds(frames: Frames) -> Array:
    """World rotations. (T, 22, 4)."""
    world = np.empty_like(frames.local)
    for joint, parent in enumerate(PARENTS):
        own = frames.local[:, joint]
        world[:, joint] = own if parent < 0 else rotations.compose(world[:, parent], own)
    return world


def _shortest(before: Array, after: Array) -> Array:
    """The smallest turns that take unit vectors (T, 3) to others. (T, 4)."""
    found = np.concatenate([rotations.cross(before, after), 1 + rotations.dot(before, after)], axis=-1)
    return rotations.normalize(found)
