"""Other people's motion, from files to our body: frames of the files a second, on one core."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.figure import Figure
from motion_backend import rotations
from motion_backend.formats.bvh import write_bvh
from motion_backend.mocap.dataset_builder import folder_labels, motion_files
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.retarget import retarget
from motion_backend.motion import Motion
from motion_backend.skeleton import INDEX, build_skeleton

RATE: Final = 2000.0
"""Frames a second, as the files hold them."""
CLIPS: Final = 8
REPEATS: Final = 3
_SWINGS: Final = {"hip": (0.0, 0.45, 0.0), "knee": (0.5, 0.45, 2.2), "shoulder": (0.0, 0.35, np.pi)}
"""About X: the middle, the swing (radians) and how late it comes in a cycle of the left leg."""


def clip_figures(folder: Path) -> list[Figure]:
    """Invented walks in BVH, long recordings and clips of a second, then the recordings of SIMS_TEST_DATA."""
    figures = []
    for seconds, fps in ((10, 120), (1, 30)):
        files = [folder / f"{seconds}s_{number}.bvh" for number in range(CLIPS)]
        for number, file in enumerate(files):
            write_bvh(invented_walk(seconds, fps, number), file)
        retargeted(files[:1])
        figures.append(_figure(f"clips of {seconds} s at {fps} /s, on our body", files, "invented walks in BVH"))
    recorded = Path(os.environ.get("SIMS_TEST_DATA", "."), "motion")
    if recorded.is_dir():
        files = [recorded / file for file in motion_files(recorded, folder_labels(recorded))]
        figures.append(_figure("recordings of SIMS_TEST_DATA, on our body", files, "all formats", repeats=1))
    return figures


def _figure(name: str, files: Sequence[Path], what: str, repeats: int = REPEATS) -> Figure:
    runs = [_timed(partial(retargeted, files)) for _ in range(repeats)]
    (clips, frames), seconds = runs[0][0], min(taken for _, taken in runs)
    note = f"{what}: {clips} clips, {frames} frames read and retargeted; {1000 * seconds / clips:.0f} ms a clip"
    return Figure(name, frames / seconds, "frames/s", RATE, "least", note, 0)


def _timed(work: partial[tuple[int, int]]) -> tuple[tuple[int, int], float]:
    """What some work gives, and its seconds of one core."""
    started = time.process_time()
    return work(), time.process_time() - started


def retargeted(files: Sequence[Path]) -> tuple[int, int]:
    """Read and retarget files: how many clips, and frames of the files, came of it."""
    clips = [clip for file in files for clip in read_clips(file)]
    for clip in clips:
        retarget(clip)
    return len(clips), sum(len(clip) for clip in clips)


def invented_walk(seconds: int, fps: int, seed: int) -> Motion:
    """A body that walks straight on with swinging legs and arms; a little of every joint is chance."""
    rng, skeleton = np.random.default_rng(seed), build_skeleton()
    times = np.arange(seconds * fps + 1) / fps
    turns = rng.normal(0.0, 0.05, (22, 3)) * np.sin(rng.uniform(2.0, 6.0, 22) * times[:, None])[..., None]
    for part, (middle, swing, late) in _SWINGS.items():
        for side, begins in (("left", 0.0), ("right", np.pi)):
            turns[:, INDEX[f"{side}_{part}"], 0] += middle - swing * np.cos(2 * np.pi * times + begins - late)
    path = np.stack([0.02 * np.sin(2 * np.pi * times), 0.01 * np.cos(4 * np.pi * times), 1.2 * times], axis=1)
    return Motion(
        root_positions=(path + np.array([0.0, skeleton.standing_height, 0.0])).astype(np.float32),
        local_rotations=rotations.rotvec_to_quat(turns).astype(np.float32),
        contacts=np.zeros((len(times), 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(times), dtype=np.int32),
        fps=fps,
    )
