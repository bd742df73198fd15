"""Bodies that go on window after window (LINGO 3): what was sampled last is the history of what is sampled next.

Ten frames a second inside; what comes out is joined to thirty, with feet held where they stand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from motion_backend.diffusion.conditions import HAND, MAX_SECONDS, PELVIS, TIME_UNIT, Conditions, MadeOf
from motion_backend.diffusion.guidance import Guide
from motion_backend.diffusion.motion_features import (
    HISTORY,
    RATE,
    WINDOW,
    HeadingFrame,
    Poses,
    from_features,
    smoothly_joined,
    to_features,
)
from motion_backend.diffusion.sampler import Sampler
from motion_backend.language.minilm import WIDTH as TEXT_WIDTH
from motion_backend.language.sentence_encoder import load_encoder
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

NEW: Final = WINDOW - HISTORY
"""Frames that a window adds."""
WINDOW_SECONDS: Final = NEW / RATE
"""What it lasts: a walk's goal is so far ahead."""


@dataclass(frozen=True)
class PelvisGoal:
    """Where pelvises are to be, in the world; of B bodies."""

    places: Array
    """(B, 3) metres; the height is told only with `seated`."""
    facing: Array | None = None
    """(B,) yaws; of who lies down, from the pelvis to the head."""
    seated: bool = False
    """Whether it is a seat, a bed or standing up from them: then the height counts too."""
    seconds: float | None = None
    """To go until it is reached; None in locomotion."""


@dataclass(frozen=True)
class HandGoal:
    """Where hands are to be, in the world."""

    places: Array
    """(B, 3)."""
    left: bool
    seconds: float
    """To go until it is there."""


@dataclass(frozen=True)
class Wish:
    """What bodies are to do in the next window."""

    caption: str
    pelvis: PelvisGoal | None = None
    hand: HandGoal | None = None
    frame: int = 0
    """Frames at 30 a second since the action began; 0 in locomotion."""
    made_of: MadeOf = MadeOf.RECORDED
    gait: NDArray[np.int64] | int = 0
    """Whose walk it is, of each body or of all; 0: nobody's."""
    voxels: NDArray[np.float32] | None = None
    """(B, 64, 32, 32); None where the scene does not matter."""


@dataclass(frozen=True)
class Rollout:
    """B bodies so far, at 10 frames a second."""

    sampler: Sampler
    skeleton: Skeleton
    poses: Poses
    """(B, T, …); the first two frames are what they go on from."""

    @property
    def frame(self) -> HeadingFrame:
        """Where the next window's features are measured from."""
        return HeadingFrame.of(self.poses, self.skeleton.scale, frame=-1)

    def go_on(self, wish: Wish, seed: list[int], guide: Guide | None = None) -> Rollout:
        """One window more. The same seed gives the same motion."""
        frame = self.frame
        history = to_features(self.poses.frames(slice(-HISTORY, None)), frame, self.skeleton)
        found = self.sampler.windows(history, conditions(wish, frame), seed, guide)
        return replace(self, poses=self.poses.followed_by(from_features(found, frame)))


def conditions(wish: Wish, frame: HeadingFrame) -> Conditions:
    """What the model is told of a wish, for bodies in their heading frames."""
    count = len(frame.origin)
    text = sentence(wish.caption)
    pelvis, hand = np.zeros((count, PELVIS)), np.zeros((count, HAND))
    if wish.pelvis is not None:
        pelvis = _told_pelvis(wish.pelvis, frame)
    if wish.hand is not None:
        pelvis[:, 7:] = _time(wish.hand.seconds), 1.0
        hand[:, :3], hand[:, 3] = frame.inward(wish.hand.places), 1.0 if wish.hand.left else -1.0
    ones = torch.ones(count)
    return Conditions(
        text=_tensor(text).expand(count, -1),
        has_text=ones * bool(text.any()),
        frame=torch.full((count,), wish.frame),
        made_of=torch.full((count,), int(wish.made_of)),
        gait=torch.from_numpy(np.broadcast_to(np.int64(wish.gait), count).copy()),
        pelvis=_tensor(pelvis),
        has_pelvis=ones * (wish.pelvis is not None or wish.hand is not None),
        hand=_tensor(hand),
        has_hand=ones * (wish.hand is not None),
        voxels=None if wish.voxels is None else torch.from_numpy(wish.voxels),
        has_scene=None if wish.voxels is None else ones,
    )


def _told_pelvis(goal: PelvisGoal, frame: HeadingFrame) -> Array:
    place, told = frame.inward(goal.places), np.zeros((len(goal.places), PELVIS))
    told[:, 0], told[:, 1] = place[:, 0], place[:, 2]
    if goal.seated:
        told[:, 2], told[:, 5] = place[:, 1], 1.0
    if goal.facing is not None:
        away = goal.facing - frame.yaw
        told[:, 3], told[:, 4] = np.sin(away), np.cos(away)
    # As in training: a walk may be told a place alone.
    told[:, 6] = goal.facing is not None
    if goal.seconds is not None:
        told[:, 7], told[:, 8] = _time(goal.seconds), 1.0
    return told


def _time(seconds: float) -> float:
    return min(max(seconds, 0.0), MAX_SECONDS) / TIME_UNIT


@lru_cache(maxsize=512)
def sentence(caption: str) -> Array:
    """A caption's features (384,); zeros, which are no text, where the encoder that was learned with is missing."""
    encoder = load_encoder()
    if encoder.name == "hashing":
        return np.zeros(TEXT_WIDTH)
    return np.asarray(encoder.encode([caption])[0], dtype=np.float64)


def to_motion(poses: Poses, skeleton: Skeleton, keyframe: int = 0, hold_feet: bool = True) -> Motion:
    """One body's frames (T, …) at 10 a second as motion at 30, its feet held where they stand."""
    smooth = smoothly_joined(poses)
    if hold_feet:
        smooth = feet_held(smooth, skeleton)
    return Motion(
        root_positions=smooth.roots.astype(np.float32),
        local_rotations=smooth.local.astype(np.float32),
        contacts=(smooth.contacts > 0.5).astype(np.float32),
        skeleton=skeleton,
        actions=np.full(len(smooth), keyframe, dtype=np.int32),
        fps=FPS,
    )


def feet_held(poses: Poses, skeleton: Skeleton) -> Poses:
    """Frames (T, …) at 30 a second with standing feet on the floor and held there."""
    return Poses(*held(poses.roots, poses.local, skeleton))


def _tensor(values: Array) -> Tensor:
    return torch.from_numpy(np.asarray(values, dtype=np.float32))
