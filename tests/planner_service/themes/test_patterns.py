"""Tables of words, phrases and patterns: what does not hold together is refused by its place, and no pattern hangs."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace

import pytest
from for_each import for_each
from planner_service.extraction.deed_parser import deed_patterns

from planner_service.narration.keyframe_phrases import templates
from planner_service.narration.story_words import story_words
from planner_service.tasks.household_knowledge import Deed, household
from planner_service.themes.lexicon import Idiom, Idioms, english_verbs, idiom_in, is_verb
from planner_service.themes.patterns import MAX_PATTERN_LENGTH, expanded, with_parts
from scene_graphs.data_tables import read_table

IDIOMS = read_table("planner_service", "idioms.toml", Idioms)


def every_pattern() -> dict[str, re.Pattern[str]]:
    deeds, words = deed_patterns(), story_words().patterns
    rows = {
        "idiom": [pattern for pattern, _ in IDIOMS.patterns],
        "kind": [pattern for _, pattern in deeds.kinds],
        "kept": [pattern for pattern, _ in deeds.things],
        "lead": [deeds.lead, deeds.no_furniture],
        "times": [pattern for pattern, _ in words["times"]],
        "titles": [pattern for pattern, _ in words["titles"]],
    }
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


def test_parts_are_put_in_and_what_is_wrong_with_a_pattern_is_said_by_its_place() -> None:
    parts = expanded({"own": "(?:the|his)", "bed": "<own>\n bed"})
    assert with_parts("kind.0", "to <bed>(?<!x)(?P<more>s?)", parts) == "to (?:the|his) bed(?<!x)(?P<more>s?)"
    for pattern, fault in (("<sofa>", "there is no part <sofa>"), ("(", "missing \\)"), ("a" * 9999, "9999 letters")):
        with pytest.raises(ValueError, match=f"^kind.0: {fault}"):
            with_parts("kind.0", pattern, parts)
    with pytest.raises(ValueError, match=r"^parts\.bed: there is no part <own>"):
        expanded({"bed": "<own> bed", "own": "his"})
    assert max(len(pattern.pattern) for pattern in every_pattern().values()) < MAX_PATTERN_LENGTH


@for_each(
    ("change", "fault"),
    [
        (lambda: replace(english_verbs(), doubled="hop sit frobnicate"), "doubled: frobnicate is none"),
        (lambda: replace(english_verbs(), irregular="sit"), "irregular: 'sit' is not"),
        (lambda: replace(english_verbs(), lasting="be be"), "lasting: be stands there twice"),
        (lambda: replace(IDIOMS, idiom=(Idiom("at <whose> wits", "", "sad"),)), "idiom.0.saying: there is no part"),
        (lambda: replace(household(), any={"seat": ("sofa", "throne")}), "any.seat: 'throne' is no furniture"),
        (lambda: replace(household(), deed=(Deed(("nap",), "lie", ("any bench",)),)), "deed.0.where: bench is none"),
        (lambda: replace(household(), deed=(Deed(("water",), "operate"),)), "deed.0.how: a deed of kind operate"),
        (lambda: replace(deed_patterns(), stands_on={"tv": "altar"}), "stands_on: 'altar' is no furniture"),
        (lambda: replace(templates(), further=("to {nowhere}",)), "further: there is no blank {nowhere}"),
        (lambda: replace(templates(), touches_at={"bed": {"knee": ()}}), "touches_at.bed: knee is none"),
        (lambda: replace(story_words(), thoughts=("Oh {dear}",)), "thoughts: there is no blank {dear}"),
    ],
)
def test_a_table_that_does_not_hold_together_is_refused_by_its_place(change: Callable[[], object], fault: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(fault)}"):
        change()


def test_one_list_of_verbs_serves_reading_and_telling() -> None:
    """What is told is read, but for the verbs that are listed as nouns."""
    verbs = english_verbs()
    assert {base for base in verbs.bases if not is_verb(base)} <= set(verbs.told_only.split())
    assert not verbs.read & set(verbs.unread_forms.split())
    assert [is_verb(word) for word in ("sat", "carries", "openned", "worn", "face")] == [True, True, True, False, False]


def test_a_saying_is_known_by_its_meaning() -> None:
    assert (found := idiom_in("he climbs the walls")) is not None
    assert found.emotion == "stressed"
    assert idiom_in("he climbs the stairs") is None
