"""Walking by the diffusion model, for the shared driver: window after window, each with its goal 1.4 s ahead."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.motion_features import HISTORY, RATE, STRIDE, Poses
from motion_backend.diffusion.rollout import WINDOW_SECONDS, PelvisGoal, Rollout, Wish
from motion_backend.diffusion.sampler import Sampler
from motion_backend.mocap.clip_captions import ways_to_say
from motion_backend.motion import FPS, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton
from motion_backend.walk_generator import Ahead, Frames, Walker

SLOW, BRISK = 0.85, 1.35
"""Metres a second below which a walk is called slow, and above which brisk, in what was learned from."""
SEEDS: Final = 2**31


@dataclass(frozen=True)
class LearnedGait:
    """The generator: what the sampler's weights walk like."""

    sampler: Sampler
    gait: int = 0
    """Whose walk it is; 0: nobody's."""
    name: str = "diffusion"
    slowest: float = 0.5

    def begin(self, past: Frames, rng: np.random.Generator) -> Walker:
        """Go on from a body's last frames; the noise of each window comes from `rng`."""
        return LearnedWalker(self.sampler, self.gait, past, int(rng.integers(SEEDS)))


@dataclass
class LearnedWalker:
    """One walk in the making."""

    sampler: Sampler
    gait: int
    past: Frames
    seed: int
    made: int = 0
    """Windows so far."""
    _velocity: tuple[Array, Array] | None = field(default=None, repr=False)
    """At the end of the last window, of the pelvis and of the rotations' components, a window frame."""

    def window(self, ahead: Ahead) -> Frames:
        """The next 42 frames."""
        body = Rollout(self.sampler, build_skeleton(), _known(self.past))
        place = np.array([[ahead.places[-1, 0], 0.0, ahead.places[-1, 1]]])
        pace = float(np.linalg.norm(ahead.places[-1] - self.past.root[-1, [0, 2]])) / WINDOW_SECONDS
        goal = PelvisGoal(place, np.array([float(ahead.yaws[-1])]))
        wish = Wish(caption_of(pace), goal, made_of=MadeOf.RECORDED, gait=self.gait)
        poses = body.go_on(wish, [self.seed, self.made]).poses
        keys = Frames(poses.roots[0, HISTORY - 1 :], poses.local[0, HISTORY - 1 :])
        found, self._velocity = spline(keys, self._velocity or _speed(self.past))
        self.made += 1
        self.past = self.past.then(found)[-HISTORY * STRIDE :]
        return found


def caption_of(pace: float) -> str:
    """What a walk at that pace (metres a second) is called in what was learned from."""
    return ways_to_say(Skill.LOCO, "slow" if pace < SLOW else "brisk" if pace > BRISK else "neutral", "")[0]


def spline(keys: Frames, velocity: tuple[Array, Array]) -> tuple[Frames, tuple[Array, Array]]:
    """Frames at 30 a second after the first of keys at 10, which sets out with a velocity; and the velocity at the end.

    Cubic, smooth in velocity and acceleration within a window and in velocity from window to window.
    """
    from scipy.interpolate import CubicSpline

    times = np.arange(len(keys))
    turns = rotations.continuous(keys.local)
    curves = [
        CubicSpline(times, values, bc_type=((1, first), (2, np.zeros_like(first))))
        for values, first in zip((keys.root, turns), velocity, strict=True)
    ]
    at = np.arange(1, (len(keys) - 1) * STRIDE + 1) / STRIDE
    root, local = (np.asarray(curve(at)) for curve in curves)
    end = tuple(np.asarray(curve(times[-1], 1)) for curve in curves)
    return Frames(root, rotations.normalize(local)), (end[0], end[1])


def _known(past: Frames) -> Poses:
    """The last two frames at 10 a second (1, 2, …); a body of which less is known has stood still."""
    frames = [max(len(past) - 1 - STRIDE * back, 0) for back in range(HISTORY - 1, -1, -1)]
    root, local = past.root[frames], past.local[frames]
    return Poses(root[None], local[None], np.zeros((1, HISTORY, 4)))


def _speed(past: Frames) -> tuple[Array, Array]:
    """Of the last frame, a frame of a window."""
    if len(past) < 2:
        return np.zeros(3), np.zeros_like(past.local[-1])
    turns = rotations.continuous(past.local[-2:])
    return (past.root[-1] - past.root[-2]) * FPS / RATE, (turns[1] - turns[0]) * FPS / RATE
