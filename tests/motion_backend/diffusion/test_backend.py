"""Walking by the weights that ship: frames that follow on, the ways of a home, and what happens without weights."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_home import small_home

from motion_backend import rotations, walk_driver
from motion_backend.backends import BrokenBackendError, load_backend
from motion_backend.diffusion import backend
from motion_backend.diffusion.backend import WEIGHTS, DiffusionBackend, walking
from motion_backend.diffusion.checkpoint import CheckpointError
from motion_backend.diffusion.learned_walker import LearnedGait
from motion_backend.director import Director, shares
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.mocap.foot_hold import held
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from motion_backend.walk_generator import Ahead, Frames, Way, follow

FLUNG = 1.5
"""Metres a second by which a joint changes its speed from frame to frame that is flung; of a quick stride it is 1.3."""


def standing_at_the_origin() -> Frames:
    """A body that has just been put there, facing +Z, its arms hanging."""
    state = ProceduralBackend().begin(small_home(), Character(), 3)
    root, local = state.history.root_positions * [0.0, 1.0, 0.0], state.history.local_rotations.copy()
    local[:, 0] = rotations.compose(rotations.yaw_to_quat(-state.yaw), local[:, 0])
    return Frames(root, local)


def straight(past: Frames, speed: float, seconds: float = 6.0) -> Way:
    ahead = np.array([0.0, 1.0]) * speed
    return Way(past.root[-1, [0, 2]] + np.arange(round(30 * seconds))[:, None] / 30 * ahead)


@cache
def walked(seed: int = 0) -> tuple[Frames, Frames, Way]:
    past = standing_at_the_origin()
    way = straight(past, 1.2)
    generator = LearnedGait(walking(), gait=1 + seed)
    return past, follow(generator.begin(past, np.random.default_rng(seed)), past, way), way


def test_a_window_is_forty_two_frames_that_follow_on() -> None:
    past = standing_at_the_origin()
    walker = LearnedGait(walking()).begin(past, np.random.default_rng(0))
    first = walker.window(straight(past, 1.0).ahead(0))
    assert len(first) == 42
    joined = past.then(first)
    assert np.linalg.norm(np.diff(joined.root, axis=0), axis=1).max() * 30 < 2.5
    assert np.allclose(np.linalg.norm(joined.local, axis=-1), 1, atol=1e-6)


def test_walks_go_where_they_are_to_go_upright_and_the_same_each_time() -> None:
    past, made, way = walked()
    # It may be in the middle of a window as it gets there.
    assert np.linalg.norm(made.root[:, [0, 2]] - way.places[-1], axis=1).min() < 0.15
    assert np.abs(made.root[:, 0]).max() < 0.3
    assert len(made) < 1.2 * len(way) + 42
    assert (made.root[:, 1] > 0.75).all()
    assert (made.root[:, 1] < 1.0).all()
    again = follow(LearnedGait(walking(), gait=1).begin(past, np.random.default_rng(0)), past, way)
    assert np.array_equal(again.root, made.root)


def test_windows_are_joined_without_a_seam() -> None:
    """Where one window ends and the next begins joints change their speed no more than elsewhere."""
    _, made, _ = walked()
    places = build_skeleton().forward_kinematics(made.root, made.local)[0]
    jumps = np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(axis=1) * 30
    seams = np.arange(42, len(made) - 2, 42)
    at_seams = jumps[np.concatenate([seams - 2, seams - 1, seams])]
    assert np.median(at_seams) < np.percentile(np.delete(jumps, seams), 99)


def test_who_takes_over_from_a_body_that_stands_flings_no_foot() -> None:
    """In whosever gait: at the seam no joint changes its speed more, from frame to frame, than in a quick stride."""
    past = standing_at_the_origin().then(standing_at_the_origin())
    for gait in (1, 3, 8, 40):
        walker = LearnedGait(walking(), gait).begin(past, np.random.default_rng(gait))
        made = walker.window(straight(past, 1.2).ahead(0))
        whole = past.then(made)[len(past) - 2 : len(past) + 3]
        places = build_skeleton().forward_kinematics(whole.root, whole.local)[0].astype(np.float64)
        assert np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max() * 30 < FLUNG, gait


def test_a_foot_that_swings_passes_over_the_floor_and_not_along_it() -> None:
    """As seldom as people's: at a walking pace and at one that is slower than any that was recorded."""
    past, skeleton = standing_at_the_origin(), build_skeleton()
    for speed in (0.5, 1.2):
        way = straight(past, speed)
        walk = follow(LearnedGait(walking(), gait=4).begin(past, np.random.default_rng(4)), past, way)
        whole = past.then(walk)
        motion = to_motion(*held(whole.root, whole.local, skeleton, len(past)))
        soles = Kinematics.of(motion).soles
        speeds = np.linalg.norm(np.gradient(soles[..., [0, 2]], axis=0) * 30, axis=-1).min(axis=2)
        swinging = speeds > 0.6
        brushing = swinging & (soles[..., 1].min(axis=2) < 0.003)
        assert swinging.any()
        assert brushing.sum() < 0.035 * swinging.sum(), speed


