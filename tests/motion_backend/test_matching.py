"""Motion matching and the driver of frame generators, over walks of our own body in place of recordings."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from motion_backend import backends
from motion_backend.backend_protocol import BodyState
from motion_backend.backends import BrokenBackendError, load_backend
from motion_backend.director import Director, shares
from motion_backend.matching.backend import MatchingBackend
from motion_backend.matching.frame_matcher import WINDOW, FrameMatcher
from motion_backend.matching.matched_walks import matched_walks
from motion_backend.matching.walk_database import WalkDatabase, build_walk_database
from motion_backend.metrics.foot_skate import floor_penetration, support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import Dataset, Entry, dataset_bytes
from motion_backend.motion import FPS, Action, Character, Emotion, Motion, Skill, join
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.skeleton import build_skeleton
from motion_backend.stride_takeover import strides_landing
from motion_backend.walk_driver import STARTS_AND_STOPS, unlike_people
from motion_backend.walk_generator import LOOK, Frames, Way, follow
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout

HALL = Layout("hall", "living_room", ((0.0, 0.0), (0.0, 4.0), (14.0, 4.0), (14.0, 0.0)))
CAPTION = "steadily walking forward"


def _walk(speed: float, seed: int, bend: float) -> Motion:
    """A walk of our body over open ground, as if somebody had been recorded."""
    skeleton, style = build_skeleton(), replace(walk_style(Emotion.NEUTRAL, CAPTION), speed=speed)
    along = np.linspace(0.0, 7.0, 60)
    way = np.stack([bend * along**2, along], axis=1)
    pose = walk(standing((0.0, 0.0), 0.0, Bearing(), skeleton), way, None, style, skeleton, np.random.default_rng(seed))
    root, local = solve(pose, skeleton)
    return Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton=skeleton,
        actions=np.zeros(len(root), dtype=np.int32),
    )


@cache
def clips() -> Dataset:
    """Six walks of two people."""
    rows = [(0.8, 0.0), (1.0, 0.03), (1.2, 0.0), (1.4, 0.0), (1.1, -0.05), (0.9, 0.05)]
    entries = [
        _entry(f"walk {number}", _walk(speed, number, bend), "train" if number % 2 else "test")
        for number, (speed, bend) in enumerate(rows)
    ]
    return Dataset(build_skeleton(), tuple(entries))


def _entry(name: str, motion: Motion, split: str = "train", style: str = "neutral", kind: str = "real mocap") -> Entry:
    return Entry(
        name=name, skill="loco", style=style, emotion="neutral", captions=("walk",), subject=f"person {split}",
        kind=kind, licence="ours", source="made here", changed=(), split=split, motion=motion,
        hands=np.zeros((len(motion), 2), dtype=np.bool_),
    )  # fmt: skip


@cache
def database() -> WalkDatabase:
    """Of all of them."""
    return build_walk_database(clips())


def test_nobody_lands_in_less_than_three_frames() -> None:
    for count in range(3):
        assert len(strides_landing(np.zeros((count, 22, 3)))) == 0


def _standing() -> Frames:
    state = BodyState.standing((0.0, 0.0), 0.0, Character(), 0)
    return Frames(state.history.root_positions, state.history.local_rotations)


@cache
def hall() -> Home:
    """Fourteen metres without furniture."""
    return home_from_layouts([HALL], 0)


@cache
def acted() -> tuple[Motion, list[bool]]:
    """To one end of the hall, to a place in it and to the other end, by recorded frames."""
    director = Director(MatchingBackend(database()), load_backend("procedural"))
    goals = [(12.5, 2.0), (7.0, 2.6), (1.5, 1.5)]
    actions = [Action(Skill.LOCO, CAPTION, Emotion.NEUTRAL, goal=goal, keyframe=k) for k, goal in enumerate(goals)]
    made = [motion for motion, _ in director.play(hall(), actions, director.begin(hall(), Character(), 4))]
    return join(made), [motion.completed for motion in made]


def test_a_straight_way_is_walked_at_its_speed_and_no_frame_is_invented() -> None:
    way = Way.along(np.array([[0.0, 0.0], [0.0, 5.0]]), 1.1)
    matcher = FrameMatcher(database(), _standing())
    made = follow(matcher, _standing(), way)
    assert np.abs(made.root[:, 0]).max() < 0.15
    assert abs(float(made.root[-1, 2]) - 5.0) < 0.3
    assert abs(len(made) - len(way)) < FPS
    assert set(np.unique(matcher.played)) <= set(range(len(database())))
    # Once what the body stood in has died away it is in the recorded poses, but for the offsets of later jumps.
    apart = np.abs(np.sum(made.local[FPS:, 1:] * database().local[matcher.played[FPS:], 1:], axis=-1))
    assert np.degrees(2 * np.arccos(np.clip(np.median(apart), 0, 1))) < 3


def test_what_is_jumped_to_is_joined_without_a_jump() -> None:
    way = Way.along(np.array([[0.0, 0.0], [0.0, 3.0], [1.5, 5.5]]), 1.2)
    made = follow(FrameMatcher(database(), _standing()), _standing(), way)
    positions = build_skeleton().forward_kinematics(made.root, made.local)[0]
    speeds = np.diff(positions, axis=0) * FPS
    jumps = np.linalg.norm(np.diff(speeds, axis=0), axis=-1).max(axis=1)
    at = np.arange(len(jumps)) % WINDOW == WINDOW - 2
    assert np.quantile(jumps[at], 0.95) < 2 * np.quantile(jumps[~at], 0.95)


def test_a_way_tells_what_is_ahead_and_goes_on_as_it_ended() -> None:
    way = Way.along(np.array([[0.0, 0.0], [0.0, 2.0]]), 1.0)
    ahead = way.ahead(len(way) - 5)
    assert ahead.places.shape == (LOOK, 2)
    assert np.allclose(np.diff(ahead.places, axis=0), [0.0, 1.0 / FPS], atol=1e-9)
    assert np.allclose(ahead.yaws, 0.0)


def test_hours_for_a_learner_are_of_one_side_and_the_same_from_a_seed() -> None:
    made = matched_walks(build_walk_database(clips(), "train"), 0.01, 3)
    assert made.frames >= 0.01 * 3600 * FPS
    assert {entry.kind for entry in made.entries} == {"matched"}
    assert all("person test" not in entry.source for entry in made.entries)
    again = matched_walks(build_walk_database(clips(), "train"), 0.01, 3)
    assert dataset_bytes(made) == dataset_bytes(again)
    bodies = [Kinematics.of(entry.motion) for entry in made.entries]
    assert np.mean([support_slip(body) for body in bodies]) < 4
    assert np.mean([floor_penetration(body) for body in bodies]) < 0.002


def test_every_walk_gets_there_and_says_who_made_what() -> None:
    motion, completed = acted()
    assert all(completed), motion.reason
    assert shares(motion)["matching"] > 0.5
    reasons = {phase.fallback for phase in motion.phases if phase.backend == "procedural"}
    assert STARTS_AND_STOPS in reasons
    assert all(not phase.fallback for phase in motion.phases if phase.backend == "matching")


def test_the_body_neither_slides_nor_jumps_where_one_takes_over_from_the_other() -> None:
    motion, _ = acted()
    body = Kinematics.of(motion)
    assert support_slip(body) < 4
    speeds = np.diff(body.positions, axis=0) * FPS
    jumps = np.linalg.norm(np.diff(speeds, axis=0), axis=-1).max(axis=1)
    seams = [phase.start for phase in motion.phases if phase.start]
    assert max(jumps[seam - 2 : seam + 2].max() for seam in seams) < 1.5 * np.quantile(jumps, 0.99)
    assert 0.75 < body.positions[:, 0, 1].min() < body.positions[:, 0, 1].max() < 1.0


def test_what_no_recorded_walk_is_like_is_left_to_the_rules() -> None:
    plain = Action(Skill.LOCO, CAPTION, Emotion.NEUTRAL)
    assert not unlike_people(plain)
    for caption in ("walk on tiptoe", "walk backwards", "run", "walk with hands on hips"):
        assert unlike_people(replace(plain, caption=caption)), caption


@pytest.mark.parametrize(
    ("spoiled", "why"),
    [
        (lambda kept: (kept[0],), "s are needed"),
        (lambda kept: tuple(replace(one, style="zombie") for one in kept), "0 s of plain recorded walking"),
        (lambda kept: tuple(replace(one, kind="hand-keyed") for one in kept), "0 s of plain recorded walking"),
        (lambda kept: tuple(replace(one, changed=("mirrored",)) for one in kept), "0 s of plain recorded walking"),
    ],
)
def test_too_little_recorded_walking_is_refused(spoiled, why: str) -> None:
    few = replace(clips(), entries=spoiled(clips().entries))
    with pytest.raises(ClipError, match=why):
        build_walk_database(few)


def test_the_backend_is_loaded_with_the_clips_that_are_named_and_says_what_is_wrong_with_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(backends, "_given", {})
    with pytest.raises(BrokenBackendError, match=r"no clips are named; give --clips FILE or SIMS_CLIPS"):
        load_backend("matching")
    file = tmp_path / "clips.npz"
    backends.give_file("matching", file)
    with pytest.raises(BrokenBackendError, match="is no file"):
        load_backend("matching")
    file.write_bytes(b"no clips")
    with pytest.raises(BrokenBackendError, match="not a collection of clips"):
        load_backend("matching")
    file.write_bytes(dataset_bytes(clips()))
    assert load_backend("matching").name == "matching"
