"""Pictures of a training run: the curve of its losses, and windows that its model samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, cast

import numpy as np

from motion_backend.diffusion.checkpoint import Weights
from motion_backend.diffusion.denoiser import Denoiser
from motion_backend.diffusion.motion_features import HISTORY, HeadingFrame, from_features
from motion_backend.diffusion.rollout import to_motion
from motion_backend.diffusion.sampler import Sampler
from motion_backend.diffusion.windows import WindowBank, Windows
from motion_backend.skeleton import build_skeleton

SAMPLES: Final = 6
"""Windows on a sheet."""
STEP: Final = "step"


def draw_curve(curve: Sequence[Mapping[str, float]], path: Path) -> None:
    """Every figure of every checkpoint over the steps, one small plot each."""
    from matplotlib.figure import Figure

    names = [name for name in (curve[-1] if curve else {}) if name != STEP]
    if not names:
        return
    figure = Figure(figsize=(3 * min(len(names), 5), 2.4 * -(-len(names) // 5)), layout="tight")
    for place, name in enumerate(names, start=1):
        axes = figure.add_subplot(-(-len(names) // 5), min(len(names), 5), place, title=name)
        rows = [row for row in curve if name in row]
        axes.plot([row[STEP] for row in rows], [row[name] for row in rows])
        axes.set_ylim(bottom=0)
    figure.savefig(path)


def draw_samples(weights: Weights, bank: WindowBank, windows: Windows, path: Path) -> None:
    """What the model makes of the history and the conditions of some windows it learns from, the same each time."""
    from motion_backend.rendering.contact_sheet import sheet
    from motion_backend.rendering.motion_figures import save_png

    starts, rows = windows.drawn(SAMPLES, np.random.default_rng(0))
    batch = bank.batch(starts, rows, np.zeros(SAMPLES, dtype=np.bool_))
    sampler, skeleton = Sampler(cast(Denoiser, weights.network), weights.scale), build_skeleton()
    known = batch.windows[:, :HISTORY].double().numpy()
    found = np.concatenate([known, sampler.windows(known, batch.given, 0)], axis=1)
    pictures = []
    for features, row in zip(found, rows.tolist(), strict=True):
        index, passage = bank.passages[row]
        poses = from_features(features, HeadingFrame(np.zeros(3), np.zeros(())))
        pictures.append((f"{bank.stretches[index].name}: {passage.caption}", to_motion(poses, skeleton)))
    save_png(sheet(pictures), path)
