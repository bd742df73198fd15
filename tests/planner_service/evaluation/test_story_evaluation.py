"""Stories are made as a user's are, added up part by part, and judged beside the limits that their reports tell."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from motion_backend.metrics.figure_limits import LIMITS, STORY_LIMITS, held_against
from motion_backend.metrics.story_flow import Share
from planner_service.cli import app
from planner_service.evaluation.story_evaluation import (
    LARGEST,
    StoryResult,
    StoryTrial,
    own_themes,
    plan_stories,
    run_stories,
    sum_up_stories,
    worst_stories,
)

THEME = "She walks to the window, walks to the bed and sits down."
UNPLAYABLE = "13"


def result(name: str, part: float, whole: float, seed: int = 0) -> StoryResult:
    share = Share(part, whole)
    return StoryResult(StoryTrial("theme", seed), 1.0, {name: share}, {}, {name: share.value})


@pytest.fixture(scope="module")
def told() -> list[StoryResult]:
    return run_stories(plan_stories([THEME, UNPLAYABLE], None), workers=1)


def test_every_limited_figure_is_measured_in_a_story_and_told_beside_its_limit(told: list[StoryResult]) -> None:
    story = next(one for one in told if one.report)
    assert story.report is not None
    assert {limit.figure for limit in STORY_LIMITS} <= set(story.report)
    rows = {row["figure"]: row for row in held_against(story.report)}
    assert rows["pen_max"]["kept"] == (story.report["pen_max"] <= rows["pen_max"]["most"])
    assert all(story.report[figure] is not None for figure in rows)
    limits = {limit.figure for limit in STORY_LIMITS}
    assert {one.name for one in sum_up_stories(told) if one.limit} <= limits


def test_a_theme_that_cannot_be_told_is_named_with_the_reason(told: list[StoryResult]) -> None:
    (refused,) = (one for one in told if one.report is None)
    assert refused.trial.theme == UNPLAYABLE
    assert refused.fault


def test_a_story_keeps_the_limits_that_trials_do() -> None:
    of_trials = {limit.figure: (limit.least, limit.most) for limit in LIMITS}
    for limit in STORY_LIMITS:
        if limit.figure in of_trials:
            assert of_trials[limit.figure] == (limit.least, limit.most)


def test_each_theme_is_told_once_before_any_is_told_again() -> None:
    assert [(one.theme, one.seed) for one in plan_stories(["a", "b"], 5)] == [
        ("a", 0), ("b", 0), ("a", 1), ("b", 1), ("a", 2),
    ]  # fmt: skip
    assert [(one.theme, one.seed) for one in plan_stories(["a", "b"], None, 2)] == [
        ("a", 0), ("b", 0), ("a", 1), ("b", 1),
    ]  # fmt: skip
    assert len(set(own_themes())) == len(own_themes()) >= 15


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0.1, 10)), min_size=1, max_size=8))
def test_stories_are_added_up_part_by_part(shares: list[tuple[float, float]]) -> None:
    results = [result("still_share", part * whole, whole, seed) for seed, (part, whole) in enumerate(shares)]
    (figure,) = sum_up_stories(results)
    total = sum(part * whole for part, whole in shares) / sum(whole for _, whole in shares)
    assert figure.value == pytest.approx(total)
    assert figure.low - 1e-9 <= figure.value <= figure.high + 1e-9
    assert figure.stories == len(shares)
    assert figure.missed_in == sum(part * whole / whole > 0.05 for part, whole in shares)


def test_a_story_without_a_seam_has_no_part_in_the_figure_of_seams() -> None:
    (figure,) = sum_up_stories([result("walk_seam_stops", 0, 0), result("walk_seam_stops", 1, 2, 1)])
    assert (figure.value, figure.stories, figure.missed_in) == (0.5, 1, 1)
    assert sum_up_stories([result("walk_seam_stops", 0, 0)]) == []


def test_the_worst_stories_of_a_figure_are_those_that_miss_it_most() -> None:
    results = [result("walk_seam_flows", part, 10, int(part)) for part in (9, 2, 5)]
    rows = worst_stories(results, sum_up_stories(results))
    assert [row["seed"] for row in rows] == [2, 5]
    slow = [result("still_share", part, 10, int(part)) for part in (0, 4, 2)]
    assert [row["seed"] for row in worst_stories(slow, sum_up_stories(slow))] == [4, 2]


def test_the_largest_of_all_stories_counts_where_one_frame_is_too_many(told: list[StoryResult]) -> None:
    figures = {one.name: one for one in sum_up_stories(told)}
    made = [one.largest for one in told if one.largest]
    assert {name: figures[name].value for name in LARGEST} == {
        name: max(float(one[name]) for one in made) for name in LARGEST
    }
    assert np.isfinite([one.value for one in figures.values()]).all()


def test_the_command_measures_the_themes_of_a_file_and_nothing_else(tmp_path: Path) -> None:
    themes = tmp_path / "themes.txt"
    themes.write_text(f"# mine\n\n{THEME}\n", encoding="utf-8")
    asked = ["evaluate", "body", "--stories", str(themes), "--workers", "1", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, asked)
    assert "zmp_upright" in done.output
    value = json.loads((tmp_path / "out" / "body.json").read_text(encoding="utf-8"))
    assert "trials" not in value
    assert value["over_stories"]["stories"] == 1
    (row,) = (tmp_path / "out" / "stories.jsonl").read_text(encoding="utf-8").splitlines()
    assert json.loads(row)["theme"] == THEME
    assert done.exit_code == int(any(figure["missed"] for figure in value["over_stories"]["figures"]))


@for_each("argument", ["0", "/no/such/file", "99999999999999", ""])
def test_what_is_no_number_of_stories_and_no_file_of_themes_is_refused(argument: str) -> None:
    done = CliRunner().invoke(app, ["evaluate", "body", "--stories", argument or "/dev/null"])
    assert done.exit_code != 0
    assert "--stories" in str(done.exception)
