"""Trials of the body are repeated exactly, summed up truly and told apart by what is seen; not how good they are."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from motion_backend import rotations
from motion_backend.metrics.figure_limits import LIMITS, Limit
from motion_backend.motion import Motion, Skill
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.cli import app
from planner_service.evaluation.body_evaluation import Result, plan_trials, run_trials, sum_up
from planner_service.evaluation.caption_classifier import APART, SAME, describe, group_of, nearest, tell_apart
from planner_service.evaluation.diversity import diversity, pairwise_distances
from planner_service.evaluation.trials import AWAY, FLOOR, Trial, perform, places_for, setting
from planner_service.scripts.captions import captions

ROOM = "living-room-0002"
SIT = Trial(Skill.SITDOWN, "crossing arms", ROOM, 3)
KNOWN = {Skill(skill): some for skill, some in captions().items()}
SKELETON = build_skeleton()


@pytest.fixture(scope="module")
def sitting():
    return perform(SIT)


def result(trial: Trial, **figures: object) -> Result:
    return Result(trial, figures, None, None)


def trial(room: str, seed: int = 0, caption: str = "sitting still", skill: Skill = Skill.SITDOWN) -> Trial:
    return Trial(skill, caption, room, seed)


def test_a_trial_begins_some_metres_away_and_ends_with_its_own_caption(sitting) -> None:
    first, last = sitting.actions[0], sitting.actions[-1]
    start = sitting.motions[0].root_positions[0, [0, 2]]
    assert AWAY[0] - 0.05 <= np.hypot(*(start - np.array(first.goal))) <= AWAY[1] + 0.05
    assert (last.skill, last.caption) == (SIT.skill, SIT.caption)
    assert sitting.figures.seconds == sitting.motion.duration
    assert sitting.to_dict()["room"] == ROOM


def test_the_same_trial_is_the_same_motion_and_another_seed_another(sitting) -> None:
    again, other = perform(SIT), perform(replace(SIT, seed=4))
    np.testing.assert_array_equal(again.motion.local_rotations, sitting.motion.local_rotations)
    assert again.to_dict() == sitting.to_dict()
    first = other.motions[0].root_positions[0]
    assert not np.array_equal(first, sitting.motions[0].root_positions[0])


def test_a_rise_is_judged_after_the_rest_it_needs() -> None:
    done = perform(Trial(Skill.STANDUP, "stand up slowly", ROOM, 0))
    assert [action.skill for action in done.actions] == [Skill.LOCO, Skill.SITDOWN, Skill.STANDUP]
    assert done.figures.skill == "standup"


def test_places_have_what_the_words_of_a_caption_ask_for() -> None:
    where = setting(ROOM)
    category = {placed.id: placed.category for placed in where.home.objects}
    assert places_for(Skill.SITDOWN, "legs extended, hands on floor for support", where) == (FLOOR,)
    for piece in places_for(Skill.SITDOWN, "Resting hands on the armrests, legs spread apart", where):
        assert "sofa" in category[piece] or category[piece] == "armchair"
    assert FLOOR in places_for(Skill.LIEDOWN, "hands on belly", where)
    assert FLOOR not in places_for(Skill.TOUCH, "touch medium height", where)
    highs = places_for(Skill.TOUCH, "An act of reaching high", where)
    assert set(highs) <= set(places_for(Skill.TOUCH, "touch medium height", where))


def test_every_caption_gets_as_many_rooms_and_seeds_as_were_asked_for() -> None:
    asked = {Skill.SITDOWN: ["sitting still", "crossing arms"], Skill.LOCO: ["excited walk"]}
    trials = plan_trials(asked, rooms=3, seeds=2)
    assert trials == plan_trials(asked, rooms=3, seeds=2)
    for skill, some in asked.items():
        for caption in some:
            own = [one for one in trials if (one.skill, one.caption) == (skill, caption)]
            assert len(own) == 6
            assert len({one.room for one in own}) == 3


def test_a_trial_that_cannot_begin_is_told_with_the_reason() -> None:
    caption = "Resting hands on the armrests, legs spread apart"
    (found,) = run_trials([Trial(Skill.SITDOWN, caption, "bedroom-0000", 0)], workers=1)
    assert "bedroom-0000" in found.fault
    assert not found.figures


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_a_mean_lies_within_its_interval_and_its_interval_within_the_values(values: list[float]) -> None:
    results = [result(trial(f"r{i}"), contact_error=value) for i, value in enumerate(values)]
    figure = sum_up(results, ["contact_error"])[0]
    assert figure.value == pytest.approx(np.mean(values))
    assert min(values) - 1e-9 <= figure.low <= figure.value + 1e-9
    assert figure.value - 1e-9 <= figure.high <= max(values) + 1e-9


def test_the_largest_value_has_no_interval_and_what_was_not_measured_does_not_count() -> None:
    results = [
        result(trial("a"), pen_max=0.01, contact_error=None),
        result(trial("b"), pen_max=0.09, contact_error=0.01),
    ]
    figures = {(one.name, one.skill): one for one in sum_up(results, ["pen_max", "contact_error"])}
    deepest, error = figures["pen_max", "sitdown"], figures["contact_error", "all"]
    assert (deepest.value, deepest.low, deepest.high, deepest.missed) == (0.09, 0.09, 0.09, True)
    assert (error.value, error.trials) == (0.01, 1)


def test_a_limit_is_kept_at_its_very_value_and_every_limit_is_of_a_figure(sitting) -> None:
    assert not Limit("reached", least=0.98).missed(0.98)
    assert Limit("reached", least=0.98).missed(0.979)
    assert Limit("pen_max", most=0.05).missed(0.051)
    assert {limit.figure for limit in LIMITS} <= set(sitting.to_dict())


def turned(motion: Motion, yaw: float, offset: tuple[float, float, float]) -> Motion:
    """The same motion elsewhere in the world."""
    turn = rotations.yaw_to_quat(yaw)
    local = motion.local_rotations.astype(np.float64).copy()
    local[:, 0] = rotations.compose(np.broadcast_to(turn, local[:, 0].shape), local[:, 0])
    root = rotations.rotate(turn, motion.root_positions.astype(np.float64)) + np.array(offset)
    goals = tuple(
        replace(goal, position=tuple(rotations.rotate(turn, np.array(goal.position)) + np.array(offset)))
        for goal in motion.goals
    )
    return replace(
        motion, root_positions=root.astype(np.float32), local_rotations=local.astype(np.float32), goals=goals
    )


@pytest.mark.parametrize("skill", [Skill.SITDOWN, Skill.LOCO, Skill.LIEDOWN])
def test_a_description_knows_no_place_and_no_heading(sitting, skill: Skill) -> None:
    moved = turned(sitting.motion, 1.9, (3.0, 0.0, -2.0))
    np.testing.assert_allclose(describe(moved, skill), describe(sitting.motion, skill), atol=2e-3)


def test_a_description_sees_an_arm_that_is_held_otherwise(sitting) -> None:
    other = sitting.motion.local_rotations.copy()
    other[:, INDEX["left_shoulder"]] = rotations.rotvec_to_quat(np.array([0.0, -1.2, 0.0]))
    raised = replace(sitting.motion, local_rotations=other)
    assert np.abs(describe(raised, Skill.SITDOWN) - describe(sitting.motion, Skill.SITDOWN)).max() > 0.1


def test_captions_that_look_alike_are_confused_and_others_are_not() -> None:
    rng = np.random.default_rng(0)
    looks = {"crossing arms": 0.0, "sitting still": 5.0, "hands on thighs": 5.0}
    described = [
        (trial(f"room-{room}", caption=caption), look + rng.normal(size=6) * 0.1)
        for room in range(8)
        for caption, look in looks.items()
    ]
    (told,) = tell_apart(described)
    assert (told.skill, told.groups, told.trials) == ("sitdown", 3, 24)
    assert 0.4 < told.accuracy < 1.0
    taken = {(one.caption, one.taken_for) for one in told.confusions}
    assert taken <= {("sitting still", group_of(Skill.SITDOWN, "hands on thighs")),
                     (group_of(Skill.SITDOWN, "hands on thighs"), "sitting still")}  # fmt: skip


def test_nobody_is_its_own_neighbour_since_rooms_are_parted() -> None:
    # Every room looks like itself alone: who looked into its own room would name everything rightly.
    described = [
        (trial(f"room-{room}", caption=caption), np.array([10.0 * room, place]))
        for room in range(6)
        for place, caption in enumerate(("crossing arms", "sitting still"))
    ]
    (told,) = tell_apart([(one, values * np.array([1.0, 0.0])) for one, values in described])
    assert told.accuracy <= 0.5


@given(st.integers(1, 5), st.integers(1, 5))
def test_the_nearest_is_found_whatever_a_feature_is_measured_in(size: int, which: int) -> None:
    known = np.random.default_rng(size).normal(size=(6, 4)) * 10
    chosen = which % len(known)
    scale = np.array([1.0, 100.0, 1000.0, 10.0])
    assert nearest(known * scale, known[[chosen]] * scale)[0] == chosen


def test_only_known_captions_are_said_to_be_the_same_and_each_once() -> None:
    for skill, groups in SAME.items():
        every = [caption for some, _ in groups for caption in some]
        assert len(set(every)) == len(every)
        assert set(every) <= set(KNOWN[skill])
        assert all(reason for _, reason in groups)


def test_diversity_is_nought_for_equal_samples_and_grows_with_their_distance() -> None:
    still = np.zeros((60, 22, 3), np.float32)
    assert pairwise_distances(np.stack([still, still]).astype(float)) == (0.0, 0.0)
    apart = pairwise_distances(np.stack([still, still + np.array([0.0, 0.3, 0.4], dtype=np.float32)]).astype(float))
    assert apart == pytest.approx((0.5 * np.sqrt(60 * 22), 0.5))
    assert diversity([still]) is None
    alike = diversity([still, still])
    assert alike is not None
    assert alike["apd_pos"] == 0.0


def test_the_command_prints_figures_and_writes_every_trial(tmp_path: Path) -> None:
    asked = ["evaluate", "body", "--skill", "standup", "--captions", "1", "--rooms", "2", "--workers", "1"]
    done = CliRunner().invoke(app, [*asked, "--out", str(tmp_path)])
    assert "reached" in done.output
    assert "told apart" in done.output
    value = json.loads((tmp_path / "body.json").read_text(encoding="utf-8"))
    rows = [json.loads(line) for line in (tmp_path / "trials.jsonl").read_text(encoding="utf-8").splitlines()]
    assert value["trials"] == len(rows) == 2
    missed = [figure["missed"] for figure in value["figures"]]
    missed += [telling["accuracy"] < APART for telling in value["telling_apart"]]
    assert done.exit_code == int(any(missed))


@for_each(
    ("asked", "told"),
    [
        (["--only", "no such caption"], "--skill"),
        (["--only", "crossing arms", "--room", "no-such-room"], "no-such-room"),
        (["--room", ROOM], "--only"),
        (["--captions", "some"], "--captions"),
        (["--captions", "9" * 5000], "--captions"),
        (["--only", "", "--skill", "loco", "--room", ROOM], "--only"),
        (["--only", "walk " * 100, "--skill", "loco", "--room", ROOM], "--only"),
        (["--only", "crossing arms", "--room", ROOM, "--out", "/dev/null"], "--out"),
    ],
)
def test_what_cannot_be_evaluated_is_told_with_what_can(asked: list[str], told: str) -> None:
    done = CliRunner().invoke(app, ["evaluate", "body", *asked])
    assert done.exit_code != 0
    assert told in str(done.exception)
