"""Strides of everybody's gait, as the model itself walks: what a walk begins in whose body walked otherwise before.

A model that is shown another body's stride goes on in it, whosever walk it is told to have. Besides the people who were
recorded there are people between two of them: a crowd of nine is known by heart after a while.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, cast

import numpy as np
import torch
from torch import Tensor

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.checkpoint import Weights
from motion_backend.diffusion.conditions import GAITS, MadeOf
from motion_backend.diffusion.denoiser import Denoiser
from motion_backend.diffusion.motion_features import (
    HISTORY,
    RATE,
    WINDOW,
    HeadingFrame,
    Poses,
    from_features,
    to_features,
)
from motion_backend.diffusion.sampler import Sampler
from motion_backend.diffusion.windows import Batch, WindowBank
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton

WALKS, WINDOWS, KEPT = 2, 4, 35
"""Walks of each gait, windows of each walk, and how many of its last frames begin a history that is kept."""
FULL: Final = 0.75
"""Of the speeds of somebody's windows: below are those in which he starts or stops."""
ALIKE: Final = 3
"""Of those whose pace is nearest to somebody's, of whom one is blended with him."""
BLENDED: Final = (0.15, 0.5)
"""Shares of the second one in a walk between two."""
SHARES: Final = {(MadeOf.RECORDED, PartKind.WALK): 1.0}


@dataclass(frozen=True)
class Walker:
    """Whose walk a gait is."""

    gait: int
    """Of the model's table."""
    main: int
    """The gait of him who was recorded, and whose strides it begins in."""
    other: int
    share: float
    """Of the other one in it."""


def with_own_strides(weights: Weights, bank: WindowBank, seed: int = 0) -> Weights:
    """Weights with people between people, histories (gaits, N, 2, 202) of each gait, and the pace each walks at.

    Each walk begins in a recorded stride and leaves it.
    """
    if not bank.gaits:
        return weights
    windows, rng = bank.windows(SHARES), np.random.default_rng(seed)
    batch = bank.batch(windows.starts, windows.passages, np.zeros(len(windows), dtype=np.bool_))
    whose = batch.given.gait.numpy()
    own = [_pace(batch.windows[torch.from_numpy(whose == gait)]) for gait in bank.gaits.values()]
    crowd = walkers(own, rng)
    network = _with_walkers(cast(Denoiser, weights.network), crowd)
    sampler, found, paces = Sampler(network, weights.scale), [], []
    for one in crowd:
        chosen = rng.choice(np.flatnonzero(whose == one.main), WALKS)
        begun = bank.batch(windows.starts[chosen], windows.passages[chosen], np.zeros(WALKS, dtype=np.bool_))
        begun.given.gait[:] = one.gait
        found.append(_histories(_walked(sampler, begun, [seed, one.gait])))
        paces.append(round((1 - one.share) * own[one.main - 1] + one.share * own[one.other - 1], 3))
    told = {**weights.config, "gaits": len(crowd), "paces": paces}
    return replace(weights, network=network, strides=torch.from_numpy(np.stack(found)).float(), config=told)


def walkers(paces: Sequence[float], rng: np.random.Generator) -> list[Walker]:
    """Those who were recorded, at their paces, and as many between two of them as the table has place for."""
    people = range(1, len(paces) + 1)
    found = [Walker(gait, gait, gait, 0.0) for gait in people]
    if len(paces) < 2:
        return found
    for gait in range(len(found) + 1, GAITS):
        main = 1 + int(rng.integers(len(paces)))
        # Who walks as fast as nobody of the two did would be a third one.
        alike = sorted((one for one in people if one != main), key=lambda one: abs(paces[one - 1] - paces[main - 1]))
        other = alike[int(rng.integers(min(ALIKE, len(alike))))]
        found.append(Walker(gait, main, other, float(rng.uniform(*BLENDED))))
    return found


def _with_walkers(network: Denoiser, crowd: Sequence[Walker]) -> Denoiser:
    """The network with everybody of a crowd in its table of gaits."""
    made = Denoiser(network.sizes)
    made.load_state_dict(network.state_dict())
    table = made.conditions.gait.weight.data
    for one in crowd:
        table[one.gait] = torch.lerp(table[one.main], table[one.other], one.share)
    made.eval().requires_grad_(False)
    return made


def _walked(sampler: Sampler, begun: Batch, seed: list[int]) -> Poses:
    """Walks that begin in the histories of windows."""
    history, skeleton = begun.windows[:, :HISTORY].double().numpy(), build_skeleton()
    poses = from_features(history, HeadingFrame(np.zeros((WALKS, 3)), np.zeros(WALKS)))
    for window in range(WINDOWS):
        frame = HeadingFrame.of(poses, frame=-1)
        known = to_features(poses.frames(slice(-HISTORY, None)), frame, skeleton)
        made = sampler.windows(known, begun.given, [*seed, window])
        poses = poses.followed_by(from_features(made, frame))
    return poses


def _pace(windows: Tensor) -> float:
    """The speed of windows (N, 16, 202) in full stride: their upper quartile, metres a second."""
    ways = windows[:, :, [0, 2]]
    return float((ways[:, -1] - ways[:, 0]).norm(dim=1).quantile(FULL)) * RATE / (WINDOW - 1)


def _histories(poses: Poses) -> Array:
    """The last pairs of neighbouring frames of walks (B, T, …), as histories. (N, 2, 202)."""
    skeleton, last = build_skeleton(), len(poses)
    rows = []
    for start in range(last - KEPT - 1, last - 1):
        pair = poses.frames(slice(start, start + HISTORY))
        rows.append(to_features(pair, HeadingFrame.of(pair), skeleton))
    return np.concatenate(rows)
