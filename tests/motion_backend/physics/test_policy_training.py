"""Policies that learn: what they see, what the teacher says, runs that go on where they were, mode `policy`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import repeat
from pathlib import Path

import numpy as np
import pytest
import torch
from policy_episodes import PART, episode, planned
from simulated import standing_still

from motion_backend import rotations
from motion_backend.motion import Skill
from motion_backend.physics.cloned_policy import CloningConfig, Rows, clone, new_policy
from motion_backend.physics.distillation import Episode, Lesson, moved, samples, teach
from motion_backend.physics.environment import SkillEnvironment
from motion_backend.physics.linear_answers import linear_answers
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mirrored_body import CONTROLS, PLAN
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.mpc import moment_of
from motion_backend.physics.observations import moments_of, state
from motion_backend.physics.policies import AHEAD, PLAN_SIZE, PolicyConfig, PolicyName
from motion_backend.physics.policy_mode import PolicyMode
from motion_backend.physics.policy_player import PolicyPlayer
from motion_backend.physics.policy_view import bodies_of, floors, level_of, policy_of
from motion_backend.physics.ppo import PPOConfig
from motion_backend.physics.train import DistilConfig, DistilRun, RewardConfig, RewardRun
from motion_backend.physics.trained_policy import PolicyError, TrainedPolicy
from motion_backend.physics.training_fault import FILE, TrainingFaultError

FRAMES = 8
SIZE = sum((PolicyConfig.of(PolicyName.WALK, NU).state, 625, 60, 64))


@pytest.fixture(scope="module")
def lesson() -> Lesson:
    """What the teacher says in a quarter of a second of a walk."""
    return teach(episode(FRAMES), None, np.random.default_rng(0))


class Plan:
    """Does what the plan says: the servos alone."""

    def offsets(self, observed: np.ndarray) -> np.ndarray:
        return np.zeros((len(observed), NU))


def rows_of(lesson: Lesson, count: int) -> Rows:
    found = list(samples(episode(FRAMES), lesson, np.random.default_rng(1), count))
    return Rows(*(np.concatenate(column) for column in zip(*found, strict=True)))


def test_a_simulated_body_is_seen_as_the_motion_that_it_makes() -> None:
    task, motion = planned(FRAMES)
    reference = task.reference.part(slice(1, FRAMES + 1))
    seen = bodies_of(reference.qpos, reference.qvel, reference.wrists, task)
    drawn = moments_of(motion)
    np.testing.assert_allclose(seen.positions, drawn.positions, atol=0.03)
    # Feet swing higher than planned, and speeds are smoothed.
    apart = np.abs(state(seen)[2:-2] - state(drawn)[2:-2])
    assert np.median(apart) < 0.02
    assert np.quantile(apart, 0.95) < 0.3


def test_an_observation_has_a_number_for_every_input_of_the_network() -> None:
    one = episode(FRAMES)
    seen = PolicyPlayer.of(one.view).observe(one.start, 0)
    assert seen.shape == (1, SIZE) == (1, len(floors(PolicyName.WALK)))
    assert np.isfinite(seen).all()


def test_the_teachers_answer_says_what_it_does_elsewhere(lesson: Lesson) -> None:
    assert not lesson.fell
    assert len(lesson.frames) == FRAMES
    assert np.abs(lesson.answer).max() > 0.05
    rows = rows_of(lesson, 3)
    assert rows.seen.shape == (4 * FRAMES, SIZE)
    told = lesson.control - episode(FRAMES).view.task.reference.controls[lesson.frames + 1]
    np.testing.assert_allclose(rows.done[:FRAMES], told, atol=1e-5)
    assert np.abs(rows.done[FRAMES : 2 * FRAMES] - told).max() > 0.005


def test_a_body_on_its_plan_sees_nothing_off_it_and_where_it_goes_on_to() -> None:
    view = episode(FRAMES).view
    reference, frames = view.task.reference, np.arange(FRAMES)
    on_it = (reference.qpos[frames], reference.qvel[frames], reference.controls[frames], frames)
    seen = view.off_plan(*on_it)
    assert seen.shape == (FRAMES, PLAN_SIZE)
    np.testing.assert_allclose(seen[:, : NX + NU], 0, atol=1e-9)
    for first, later in zip(range(NX + NU, PLAN_SIZE, NV), AHEAD, strict=False):
        way = reference.qpos[later : later + FRAMES, :3] - reference.qpos[:FRAMES, :3]
        ahead = rotations.rotate(level_of(reference.qpos[frames]), way)
        np.testing.assert_allclose(seen[:, first : first + 3], ahead, atol=1e-9)
    off = np.zeros((FRAMES, NV))
    off[:, 2] = 0.01
    moved_off = view.off_plan(moved(reference.qpos[frames], off, view), *on_it[1:])
    off[:, :3] = rotations.rotate(level_of(reference.qpos[frames]), off[:, :3])
    np.testing.assert_allclose(moved_off[:, :NV], off, atol=1e-9)


def test_a_new_policy_answers_as_its_teacher_does_where_that_is_linear(lesson: Lesson) -> None:
    # One frame, and others like it: all of its answers are one rule.
    one = episode(FRAMES)
    alike = replace(
        lesson, **{name: getattr(lesson, name)[:1] for name in ("qpos", "qvel", "held", "control", "answer", "frames")}
    )
    found = list(samples(one, alike, np.random.default_rng(1), 40))
    rows = Rows(*(np.concatenate(column) for column in zip(*found, strict=True)))
    policy = new_policy(PolicyName.WALK, rows, answers=linear_answers([(one, alike)]))
    apart = np.abs(policy.offsets(rows.seen.astype(np.float64)) - rows.done)
    assert apart.mean() < 0.1 * np.abs(rows.done - rows.done.mean(axis=0)).mean()


def test_a_teacher_who_takes_over_everywhere_asks_its_policy_for_nothing() -> None:
    class Silent:
        def offsets(self, observed: np.ndarray) -> np.ndarray:
            raise AssertionError(f"it was asked {len(observed)} times")

    taught = teach(episode(FRAMES), Silent(), np.random.default_rng(0), 1.0)
    assert len(taught.frames) == FRAMES
    # What it says is what it does: there is no noise.
    np.testing.assert_allclose(taught.held[1:], taught.control[:-1], atol=1e-12)
    with pytest.raises(AssertionError, match="it was asked"):
        teach(episode(FRAMES), Silent(), np.random.default_rng(0), 0.0)


def test_linear_answers_learned_in_the_mirror_do_there_what_they_do_here(lesson: Lesson) -> None:
    found = linear_answers([(episode(FRAMES), lesson)], mirrored=True)
    seen = episode(FRAMES).view.off_plan(lesson.qpos, lesson.qvel, lesson.held, lesson.frames)
    for support, there in ((1, 2), (2, 1), (3, 3)):
        here = np.column_stack([seen, np.ones(FRAMES)]) @ found[support]
        image = np.column_stack([PLAN(seen), np.ones(FRAMES)]) @ found[there]
        np.testing.assert_allclose(image, CONTROLS(here), atol=1e-8)
    assert np.abs(found).max() > 0.01


def test_a_lesson_is_kept_as_it_was(lesson: Lesson, tmp_path: Path) -> None:
    lesson.save(tmp_path / "one.npz")
    again = Lesson.load(tmp_path / "one.npz")
    np.testing.assert_array_equal(again.qpos, lesson.qpos)
    np.testing.assert_allclose(again.answer, lesson.answer, atol=2e-2)
    assert again.fell == lesson.fell


def test_a_policy_learns_a_walk_by_heart_and_is_the_same_on_disk(lesson: Lesson, tmp_path: Path) -> None:
    rows = rows_of(lesson, 2)
    policy = new_policy(PolicyName.WALK, rows)
    losses = clone(policy, rows, CloningConfig(steps=60, batch=16))
    assert np.mean(losses[-10:]) < 0.4 * losses[0]
    policy.save(tmp_path / "walk.safetensors")
    again = TrainedPolicy.load(tmp_path / "walk.safetensors")
    seen = rows.seen[:4].astype(np.float64)
    np.testing.assert_allclose(again.offsets(seen), policy.offsets(seen), atol=0.02)


def test_a_loss_that_is_no_number_ends_it_and_keeps_the_batch(lesson: Lesson, tmp_path: Path) -> None:
    rows = rows_of(lesson, 0)
    policy = new_policy(PolicyName.WALK, rows)
    rows.done[3] = np.nan
    with pytest.raises(TrainingFaultError, match="done"):
        clone(policy, rows, CloningConfig(steps=5), tmp_path)
    assert (tmp_path / FILE).is_file()


def distilled(folder: Path, source: Iterator[Episode], rounds: int = 2) -> TrainedPolicy:
    config = DistilConfig(rounds, 1, 1, CloningConfig(steps=4, batch=8))
    return DistilRun(PolicyName.WALK, source, folder, config).run()


@pytest.mark.sweep
def test_distilling_goes_on_where_it_was_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = distilled(tmp_path / "whole", repeat(episode(4)))
    distilled(tmp_path / "parts", repeat(episode(4)), 1)
    again = distilled(tmp_path / "parts", repeat(episode(4)))
    for name, value in whole.network.state_dict().items():
        assert torch.equal(value, again.network.state_dict()[name]), name
    monkeypatch.setattr("motion_backend.physics.train.teach", None)
    distilled(tmp_path / "whole", repeat(episode(4)))


@pytest.mark.parametrize("style", [False, True])
def test_learning_from_rewards_goes_on_where_it_was_ended(tmp_path: Path, style: bool) -> None:
    config = RewardConfig(1, 2, 3, style=style, ppo=PPOConfig(epochs=1, batch=8))
    first = RewardRun(PolicyName.SIT, [episode(FRAMES)], tmp_path, config)
    first.run()
    told: list[str] = []
    again = RewardRun(PolicyName.SIT, [episode(FRAMES)], tmp_path, replace(config, rounds=2))
    policy = again.run(told.append)
    assert len(told) == 1
    assert told[0].startswith("round 2 of 2: ")
    assert ("style told" in told[0]) == style
    assert again.ppo.scale.count == 2 * first.ppo.scale.count
    assert np.isfinite(policy.offsets(np.zeros((1, SIZE)))).all()
    with pytest.raises(TrainingFaultError, match="other settings"):
        RewardRun(PolicyName.SIT, [episode(FRAMES)], tmp_path, replace(config, seed=1)).run()


def test_bodies_begin_anew_when_they_fall_or_their_time_is_over() -> None:
    one = episode(4)
    world = SkillEnvironment([one], new_policy(PolicyName.WALK, flat_rows(one)).done, 2)
    for body in world.bodies:
        body.at, body.now = 0, moment_of(one.view.task.reference, 0)
    world.bodies[1].now.state.qpos[0] += 2.0
    calm = world.scale.apply(np.zeros((2, NU)))
    done = world.step(calm)
    assert done.terminated.tolist() == [False, True]
    assert world.failed.tolist() == [2.0]
    assert 0 < done.rewards[0] <= 1
    assert done.rewards[1] == 0
    world.bodies[0].at = 3
    assert world.step(calm).truncated[0]


def flat_rows(one: Episode) -> Rows:
    controls = one.view.task.reference.controls.astype(np.float32)
    return Rows(np.zeros((len(controls), SIZE), np.float32), controls)


def test_a_player_does_what_a_policy_says_until_it_falls() -> None:
    one = episode(FRAMES)
    done = PolicyPlayer.of(one.view).play(Plan(), one.start, FRAMES)
    assert len(done.moments) == FRAMES + 1
    away = done.moments[-1].state.qpos[:3] - one.view.task.reference.qpos[FRAMES, :3]
    assert np.linalg.norm(away) < 0.1
    gone = one.start._replace(state=one.start.state._replace(qpos=one.start.state.qpos + np.eye(45)[0]))
    assert len(PolicyPlayer.of(one.view).play(Plan(), gone, FRAMES).moments) == 2


def test_each_part_is_done_by_its_policy_and_standing_by_none() -> None:
    standing, _ = standing_still(0.3)
    assert policy_of(standing) is None
    assert policy_of(PART) is PolicyName.WALK
    seated = replace(standing, action=replace(standing.action, skill=Skill.SITDOWN))
    assert policy_of(seated) is PolicyName.SIT


@pytest.mark.parametrize(
    ("spoiled", "said"),
    [
        (lambda path: path.unlink(), "is missing"),
        (lambda path: path.write_bytes(path.read_bytes()[:1000]), "no weights of this version"),
        (lambda path: path.write_bytes(b"nothing"), "no weights of this version"),
    ],
)
def test_weights_that_cannot_be_used_are_named(tmp_path: Path, spoiled: object, said: str) -> None:
    path = tmp_path / "walk.safetensors"
    new_policy(PolicyName.WALK, flat_rows(episode(4))).save(path)
    spoiled(path)  # type: ignore[operator]
    with pytest.raises(PolicyError, match=said):
        TrainedPolicy.load(path)


def test_mode_policy_leaves_to_mpc_what_no_policy_passed_and_says_why(tmp_path: Path) -> None:
    policy = new_policy(PolicyName.WALK, flat_rows(episode(4)))
    replace(policy, figures={"reached": 0.5, "trials": 40}).save(tmp_path / "walk.safetensors")
    task, motion = planned(FRAMES)
    played = PolicyMode(tmp_path).play(task, PART, motion, episode(FRAMES).start)
    assert played.done is None
    assert played.why == "the policy walk did 50% of 40 trials and not 80%"
    replace(policy, figures={"reached": 0.9, "trials": 40}).save(tmp_path / "walk.safetensors")
    played = PolicyMode(tmp_path).play(task, PART, motion, episode(FRAMES).start)
    assert played.done is not None or "fell" in played.why
