"""Hours of walking for a learner: ways through homes and over open ground, walked by recorded frames alone.

Recordings are short and straight: few of their seconds show a body that steers to a goal out of its own stride. These
do; they are labelled `matched`, in the form of a collection of clips.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.matching.frame_matcher import FrameMatcher
from motion_backend.matching.walk_database import WalkDatabase
from motion_backend.mocap.clip_captions import ways_to_say
from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import FPS, Emotion, Motion, Skill
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from motion_backend.walk_generator import Frames, Way, follow
from scene_graphs.home import Home
from scene_graphs.navigation.path_planner import NoPath

MATCHED: Final = "matched"
"""Kind and subject of clips that were put together from recorded frames."""
SPEEDS: Final = (0.6, 1.6)
"""Metres a second of a way: what people walk at home and outside."""
LENGTHS: Final = (5.0, 9.0)
"""Metres of a curve."""
BENDS, BEND = 6, 0.45
"""Places of a curve at which its bend is drawn, and how much (radians a metre, one standard deviation)."""
SHORTEST: Final = 1.5
"""Metres of a way through a home that is worth walking."""
SETTLES: Final = 15
"""Frames at the beginning that are not kept: the body comes from a frame of another way."""
USUAL: Final = 150
"""Frames of about the wanted speed that a walk may begin in."""
LEAST_FRAMES: Final = 60
"""Of a walk that is kept."""
SLOW, BRISK = 0.85, 1.35
"""Metres a second under which a walk is called slow, and over which it is called brisk."""


def matched_walks(database: WalkDatabase, hours: float, seed: int, homes: Sequence[Home] = ()) -> Dataset:
    """About so many hours of walks, half of them through homes where there are any; the same seed gives the same.

    Each is an entry of kind `matched` whose motion is what was walked; what it was to go to is where its pelvis gets.
    """
    rng, entries, frames = np.random.default_rng(seed), list[Entry](), 0
    places = [_ways_through(home, rng) for home in homes]
    while frames < hours * 3600 * FPS:
        speed = float(rng.uniform(*SPEEDS))
        indoors = places and rng.random() < 0.5
        points = next(places[int(rng.integers(len(places)))]) if indoors else _curve(rng)
        way = Way.along(points, speed)
        if len(way) < LEAST_FRAMES:
            continue
        motion = _walked(database, way, speed, rng)
        if len(motion) >= LEAST_FRAMES:
            entries.append(_entry(database, motion, len(entries)))
            frames += len(motion)
    return Dataset(build_skeleton(), tuple(entries))


def _walked(database: WalkDatabase, way: Way, speed: float, rng: np.random.Generator) -> Motion:
    """A way walked from somewhere in a stride on, feet held; no frames where too few of them came together."""
    past, skeleton = _in_stride(database, way, speed, rng), build_skeleton()
    made = follow(FrameMatcher(database, past), past, way)[SETTLES:]
    root, local, contacts = held(made.root, made.local, skeleton)
    return Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=contacts.astype(np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(root), dtype=np.int32),
    )


def _in_stride(database: WalkDatabase, way: Way, speed: float, rng: np.random.Generator) -> Frames:
    """Two recorded frames of about that speed, put to the beginning of a way."""
    usual = database.entries[np.argsort(np.abs(database.paces - speed), kind="stable")[:USUAL]]
    at = int(rng.choice(usual))
    turn = rotations.yaw_to_quat(way.yaw - float(database.heading[at]))
    root, local = database.root[at - 1 : at + 1], database.local[at - 1 : at + 1].copy()
    local[:, 0] = rotations.compose(turn, local[:, 0])
    start = np.array([way.places[0, 0], 0.0, way.places[0, 1]])
    return Frames(rotations.rotate(turn, root - root[1] * [1.0, 0.0, 1.0]) + start, local)


def _curve(rng: np.random.Generator) -> Array:
    """A way over open ground that bends to and fro. (N, 2)."""
    length, count = float(rng.uniform(*LENGTHS)), 200
    along = np.linspace(0.0, length, count)
    bend = np.interp(along, np.linspace(0.0, length, BENDS), rng.normal(0.0, BEND, BENDS))
    yaw = rng.uniform(-np.pi, np.pi) + np.cumsum(bend) * (length / count)
    return np.cumsum(np.stack([np.sin(yaw), np.cos(yaw)], axis=1), axis=0) * (length / count)


def _ways_through(home: Home, rng: np.random.Generator) -> Iterator[Array]:
    """Ways between free places of a home, one after the other. (N, 2)."""
    walkable, rooms = scene_of(home).walkable, len(home.rooms)
    while True:
        try:
            start, goal = (walkable.random_point(rng, int(rng.integers(rooms))) for _ in range(2))
            path = walkable.path(start, goal)
        except NoPath:
            yield _curve(rng)
            continue
        if float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) >= SHORTEST:
            yield path


def _entry(database: WalkDatabase, motion: Motion, number: int) -> Entry:
    way = np.linalg.norm(np.diff(motion.root_positions[:, [0, 2]], axis=0), axis=1).sum()
    pace = float(way) / motion.duration
    style = "slow" if pace < SLOW else "brisk" if pace > BRISK else "neutral"
    return Entry(
        name=f"matched {number:05d}",
        skill=Skill.LOCO,
        style=style,
        emotion=Emotion.NEUTRAL,
        captions=ways_to_say(Skill.LOCO, style, ""),
        subject=MATCHED,
        kind=MATCHED,
        licence="as the recordings'",
        source=f"put together from recorded walks of {', '.join(database.people)}",
        changed=(),
        split="train",
        motion=motion,
        hands=np.zeros((len(motion), 2), dtype=np.bool_),
    )
