"""Walks of a diffusion model at recorded speeds, and how surely a classifier tells them from people it never saw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend.backend_protocol import HISTORY
from motion_backend.diffusion.learned_walker import LearnedGait
from motion_backend.diffusion.sampler import Sampler
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.kernel_mmd import discrepancy
from motion_backend.metrics.walk_classifier import told_apart
from motion_backend.mocap.dataset_file import Dataset
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Emotion, Motion
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.gait_character import gait_character
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from motion_backend.walk_generator import LOOK, Ahead, Frames
from planner_service.evaluation.walk_comparison import MAX_SECONDS, with_sides
from planner_service.evaluation.walk_evaluation import CAPTION, Take, Walks, recorded_walks, spread, walks_of

WINDOWS: Final = 4
"""Of 1.4 s that are walked: what is judged comes after the first."""
SETTLES: Final = 30
"""Frames in which a body comes from the stride of the rules into its own."""
LIMBS: Final = ("whole body", "legs", "arms")


@dataclass(frozen=True)
class LearnedWalks:
    """Straight walks of one model."""

    walks: Walks
    motions: tuple[Motion, ...]
    goal_error: float
    """Median metres from a window's end to its goal."""

    @property
    def slip(self) -> float:
        """Mean speed of the best supported point of the soles, cm/s."""
        return float(np.mean([support_slip(Kinematics.of(motion)) for motion in self.motions]))


def walked(sampler: Sampler, speeds: Array, skeleton: Skeleton, seed: int = 0) -> LearnedWalks:
    """Straight on at these speeds, from the middle of a walk by rules, each body in a gait of its own."""
    takes, errors = [], []
    for number, speed in enumerate(speeds.tolist()):
        past = _beginning(speed, number, skeleton)
        walker = LearnedGait(sampler, sampler.gait_of(number)).begin(past, np.random.default_rng([seed, number]))
        made = past
        for _ in range(WINDOWS):
            goal = made.root[-1, [0, 2]] * [0.0, 1.0] + np.arange(1, LOOK + 1)[:, None] / FPS * [0.0, speed]
            made = made.then(walker.window(Ahead(goal)))
            errors.append(np.linalg.norm(made.root[-1, [0, 2]] - goal[-1]))
        root, local, contacts = held(made.root, made.local, skeleton, len(past))
        motion = Motion(
            root.astype(np.float32), local.astype(np.float32), contacts.astype(np.float32), skeleton,
            np.zeros(len(root), np.int32),
        )  # fmt: skip
        takes.append(Take(f"walk {number}", f"walk {number}", motion.part(len(past) + SETTLES, len(motion))))
    return LearnedWalks(walks_of("learned", takes), tuple(take.motion for take in takes), float(np.median(errors)))


def judged(sampler: Sampler, dataset: Dataset, people: int = 48, seed: int = 0) -> Mapping[str, float]:
    """How a model walks beside recorded people of whom it has seen nothing.

    Where it does not say whom it has seen these are the people of the dataset's test side.
    """
    dataset = with_sides(dataset, sampler.learned_from)
    unseen = recorded_walks(replace(dataset, entries=tuple(e for e in dataset.entries if e.split == "test")))
    everybody = recorded_walks(dataset)
    speeds = np.random.default_rng(seed).choice(everybody.of("speed"), people)
    if sampler.paces is not None:  # as the backend has them walk, where nothing hurries them
        speeds = np.array([sampler.pace_of(sampler.gait_of(number)) for number in range(people)])
    made = walked(sampler, speeds, dataset.skeleton, seed)
    if len(made.walks.seconds) < 8:
        return {"goal_error": made.goal_error, "windows": len(made.walks.seconds)}
    # As many windows as everybody else is judged by: a judge who is shown more of a body tells it more surely.
    own = made.walks.seconds.of_one("learned").spread(MAX_SECONDS)
    told = {f"auc {limb}": told_apart(unseen.seconds, own, limb).auc for limb in LIMBS}
    distance = discrepancy(everybody.features, everybody.groups, made.walks.features, made.walks.groups)
    wide = float(np.minimum(spread(everybody, made.walks), 1.0).mean())
    return {**told, "mmd2": distance.value, "spread": wide, "slip": made.slip, "goal_error": made.goal_error}


def _beginning(speed: float, seed: int, skeleton: Skeleton) -> Frames:
    """Ten frames from the middle of a walk by rules, along +Z."""
    style = replace(walk_style(Emotion.NEUTRAL, CAPTION), speed=speed / skeleton.scale, character=gait_character(seed))
    start, way = standing((0.0, 0.0), 0.0, style.bearing, skeleton), np.array([[0.0, 0.0], [0.0, 3.0 + speed]])
    root, local = solve(walk(start, way, None, style, skeleton, np.random.default_rng(seed)), skeleton)
    middle = slice(len(root) // 2 - HISTORY, len(root) // 2)
    return Frames(root[middle], local[middle])
