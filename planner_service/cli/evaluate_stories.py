"""`sims evaluate body --stories`: themes told and acted from beginning to end, every figure beside its limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from motion_backend.metrics.figure_limits import Limit
from planner_service.cli.console import plain_table
from planner_service.pipeline import RequestError

if TYPE_CHECKING:
    from planner_service.evaluation.story_evaluation import StoryFigure, StoryResult, StoryTrial

MAX_STORIES = 10_000
MAX_BYTES = 1_000_000
"""Of a file of themes."""
UNITS = {
    "success": "%", "skate_ratio_loco": "%", "walk_seam_stops": "%", "walk_seam_flows": "%", "still_share": "%",
    "spot_turning": "%", "fast_stories": "%", "touch_wait": "s",
}  # fmt: skip
"""Of what only stories have; the others are those of trials."""
SHOWN = {"%": (100, 1), "cm": (100, 1), "m/s³": (1, 0), "cm/s": (1, 1), "rad/s": (1, 1)}
"""By what a figure is multiplied to be shown in a unit, and its digits; others are shown with two."""
MAX_UNMADE = 10


def read_stories(argument: str, seeds: int) -> list[StoryTrial]:
    """So many stories on themes of ours, or those that the lines of a file name, with every seed."""
    from planner_service.evaluation.story_evaluation import own_themes, plan_stories

    if argument.isdecimal():
        count = int(argument[:9])
        if not 1 <= count <= MAX_STORIES:
            raise RequestError(f"{argument:.40} must be a number from 1 to {MAX_STORIES}, or a file", at="--stories")
        return plan_stories(own_themes(), count)
    try:
        with Path(argument).open("rb") as file:
            lines = file.read(MAX_BYTES + 1)
        themes = [line.strip() for line in lines.decode("utf-8-sig").splitlines()]
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise RequestError(f"{argument:.200} cannot be read: {why}", "a theme a line", at="--stories") from error
    themes = [theme for theme in themes if theme and not theme.startswith("#")]
    if len(lines) > MAX_BYTES or not 1 <= len(themes) * seeds <= MAX_STORIES:
        raise RequestError(f"{argument:.200} holds {len(themes)} themes", f"give 1 to {MAX_STORIES}", at="--stories")
    return plan_stories(themes, None, seeds)


def stories_to_dict(results: Sequence[StoryResult], figures: Sequence[StoryFigure]) -> dict[str, Any]:
    """For JSON: figures over all stories, the worst stories, and those that could not be made."""
    from planner_service.evaluation.story_evaluation import worst_stories

    return {
        "stories": len(results),
        "seconds": round(sum(result.seconds for result in results), 1),
        "figures": [
            {
                "name": one.name, "value": round(one.value, 5), "low": round(one.low, 5), "high": round(one.high, 5),
                "stories": one.stories, "missed_in": one.missed_in, "missed": one.missed,
                "least": one.limit.least if one.limit else None, "most": one.limit.most if one.limit else None,
            }
            for one in figures
        ],
        "worst": worst_stories(results, figures),
        "not_made": [
            {"theme": one.trial.theme, "seed": one.trial.seed, "why": one.fault} for one in results if one.fault
        ],
    }  # fmt: skip


def print_stories(
    console: Console, figures: Sequence[StoryFigure], value: Mapping[str, Any], units: Mapping[str, str]
) -> None:
    """The figures as a table, and which stories are to be looked at."""
    units = {**units, **UNITS}
    right = ("over all", "95 %", "limit", "stories", "missed in")
    table = plain_table("figure", *right, right=right)
    for one in figures:
        unit = units.get(one.name, "")
        around = f"{shown(one.low, unit)} to {shown(one.high, unit)}" if one.high > one.low else ""
        mark = " !" if one.missed else ""
        missed = str(one.missed_in) if one.limit else ""
        table.add_row(
            f"{one.name}, {unit}" if unit else one.name,
            f"{shown(one.value, unit)}{mark}", around, bounds(one.limit, unit), str(one.stories), missed,
        )  # fmt: skip
    console.print(table)
    console.print(f"{value['stories']} stories, {value['seconds']:.0f} s of motion; kinematic; 95 % over stories")
    if value["worst"]:
        console.print("\nworst stories; sims story THEME --seed S shows one")
    for row in value["worst"]:
        unit = units.get(row["figure"], "")
        told = f"{row['theme']} · {row['seed']}"
        console.print(f"{row['figure']:17} {shown(float(row['value']), unit):>8} {unit:5} {told}", soft_wrap=True)
    for row in value["not_made"][:MAX_UNMADE]:
        console.print(f"not made: {row['theme']} · {row['seed']}: {row['why']}", soft_wrap=True)


def shown(value: float, unit: str) -> str:
    """A figure in our units as it is shown in another."""
    scale, digits = SHOWN.get(unit, (1, 2))
    return f"{value * scale:.{digits}f}"


def bounds(limit: Limit | None, unit: str) -> str:
    """A limit in words."""
    if limit is None:
        return ""
    least = "" if limit.least is None else f"≥ {shown(limit.least, unit)}"
    most = "" if limit.most is None else f"≤ {shown(limit.most, unit)}"
    return " ".join(filter(None, (least, most)))
