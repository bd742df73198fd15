"""How a story begins, goes on and ends: openings, connecting words, closings and titles, by mood.

Why a body does what it does: words for a mood that lead to an act, and for one mood that gives way to another.
"""

from __future__ import annotations

import re
from functools import cache, cached_property
from typing import Final

from planner_service.narration.narrative_voice import require_blanks
from planner_service.themes.patterns import compiled, with_parts
from scene_graphs.data_tables import read_table, table

STANDS_ALONE: Final = re.compile(r"(?:That (?:night|day)|It was|There was|The next|The day|Then|But|So|Later|After)\b")
"""Sentences that no word for the time goes before."""

ANY_OTHER: Final = "any_other"
"""A mood before that has no words of its own."""
_BLANKS: Final = ("time", "event", "who", "did", "They", "Their")


@table
class TimeOfDay:
    """A pattern for what a text says, and the time of day that it speaks of."""

    pattern: str
    time: str


@table
class Title:
    """A pattern for what a theme is about, and a title for it."""

    pattern: str
    title: str


@table
class StoryTexts:
    """data/openings_and_endings.toml: templates, by mood where they are tables."""

    beginnings: tuple[str, ...]
    """A story's first sentence with what happens first in it."""
    sudden_beginnings: tuple[str, ...]
    """The same where it is no state."""
    joints: tuple[str, ...]
    """What happens and what the body does, in one sentence."""
    there: tuple[str, ...]
    """Before what is done at rest, once the body rests."""
    so: tuple[str, ...]
    """Before what the body has just done."""
    turns: tuple[str, ...]
    """Before a sentence about what happens that begins like one before it."""
    notes: tuple[str, ...]
    """Before such a sentence where it cannot be told when."""
    cries: tuple[str, ...]
    openings: dict[str, tuple[str, ...]]
    closings: dict[str, tuple[str, ...]]
    lying_closings: dict[str, tuple[str, ...]]
    turned_closings: dict[str, dict[str, tuple[str, ...]]]
    """Where a story ends in another mood than it began, by the first mood and then the last."""
    moods: dict[str, tuple[str, ...]]
    """Words about the body's mood that may open a sentence before its subject."""
    reasons: dict[str, dict[str, tuple[str, ...]]]
    """Frames that give a reason, by mood and by what the sentence is for: to roam, to rest there and then, to go and
    settle somewhere, or to do something."""
    mood_changes: dict[str, dict[str, tuple[str, ...]]]
    """A sentence between two moods, by the new mood and then the old one, or `ANY_OTHER`."""
    mood_titles: dict[str, str]
    """Where no theme fits."""
    times: tuple[TimeOfDay, ...]
    """The first that is found is taken; so for titles."""
    titles: tuple[Title, ...]

    def __post_init__(self) -> None:
        patterned = ("times", "titles")
        require_blanks("", {name: text for name, text in vars(self).items() if name not in patterned}, _BLANKS)
        if not (self.time_patterns and self.title_patterns):
            raise ValueError("times, titles: there is none")

    @cached_property
    def time_patterns(self) -> tuple[tuple[re.Pattern[str], str], ...]:
        """What to look for, and the time of day it means."""
        return tuple(
            (compiled(with_parts(f"times.{at}.pattern", row.pattern, {})), row.time)
            for at, row in enumerate(self.times)
        )

    @cached_property
    def title_patterns(self) -> tuple[tuple[re.Pattern[str], str], ...]:
        """What to look for, and the title for it."""
        return tuple(
            (compiled(with_parts(f"titles.{at}.pattern", row.pattern, {})), row.title)
            for at, row in enumerate(self.titles)
        )


@cache
def story_texts() -> StoryTexts:
    """How stories begin, go on and end, from data/openings_and_endings.toml."""
    known: StoryTexts = read_table("planner_service", "openings_and_endings.toml", StoryTexts)
    return known


def time_of(*texts: str) -> str:
    """The time of day that the first text to do so speaks of: morning, afternoon, evening, night, Sunday, or day."""
    found = (time for text in texts for pattern, time in story_texts().time_patterns if pattern.search(text))
    return next(found, "day")


def tells_time(text: str) -> bool:
    """Whether a text says when it happens."""
    return time_of(text) != "day" or bool(re.search(r"\b(?:day|noon|hours?|weeks?)\b", text))


def gainsaid(opening: str, event: str) -> bool:
    """Whether a story's opening sentence claims a place or a time that its first event speaks of itself."""
    away = re.search(r"\bhome\b|\breturn|\barriv|\bback from\b|\bguests?\b|\bfriends?\b|\bvisit", event, re.IGNORECASE)
    all_of_it = re.search(r"\b(?:all|whole|until|till)\b", event)
    return bool(
        (away and re.search(r"at home|the house|alone", opening))
        or (all_of_it and re.search(r"^All that|long \{time\}|only just begun|lay ahead", opening))
    )


def title_of(theme: str, mood: str, time: str | None = None) -> str:
    """A short title: after what the theme is about, else after its mood and the time of day."""
    for pattern, title in story_texts().title_patterns:
        if pattern.search(theme):
            return title
    title = story_texts().mood_titles[mood].format(time=(time or time_of(theme)).capitalize())
    return re.sub(r"^A (?=[AEIOU])", "An ", title)
