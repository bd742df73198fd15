"""What pulls each clean guess of a window towards a goal while it is sampled (LINGO A.4).

A guess is moved by a share of what it lacks, at every step: the network answers to that in the next one, so that feet
and trunk go along. What is left after the last step is for the clean-up.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import torch
from torch import Tensor

from motion_backend import rotations
from motion_backend.diffusion.goal_cleanup import below
from motion_backend.diffusion.motion_features import (
    JOINT_COUNT,
    ROOT,
    TURNS,
    HeadingFrame,
    from_features,
    quat_to_six,
)
from motion_backend.mocap.rest_pose import world_to_local
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

Guide = Callable[[Tensor], Tensor]
"""Moves a clean guess (B, 14, 202), in metres and rotations, towards what it is to come to."""
PULL: Final = 0.5
"""Share of what is left to the goal by which a guess is moved."""
HOLD: Final = 0.8
"""The same of a pose that is to be held."""
REACHES: Final = ("spine1", "spine2", "spine3", "collar", "shoulder", "elbow")
"""What turns for a hand, from the trunk to the elbow."""
READY: Final = (0.1, 0.1, 0.1, 0.5, 1.0, 1.0)
"""How readily each of them does: a trunk that comes along comes into the table."""
DAMPED: Final = 0.02
"""Square metres a square radian that keep a stretched arm from turning wildly."""
HERE: Final = HeadingFrame(np.zeros(3), np.zeros(()))
"""The heading frame of a window, seen from itself."""


def towards(goal: Tensor, axes: tuple[int, ...], pull: float = PULL) -> Guide:
    """Guidance of the root: the last frame comes nearer to the goal (B, len(axes)) by a share, those before it by less.

    Axes are 0, 1 and 2 for x, height and z in the heading frame.
    """

    def guide(guess: Tensor) -> Tensor:
        share = pull * torch.linspace(1 / guess.shape[1], 1.0, guess.shape[1])[None, :, None]
        moved = guess.clone()
        lacking = goal[:, None] - guess[:, -1:, list(axes)]
        moved[..., list(axes)] += share * lacking
        return moved

    return guide


def along(way: Tensor, pull: float = PULL, order: int = 2) -> Guide:
    """Guidance of a walk along a way (B, 14, 2) of the root, [x, z] in the heading frame.

    What it is off on the whole is taken away, a polynomial of that order from where it begins: with a parabola its sway
    is its own, with more it follows bends.
    """
    share = torch.linspace(1 / way.shape[1], 1.0, way.shape[1])
    curves = torch.stack([share**power for power in range(1, order + 1)], dim=1)
    fitted = curves @ torch.linalg.pinv(curves)  # (14, 14)

    def guide(guess: Tensor) -> Tensor:
        moved = guess.clone()
        moved[..., [0, 2]] += pull * (fitted @ (way - guess[..., [0, 2]]))
        return moved

    return guide


def posed(turns: Tensor, shares: Tensor, pull: float = HOLD) -> Guide:
    """Guidance to a pose that is to be held, and to where it is: its features (14, 202), by shares (14,).

    Legs that are bent as on the seat would float under a pelvis that has not come to it.
    """

    def guide(guess: Tensor) -> Tensor:
        moved = guess.clone()
        share = pull * shares[None, :, None]
        for part in (ROOT, TURNS):
            moved[..., part] += share * (turns[None, :, part] - guess[..., part])
        return moved

    return guide


def both(first: Guide, second: Guide) -> Guide:
    """One after the other."""
    return lambda guess: second(first(guess))


def reaching(goal: Array, left: bool, shares: Array, pull: float = PULL) -> Guide:
    """Guidance of one body's hand to a goal (3,) in the heading frame, in each frame by a share (14,).

    Trunk and arm turn as damped least squares have it (Buss 2004): all of them a little.
    """
    side = "left" if left else "right"
    chain = [INDEX[name if name.startswith("spine") else f"{side}_{name}"] for name in REACHES]
    wrist, skeleton = INDEX[f"{side}_wrist"], build_skeleton()

    def guide(guess: Tensor) -> Tensor:
        features = guess[0].double().numpy()
        poses = from_features(features, HERE)
        positions, world = skeleton.forward_kinematics(poses.roots, poses.local)
        places = positions.astype(np.float64)
        lacking = pull * shares[:, None] * (goal - places[:, wrist])
        turns = _turns(places[:, wrist, None] - places[:, chain], lacking)
        turned = world.copy()
        for joint, turn in zip(chain, np.moveaxis(turns, 1, 0), strict=True):
            hanging = below(joint)
            turned[:, hanging] = rotations.compose(rotations.rotvec_to_quat(turn)[:, None], turned[:, hanging])
        local = world_to_local(turned)
        found = features.copy()
        six = found[:, TURNS].reshape(-1, JOINT_COUNT, 6)
        six[:, chain] = quat_to_six(local[:, chain])
        found[:, TURNS] = six.reshape(len(found), -1)
        return torch.from_numpy(found.astype(np.float32))[None]

    return guide


def _turns(arms: Array, lacking: Array) -> Array:
    """Rotation vectors (T, N, 3) of joints that are `arms` (T, N, 3) behind a hand which is to move by (T, 3)."""
    readiness = np.array(READY)[:, None, None]
    # A turn w of a joint moves the hand by w × arm: the columns of a matrix (T, 3, 3N).
    columns = np.stack([np.cross(axis, arms) for axis in np.eye(3)], axis=-1)  # (T, N, 3, 3)
    weighed = columns * readiness
    whole = np.einsum("tnij,tnkj->tik", weighed, columns) + DAMPED * np.eye(3)
    needed = np.linalg.solve(whole, lacking[..., None])[..., 0]
    return np.asarray(np.einsum("tnij,ti->tnj", weighed, needed))
