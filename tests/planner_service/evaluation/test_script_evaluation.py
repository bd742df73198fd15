"""Whole scripts in library rooms: how they are written, what counts as a step, and what is told of them."""

from __future__ import annotations

import json
from itertools import pairwise

import pytest
from typer.testing import CliRunner

from motion_backend.motion import Skill
from planner_service.cli import app
from planner_service.evaluation import script_evaluation
from planner_service.evaluation.script_evaluation import (
    INTERACTIONS,
    LEVELS,
    ScriptFigure,
    ScriptResult,
    ScriptTrial,
    plan_script_trials,
    run_script,
    sum_up_scripts,
)
from planner_service.grounding.keyframes_to_actions import UnreachableError
from scene_graphs.layout_library import built_in_index

RISES = {Skill.SITDOWN: Skill.STANDUP, Skill.LIEDOWN: Skill.GETUP}
TRIAL = ScriptTrial("bedroom-0000", 0, "simple")


def result(
    level: script_evaluation.Level, interactions: int, steps: int, errors: tuple[float, ...] = (0.01,)
) -> ScriptResult:
    return ScriptResult(ScriptTrial("bedroom-0000", 0, level), interactions, steps, steps, errors)


def told(figures: list[ScriptFigure], name: str, level: str) -> ScriptFigure:
    return next(one for one in figures if (one.name, one.level) == (name, level))


def test_every_level_is_acted_in_the_largest_rooms_of_each_type() -> None:
    trials = plan_script_trials(rooms=2, seeds=3)
    assert len(trials) == 4 * 2 * 3 * len(LEVELS)
    index = built_in_index()
    chosen = {trial.room for trial in trials}
    for kind in {layout.room_type for layout in index.layouts}:
        areas = {layout.id: layout.area for layout in index.layouts if layout.room_type == kind}
        assert min(areas[room] for room in chosen & set(areas)) >= max(areas[room] for room in set(areas) - chosen)


def test_a_script_is_done_from_beginning_to_end_and_the_same_again() -> None:
    done = run_script(TRIAL)
    assert done.interactions == 2
    assert done.success, done.fault
    assert done.success_any
    assert len(done.errors) == 2
    assert run_script(TRIAL) == done


def test_a_script_walks_to_everything_and_rises_before_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []
    monkeypatch.setattr(script_evaluation, "_acted", lambda _trial, actions, _where: seen.append(actions))
    for seed in range(6):
        run_script(ScriptTrial("bedroom-0000", seed, "hard"))
    for actions in seen:
        least, most = LEVELS["hard"]
        assert least <= sum(action.skill in INTERACTIONS for action in actions) <= most
        for before, action in pairwise(actions):
            if before.skill in RISES:
                assert action.skill is RISES[before.skill]
            if action.skill in INTERACTIONS:
                assert before.skill is Skill.LOCO


def test_a_script_that_cannot_be_grounded_counts_as_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere(*_: object) -> None:
        raise UnreachableError("keyframe 0: no way there")

    monkeypatch.setattr(script_evaluation, "act", nowhere)
    done = run_script(TRIAL)
    assert (done.success, done.steps, done.fault) == (False, 0, "keyframe 0: no way there")


def test_steps_are_counted_up_to_the_first_failure_and_theirs_only_where_all_was_done() -> None:
    figures = sum_up_scripts([result("hard", 6, 6), result("hard", 4, 1), result("hard", 5, 0, errors=())])
    assert told(figures, "script_success", "hard").value == pytest.approx(1 / 3)
    assert told(figures, "success_steps", "hard").value == pytest.approx(7 / 3)
    assert told(figures, "success_steps_unihsi", "hard").value == pytest.approx(6.0)
    assert told(figures, "plan_length", "hard").value == pytest.approx(5.0)
    assert told(figures, "contact_error", "hard").value == pytest.approx(0.01)


def test_an_interval_holds_its_figure_and_is_none_wide_where_all_agree() -> None:
    mixed = [result("mid", 4, steps) for steps in (0, 1, 4, 4, 4)]
    for figure in sum_up_scripts(mixed):
        assert figure.low <= figure.value <= figure.high
    length = told(sum_up_scripts(mixed), "plan_length", "mid")
    assert length.low == length.high == 4.0


def test_the_command_tells_ours_beside_the_papers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(script_evaluation, "plan_script_trials", lambda *_: [TRIAL])
    monkeypatch.setattr(script_evaluation, "run_script", lambda _: result("simple", 2, 1))
    run = CliRunner().invoke(app, ["evaluate", "scripts", "--json"])
    assert run.exit_code == 0, run.output
    found = json.loads(run.stdout)
    assert found["label"] == "kinematic"
    assert found["paper"]["SIMS, Table 2"]["script_success"] == [74.3, 42.2, 31.5]
    shown = CliRunner().invoke(app, ["evaluate", "scripts"], env={"COLUMNS": "140"})
    assert "ours, kinematic" in shown.output
    assert "a sample" in shown.output
