"""How far made walks are from recorded ones: how surely they are told from people, and by what.

Features of 2 s windows, their distance, jerk and skating at equal speed come with it. The figures are a baseline: what
moves the body otherwise, a learned model say, is to come nearer than the rules do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.director import Director
from motion_backend.metrics.foot_skate import skate_ratio, skate_speed
from motion_backend.metrics.gait_features import UNITS, gait_features, windows
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.kernel_mmd import Distance, discrepancy, floor
from motion_backend.metrics.smoothness import RULER
from motion_backend.metrics.walk_classifier import MIN_WINDOWS, Told, Yardstick, people_apart, told_apart
from motion_backend.metrics.walk_seconds import LIMBS, WHOLE, Seconds, seconds_of
from motion_backend.metrics.walk_traits import GiveAway, give_aways
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.mocap.plain_walks import RECORDED, is_plain_walk
from motion_backend.mocap.resampling import low_pass
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, Skill
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.gait_character import gait_character
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from planner_service.evaluation.body_evaluation import plan_trials
from planner_service.evaluation.trials import perform
from planner_service.pipeline import RequestError
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout

CAPTION: Final = "steadily walking forward"
MAX_WINDOWS: Final = 12
"""Of one person, spread over their clips: who walked up and down thirty times is one person still."""
MAX_SECONDS: Final = 24
"""Likewise, of one second each."""
MIN_PEOPLE: Final = 4
AUC_MOST: Final = 0.90
"""Limit for a body of ours at recorded speeds."""
PEOPLE_AUC: Final = (0.65, 0.80)
"""What half of the people must have against the other half: else the classifier is too blind or too sharp to judge."""
SPREAD_LEAST: Final = 0.7
"""Limit for the spread of gait features against that of people."""
SPEEDS: Final = ((0.3, 0.8), (0.8, 1.1), (1.1, 1.4), (1.4, 1.7), (1.7, 2.2))
"""Bins in which jerk is compared (metres a second)."""
GROUND: Final = Layout("ground", "living_room", ((0.0, 0.0), (0.0, 4.0), (16.0, 4.0), (16.0, 0.0)))
ENDS: Final = ((1.5, 2.0), (14.5, 2.0))
"""An empty hall, and where walks in it lead to ([x, z], metres)."""


class Take(NamedTuple):
    """A motion, whose it is and what it was cut from."""

    group: str
    name: str
    motion: Motion


@dataclass(frozen=True)
class Walks:
    """Windows of steady walking of one kind."""

    name: str
    features: Array
    """(N, 16) as `UNITS` has them."""
    groups: tuple[str, ...]
    """Whose each is: a person, or a seed or room of ours; windows of one group are alike."""
    skates: tuple[float, ...]
    """Share of skating frames of each."""
    slides: tuple[float, ...]
    """Speed of sole corners on the floor, cm/s, likewise."""
    seconds: Seconds
    """What a classifier sees of the same walks."""

    def __len__(self) -> int:
        return len(self.features)

    def of(self, feature: str) -> Array:
        """One feature of all windows. (N,)."""
        return np.asarray(self.features[:, list(UNITS).index(feature)])


@dataclass(frozen=True)
class Compared:
    """Made walks beside the recorded ones."""

    walks: Walks
    distance: Distance
    told: Told | None
    """How surely a classifier tells them from people; None for moods, which people here are not in, and few windows."""


@dataclass(frozen=True)
class JerkBin:
    """Mean jerk of walks at one speed, m/s³."""

    slowest: float
    fastest: float
    recorded: float
    ours: float
    windows: int
    """Recorded ones in it."""


@dataclass(frozen=True)
class WalkReport:
    """Everything that `sims evaluate walks` prints."""

    recorded: Walks
    floor: Distance
    """Between halves of the people who were recorded."""
    compared: tuple[Compared, ...]
    """Walks at the recorded speeds first."""
    jerk: tuple[JerkBin, ...]
    yardstick: Yardstick
    """How surely the classifier tells people from each other."""
    limbs: dict[str, Told]
    """How surely it tells walks at the recorded speeds by some joints alone."""
    give_aways: tuple[GiveAway, ...]
    """By what else, the surest first."""
    caption: str
    backend: str

    @property
    def spread(self) -> float:
        """Spread of the gait features at recorded speeds over that of people: the mean, more than theirs as theirs."""
        return float(np.minimum(spread(self.recorded, self.compared[0].walks), 1.0).mean())

    def to_dict(self) -> dict[str, Any]:
        """For JSON; features as mean and standard deviation."""
        recorded, matched = self.recorded, self.compared[0].walks
        deviations = dict(zip(UNITS, apart(recorded, matched).tolist(), strict=True))
        spreads = dict(zip(UNITS, spread(recorded, matched).tolist(), strict=True))
        return {
            "physics_mode": "none", "backend": self.backend, "caption": self.caption,
            "recorded": {"people": len(set(recorded.groups)), **_summed(recorded), "mmd2_between_halves":
                         vars(self.floor)},
            "compared": [{**_summed(one.walks), "name": one.walks.name, "mmd2": vars(one.distance),
                          "classifier": one.told and vars(one.told)} for one in self.compared],
            "deviations_apart": deviations,
            "spread": {"mean": self.spread, "limit_least": SPREAD_LEAST, "of": spreads},
            "classifier": {
                "limit_most": AUC_MOST, "limit_people": PEOPLE_AUC, "people": vars(self.yardstick),
                "limbs": {limb: vars(told) for limb, told in self.limbs.items()},
            },
            "give_aways": [asdict(one) for one in self.give_aways],
            "jerk": [vars(one) for one in self.jerk],
        }  # fmt: skip


def evaluate_walks(
    dataset: Dataset, style: str = "", caption: str = CAPTION, rooms: int = 6, seeds: int = 3
) -> WalkReport:
    """Compare ours with recorded walks: at their speeds, in rooms, and in every mood. ClipError for too few of them."""
    recorded = recorded_walks(dataset, style)
    matched = matched_walks(recorded.of("speed"), caption, dataset.skeleton)
    if len(matched) < 2:
        raise RequestError(f"{caption!r:.80} is not walked straight on", f"try {CAPTION!r}", at="--caption")
    plain = [matched, room_walks(caption, rooms, seeds)]
    moods = [mood_walks(caption, mood, seeds) for mood in Emotion]
    return WalkReport(
        recorded=recorded,
        floor=floor(recorded.features, recorded.groups),
        compared=tuple(_compared(recorded, one, one in plain) for one in plain + moods if len(one) > 1),
        jerk=jerk_bins(recorded, matched),
        yardstick=people_apart(recorded.seconds),
        limbs={limb: told_apart(recorded.seconds, _as_one(matched), limb) for limb in LIMBS if limb != WHOLE},
        give_aways=tuple(give_aways(recorded.seconds, matched.seconds)),
        caption=caption,
        backend="procedural",
    )


def _compared(recorded: Walks, ours: Walks, judged: bool) -> Compared:
    distance = discrepancy(recorded.features, recorded.groups, ours.features, ours.groups)
    few = not judged or len(ours.seconds) < MIN_WINDOWS
    return Compared(ours, distance, None if few else told_apart(recorded.seconds, _as_one(ours)))


def _as_one(ours: Walks) -> Seconds:
    """Whatever the seed or room, it is one body."""
    return ours.seconds.of_one(ours.name)


def recorded_walks(dataset: Dataset, style: str = "") -> Walks:
    """Recorded walks, as they were recorded: plain ones, or those whose style has a word."""
    chosen = [entry for entry in dataset.entries if entry.kind == RECORDED and _is_asked_for(entry, style)]
    found = walks_of("recorded", [Take(entry.subject, entry.name, entry.motion) for entry in chosen])
    people = np.array(found.groups)
    if len(set(found.groups)) < MIN_PEOPLE:
        what = f"walks called {style!r:.40}" if style else "plain walks"
        raise ClipError(
            f"--clips: recorded {what} of {len(set(found.groups))} people hold 2 s of steady walking",
            f"at least {MIN_PEOPLE} are needed (sims clips build --kinds 'real mocap')",
        )
    kept = np.sort(np.concatenate([_spread(np.flatnonzero(people == name)) for name in np.unique(people)]))
    return _chosen(found, kept)


def matched_walks(speeds: Array, caption: str, skeleton: Skeleton, mood: Emotion = Emotion.NEUTRAL) -> Walks:
    """A straight walk over open ground at each of these speeds, each in a gait of its own, its middle two seconds."""
    motions = []
    for seed, speed in enumerate(speeds.tolist()):
        style = replace(walk_style(mood, caption), speed=speed / skeleton.scale, character=gait_character(seed))
        start, way = standing((0.0, 0.0), 0.0, style.bearing, skeleton), np.array([[0.0, 0.0], [0.0, 3.0 + 3 * speed]])
        pose = walk(start, way, None, style, skeleton, np.random.default_rng(seed))
        root, local = solve(pose, skeleton)
        motion = Motion(
            root_positions=root.astype(np.float32),
            local_rotations=local.astype(np.float32),
            contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
            skeleton=skeleton,
            actions=np.zeros(len(pose), dtype=np.int32),
        )
        middle = (len(motion) - 60) // 2
        motions.append(Take(f"seed {seed}", f"seed {seed}", motion.part(middle, middle + 60)))
    return walks_of("at recorded speeds", motions)


def room_walks(caption: str, rooms: int, seeds: int) -> Walks:
    """Walks to places of library rooms, as trials of the body have them."""
    trials = plan_trials({Skill.LOCO: [caption]}, rooms, seeds)
    return walks_of(
        "in rooms", [Take(trial.room, trial.room, made) for trial in trials for made in perform(trial).motions]
    )


def mood_walks(caption: str, mood: Emotion, seeds: int) -> Walks:
    """From somewhere in an empty hall to both its ends in a mood, as a backend walks that is told no more than that."""
    home, director = hall(), Director.of("procedural")
    motions = []
    for seed in range(seeds):
        state = director.begin(home, Character(), seed)
        actions = [Action(Skill.LOCO, caption, mood, goal=goal, keyframe=index) for index, goal in enumerate(ENDS)]
        motions += [Take(f"seed {seed}", f"seed {seed}", motion) for motion, _ in director.play(home, actions, state)]
    return walks_of(mood, motions)


def jerk_bins(recorded: Walks, ours: Walks) -> tuple[JerkBin, ...]:
    """Mean jerk by speed, where both have windows."""
    found = []
    for slowest, fastest in SPEEDS:
        means = []
        for walks in (recorded, ours):
            inside = (walks.of("speed") >= slowest) & (walks.of("speed") < fastest)
            means.append(np.exp(walks.of("log_jerk")[inside]))
        if all(map(len, means)):
            found.append(JerkBin(slowest, fastest, float(means[0].mean()), float(means[1].mean()), len(means[0])))
    return tuple(found)


def apart(recorded: Walks, ours: Walks) -> Array:
    """How many standard deviations of the recorded ones the mean of ours is above theirs. (16,)."""
    deviation = np.maximum(recorded.features.std(axis=0), 1e-9)
    return np.asarray((ours.features.mean(axis=0) - recorded.features.mean(axis=0)) / deviation)


def spread(recorded: Walks, ours: Walks) -> Array:
    """Standard deviation of each feature of ours over that of the recorded ones. (16,)."""
    return np.asarray(ours.features.std(axis=0) / np.maximum(recorded.features.std(axis=0), 1e-9))


@lru_cache(maxsize=1)
def hall() -> Home:
    """An empty hall, the same one each time."""
    return home_from_layouts([GROUND], 0)


def _is_asked_for(entry: Entry, style: str) -> bool:
    if style:
        return entry.skill == Skill.LOCO and not entry.changed and style.lower() in entry.style.lower()
    return is_plain_walk(entry) and not entry.changed


def _spread(of: NDArray[np.int64]) -> NDArray[np.int64]:
    """At most `MAX_WINDOWS` of these, from the first to the last."""
    return of[np.unique(np.linspace(0, len(of) - 1, min(len(of), MAX_WINDOWS)).round().astype(np.int64))]


def walks_of(name: str, takes: Sequence[Take]) -> Walks:
    """What steady walking there is in takes."""
    # What a camera shakes is smoothed out of recordings: both are compared without it.
    smooth = [low_pass(take.motion.joint_positions().astype(np.float64), take.motion.fps, RULER) for take in takes]
    rows = [row for take, positions in zip(takes, smooth, strict=True) for row in _windows_of(take, positions)]
    features = np.array([row[1] for row in rows]).reshape(-1, len(UNITS))
    groups, skates, slides = (
        tuple(row[0] for row in rows), tuple(row[2] for row in rows), tuple(row[3] for row in rows)
    )  # fmt: skip
    named = [(take.group, take.name, positions) for take, positions in zip(takes, smooth, strict=True)]
    return Walks(name, features, groups, skates, slides, seconds_of(named, FPS))


def _windows_of(take: Take, positions: Array) -> Iterator[tuple[str, Array, float, float]]:
    for start, stop in windows(positions, take.motion.fps):
        features = gait_features(positions[start:stop], take.motion.fps)
        if features is not None:
            body = Kinematics.of(take.motion.part(start, stop))
            yield take.group, features, skate_ratio(body), skate_speed(body)


def _chosen(walks: Walks, kept: NDArray[np.int64]) -> Walks:
    columns = ([column[index] for index in kept] for column in (walks.groups, walks.skates, walks.slides))
    groups, skates, slides = map(tuple, columns)
    return Walks(walks.name, walks.features[kept], groups, skates, slides, walks.seconds.spread(MAX_SECONDS))


def _summed(walks: Walks) -> dict[str, Any]:
    means, deviations = walks.features.mean(axis=0).tolist(), walks.features.std(axis=0).tolist()
    return {
        "windows": len(walks),
        "features": {name: {"mean": m, "sd": s} for name, m, s in zip(UNITS, means, deviations, strict=True)},
        "skate_ratio": float(np.mean(walks.skates)),
        "skate": float(np.mean(walks.slides)),
    }
