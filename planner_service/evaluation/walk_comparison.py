"""Walks of several backends beside each other, judged by people whom none of them was made of.

A backend that is made of recordings is made of those of the people meant for training, and judged by the others'. Those
people themselves, as one body, are what all of them are read against: nobody is less like strangers than strangers are.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from motion_backend.backends import DEFAULT_BACKEND, DIFFUSION, MATCHING, load_backend
from motion_backend.director import Director, shares
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.gait_features import UNITS
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.kernel_mmd import Distance, discrepancy
from motion_backend.metrics.walk_classifier import MIN_WINDOWS, Told, told_apart
from motion_backend.metrics.walk_seconds import LIMBS
from motion_backend.mocap.dataset_file import Dataset
from motion_backend.mocap.plain_walks import recorded_walks as plain_walks
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.scene import scene_of
from planner_service.evaluation.walk_evaluation import (
    ENDS,
    Take,
    Walks,
    apart,
    hall,
    recorded_walks,
    spread,
    walks_of,
)
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout_library import built_in_index

TRAIN, TEST = "train", "test"
MAX_SECONDS: Final = 120
"""Windows of a body that the classifier is shown, spread over its takes."""
WALKS_A_ROOM: Final = 4
"""Places that are walked to, one after the other, where nothing else is asked for."""


@dataclass(frozen=True)
class Judged:
    """One body's walks against people it was not made of."""

    name: str
    place: str
    """in the hall, in rooms, or as recorded."""
    seconds: int
    """Windows of one second."""
    told: dict[str, Told]
    """How surely each limb is told from people, with 95 % over them; empty for too few windows."""
    distance: Distance | None
    spread: float
    """Of the gait features over that of all people: the mean, more than theirs counted as theirs."""
    slip: float
    """Of the best supported point of the soles, cm/s."""
    made_by: dict[str, float]
    """Shares of the frames."""
    reached: float
    """Share of walks that got where they were to get."""
    deviations: dict[str, float]
    """Standard deviations of recorded features by which the mean is above theirs."""

    @property
    def auc(self) -> dict[str, float]:
        """The means alone."""
        return {limb: told.auc for limb, told in self.told.items()}

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        told = {limb: vars(told) for limb, told in self.told.items()}
        return {**vars(self), "told": told, "auc": self.auc, "distance": self.distance and vars(self.distance)}


def compare_walks(
    dataset: Dataset, names: Sequence[str], caption: str, rooms: int, seeds: int, walks_a_room: int = WALKS_A_ROOM
) -> list[Judged]:
    """People meant for training, then every backend in the hall and in rooms. ClipError for too few people."""
    if DIFFUSION in names:
        from motion_backend.diffusion.backend import walking

        dataset = with_sides(dataset, walking().learned_from)
    everybody = recorded_walks(dataset)
    strangers = recorded_walks(_side(dataset, TEST))
    own = recorded_walks(_side(dataset, TRAIN))
    plain = [Take(entry.subject, entry.name, entry.motion) for entry in plain_walks(dataset, TRAIN)]
    found = [_judged("people of the training side", "as recorded", own, (strangers, everybody), plain, 1.0)]
    for name in names:
        director = _director(name, dataset)
        for place, homes in (("in the hall", [hall()] * seeds), ("in rooms", _rooms(rooms))):
            made, reached = _acted(director, homes, caption, walks_a_room)
            walks = walks_of(name, made)
            found.append(_judged(name, place, walks, (strangers, everybody), made, reached))
    return found


def with_sides(dataset: Dataset, learned_from: Collection[str]) -> Dataset:
    """A collection whose test side is everybody that was not learned from; as it is where nobody is named.

    Who is dealt to which side hangs on all clips that were accepted, and may differ from build to build.
    """
    if not learned_from:
        return dataset
    sides = [TRAIN if entry.subject in learned_from else TEST for entry in dataset.entries]
    rows = zip(dataset.entries, sides, strict=True)
    return replace(dataset, entries=tuple(replace(entry, split=side) for entry, side in rows))


def _side(dataset: Dataset, split: str) -> Dataset:
    return replace(dataset, entries=tuple(entry for entry in dataset.entries if entry.split == split))


def _director(name: str, dataset: Dataset) -> Director:
    if name != MATCHING:
        return Director.of(name)
    from motion_backend.matching.backend import MatchingBackend
    from motion_backend.matching.walk_database import build_walk_database

    return Director(MatchingBackend(build_walk_database(dataset, TRAIN)), load_backend(DEFAULT_BACKEND))


def _rooms(count: int) -> list[Home]:
    """Rooms of the library in an order by chance, those in which one can walk some way."""
    layouts = built_in_index().layouts
    order = np.random.default_rng(0).permutation(len(layouts))[:count]
    return [home_from_layouts([built_in_index().layout(layouts[index].id)], 0) for index in order]


def _acted(director: Director, homes: Sequence[Home], caption: str, walks_a_room: int) -> tuple[list[Take], float]:
    """Walks in homes, and the share of them that got there."""
    takes, done = list[Take](), list[bool]()
    for number, home in enumerate(homes):
        rng = np.random.default_rng([number, len(homes)])
        if home is hall():
            goals: list[tuple[float, float]] = [ENDS[index % 2] for index in range(2)]
        else:
            goals = [scene_of(home).walkable.random_point(rng, 0) for _ in range(walks_a_room)]
        actions = [
            Action(Skill.LOCO, caption, Emotion.NEUTRAL, goal=goal, keyframe=index) for index, goal in enumerate(goals)
        ]
        state = director.begin(home, Character(), number)
        for motion, _ in director.play(home, actions, state):
            takes.append(Take(str(number), f"{number}", motion))
            done.append(motion.completed)
    return takes, float(np.mean(done))


def _judged(
    name: str, place: str, walks: Walks, people: tuple[Walks, Walks], takes: Sequence[Take], reached: float
) -> Judged:
    strangers, everybody = people
    seconds = walks.seconds.of_one(name).spread(MAX_SECONDS)
    enough = len(seconds) >= MIN_WINDOWS
    told = {limb: told_apart(strangers.seconds, seconds, limb) for limb in LIMBS} if enough else {}
    many = len(walks) > 1
    far = discrepancy(strangers.features, strangers.groups, walks.features, walks.groups) if many else None
    wide = float(np.minimum(spread(everybody, walks), 1.0).mean()) if many else 0.0
    moved = dict(zip(UNITS, apart(everybody, walks).tolist(), strict=True)) if many else {}
    slips = [support_slip(Kinematics.of(take.motion)) for take in takes if len(take.motion) > 1]
    return Judged(
        name=name,
        place=place,
        seconds=len(walks.seconds),
        told=told,
        distance=far,
        spread=wide,
        slip=float(np.mean(slips)),
        made_by=_made_by([take.motion for take in takes]),
        reached=reached,
        deviations=moved,
    )


def _made_by(motions: Sequence[Motion]) -> dict[str, float]:
    frames = dict[str, float]()
    for motion in motions:
        for name, share in shares(motion).items():
            frames[name] = frames.get(name, 0.0) + share * len(motion)
    total = sum(frames.values())
    return {name: round(count / total, 4) for name, count in frames.items()}
