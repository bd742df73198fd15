"""Made-up motions for tests: every joint turns, the pelvis wanders."""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.motion import ContactGoal, Motion
from motion_backend.skeleton import JOINTS, build_skeleton


def tumbling(frames: int = 40, seed: int = 0, height: float = 1.70) -> Motion:
    """A body whose joints all swing smoothly, with turns of more than half a circle at the pelvis."""
    rng = np.random.default_rng(seed)
    phase = np.linspace(0.0, 1.0, frames)[:, None, None]
    swing = rng.normal(size=(1, len(JOINTS), 3))
    turns = swing * np.sin(2 * np.pi * phase + rng.uniform(0, 6, (1, len(JOINTS), 1)))
    turns[:, 0] = np.array([0.0, 1.0, 0.0]) * phase[:, 0] * 9.0
    return Motion(
        root_positions=np.cumsum(rng.normal(0, 0.02, (frames, 3)), axis=0).astype(np.float32) + np.float32(0.9),
        local_rotations=rotations.rotvec_to_quat(turns).astype(np.float32),
        contacts=rng.integers(0, 2, (frames, 4)).astype(np.float32),
        skeleton=build_skeleton(height),
        actions=np.repeat(np.arange(4, dtype=np.int32), -(-frames // 4))[:frames],
        goals=(ContactGoal("pelvis", (1.0, 0.5, -0.25)), ContactGoal("left_wrist", (0.1, 1.0, 2.0))),
        completed=False,
        reason="only a test",
    )


def standing_still(frames: int = 60, root: np.ndarray | None = None, height: float = 1.70) -> Motion:
    """A T-pose on its feet; `root` (T, 3) moves it."""
    skeleton = build_skeleton(height)
    place = np.zeros((frames, 3)) if root is None else root
    frames = len(place)
    up = np.array([0.0, skeleton.standing_height, 0.0])
    return Motion(
        (place + up).astype(np.float32),
        np.tile(rotations.IDENTITY, (frames, 22, 1)).astype(np.float32),
        np.ones((frames, 4), np.float32),
        skeleton,
        np.zeros(frames, np.int32),
    )
