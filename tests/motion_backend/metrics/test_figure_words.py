"""A missed limit is told in everyday words, with the value and the limit, alike wherever it is told."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.metrics.figure_limits import LIMITS, STORY_LIMITS, Limit, held_against
from motion_backend.metrics.figure_words import NO_ERRORS, missed_words, told_limits, wordings

METRICS = Path(__file__).resolve().parents[3] / "docs" / "metrics.md"


def _bound(limit: Limit, over: bool) -> bool:
    return (limit.most if over else limit.least) is not None


SIDES = [(limit, over) for limit in (*LIMITS, *STORY_LIMITS) for over in (True, False) if _bound(limit, over)]


@given(st.sampled_from(SIDES), st.floats(1e-3, 10.0))
def test_whatever_misses_a_limit_is_told_with_a_number_apart_from_the_limit(
    side: tuple[Limit, bool], far: float
) -> None:
    limit, over = side
    edge = limit.most if over else limit.least
    assert edge is not None
    value = edge + far * max(edge, 1e-3) if over else edge - far * edge
    told = missed_words(limit.figure, value, limit.least, limit.most)
    words = wordings()[limit.figure]
    assert told.startswith(f"{words.above if over else words.below}: ")
    number, bound = (float(one) for one in re.findall(r"(-?[\d.]+)(?= |$)", told.rpartition(": ")[2]))
    assert (number > bound) is over
    assert number == pytest.approx(words.times * value, abs=0.06)
    assert bound == pytest.approx(words.times * edge)
    assert "_" not in told


def test_a_limit_that_is_kept_has_no_words() -> None:
    with pytest.raises(ValueError, match="misses no limit"):
        missed_words("slip", 1.0, None, 3.0)
    assert held_against({"slip": 1.0})[0]["words"] is None


def test_missed_limits_are_said_to_be_no_errors_each_with_its_name() -> None:
    first, *lines = told_limits(held_against({"slip": 3.4, "zmp_rising": 0.061, "pen_mean": 0.0}))
    assert first == f"1 of 3 limits of how well it moves are kept. {NO_ERRORS}"
    assert lines == [
        "- a foot that stands slips: 3.4 cm a second, at most 3 (slip)",
        f"- {missed_words('zmp_rising', 0.061, None, 0.04)} (zmp_rising)",
    ]
    assert told_limits(held_against({"slip": 3.0})) == ["All 1 limits of how well it moves are kept."]


def test_the_documentation_has_the_same_words_and_limits() -> None:
    table = METRICS.read_text(encoding="utf-8").partition("### What a missed limit means")[2].partition("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in table.splitlines() if "| `" in line]
    assert [row[0].strip("`| ") for row in rows] == [limit.figure for limit in STORY_LIMITS]
    for (_, words, told), limit in zip(rows, STORY_LIMITS, strict=True):
        own = wordings()[limit.figure]
        sides = [(own.below, limit.least, "at least"), (own.above, limit.most, "at most")]
        for said, bound, side in sides:
            if bound is not None:
                assert said in words
                assert f"{side} {own.times * bound:g}" in told
        assert told.endswith(own.unit)
