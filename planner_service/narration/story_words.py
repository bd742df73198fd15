"""Words that stories are told with besides those of themes and keyframes, and titles: both are data."""

from __future__ import annotations

import re
from functools import cache, cached_property
from typing import Final

from motion_backend.motion import Skill
from planner_service.narration.narrative_voice import require_blanks
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.things import things
from scene_graphs.data_tables import read_table, require_known, table

MAX_PATTERN_LENGTH: Final = 3000
"""Letters of a pattern."""
MAX_TITLE: Final = 60
"""Letters of a title that is made of a text's first words."""
_FIRST: Final = re.compile(r"[^.!?…]+")


@table
class Said:
    """A pattern for what a theme says, and the words for it: a time of day, or a title."""

    pattern: str
    words: str


@table
class StoryWords:
    """data/story_words.toml; what each table is for stands there."""

    after_verbs: str
    helpers: dict[str, str]
    days: dict[str, str]
    deeds: dict[str, str]
    mood_titles: dict[str, str]
    times: tuple[Said, ...]
    titles: tuple[Said, ...]

    def __post_init__(self) -> None:
        require_blanks("mood_titles", self.mood_titles, ("time",))
        require_blanks("helpers", self.helpers, ("was",))
        require_known("deeds", self.deeds, tuple(Skill))

    @cached_property
    def patterns(self) -> dict[str, tuple[tuple[re.Pattern[str], str], ...]]:
        """Of times and titles, what to look for and the words for it."""
        rows = {"times": self.times, "titles": self.titles}
        return {
            name: tuple((pattern_at(f"{name}.{at}.pattern", row.pattern), row.words) for at, row in enumerate(said))
            for name, said in rows.items()
        }


@cache
def story_words() -> StoryWords:
    """The words, from data/story_words.toml."""
    known: StoryWords = read_table("planner_service", "story_words.toml", StoryWords)
    return known


def title_of(theme: str, mood: str, thing: str = "", shown: str | None = None) -> str:
    """A short title: after what the theme is about, else a thing that something is done to, else after its mood and the
    time of day it speaks of. No story is called after things that are not among what is `shown` of it."""
    found = {
        name: next((words for pattern, words in rows if _is_about(pattern, theme, shown)), "")
        for name, rows in story_words().patterns.items()
    }
    plain = story_words().mood_titles[mood].format(time=found["times"] or "Day")
    about = f"The {thing.title()}" if thing else ""
    return found["titles"] or about or re.sub(r"^A (?=[AEIOU])", "An ", plain)


def _is_about(pattern: re.Pattern[str], theme: str, shown: str | None) -> bool:
    told = pattern.search(theme)
    is_thing = told is not None and any(lemma_of(word) in things() for word in told[0].lower().split())
    return told is not None and (not is_thing or shown is None or pattern.search(shown) is not None)


def headline(text: str) -> str:
    """A text's first sentence, short enough for a title: up to a comma or an "and", or its first words."""
    first = _FIRST.match(" ".join(text.split()))
    words = first[0].rstrip(" .,;:") if first else ""
    if len(words) > MAX_TITLE:
        whole = max(words.rfind(joint, 0, MAX_TITLE) for joint in (",", " and ", " then "))
        space = words.rfind(" ", 0, MAX_TITLE)
        words = words[:whole] if whole > 0 else f"{words[: max(space, 0) or MAX_TITLE]}…"
    return words[:1].upper() + words[1:]


@cache
def pattern_at(place: str, pattern: str) -> re.Pattern[str]:
    """A pattern of a table, whatever the letters' case; breaks between lines count for nothing. ValueError says at
    which place in the data what is wrong."""
    whole = pattern.replace("\n", "")
    if len(whole) > MAX_PATTERN_LENGTH:
        raise ValueError(f"{place}: {len(whole)} letters, at most {MAX_PATTERN_LENGTH} are compiled")
    try:
        return re.compile(whole, re.IGNORECASE)
    except re.error as error:
        raise ValueError(f"{place}: {error} in {whole[:60]!r}") from error
