"""Strides of everybody's gait, as the model itself walks: what a walk begins in whose body walked otherwise before.

A model that is shown another body's stride goes on in it, whosever walk it is told to have.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, cast

import numpy as np
import torch

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.checkpoint import Weights
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.denoiser import Denoiser
from motion_backend.diffusion.motion_features import HISTORY, HeadingFrame, Poses, from_features, to_features
from motion_backend.diffusion.sampler import Sampler
from motion_backend.diffusion.windows import WindowBank
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton

WALKS, WINDOWS, KEPT = 2, 4, 35
"""Walks of each gait, windows of each walk, and how many of its last frames begin a history that is kept."""
SHARES: Final = {(MadeOf.RECORDED, PartKind.WALK): 1.0}


def with_own_strides(weights: Weights, bank: WindowBank, seed: int = 0) -> Weights:
    """Weights with histories (gaits, N, 2, 202) of each gait; each walk begins in a recorded stride and leaves it."""
    if not bank.gaits:
        return weights
    windows, rng = bank.windows(SHARES), np.random.default_rng(seed)
    sampler = Sampler(cast(Denoiser, weights.network), weights.scale)
    whose = bank.batch(windows.starts, windows.passages, np.zeros(len(windows), dtype=np.bool_)).given.gait.numpy()
    found = []
    for gait in bank.gaits.values():
        chosen = rng.choice(np.flatnonzero(whose == gait), WALKS)
        batch = bank.batch(windows.starts[chosen], windows.passages[chosen], np.zeros(WALKS, dtype=np.bool_))
        history, skeleton = batch.windows[:, :HISTORY].double().numpy(), build_skeleton()
        poses = from_features(history, HeadingFrame(np.zeros((WALKS, 3)), np.zeros(WALKS)))
        for window in range(WINDOWS):
            frame = HeadingFrame.of(poses, frame=-1)
            known = to_features(poses.frames(slice(-HISTORY, None)), frame, skeleton)
            made = sampler.windows(known, batch.given, [seed, gait, window])
            poses = poses.followed_by(from_features(made, frame))
        found.append(_histories(poses))
    return replace(weights, strides=torch.from_numpy(np.stack(found)).float())


def _histories(poses: Poses) -> Array:
    """The last pairs of neighbouring frames of walks (B, T, …), as histories. (N, 2, 202)."""
    skeleton, last = build_skeleton(), len(poses)
    rows = []
    for start in range(last - KEPT - 1, last - 1):
        pair = poses.frames(slice(start, start + HISTORY))
        rows.append(to_features(pair, HeadingFrame.of(pair), skeleton))
    return np.concatenate(rows)
