"""What learned and matched motion cost: windows against playing them, and a step beside what its products cost.

The speed of `paper` is that of an untrained network of its sizes: what a network has learned does not change its cost.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
import torch

from benchmarks.figure import Figure
from motion_backend.diffusion.backend import acting, walking
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.denoiser import PRESETS, Denoiser
from motion_backend.diffusion.learned_walker import LearnedGait, known_poses
from motion_backend.diffusion.motion_features import FEATURES, WINDOW
from motion_backend.diffusion.noise_schedule import NoiseSchedule
from motion_backend.diffusion.rollout import PelvisGoal, Rollout, Wish
from motion_backend.diffusion.sampler import DDIM_STEPS, Sampler, Scale
from motion_backend.matching.backend import Matching
from motion_backend.matching.walk_database import build_walk_database
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.motion import FPS, Emotion, Motion
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.skeleton import build_skeleton
from motion_backend.walk_generator import LOOK, Ahead, Frames, WalkGenerator

if TYPE_CHECKING:
    from collections.abc import Iterator

SMALL, PAPER, MATCHED = 20.0, 5.0, 100.0
"""Times real time on one core, at least."""
WINDOWS: Final = 12
"""That are made for a figure."""
REPEATS: Final = 3
SIDE: Final = 512
"""Of the matrices whose product tells what a core can do."""
TOKENS: Final = 20


def learned_figures() -> list[Figure]:
    """All of them, on one thread."""
    with _one_thread():
        paper = _untrained("paper")
        return [
            _speed("learned walk in full stride", LearnedGait(walking(), 1), SMALL, f"preset walk, {_size(walking())}"),
            _rolled("learned parts, preset small", acting().acting, SMALL),
            _rolled("preset paper, not trained", paper, PAPER),
            _speed("walk matched to clips", Matching(build_walk_database(_clips())), MATCHED, "twelve made walks"),
            *_steps(acting().acting, "small"),
            *_steps(paper, "paper"),
        ]


@contextmanager
def _one_thread() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _speed(name: str, generator: WalkGenerator, limit: float, note: str) -> Figure:
    """How much faster than it plays a walk straight on is made, splines counted in, feet not yet held."""
    walker = generator.begin(_beginning(), np.random.default_rng(0))
    ways = iter([[0.0, 1.2 * (LOOK * number + frame) / FPS] for frame in range(1, LOOK + 1)] for number in range(10**6))
    walker.window(Ahead(np.array(next(ways))))
    seconds = _least(lambda: [walker.window(Ahead(np.array(next(ways)))) for _ in range(WINDOWS)])
    return Figure(f"{name}, against playing it", WINDOWS * LOOK / FPS / seconds, "×", limit, "least", note, 0)


def _rolled(name: str, sampler: Sampler, limit: float) -> Figure:
    """The same of windows that see the scene, without splines."""
    past = _beginning()
    body = Rollout(sampler, build_skeleton(), known_poses(past))
    voxels = np.zeros((1, 64, 32, 32), dtype=np.float32)
    goal = PelvisGoal(past.root[-1:] + np.array([0.0, -0.4, 0.5]), np.zeros(1), True, 2.0)
    wish = Wish("sit down", goal, None, 30, MadeOf.PROCEDURAL, voxels=voxels)
    body.go_on(wish, [0])
    seconds = _least(lambda: [body.go_on(wish, [number]) for number in range(WINDOWS)])
    played = WINDOWS * LOOK / FPS
    note = f"{DDIM_STEPS} steps of DDIM, scene seen, {_size(sampler)}"
    return Figure(f"{name}, against playing it", played / seconds, "×", limit, "least", note, 0)


def _steps(sampler: Sampler, name: str) -> list[Figure]:
    """Milliseconds of one step of sampling, and how often its products alone would fit into that."""
    net = sampler.denoiser
    noised, tokens = torch.randn(1, WINDOW, FEATURES), torch.randn(1, TOKENS - WINDOW, net.sizes.width)
    with torch.inference_mode():
        net(noised, torch.zeros(1), tokens)
        seconds = _least(lambda: [net(noised, torch.zeros(1), tokens) for _ in range(WINDOWS)]) / WINDOWS
    flops, rate = products(net), _matmul_rate()
    note = f"{flops / 1e6:.0f} MFLOP; {rate / 1e9:.0f} GFLOP/s in products of {SIDE} × {SIDE}"
    return [
        Figure(f"a step of preset {name}", 1000 * seconds, "ms", note=note, digits=2),
        Figure("the same beside its products alone", seconds / (flops / rate), "×", digits=1),
    ]


def products(net: Denoiser) -> float:
    """Floating-point operations of the matrix products of one step for one window."""
    sizes = net.sizes
    layer = 2 * TOKENS * (4 * sizes.width**2 + 2 * sizes.width * sizes.hidden) + 4 * TOKENS**2 * sizes.width
    return float(sizes.layers * layer + 2 * 2 * WINDOW * FEATURES * sizes.width + 4 * sizes.width**2)


def _matmul_rate() -> float:
    one = torch.randn(SIDE, SIDE)
    one @ one
    return 2 * SIDE**3 * WINDOWS / _least(lambda: [one @ one for _ in range(WINDOWS)])


def _least(work: Callable[[], object]) -> float:
    """Seconds of a core, of the quickest of a few runs."""
    found = []
    for _ in range(REPEATS):
        started = time.process_time()
        work()
        found.append(time.process_time() - started)
    return min(found)


def _size(sampler: Sampler) -> str:
    return f"{sum(one.numel() for one in sampler.denoiser.parameters()) / 1e6:.1f} million parameters"


def _untrained(preset: str) -> Sampler:
    torch.manual_seed(0)
    scale = Scale(torch.zeros(FEATURES), torch.full((FEATURES,), 0.02))
    return Sampler(Denoiser(PRESETS[preset]).eval(), scale, NoiseSchedule())


def _walked(speed: float, bend: float, seed: int) -> Motion:
    """A walk of our own body over open ground."""
    skeleton, style = build_skeleton(), replace(walk_style(Emotion.NEUTRAL, "walk"), speed=speed)
    along = np.linspace(0.0, 9.0, 60)
    way = np.stack([bend * along**2, along], axis=1)
    pose = walk(standing((0.0, 0.0), 0.0, Bearing(), skeleton), way, None, style, skeleton, np.random.default_rng(seed))
    root, local = solve(pose, skeleton)
    return Motion(
        root.astype(np.float32), local.astype(np.float32), np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton, np.zeros(len(root), np.int32),
    )  # fmt: skip


def _beginning() -> Frames:
    """Ten frames from the middle of a walk."""
    motion = _walked(1.2, 0.0, 0)
    middle = slice(len(motion) // 2 - 10, len(motion) // 2)
    return Frames(motion.root_positions[middle].astype(np.float64), motion.local_rotations[middle].astype(np.float64))


def _clips() -> Dataset:
    """Walks of our own body as if people had been recorded."""
    rows = [(speed, bend) for speed in (0.8, 1.0, 1.2, 1.4) for bend in (-0.04, 0.0, 0.04)]
    entries = [
        Entry(
            name=f"walk {number}", skill="loco", style="neutral", emotion="neutral", captions=("walk",),
            subject=f"person {number % 3}", kind="real mocap", licence="ours", source="made here", changed=(),
            split="train", motion=motion, hands=np.zeros((len(motion), 2), dtype=np.bool_),
        )
        for number, (speed, bend) in enumerate(rows)
        for motion in (_walked(speed, bend, number),)
    ]  # fmt: skip
    return Dataset(build_skeleton(), tuple(entries))
