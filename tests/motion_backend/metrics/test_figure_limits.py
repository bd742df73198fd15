"""The limits of the body are those that the documentation states, and are kept from both sides."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from motion_backend.metrics.figure_limits import LIMITS, Limit, held_against

METRICS = Path(__file__).resolve().parents[3] / "docs" / "metrics.md"
HEAD = "| figure, over all captions, rooms and seeds | limit |\n|---|---|\n"
UNITS = {"%": 0.01, "cm": 0.01, "cm/s": 1.0, "rad/s": 1.0, "": 1.0}
Stated = tuple[str, float | None, float | None]


def stated() -> Iterator[Stated]:
    """Every figure of the table with its least and its most."""
    table = METRICS.read_text(encoding="utf-8").partition(HEAD)[2].partition("\n\n")[0]
    for row in table.splitlines():
        figures, limits = (cell.strip() for cell in row.strip("|").split("|"))
        names, sign = re.findall(r"`(\w+)`", figures), limits[0]
        if low_high := re.fullmatch(r"([\d.]+) to ([\d.]+)", limits):
            yield names[0], float(low_high[1]), float(low_high[2])
            continue
        numbers = re.findall(r"([\d.]+)(?: (cm/s|rad/s|cm|%))?", re.sub(r"\(.*?\)", "", limits))
        values = [float(number) * UNITS[unit] for number, unit in numbers]
        several = max(len(names), len(values))
        for place in range(several if names else 0):
            value = values[min(place, len(values) - 1)]
            yield names[min(place, len(names) - 1)], *((value, None) if sign == "≥" else (None, value))


def test_the_limits_of_trials_are_those_of_the_documentation() -> None:
    held = sorted((one.figure, one.least or 0.0, one.most or 0.0) for one in LIMITS)
    told = sorted((name, least or 0.0, most or 0.0) for name, least, most in stated())
    assert [name for name, *_ in held] == [name for name, *_ in told]
    assert [numbers for _, *numbers in held] == [pytest.approx(numbers) for _, *numbers in told]


def test_a_limit_itself_is_kept_and_what_is_beyond_is_missed() -> None:
    both = Limit("it", most=2.0, least=1.0)
    assert [both.missed(value) for value in (0.9, 1.0, 1.5, 2.0, 2.1)] == [True, False, False, False, True]
    assert not Limit("it").missed(1e9)


def test_a_figure_without_a_value_has_no_row() -> None:
    limits = [Limit("slip", most=1.0), Limit("success", least=0.9), Limit("pen_max", most=1.0), Limit("jerk", most=1.0)]
    rows = held_against({"slip": 1.0, "success": 0.5, "jerk": None, "more": 3.0}, limits)
    assert rows == [
        {"figure": "slip", "value": 1.0, "least": None, "most": 1.0, "kept": True, "words": None},
        {
            "figure": "success",
            "value": 0.5,
            "least": 0.9,
            "most": None,
            "kept": False,
            "words": "not every moment was done: 50.0 % of them were, at least 90",
        },
    ]
