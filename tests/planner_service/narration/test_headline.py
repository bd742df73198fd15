"""What keyframes of one's own are called: what they were given as, else what is told first."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Character, Skill
from planner_service.composition.compose import script_of
from planner_service.narration.narrator import narrate
from planner_service.narration.story_words import MAX_TITLE, headline
from planner_service.scripts.script import Keyframe

SIT = Keyframe(skill=Skill.SITDOWN, emotion="sad", caption="sitting still", furniture="sofa")


@given(st.text())
def test_a_headline_is_short_and_begins_as_its_text_does(text: str) -> None:
    found = headline(text)
    assert len(found) <= MAX_TITLE + 3
    kept = " ".join(found.split()).rstrip("…").casefold()
    assert " ".join(text.split()).casefold().lstrip(".!?… ").startswith(kept) or not kept


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("watch TV on the sofa", "Watch TV on the sofa"),
        ("She slept. Then she rose.", "She slept"),
        (
            "Sam walked listlessly over to the corner sofa and sat down wearily, chin in hand.",
            "Sam walked listlessly over",
        ),
    ],
)
def test_a_headline_ends_where_something_does(text: str, said: str) -> None:
    assert headline(text).startswith(said)
    assert not headline(text).endswith((",", ".", " and"))


def test_a_script_of_ones_own_is_called_what_it_calls_itself_else_by_its_first_words() -> None:
    assert narrate(script_of([SIT], "My evening"), Character()).title == "My evening"
    told = narrate(script_of([SIT], ""), Character())
    assert told.title
    assert told.text.casefold().startswith(told.title.rstrip("…").casefold())
