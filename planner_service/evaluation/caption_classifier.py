"""Whether captions can be told apart by what the body does: the nearest neighbour among motions of other rooms.

A motion is described by analytic features of how the caption is held or walked: they see no furniture, no caption and
no place in the room. Every trial is named after the trial most like it, out of rooms and seeds it has no share in.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.metrics.contact_error import THRESHOLDS, contact_distance, longest_run
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from planner_service.evaluation.trials import Trial

SAME: Final[dict[Skill, tuple[tuple[tuple[str, ...], str], ...]]] = {
    Skill.SITDOWN: (
        (
            ("sit upright with hands on thighs", "sitting upright, hands placed on thighs", "hands on thighs"),
            "the same pose in other words; who sits is upright unless it is said otherwise",
        ),
        (
            ("hands behind head, cross-legged, lean back", "hands behind head, lean back, cross-legged"),
            "the same words in another order",
        ),
    ),
    Skill.TOUCH: tuple(
        ((caption, f"{caption} with the right hand"), "the right hand touches where none is named")
        for caption in ("An act of reaching high", "touch low height", "touch medium height")
    ),
}
"""Captions that mean the same, and why; everything else is to be told apart."""
JOINTS: Final = (
    "spine3", "neck", "head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist",
    "right_wrist", "left_knee", "right_knee", "left_ankle", "right_ankle",
)  # fmt: skip
_TO_HANDS: Final = ("head", "neck", "spine3", "spine1", "left_hip", "right_hip", "left_knee", "right_knee")
NEAR: Final = (
    *((f"{side}_wrist", other) for side in ("left", "right") for other in _TO_HANDS),
    ("left_wrist", "right_wrist"), ("left_wrist", "right_elbow"), ("right_wrist", "left_elbow"),
    ("left_ankle", "right_ankle"), ("left_knee", "right_knee"), ("left_ankle", "right_knee"),
    ("right_ankle", "left_knee"),
)  # fmt: skip
TURNED: Final = ("pelvis", "spine3", "head", "left_wrist", "right_wrist")
BEATING: Final = ("left_wrist", "right_wrist", "head", "left_ankle", "right_ankle")
APART: Final = 0.95
"""The share of trials of a skill that is to be named rightly."""
VISIBLE: Final = 0.02
"""What one can see of a difference (metres, metres a second …): features that vary less are not blown up."""


def describe(motion: Motion, skill: Skill) -> Array:
    """What a caption looks like, in numbers: (F,) features of its telling part, free of place and heading."""
    body = Kinematics.of(motion)
    frames = telling_part(body, skill)
    positions, turns = body.positions[frames], body.world[frames]
    heading = _heading(positions, turns, lying=skill in (Skill.LIEDOWN, Skill.GETUP))
    level = rotations.yaw_to_quat(-heading)
    local = rotations.rotate(level[:, None], positions - positions[:, :1])
    joints = local[:, [INDEX[name] for name in JOINTS]]
    speeds = np.linalg.norm(np.diff(joints, axis=0), axis=-1) * motion.fps
    near = np.array([np.linalg.norm(local[:, INDEX[a]] - local[:, INDEX[b]], axis=-1) for a, b in NEAR])
    return np.concatenate(
        [
            # A thing is picked up or put down: what tells them apart is how a hand comes and goes.
            joints[[0, -1]].ravel() if skill is Skill.TOUCH else [],
            joints.mean(axis=0).ravel(),
            joints.std(axis=0).ravel(),
            np.ptp(joints, axis=0).ravel(),
            speeds.mean(axis=0),
            near.mean(axis=1),
            near.min(axis=1),
            _axes(turns, level).ravel(),
            _spins(turns, motion.fps),
            _beats(local, motion.fps),
            _travel(positions, heading, motion.fps),
        ]
    )


def telling_part(body: Kinematics, skill: Skill) -> slice:
    """The frames that show a caption: a pose held, a touch with a second about it, the middle of a walk, a rise."""
    frames, fps = len(body.motion), body.motion.fps
    if skill in THRESHOLDS:
        start, stop = longest_run(contact_distance(body) <= THRESHOLDS[skill])
        if skill is Skill.TOUCH:
            return slice(max(start - fps, 0), stop + fps)
        return slice(max(start, stop - 4 * fps), stop)
    if skill is Skill.LOCO:
        edge = frames // 8
        return slice(edge, frames - edge)
    return slice(0, frames)


def _heading(positions: Array, turns: Array, lying: bool) -> Array:
    """Yaw of the pelvis, or of the line from pelvis to neck where the body lies. (T,)."""
    if lying:
        along = positions[:, INDEX["neck"]] - positions[:, 0]
        # One direction for the whole of it: a body that sits up on the way points nowhere.
        mean = along.mean(axis=0)
        return np.full(len(positions), np.arctan2(mean[0], mean[2]))
    forward = rotations.rotate(turns[:, 0], np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arctan2(forward[:, 0], forward[:, 2]))


def _axes(turns: Array, level: Array) -> Array:
    """Where pelvis, chest, head and hands look and how they are tilted, on average. (5, 2, 3)."""
    parts = rotations.compose(level[:, None], turns[:, [INDEX[name] for name in TURNED]])
    ahead, up = (rotations.rotate(parts, np.array(axis)) for axis in ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]))
    return np.stack([ahead.mean(axis=0), up.mean(axis=0)], axis=1)


def _spins(turns: Array, fps: int) -> Array:
    """How fast chest, head and hands turn, on average (radians a second). (4,)."""
    parts = turns[:, [INDEX[name] for name in TURNED[1:]]]
    steps = rotations.quat_to_rotvec(rotations.compose(rotations.inverse(parts[:-1]), parts[1:]))
    return np.asarray(np.linalg.norm(steps, axis=-1).mean(axis=0) * fps)


def _beats(local: Array, fps: int) -> Array:
    """How often a second wrists, head and ankles go up and down or to and fro, and how far. (2 x joints,)."""
    moved = local[:, [INDEX[name] for name in BEATING]]
    moved = moved - moved.mean(axis=0)
    power = np.abs(np.fft.rfft(moved, axis=0)[1:]) ** 2
    rates = np.fft.rfftfreq(len(moved), 1 / fps)[1:]
    total = power.sum(axis=(0, 2))
    rate = (power.sum(axis=2) * rates[:, None]).sum(axis=0) / np.maximum(total, 1e-12)
    return np.concatenate([rate * (moved.std(axis=(0, 2)) > VISIBLE / 4), moved.std(axis=(0, 2))])


def _travel(positions: Array, heading: Array, fps: int) -> Array:
    """How the pelvis moves: height, bob, pace forwards and sideways, turning, where it ends, and how long it takes."""
    step = np.diff(positions[:, 0][:, [0, 2]], axis=0) * fps
    yaw = heading[:-1]
    forwards = step[:, 0] * np.sin(yaw) + step[:, 1] * np.cos(yaw)
    leftwards = step[:, 0] * np.cos(yaw) - step[:, 1] * np.sin(yaw)
    turning = rotations.wrap(np.diff(heading)) * fps
    height = positions[:, 0, 1]
    pace = np.hypot(*step.T)
    return np.array([
        height.mean(), height.std(), height.min(), height.max(), forwards.mean(), forwards.std(), leftwards.mean(),
        np.abs(leftwards).mean(), np.abs(turning).mean(), turning.mean(), pace.mean(), pace.max(),
        (pace < 0.1).mean(), len(positions) / fps,
    ])  # fmt: skip


@dataclass(frozen=True)
class Confusion:
    """A caption that was taken for another."""

    skill: str
    caption: str
    taken_for: str
    times: int
    of: int


@dataclass(frozen=True)
class Telling:
    """How many trials of a skill were named rightly."""

    skill: str
    accuracy: float
    groups: int
    trials: int
    confusions: tuple[Confusion, ...]
    """The most frequent first."""

    @property
    def missed(self) -> bool:
        """Whether captions are too much alike."""
        return self.accuracy < APART


def group_of(skill: Skill, caption: str) -> str:
    """The caption that stands for all that mean the same."""
    return next((some[0] for some, _ in SAME.get(skill, ()) if caption in some), caption)


def tell_apart(described: Sequence[tuple[Trial, Array]]) -> list[Telling]:
    """Name every trial after its nearest neighbour in the other half of the rooms; rooms of a half share no seed."""
    return [
        _tell(skill, [one for one in described if one[0].skill is skill])
        for skill in Skill
        if len({trial.room for trial, _ in described if trial.skill is skill}) > 1
    ]


def _tell(skill: Skill, described: Sequence[tuple[Trial, Array]]) -> Telling:
    groups = [group_of(skill, trial.caption) for trial, _ in described]
    halves = _halves([trial for trial, _ in described], groups)
    features = np.stack([values for _, values in described])
    names = np.array(groups, dtype=object)
    taken = np.empty(len(names), dtype=object)
    for half in (0, 1):
        known, asked = halves != half, halves == half
        if known.any() and asked.any():
            taken[asked] = names[known][nearest(features[known], features[asked])]
    judged = np.array([name is not None for name in taken])
    wrong = Counter((names[i], taken[i]) for i in np.flatnonzero(judged) if names[i] != taken[i])
    counts = Counter(names[judged])
    confusions = tuple(
        Confusion(skill.value, a, b, times, counts[a]) for (a, b), times in sorted(wrong.items(), key=_most_first)
    )
    share = 1 - sum(wrong.values()) / max(int(judged.sum()), 1)
    return Telling(skill.value, share, len(set(groups)), int(judged.sum()), confusions)


def _halves(trials: Sequence[Trial], groups: Sequence[str]) -> NDArray[np.int_]:
    """0 or 1 for every trial, by its room: for every group each half has as many rooms, as far as may be."""
    played: dict[str, set[str]] = {}
    for trial, group in zip(trials, groups, strict=True):
        played.setdefault(trial.room, set()).add(group)
    half: dict[str, int] = {}
    counts: tuple[Counter[str], Counter[str]] = (Counter(), Counter())
    for room in sorted(played):
        first, second = (sum(count[group] for group in played[room]) for count in counts)
        half[room] = int(second < first)
        counts[half[room]].update(played[room])
    return np.array([half[trial.room] for trial in trials])


def _most_first(entry: tuple[tuple[str, str], int]) -> tuple[int, tuple[str, str]]:
    return -entry[1], entry[0]


def nearest(known: Array, asked: Array) -> NDArray[np.int_]:
    """For each of A motions the nearest of K known ones, features being standardised by the known. (A,)."""
    scale = known.std(axis=0) + VISIBLE
    a, b = asked / scale, known / scale
    squares = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1)[None] - 2 * a @ b.T
    return np.asarray(squares.argmin(axis=1))
