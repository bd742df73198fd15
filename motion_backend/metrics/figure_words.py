"""Figures in everyday words: what one that misses its limit means, by one table for printouts, files, page and docs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, Final

from scene_graphs.data_tables import read_table, table

MAX_DIGITS: Final = 6
"""Behind the point, where fewer would not tell a value from its limit."""
NO_ERRORS: Final = "Those that are missed are no errors; the story is whole:"
"""What is said beside limits that are missed."""


@table
class Wording:
    """One figure."""

    name: str
    unit: str
    """What is written behind its value."""
    above: str = ""
    """What it means that its value is over its limit; empty where there is none."""
    below: str = ""
    """And under it."""
    times: float = 1.0
    """From the value in metres, seconds, radians or shares to the one in its unit."""
    digits: int = 1
    """Behind the point."""


@table
class FigureWords:
    """All figures that have a limit."""

    figure: tuple[Wording, ...]


@cache
def wordings() -> Mapping[str, Wording]:
    """How each figure is told, by its name."""
    return {one.name: one for one in read_table("motion_backend", "figure_words.toml", FigureWords).figure}


def missed_words(figure: str, value: float, least: float | None, most: float | None) -> str:
    """What it means that a value misses its limit: "a foot that stands slips: 3.4 cm a second, at most 3.0"."""
    words = wordings()[figure]
    over = most is not None and value > most
    limit = most if over else least
    if limit is None:
        raise ValueError(f"{figure} of {value} misses no limit")
    told, bound = _apart(words.times * value, words.times * limit, words.digits)
    return f"{words.above if over else words.below}: {told} {words.unit}, at {'most' if over else 'least'} {bound}"


def told_limits(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """How many limits are kept and, of each that is not, what that means, in lines; of rows of `held_against`."""
    held = list(rows)
    missed = [row for row in held if not row["kept"]]
    if not missed:
        return [f"All {len(held)} limits of how well it moves are kept."]
    return [
        f"{len(held) - len(missed)} of {len(held)} limits of how well it moves are kept. {NO_ERRORS}",
        *(f"- {row['words']} ({row['figure']})" for row in missed),
    ]


def _apart(value: float, limit: float, digits: int) -> tuple[str, str]:
    """Both with as many digits as tell them from each other; the limit without zeros at its end."""
    while f"{value:.{digits}f}" == f"{limit:.{digits}f}" and digits < MAX_DIGITS:
        digits += 1
    return f"{value:.{digits}f}", f"{limit:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{limit:.0f}"
