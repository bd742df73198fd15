"""Whole scripts in library rooms: how they are written, what counts as a step, and what is told of them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from motion_backend.backend_protocol import BodyState
from motion_backend.director import Director
from motion_backend.motion import Action, Motion, Note, Simulated, Skill
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
    run_script_trials,
    sum_up_scripts,
)
from planner_service.evaluation.trials import setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from scene_graphs.home import Home
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
    monkeypatch.setattr(script_evaluation, "_acted", lambda _trial, actions, _where, _backend: seen.append(actions))
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
        raise UnreachableError("moment 1: no way there")

    monkeypatch.setattr(script_evaluation, "act", nowhere)
    done = run_script(TRIAL)
    assert (done.success, done.steps, done.fault) == (False, 0, "moment 1: no way there")


class Simulating:
    """A director whose body does what the kinematic one does, falls in one action and is left to another in one."""

    def __init__(self, falls: int | None = None, left: int | None = None) -> None:
        self.falls, self.left, self.own = falls, left, setting(TRIAL.room).director
        self.begin = self.own.begin

    def play(self, home: Home, actions: Sequence[Action], state: BodyState) -> Iterator[tuple[Motion, BodyState]]:
        for index, (motion, after) in enumerate(self.own.play(home, actions, state)):
            places = (index, index - len(actions))
            by, why = ("procedural", "time is over") if self.left in places else ("physics", "")
            phases = tuple(replace(phase, backend=by, fallback=why) for phase in motion.phases)
            fell = Simulated(index, "mpc", motion.duration, resets=int(self.falls in places), rewinds=2)
            yield replace(motion, phases=phases, simulated=(fell,), notes=(Note(index, "fell"),)), after


@pytest.mark.parametrize(("how", "steps", "fault"), [
    ({}, 2, ""), ({"falls": 0}, 0, "fell"), ({"falls": -1}, 1, "fell"), ({"left": -1}, 1, "time is over"),
])  # fmt: skip
def test_what_was_not_simulated_to_its_end_without_a_reset_is_not_done(
    monkeypatch: pytest.MonkeyPatch, how: dict[str, int], steps: int, fault: str
) -> None:
    monkeypatch.setattr(Director, "of", lambda _: Simulating(**how))
    done = run_script(TRIAL, "physics")
    assert (done.steps, done.steps_any, done.success) == (steps, steps, not fault)
    assert fault in done.fault
    assert done.resets == int("falls" in how)
    assert done.rewinds in (8, 10), "two in each of four actions, or five with a rise"
    assert done.seconds > 4


def test_a_run_that_was_ended_goes_on_with_what_it_has_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trials = [replace(TRIAL, seed=seed) for seed in range(3)]
    kept, asked = tmp_path / "scripts.jsonl", []

    def acted(trial: ScriptTrial, backend: str) -> ScriptResult:
        asked.append((trial.seed, backend))
        return ScriptResult(trial, 2, 1, 2, (0.01, 0.02), "fell", resets=1, rewinds=3, seconds=20.0)

    monkeypatch.setattr(script_evaluation, "run_script", acted)
    first = run_script_trials(trials[:2], backend="physics", kept=kept)
    assert run_script_trials(trials, backend="physics", kept=kept)[:2] == first
    assert asked == [(0, "physics"), (1, "physics"), (2, "physics")]


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
    monkeypatch.setattr(script_evaluation, "run_script", lambda *_: result("simple", 2, 1))
    run = CliRunner().invoke(app, ["evaluate", "scripts", "--json"])
    assert run.exit_code == 0, run.output
    found = json.loads(run.stdout)
    assert found["label"] == "kinematic"
    assert found["paper"]["SIMS, Table 2"]["script_success"] == [74.3, 42.2, 31.5]
    shown = CliRunner().invoke(app, ["evaluate", "scripts"], env={"COLUMNS": "140"})
    assert "ours, kinematic" in shown.output
    assert "a sample" in shown.output
    simulated = CliRunner().invoke(app, ["evaluate", "scripts", "--backend", "physics"], env={"COLUMNS": "140"})
    assert "ours, simulated" in simulated.output
    assert "0 resets and 0 rewinds" in simulated.output


def test_a_share_of_few_scripts_that_all_succeed_is_not_told_as_certain() -> None:
    figure = told(sum_up_scripts([result("mid", 3, 3)] * 4), "script_success", "mid")
    assert (figure.value, figure.high) == (1.0, 1.0)
    assert figure.low == pytest.approx(0.51, abs=0.01)
