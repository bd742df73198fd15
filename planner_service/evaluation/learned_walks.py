"""Walks of a diffusion model at recorded speeds, and how surely a classifier tells them from people it never saw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend.diffusion.learned_walker import caption_of
from motion_backend.diffusion.motion_features import HISTORY, STRIDE, Poses
from motion_backend.diffusion.rollout import WINDOW_SECONDS, PelvisGoal, Rollout, Wish, to_motion
from motion_backend.diffusion.sampler import Sampler
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.kernel_mmd import discrepancy
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.walk_classifier import told_apart
from motion_backend.mocap.dataset_file import Dataset
from motion_backend.motion import Emotion, Motion
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.gait_character import gait_character
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from planner_service.evaluation.walk_evaluation import CAPTION, Take, Walks, recorded_walks, spread, walks_of

WINDOWS: Final = 4
"""Of 1.4 s that are walked: what is judged comes after the first."""
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
    """Straight on at these speeds, from the middle of a walk by rules; all bodies at once."""
    body = Rollout(sampler, skeleton, _beginnings(speeds, skeleton))
    first = body.frame
    ahead = np.stack([np.sin(first.yaw), np.zeros(len(speeds)), np.cos(first.yaw)], axis=-1)
    gait, errors = np.array([sampler.gait_of(one) for one in range(len(speeds))]), list[Array]()
    for window in range(WINDOWS):
        here = body.poses.roots[:, -1]
        along = np.sum((here - first.origin) * ahead, axis=1)
        goal = first.origin + ahead * (along + WINDOW_SECONDS * speeds)[:, None]
        wish = Wish(caption_of(float(speeds.mean())), PelvisGoal(goal, first.yaw), gait=gait)
        body = body.go_on(wish, [seed, window])
        errors.append(np.linalg.norm((body.poses.roots[:, -1] - goal)[:, [0, 2]], axis=1))
    motions = [to_motion(_of(body.poses, index), skeleton) for index in range(len(speeds))]
    later = [motion.part(HISTORY * STRIDE + 24, len(motion)) for motion in motions]
    takes = [Take(f"walk {index}", f"walk {index}", motion) for index, motion in enumerate(later)]
    return LearnedWalks(walks_of("learned", takes), tuple(later), float(np.median(errors)))


def judged(sampler: Sampler, dataset: Dataset, people: int = 48, seed: int = 0) -> Mapping[str, float]:
    """How a model walks beside recorded people of the dataset's test side, of whom it has seen nothing."""
    unseen = recorded_walks(replace(dataset, entries=tuple(e for e in dataset.entries if e.split == "test")))
    everybody = recorded_walks(dataset)
    speeds = np.random.default_rng(seed).choice(everybody.of("speed"), people)
    made = walked(sampler, speeds, dataset.skeleton, seed)
    if len(made.walks.seconds) < 8:
        return {"goal_error": made.goal_error, "windows": len(made.walks.seconds)}
    own = made.walks.seconds.of_one("learned")
    told = {f"auc {limb}": told_apart(unseen.seconds, own, limb).auc for limb in LIMBS}
    distance = discrepancy(everybody.features, everybody.groups, made.walks.features, made.walks.groups)
    wide = float(np.minimum(spread(everybody, made.walks), 1.0).mean())
    return {**told, "mmd2": distance.value, "spread": wide, "slip": made.slip, "goal_error": made.goal_error}


def _beginnings(speeds: Array, skeleton: Skeleton) -> Poses:
    """Two frames from the middle of a walk by rules at each speed. (B, 2, …)."""
    found = []
    for seed, speed in enumerate(speeds.tolist()):
        style = replace(walk_style(Emotion.NEUTRAL, CAPTION), speed=speed / skeleton.scale, character=gait_character(seed))
        start, way = standing((0.0, 0.0), 0.0, style.bearing, skeleton), np.array([[0.0, 0.0], [0.0, 3.0 + speed]])
        pose = walk(start, way, None, style, skeleton, np.random.default_rng(seed))
        root, local = solve(pose, skeleton)
        middle = len(pose) // 2
        chosen = slice(middle, middle + HISTORY * STRIDE, STRIDE)
        found.append(Poses(root[chosen], local[chosen], np.repeat(pose.planted, 2, axis=1)[chosen].astype(np.float64)))
    return Poses(*(np.stack([getattr(one, name) for one in found]) for name in ("roots", "local", "contacts")))


def _of(poses: Poses, index: int) -> Poses:
    return Poses(poses.roots[index], poses.local[index], poses.contacts[index])
