"""Walking by the diffusion model, for the shared driver: window after window, each with its goal 1.4 s ahead."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
import torch

from motion_backend import rotations
from motion_backend.backend_protocol import History
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.guidance import along
from motion_backend.diffusion.motion_features import HISTORY, STRIDE, HeadingFrame, Poses, from_features, to_features
from motion_backend.diffusion.rollout import PelvisGoal, Rollout, Wish
from motion_backend.diffusion.sampler import Sampler
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.skeleton import build_skeleton
from motion_backend.stride_takeover import joined_within
from motion_backend.walk_generator import Ahead, Frames, Walker

CAPTION: Final = "a person walks"
"""What all plain walks are called among others in what was learned from; how fast says the goal."""
KEYS: Final = slice(STRIDE - 1, None, STRIDE)
"""The frames of a window at 30 a second that it has at 10."""
SEEDS: Final = 2**31
SETTLED: Final = 0.2
"""Seconds in which half of what a body is off the stride of its gait is gone: in less the swinging foot is flung."""


@dataclass
class LearnedGait:
    """The generator: what the sampler's weights walk like."""

    sampler: Sampler
    gait: int = 0
    """Whose walk it is; 0: nobody's."""
    name: str = "diffusion"
    slowest: float = 0.5

    @property
    def pace(self) -> float | None:
        """What he walked at whose walk it is; None for nobody's."""
        return self.sampler.pace_of(self.gait)

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
        """The next 42 frames, pulled to their way: rooms are narrow.

        Who has just begun goes on in the stride of his gait; what he is off it dies away.

        A model that is shown another body's stride walks on in it, whosever walk it is told to have.
        """
        known = known_poses(self.past)
        if not self.made:
            known = self._in_stride(known)
            self._velocity = _key_speed(known)
        body = Rollout(self.sampler, build_skeleton(), known)
        place = np.array([[ahead.places[-1, 0], 0.0, ahead.places[-1, 1]]])
        goal = PelvisGoal(place)
        wish = Wish(CAPTION, goal, made_of=MadeOf.RECORDED, gait=self.gait)
        way = body.frame.inward(np.insert(ahead.places[KEYS], 1, 0.0, axis=1))[None, :, [0, 2]]
        guide = along(torch.from_numpy(way.astype(np.float32)))
        poses = body.go_on(wish, [self.seed, self.made], guide).poses
        keys = Frames(poses.roots[0, HISTORY - 1 :], poses.local[0, HISTORY - 1 :])
        assert self._velocity is not None
        found, self._velocity = spline(keys, self._velocity)
        if not self.made:
            found = _eased(self.past, found)
        self.made += 1
        self.past = self.past.then(found)[-HISTORY * STRIDE :]
        return found

    def _in_stride(self, known: Poses) -> Poses:
        """The history of the walker's own gait that is most like that of a body (1, 2, …), in its place."""
        frame, skeleton = HeadingFrame.of(known), build_skeleton()
        history = to_features(known, frame, skeleton)
        return from_features(self.sampler.stride_like(history[0], self.gait)[None], frame)


def _eased(past: Frames, found: Frames) -> Frames:
    """Frames that begin as the body was, in place and in speed; what it was off dies away."""
    still = np.zeros((len(past), 4))
    motion = Motion(
        found.root.astype(np.float32), found.local.astype(np.float32), np.zeros((len(found), 4), np.float32),
        build_skeleton(), np.zeros(len(found), np.int32),
    )  # fmt: skip
    eased = joined_within(History.of(past.root, past.local, still), motion, SETTLED, SETTLED)
    return Frames(eased.root_positions.astype(np.float64), eased.local_rotations.astype(np.float64))


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


def known_poses(past: Frames) -> Poses:
    """The last two frames at 10 a second (1, 2, …); a body of which less is known has stood still."""
    frames = [max(len(past) - 1 - STRIDE * back, 0) for back in range(HISTORY - 1, -1, -1)]
    root, local = past.root[frames], past.local[frames]
    return Poses(root[None], local[None], np.zeros((1, HISTORY, 4)))


def _key_speed(known: Poses) -> tuple[Array, Array]:
    """From the first to the last frame of a history (1, 2, …), a frame of a window."""
    turns = rotations.continuous(known.local[0])
    return known.roots[0, 1] - known.roots[0, 0], turns[1] - turns[0]
