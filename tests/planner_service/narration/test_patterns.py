"""Tables of words, phrases and patterns: what does not hold together is refused by its place, and no pattern hangs."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace

import pytest
from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.narration.keyframe_phrases import templates
from planner_service.narration.story_words import pattern_at, story_words
from planner_service.tasks.household import Takes, household


def every_pattern() -> dict[str, re.Pattern[str]]:
    rows = {name: [pattern for pattern, _ in found] for name, found in story_words().patterns.items()}
    return {f"{name}.{at}": pattern for name, patterns in rows.items() for at, pattern in enumerate(patterns)}


def test_no_pattern_of_the_tables_takes_long_over_the_longest_theme() -> None:
    """Repeated words that many patterns begin to match, up to the 2,000 letters of a theme."""
    pieces = (
        "a ",
        "the ",
        "slowly ",
        "takes a ",
        "turns the ",
        "drops down up ",
        "phone fail ",
        "leaving his ",
        "his ",
    )
    texts = [(piece * 2000)[:2000] + " zzz" for piece in pieces]
    slow = {}
    for place, pattern in every_pattern().items():
        started = time.process_time()
        for text in texts:
            pattern.search(text)
        if (spent := time.process_time() - started) > 2.0:
            slow[place] = spent
    assert slow == {}


def test_what_is_wrong_with_a_pattern_is_said_by_its_place() -> None:
    assert pattern_at("times.0", "at\n night") == re.compile("at night", re.IGNORECASE)
    for pattern, fault in (("(", "missing \\)"), ("a" * 9999, "9999 letters")):
        with pytest.raises(ValueError, match=f"^times.0: {fault}"):
            pattern_at("times.0", pattern)


@for_each(
    ("change", "fault"),
    [
        (lambda: replace(household(), seats=("sofa", "throne")), "household: 'throne' is no furniture"),
        (lambda: replace(household(), takes=(Takes(("fly",)),)), "takes: fly is none"),
        (lambda: replace(deed_table(), deed=(DeedRow(("nap",), Skill.LIEDOWN, ("altar",)),)), "deed 'nap': 'altar' is"),
        (lambda: replace(deed_table(), deed=(DeedRow(("nap",), Skill.LIEDOWN, captions=("fly",)),)), "deed 'nap': fly"),
        (lambda: replace(templates(), further=("to {nowhere}",)), "further: there is no blank {nowhere}"),
        (lambda: replace(templates(), touches_at={"bed": {"knee": ()}}), "touches_at.bed: knee is none"),
    ],
)
def test_a_table_that_does_not_hold_together_is_refused_by_its_place(change: Callable[[], object], fault: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(fault)}"):
        change()