def to_motion(root: Array, local: Array, contacts: Array) -> Motion:
    """Frames of a body as motion."""
    values = (root.astype(np.float32), local.astype(np.float32), contacts.astype(np.float32))
    return Motion(*values, build_skeleton(), np.zeros(len(root), np.int32))


def test_two_bodies_walk_in_two_gaits() -> None:
    _, one, _ = walked(0)
    _, other, _ = walked(3)
    frames = min(len(one), len(other))
    assert np.abs(one.local[:frames] - other.local[:frames]).max() > 0.05


def across_the_room(name: str) -> Motion:
    home, director = small_home(), Director.of(name)
    state = director.begin(home, Character(), 5)
    goals = [(5.0, 0.6), (0.6, 3.2)]
    actions = [
        Action(Skill.LOCO, "walk to the shelf", Emotion.NEUTRAL, goal=goal, keyframe=index)
        for index, goal in enumerate(goals)
    ]
    *_, (motion, _) = director.play(home, actions, state)
    return motion


def test_the_backend_walks_the_ways_of_a_home_and_says_what_it_made() -> None:
    motion = across_the_room("diffusion")
    assert motion.completed
    made = shares(motion)
    assert set(made) <= {"diffusion", "procedural"}
    assert made["diffusion"] > 0.5
    assert all(phase.fallback for phase in motion.phases if phase.backend == "procedural")


def test_a_walk_that_goes_on_is_the_models_to_where_a_heel_comes_down_by_its_place() -> None:
    home, director = small_home(), Director(DiffusionBackend(), ProceduralBackend())
    caption = "walk while talking on the phone with the left hand"
    for seed in (4, 5):
        rng = np.random.default_rng(seed)
        goals = [scene_of(home).walkable.random_point(rng, 0) for _ in range(3)]
        actions = [
            Action(Skill.LOCO, caption, Emotion.NEUTRAL, goal=goal, keyframe=at) for at, goal in enumerate(goals)
        ]
        made = [motion for motion, _ in director.play(home, actions, director.begin(home, Character(), seed))]
        assert sum(shares(motion) == {"diffusion": 1.0} for motion in made) >= 2
        for motion, goal in zip(made, goals, strict=True):
            away = np.linalg.norm(motion.root_positions[:, [0, 2]] - np.array(goal), axis=1)
            assert away.min() < 0.2


@pytest.mark.parametrize("fault", ["missing", "cut off"])
def test_without_its_weights_the_backend_is_broken_and_says_which(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "weights"
    if fault == "cut off":
        shutil.copytree(WEIGHTS, folder)
        whole = (folder / "walk.safetensors").read_bytes()
        (folder / "walk.safetensors").write_bytes(whole[:1000])
    with pytest.raises(CheckpointError):
        DiffusionBackend(folder)
    monkeypatch.setattr(backend, "walking", lambda: walking(folder))
    with pytest.raises(BrokenBackendError, match=r"'diffusion' cannot be used: .*walk\."):
        load_backend("diffusion")


def test_a_way_that_bends_is_told_by_where_it_is_in_a_window() -> None:
    places = np.stack([np.linspace(0.0, 1.0, 42), np.linspace(0.0, 1.0, 42)], axis=1)
    assert Ahead(places).yaws[-1] == pytest.approx(np.pi / 4)


def test_a_stretch_ends_a_step_earlier_where_the_rules_would_come_into_furniture(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ends = []
    for deep in (0.0, 0.1):
        depths = iter([deep])
        monkeypatch.setattr(walk_driver._Stretch, "deep", property(lambda _, depths=depths: next(depths, 0.0)))
        stretches = list[int]()
        after = walk_driver._Walk.after_stretch

        def counted(*told: Any, after: Any = after, stretches: list[int] = stretches) -> Any:
            stretches.append(len(told[2]))
            return after(*told)

        monkeypatch.setattr(walk_driver._Walk, "after_stretch", counted)
        across_the_room("diffusion")
        monkeypatch.setattr(walk_driver._Walk, "after_stretch", after)
        ends.append(stretches)
    assert ends[0][0] == ends[1][0]
    assert 8 < ends[1][0] - ends[1][1] < 30


def test_a_walk_keeps_to_a_bending_way() -> None:
    past = standing_at_the_origin()
    turned = np.arange(360)[:, None] / 30 / 2.5
    way = Way(past.root[-1, [0, 2]] + 2.5 * np.hstack([1 - np.cos(turned), np.sin(turned)]))
    made = follow(LearnedGait(walking(), gait=4).begin(past, np.random.default_rng(4)), past, way)
    away = np.linalg.norm(made.root[90:, None, [0, 2]] - way.places, axis=2).min(axis=1)
    assert np.quantile(away, 0.95) < 0.13
