"""Simulated bodies are held against their plans: intervals hold what they are of, and a run goes on where it was."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from for_each import for_each
from sample_motions import standing_still

from motion_backend.motion import Motion, Phase, PhaseKind, Skill
from planner_service.evaluation import physics_evaluation
from planner_service.evaluation.physics_evaluation import (
    BACKEND,
    by_turns,
    draw_trials,
    figures_of,
    keep_row,
    kept_rows,
    run_trial,
    summed,
)
from planner_service.evaluation.trials import Performance, Trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions

TRIAL = Trial(Skill.LOCO, "stand still", "bedroom-0000", 7)


class Figures:
    reached, reason = True, ""

    def to_dict(self) -> dict[str, Any]:
        return {"contact_error": 0.02, "execution_time": 1.5}


def performed(motion: Motion) -> Performance:
    return Performance(TRIAL, cast("Any", None), (), (), (motion,), cast("Any", Figures()), {})


def by(backend: str) -> Motion:
    still = standing_still(60)
    return replace(still, phases=(Phase(PhaseKind.STAND, 0, len(still), backend),))


def test_trials_are_drawn_by_chance_and_the_same_each_time() -> None:
    drawn = draw_trials(Skill.TOUCH, 3)
    assert drawn[:2] == draw_trials(Skill.TOUCH, 2)
    assert len({one.room for one in drawn}) == 3
    assert all(one.caption in captions()["touch"] and 1601 <= one.seed < 1 << 31 for one in drawn)
    assert all(places_for(one.skill, one.caption, setting(one.room)) for one in drawn)


def test_skills_take_turns_and_another_seed_draws_others() -> None:
    skills = [Skill.LOCO, Skill.TOUCH]
    turns = list(by_turns(skills, 2))
    assert [one.skill for one in turns] == skills * 2
    assert turns[1::2] == draw_trials(Skill.TOUCH, 2)
    assert not set(turns) & set(by_turns(skills, 2, drawn=3))


def test_a_trial_without_a_place_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: Trial) -> Performance:
        raise UnreachableError("nowhere")

    monkeypatch.setattr(physics_evaluation, "perform", fails)
    assert run_trial(TRIAL) is None


@for_each(
    ("backend", "told", "reached"),
    [(BACKEND, {"resets": 0}, True), ("procedural", {"resets": 0}, False), (BACKEND, {"resets": 1}, False),
     (BACKEND, None, False)],
)  # fmt: skip
def test_a_trial_is_done_where_the_simulated_body_did_all_of_it(
    backend: str, told: dict[str, float] | None, reached: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    bodies = iter([standing_still(80), by(backend)])
    monkeypatch.setattr(physics_evaluation, "perform", lambda *_: performed(next(bodies)))
    monkeypatch.setattr(
        physics_evaluation, "physics_of", lambda _: told and dict(told, rewinds=1) | {"weight_error": 0.03}
    )
    found = run_trial(TRIAL)
    assert found is not None
    row = found.row
    assert row["reached"] is reached
    assert (row["skill"], row["caption"], row["room"], row["seed"]) == ("loco", "stand still", "bedroom-0000", 7)
    assert (row["seconds"], row["contact_error"], row["planned"]) == (2.0, 0.02, True)
    assert (row["execution"], row["weight_error"]) == (1.5, 0.03 if told else None)
    assert (row["resets"], row["rewinds"]) == ((told["resets"], 1) if told else (0, 0))
    assert (row["away"], row["slip"], row["skate_ratio"], row["floor_pen"]) == (
        0.0,
        0.0,
        0.0,
        pytest.approx(0, abs=1e-3),
    )


def test_rows_are_kept_a_line_each_and_read_again(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    assert kept_rows(file) == kept_rows(None) == []
    for number in range(3):
        keep_row(file, {"skill": "loco", "caption": "gehen – ä", "slip": number})
    keep_row(None, {})
    assert [row["slip"] for row in kept_rows(file)] == [0, 1, 2]
    assert kept_rows(file)[0]["caption"] == "gehen – ä"


def test_a_share_has_wilsons_interval() -> None:
    mean, low, high = figures_of([{"reached": one} for one in [True] * 8 + [False] * 2])["reached"]
    assert (mean, low, high) == pytest.approx((0.8, 0.490, 0.943), abs=1e-3)
    assert figures_of([{"reached": True}] * 5)["reached"][2] == 1.0
    assert figures_of([{"reached": False}] * 5)["reached"][1] == 0.0


def test_a_figure_lies_in_its_interval_and_what_no_row_has_is_left_out() -> None:
    rows = [{"slip": value, "cpu": None} for value in np.linspace(1.0, 3.0, 40)]
    found = figures_of(rows)
    assert set(found) == {"slip"}
    mean, low, high = found["slip"]
    assert mean == pytest.approx(2.0)
    assert low < mean < high
    assert high - low == pytest.approx(2 * 1.96 * np.std([row["slip"] for row in rows]) / np.sqrt(40), rel=0.1)


def test_every_skill_is_summed_by_itself() -> None:
    rows = [{"skill": "touch", "slip": 1.0}, {"skill": "loco", "slip": 2.0}, {"skill": "touch", "slip": 3.0}]
    told = [(skill, count, figures["slip"][0]) for skill, count, figures in summed(rows)]
    assert told == [("loco", 1, 2.0), ("touch", 2, 2.0)]
